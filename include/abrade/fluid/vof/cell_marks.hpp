#pragma once
// What is known of each cell before anything flows: see cell_mark.

#include <abrade/fluid/mesh/ghost_cells.hpp>
#include <abrade/fluid/mesh/volume_tolerance.hpp>
#include <abrade/fluid/vof/planes.hpp>

namespace abrade {

namespace detail {

/// Marks `mark` where all cells within reach[axis] along the axes are whole.
template <int Dim>
void mark_surrounded(Field<std::uint8_t>& marks, const Grid<Dim>& grid, const CellNumber<Dim>& reach,
                     std::uint8_t mark) {
    const Layout<Dim>& layout = grid.layout();
    Field<std::uint8_t> now(layout.total, 0), next(layout.total, 0);
    grid.for_each([&](const CellNumber<Dim>&, Offset c) { now[c] = marks[c] & cell_mark::whole; },
                  Layout<Dim>::ghosts);
    for (int a = 0; a < Dim; ++a) {
        const Offset step = layout.stride[a];
        const int far = reach[a], edge = Layout<Dim>::ghosts - far;  // no farther than the ghosts
        next.fill(0);
        // Cells beyond other sides are looked at later, along their axes.
        grid.for_each(
            [&](const CellNumber<Dim>& cell, Offset c) {
                if (cell[a] < -edge || cell[a] >= layout.cells[a] + edge) return;
                std::uint8_t all = 1;
                for (int k = -far; k <= far; ++k) all = static_cast<std::uint8_t>(all & now[c + k * step]);
                next[c] = all;
            },
            Layout<Dim>::ghosts);
        std::swap(now, next);
    }
    grid.for_each([&](const CellNumber<Dim>&, Offset c) {
        if (now[c] != 0) marks[c] = static_cast<std::uint8_t>(marks[c] | mark);
    });
}

}  // namespace detail

/// Marks of all cells; `open_fractions` [-] are the shares that walls leave, none: all open.
template <int Dim>
Field<std::uint8_t> surface_marks(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries,
                                  const Field<Real>* open_fractions) {
    const Layout<Dim>& layout = grid.layout();
    Field<std::uint8_t> marks(layout.total, 0);
    const auto of = [&](Offset c) {
        const Real share = open_fractions ? (*open_fractions)[c] : 1;
        return static_cast<std::uint8_t>((share > volume_tolerance::open ? cell_mark::open : 0) |
                                         (share > 1 - 1e-9 ? cell_mark::whole : 0));
    };
    grid.for_each(
        [&](const CellNumber<Dim>& cell, Offset c) {
            int beyond = 0;
            bool given = true;  // by an inflow
            for (int a = 0; a < Dim; ++a) {
                const int i = cell[a];
                const int end = i < 0 ? 0 : i >= grid.cells(a) ? 1 : -1;
                if (end < 0) continue;
                ++beyond;
                given = given && boundaries[a][end] == Boundary::inflow;
            }
            if (beyond == 0)
                marks[c] = static_cast<std::uint8_t>(of(c) | cell_mark::inside);
            else if (given)
                marks[c] = of(c);
        },
        Layout<Dim>::ghosts);
    // Ghosts beyond periodic ends are what they are copies of, but for their place.
    Field<std::uint8_t> copies = marks;
    fill_periodic(copies, layout, boundaries);
    grid.for_each(
        [&](const CellNumber<Dim>&, Offset c) {
            if ((marks[c] & cell_mark::inside) == 0)
                marks[c] = static_cast<std::uint8_t>(copies[c] & ~cell_mark::inside);
        },
        Layout<Dim>::ghosts);
    CellNumber<Dim> reach;
    reach.fill(1);
    detail::mark_surrounded(marks, grid, reach, cell_mark::ringed);
    for (int a = 0; a < Dim; ++a) {
        reach.fill(1);
        reach[a] = 3;
        detail::mark_surrounded(marks, grid, reach, cell_mark::deep(a));
    }
    return marks;
}

}  // namespace abrade
