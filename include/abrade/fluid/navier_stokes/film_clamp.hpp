#pragma once
// Liquid on walls that has no pressure of its own: films thinner than half a cell.

#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>
#include <abrade/fluid/mesh/row_index.hpp>
#include <abrade/fluid/mesh/volume_tolerance.hpp>
#include <abrade/fluid/mesh/water_cells.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace abrade::detail {

/// Liquid between dry cells flies: nothing would ever hold it up on the wall that it lies on. A wall takes
/// from it what moves into the wall, as an inelastic impact does, and leaves what moves along the wall or off
/// it:
///   v <- v - min(v . n, 0) n,   v: velocity of the faces that the cell gives liquid to, n: the wall's
///   normal, which the divergence theorem gives from the apertures of the cell's faces, sides of the box
///   included.
/// Where all of them are open or closed as a whole, each axis has a wall of its own: a corner.
template <int Dim>
class FilmClamp {
public:
    FilmClamp() = default;
    /// `walls`: inside the box; may be none. `gravity`: its amount [m/s2].
    FilmClamp(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries,
              const EmbeddedBoundary<Dim>* walls, Real gravity)
        : fastest_fall_(2 * gravity * grid.largest(Dim - 1)) {
        const Layout<Dim>& layout = grid.layout();
        grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            if (walls && walls->open_fraction()[c] == 0) return;
            Cell film{.cell = c};
            bool aligned = true;
            for (int a = 0; a < Dim; ++a) {
                const Offset s = layout.stride[a];
                PerAxis<Real, 2> open{{1, 1}};
                for (const int end : {0, 1}) {
                    const bool at_side = end == 0 ? cell[a] == 0 : cell[a] + 1 == grid.cells(a);
                    Offset face = c + end * s, beyond = end == 0 ? c - s : c + s;
                    if (walls) open[end] = walls->aperture()[a][face];
                    if (at_side && is_closed(boundaries[a][end])) open[end] = 0;
                    aligned = aligned && (open[end] == 0 || open[end] == 1);
                    if (at_side && boundaries.periodic(a)) {
                        const Offset around = grid.cells(a) * s * (end == 0 ? 1 : -1);
                        beyond += around, face += end == 0 ? 0 : around;
                    }
                    // Sides that let water through have velocities of their own.
                    const bool moves = open[end] > 0 && (!at_side || boundaries.periodic(a));
                    film.face[a][end] = moves ? face : -1;
                    film.beyond[a][end] = beyond;
                }
                film.normal[a] = (open[1] - open[0]) / grid.size(a, cell[a]);
            }
            film.corner = aligned;
            constexpr Real round_off = 1e-9;
            const Real length = film.normal.norm();
            if (!(length * grid.size(Dim - 1, cell[Dim - 1]) > round_off)) return;
            film.normal /= length;
            cells_.push_back(film);
        });
        std::ranges::sort(cells_, {}, &Cell::cell);
        push_.resize(cells_.size(), Point<Dim>::Zero());
        starts_ = {layout, cells_.size(), [&](std::size_t k) { return cells_[k].cell; }};
    }

    /// `wet`: 1 where there is a pressure; `liquid_fraction`: liquid of a cell, as a share of it [-]; `rows`
    /// hold it.
    void hold(FaceField<Dim>& u, const WetRows<Dim>& rows, const Field<std::uint8_t>& wet,
              const Field<Real>& liquid_fraction) {
        // A face is a cell's where the cell gives liquid to it, or the next one has none to give: or little,
        // and its face is faster than the fall through a cell that brings that here.
        constexpr Real little = 0.1;  // of what the cell holds
        const auto gives = [&](const Cell& film, int a, int end, Real speed, Real push = 0) {
            const Real none =
                square(speed) > fastest_fall_ ? little * liquid_fraction[film.cell] : volume_tolerance::face;
            return film.face[a][end] >= 0 && wet[film.beyond[a][end]] == 0 &&
                   (liquid_fraction[film.beyond[a][end]] <= none ||
                    (end == 0 ? speed + push < 0 : speed + push > 0));
        };
        starts_.for_each(&rows, [&](std::size_t k) {
            const Cell& film = cells_[k];
            push_[k].setZero();
            if (wet[film.cell] != 0 || liquid_fraction[film.cell] <= volume_tolerance::face) return;
            Point<Dim> v = Point<Dim>::Zero();
            for (int a = 0; a < Dim; ++a) {
                int count = 0;
                for (const int end : {0, 1})
                    if (const Offset f = film.face[a][end]; f >= 0 && gives(film, a, end, u[a][f]))
                        v[a] += u[a][f], ++count;
                if (count == 2) v[a] *= 0.5;
            }
            if (film.corner)
                for (int a = 0; a < Dim; ++a) push_[k][a] = film.normal[a] * v[a] < 0 ? -v[a] : Real(0);
            else
                push_[k] = std::max(-film.normal.dot(v), Real(0)) * film.normal;
        });
        // A face is the upper one of one cell, the lower one of another: cells of both planes may give to it.
        for (const int end : {0, 1})
            starts_.for_each(&rows, [&](std::size_t k) {
                if (push_[k].isZero(0)) return;
                for (int a = 0; a < Dim; ++a) {
                    const Offset face = cells_[k].face[a][end];
                    if (face >= 0 && gives(cells_[k], a, end, u[a][face], push_[k][a]))
                        u[a][face] += push_[k][a];
                }
            });
    }

private:
    struct Cell {
        Offset cell = 0;
        PerAxis<PerAxis<Offset, 2>, Dim> face{};    ///< [axis][low, high]; -1: closed, or a side's own
        PerAxis<PerAxis<Offset, 2>, Dim> beyond{};  ///< cells there
        Point<Dim> normal = Point<Dim>::Zero();     ///< into the water
        bool corner = false;                        ///< of walls along the grid's planes alone
    };
    Real fastest_fall_ = 0;         ///< through a cell, squared [m2/s2]
    std::vector<Cell> cells_;       ///< beside a wall or a closed side, in the order of memory
    std::vector<Point<Dim>> push_;  ///< [m/s], of each
    RowStarts<Dim> starts_;
};

}  // namespace abrade::detail
