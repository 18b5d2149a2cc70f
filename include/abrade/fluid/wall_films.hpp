#pragma once
// Liquid on walls that has no pressure of its own: films thinner than half a cell.

#include <abrade/fluid/row_starts.hpp>
#include <abrade/fluid/walls.hpp>
#include <abrade/fluid/water_cells.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace abrade::detail {

/// Liquid between dry cells flies: nothing would ever hold it up on the wall that it lies on. A wall takes
/// from it what moves into the wall, as an inelastic impact does, and leaves what moves along the wall or off
/// it:
///   v <- v - min(v . n, 0) n,   v: mean velocity of the cell's open faces, n: the wall's normal, which the
///   divergence theorem gives from the apertures of the cell's faces, sides of the box included.
/// The kinetic energy of a film falls by that, never grows. A face takes its change from both of its cells,
/// in shares of the liquid that they hold.
template <int Dim>
class WallFilms {
public:
    WallFilms() = default;
    /// `walls`: inside the box; may be none.
    WallFilms(const Grid<Dim>& grid, const Sides<Dim>& sides, const Walls<Dim>* walls) {
        const Layout<Dim>& layout = grid.layout();
        grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            if (walls && walls->open_volume()[c] == 0) return;
            Cell film{.cell = c};
            for (int a = 0; a < Dim; ++a) {
                const Offset s = layout.stride[a];
                PerAxis<Real, 2> open{{1, 1}};
                for (const int end : {0, 1}) {
                    const bool at_side = end == 0 ? cell[a] == 0 : cell[a] + 1 == grid.cells(a);
                    Offset face = c + end * s, beyond = end == 0 ? c - s : c + s;
                    if (walls) open[end] = walls->open_area()[a][face];
                    if (at_side && is_closed(sides[a][end])) open[end] = 0;
                    if (at_side && sides.periodic(a)) {
                        const Offset around = grid.cells(a) * s * (end == 0 ? 1 : -1);
                        beyond += around, face += end == 0 ? 0 : around;
                    }
                    // Sides that let water through have velocities of their own.
                    const bool moves = open[end] > 0 && (!at_side || sides.periodic(a));
                    film.face[a][end] = moves ? face : -1;
                    film.beyond[a][end] = beyond;
                }
                film.normal[a] = (open[1] - open[0]) / grid.size(a, cell[a]);
            }
            constexpr Real round_off = 1e-9;
            const Real length = film.normal.norm();
            if (!(length * grid.size(Dim - 1, cell[Dim - 1]) > round_off)) return;
            film.normal /= length;
            cells_.push_back(film);
        });
        push_.resize(cells_.size());
        starts_ = {layout, cells_.size(), [&](std::size_t k) { return cells_[k].cell; }};
    }

    /// `wet`: 1 where there is a pressure; `held`: liquid of a cell, as a share of it [-]; `rows` hold it.
    void hold(FaceField<Dim>& u, const WetRows<Dim>& rows, const Field<std::uint8_t>& wet,
              const Field<Real>& held) {
        std::fill(push_.begin(), push_.end(), 0);
        starts_.for_each(&rows, [&](std::size_t k) {
            const Cell& film = cells_[k];
            if (wet[film.cell] != 0 || held[film.cell] <= liquid_of_a_face) return;
            Real into = 0;
            for (int a = 0; a < Dim; ++a) into += mean(u[a], film.face[a]) * film.normal[a];
            push_[k] = std::max(-into, Real(0));
        });
        for (std::size_t k = 0; k < cells_.size(); ++k) {  // one after the other: faces are shared
            if (push_[k] == 0) continue;
            const Cell& film = cells_[k];
            for (int a = 0; a < Dim; ++a)
                for (const int end : {0, 1}) {
                    const Offset face = film.face[a][end], beyond = film.beyond[a][end];
                    if (face < 0 || wet[beyond] != 0) continue;
                    const Real own = held[film.cell];
                    u[a][face] += push_[k] * film.normal[a] * own / (own + held[beyond]);
                }
        }
    }

private:
    struct Cell {
        Offset cell = 0;
        PerAxis<PerAxis<Offset, 2>, Dim> face{};    ///< [axis][low, high]; -1: closed, or a side's own
        PerAxis<PerAxis<Offset, 2>, Dim> beyond{};  ///< cells there
        Point<Dim> normal = Point<Dim>::Zero();     ///< into the water
    };
    static Real mean(const Field<Real>& u, const PerAxis<Offset, 2>& face) noexcept {
        const auto at = [&](int end) { return face[end] < 0 ? Real(0) : u[face[end]]; };
        return (at(0) + at(1)) / std::max((face[0] >= 0) + (face[1] >= 0), 1);
    }

    std::vector<Cell> cells_;  ///< beside a wall or a closed side, in the order of memory
    std::vector<Real> push_;   ///< [m/s], of each
    RowStarts<Dim> starts_;
};

}  // namespace abrade::detail
