#pragma once
// Copies of cells beyond the sides of a box.

#include <abrade/fluid/mesh/boundary_conditions.hpp>
#include <abrade/fluid/mesh/wet_rows.hpp>

namespace abrade {

/// Copies all cells with number `from` along an axis, those beyond other sides included, to number `to`.
template <int Dim, class Number>
void copy_layer(Field<Number>& field, const Layout<Dim>& layout, int axis, int from, int to) noexcept {
    constexpr int ghosts = Layout<Dim>::ghosts;
    // The ghosts above a row stand in the first half of what pads the next one.
    Number* data = field.data() + Layout<Dim>::lanes / 2;
    const Offset planes = layout.planes() + 2 * ghosts, plane = layout.stride[Layout<Dim>::outer];
    if (axis == Layout<Dim>::outer) {
        std::copy_n(data + (from + ghosts) * plane, plane, data + (to + ghosts) * plane);
    } else if (axis != Layout<Dim>::inner) {
        const Offset row = layout.stride[axis];
        for (Offset p = 0; p < planes; ++p)
            std::copy_n(data + p * plane + (from + ghosts) * row, row,
                        data + p * plane + (to + ghosts) * row);
    } else {
        for (int p = -ghosts; p < layout.planes() + ghosts; ++p)
            for (int r = Dim == 3 ? -ghosts : 0; r < layout.rows_per_plane() + (Dim == 3 ? ghosts : 0); ++r) {
                Number* row = field.data() + layout.row_start(p, r);
                row[to] = row[from];
            }
    }
}

/// The cell along a periodic axis of n that ghost g beyond an end is a copy of: an axis of one cell is its
/// own neighbour, twice over.
constexpr int copied_cell(int n, bool high, int g) noexcept { return high ? g % n : n - 1 - g % n; }

/// Ghosts beyond both ends of a periodic axis.
template <int Dim, class Number>
void wrap_axis(Field<Number>& field, const Layout<Dim>& layout, int axis) noexcept {
    const int n = layout.cells[axis];
    for (int g = 0; g < Layout<Dim>::ghosts; ++g) {
        copy_layer(field, layout, axis, copied_cell(n, false, g), -1 - g);
        copy_layer(field, layout, axis, copied_cell(n, true, g), n + g);
    }
}

/// Ghosts beyond periodic ends, of a cell field or of all components of a velocity.
template <int Dim, class Number>
void fill_periodic(Field<Number>& field, const Layout<Dim>& layout,
                   const BoundaryConditions<Dim>& boundaries) noexcept {
    for (int a = 0; a < Dim; ++a)
        if (boundaries.periodic(a)) wrap_axis(field, layout, a);
}
template <int Dim, class Number>
void fill_periodic(FaceField<Dim, Number>& field, const Layout<Dim>& layout,
                   const BoundaryConditions<Dim>& boundaries) noexcept {
    for (auto& component : field) fill_periodic(component, layout, boundaries);
}

/// Ghosts beyond all sides but those of an inflow, which are given: periodic, or as the cell inside. Rows get
/// their ends filled where `rows` has them, dry ones are left as they are.
template <int Dim, class Number>
void fill_ghosts(Field<Number>& field, const WetRows<Dim>& rows, const BoundaryConditions<Dim>& boundaries) {
    const Layout<Dim>& layout = rows.layout();
    constexpr int inner = Layout<Dim>::inner, ghosts = Layout<Dim>::ghosts;
    const auto source = [&](int axis, bool high, int g) {
        const int n = layout.cells[static_cast<std::size_t>(axis)];
        return boundaries.periodic(axis) ? copied_cell(n, high, g) : high ? n - 1 : 0;
    };
    rows.for_each_row([&](int plane, int r, const RowRange&) {
        Number* row = field.data() + layout.row_start(plane, r);
        for (int g = 0; g < ghosts; ++g) {
            if (boundaries[inner][0] != Boundary::inflow) row[-1 - g] = row[source(inner, false, g)];
            if (boundaries[inner][1] != Boundary::inflow)
                row[layout.row_length() + g] = row[source(inner, true, g)];
        }
    });
    // The other axes copy whole rows, ends included.
    for (int a = Dim - 1; a >= 0; --a) {
        if (a == inner) continue;
        const int n = layout.cells[static_cast<std::size_t>(a)];
        for (int g = 0; g < ghosts; ++g) {
            if (boundaries[a][0] != Boundary::inflow)
                copy_layer(field, layout, a, source(a, false, g), -1 - g);
            if (boundaries[a][1] != Boundary::inflow) copy_layer(field, layout, a, source(a, true, g), n + g);
        }
    }
}

}  // namespace abrade
