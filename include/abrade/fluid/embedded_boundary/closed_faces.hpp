#pragma once
// Velocities of faces that walls close, for the water that flows past them.

#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace abrade::detail {

/// A wall that is oblique to the grid closes faces of cells in which there is water. The control volume of
/// such a face, at rest, would take momentum from the inflow and give none to the outflow: a stream along a
/// frictionless bed lost a fifth of its head behind a bump. So while momentum is advected a closed face of a
/// full cell moves along the wall:
///   u_a = v_a - n_a (n . v), kept between 0 and v_a, and between 0 and each w,
///   v  mean velocity of the cell's open faces, weighted by what is open of them [m/s]
///   n  unit normal of the wall, into the water
///   w  velocity of an open face beside the closed one along the same axis [m/s]
/// A closed face that moved faster than w would drive the flow, which then gains energy. Where the wall is
/// square to the axis u_a is 0. Between two cells with oblique walls it is the mean of both, 0 from a cell
/// that is not full at the beginning and at the end of the step.
template <int Dim>
class ClosedFaces {
public:
    ClosedFaces() = default;
    ClosedFaces(const EmbeddedBoundary<Dim>& walls, const BoundaryConditions<Dim>& boundaries)
        : layout_(walls.grid().layout()), boundaries_(boundaries) {
        const auto& open = walls.aperture();
        Field<std::int32_t> number(layout_.total, -1);
        for (const CutCell<Dim>& wall : walls.cut_cells()) {
            if (walls.open_fraction()[wall.cell] == 0) continue;
            Cell cell{wall.cell, nearly * walls.open_fraction()[wall.cell], wall.normal};
            for (int a = 0; a < Dim; ++a) {
                const Real low = open[a][wall.cell], high = open[a][wall.cell + layout_.stride[a]];
                cell.upper[a] = low + high > 0 ? high / (low + high) : 0;
                cell.lower[a] = low + high > 0 ? low / (low + high) : 0;
            }
            number[wall.cell] = static_cast<std::int32_t>(cells_.size());
            cells_.push_back(cell);
        }
        fill_periodic(number, layout_, boundaries_);
        walls.grid().for_each([&](const CellNumber<Dim>& of, Offset c) {
            for (int a = 0; a < Dim; ++a) {
                if (of[a] == 0 && !boundaries_.periodic(a)) continue;  // a side's own
                Face face{c, a, number[c - layout_.stride[a]], number[c]};
                if (open[a][c] != 0 || (!moves(face.below, a) && !moves(face.above, a))) continue;
                for (int b = 0; b < Dim; ++b)
                    face.open_beside |= unsigned{open[a][c - layout_.stride[b]] > 0} << 2 * b |
                                        unsigned{open[a][c + layout_.stride[b]] > 0} << (2 * b + 1);
                faces_.push_back(face);
            }
        });
    }

    /// `before`, `now`: liquid in a cell when the step began and at its end, as a share of the whole cell
    /// [-].
    void fill(FaceField<Dim>& u, const Field<Real>& before, const Field<Real>& now) const {
        set(u, [&](const Face& f) {
            Real sum = 0;
            int count = 0;
            for (const std::int32_t n : {f.below, f.above}) {
                if (!moves(n, f.axis)) continue;
                ++count;
                const Cell& cell = cells_[static_cast<std::size_t>(n)];
                if (std::min(before[cell.cell], now[cell.cell]) > cell.full)
                    sum += along_wall(cell, u, f.axis);
            }
            return no_faster(sum / count, f, u[f.axis]);
        });
    }
    void clear(FaceField<Dim>& u) const {
        set(u, [](const Face&) { return Real(0); });
    }

private:
    static constexpr Real nearly = 0.99;  ///< of what is open: the last step left a trace of air
    struct Cell {
        Offset cell = 0;
        Real full = 0;  ///< liquid beyond which it counts as full [-]
        Point<Dim> normal = Point<Dim>::Zero();
        Point<Dim> lower = Point<Dim>::Zero(),
                   upper = Point<Dim>::Zero();  ///< shares of v along each axis [-]
    };
    struct Face {
        Offset face = 0;
        int axis = 0;
        std::int32_t below = -1, above = -1;  ///< cells, by number; -1: no wall is in it
        unsigned open_beside =
            0;  ///< bit 2 b: the lower neighbour along b is open, bit 2 b + 1: the upper one
    };

    /// Whether water of a cell moves along an axis at its wall.
    bool moves(std::int32_t n, int axis) const noexcept {
        constexpr Real square_to_it = 1 - 1e-9;
        return n >= 0 && std::abs(cells_[static_cast<std::size_t>(n)].normal[axis]) < square_to_it;
    }
    Real along_wall(const Cell& cell, const FaceField<Dim>& u, int axis) const noexcept {
        Point<Dim> v = Point<Dim>::Zero();
        for (int a = 0; a < Dim; ++a) {  // open faces only: other threads write the closed ones
            if (cell.lower[a] > 0) v[a] += cell.lower[a] * u[a][cell.cell];
            if (cell.upper[a] > 0) v[a] += cell.upper[a] * u[a][cell.cell + layout_.stride[a]];
        }
        const auto [least, most] = std::minmax({v[axis], Real(0)});
        return std::clamp(v[axis] - cell.normal[axis] * cell.normal.dot(v), least, most);
    }
    Real no_faster(Real speed, const Face& face, const Field<Real>& u) const noexcept {
        Real least = std::min(speed, Real(0)), most = std::max(speed, Real(0));
        for (int b = 0; b < Dim; ++b)
            for (const int end : {0, 1}) {
                if ((face.open_beside >> (2 * b + end) & 1) == 0) continue;
                const Real beside = u[face.face + (end == 0 ? -1 : 1) * layout_.stride[b]];
                most = std::min(most, std::max(beside, Real(0)));
                least = std::max(least, std::min(beside, Real(0)));
            }
        return std::clamp(speed, least, most);
    }
    void set(FaceField<Dim>& u, auto&& of) const {
        if (faces_.empty()) return;
        parallel_for(static_cast<Index>(faces_.size()), [&](Index n) {
            const Face& face = faces_[static_cast<std::size_t>(n)];
            u[face.axis][face.face] = of(face);
        });
        for (auto& component : u) fill_periodic(component, layout_, boundaries_);
    }

    Layout<Dim> layout_;
    BoundaryConditions<Dim> boundaries_;
    std::vector<Cell> cells_;
    std::vector<Face> faces_;
};

}  // namespace abrade::detail
