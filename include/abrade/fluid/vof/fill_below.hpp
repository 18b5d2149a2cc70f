#pragma once
// Liquid fractions of a shape.

#include <abrade/fluid/mesh/grid.hpp>
#include <abrade/fluid/vof/plic.hpp>

namespace abrade {

namespace detail {

template <int Dim>
Real fraction_of_box(const auto& distance, const Point<Dim>& centre, const Point<Dim>& size, int depth) {
    const Real d = distance(centre);
    // A distance changes by no more than the way.
    if (std::abs(d) > 0.5 * size.norm()) return d < 0 ? 1 : 0;
    if (depth > 0) {
        const Point<Dim> half = 0.5 * size;
        Real sum = 0;
        for (int corner = 0; corner < 1 << Dim; ++corner) {
            Point<Dim> part = centre;
            for (int a = 0; a < Dim; ++a) part[a] += (corner >> a & 1 ? 0.5 : -0.5) * half[a];
            sum += fraction_of_box<Dim>(distance, part, half, depth - 1);
        }
        return sum / (1 << Dim);
    }
    std::array<Real, Dim> normal;
    for (int a = 0; a < Dim; ++a) {
        Point<Dim> aside = Point<Dim>::Zero();
        aside[a] = 0.5 * size[a];
        normal[static_cast<std::size_t>(a)] = distance(centre + aside) - distance(centre - aside);
    }
    return fraction_below<Dim>(normal, -d);
}

}  // namespace detail

/// Share of each cell where `distance(x)` < 0, a signed distance [m] to the liquid's surface (or any function
/// that changes by no more than the way). Cells at the surface are cut in half `depth` times along each axis,
/// the smallest parts by the plane that the distance's differences give: exact for planes, and for others the
/// error falls by 4 with each cut. Ghosts are filled too.
template <int Dim>
void fill_below(Field<Real>& fraction, const Grid<Dim>& grid, const auto& distance, int depth = 3) {
    grid.for_each(
        [&](const CellNumber<Dim>& cell, Offset c) {
            Point<Dim> size;
            for (int a = 0; a < Dim; ++a) size[a] = grid.size(a, cell[static_cast<std::size_t>(a)]);
            fraction[c] = detail::fraction_of_box<Dim>(distance, grid.centre(cell), size, depth);
        },
        Layout<Dim>::ghosts);
}

}  // namespace abrade
