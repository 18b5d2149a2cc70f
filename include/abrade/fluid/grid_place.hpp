#pragma once
// What a field on a grid is at a point: linear between cells or faces.

#include <abrade/fluid/grid.hpp>

#include <algorithm>

namespace abrade {

/// Between which two numbers along an axis a place lies, and how near to the upper one [-].
struct GridPlace {
    int low = 0;
    Real weight = 0;
};

namespace detail {

/// `at(i)`: coordinate of number i, rising, 0 <= i <= last. Places beyond are taken to the end.
GridPlace place_between(Real x, int last, Real first_gap, bool even, auto&& at) noexcept {
    if (last == 0) return {};
    int low = 0;
    if (even) {
        const Real number = (x - at(0)) / first_gap;
        low = number > 0 ? static_cast<int>(std::min(number, static_cast<Real>(last - 1))) : 0;  // NaN: 0
    } else {
        for (int end = last; end - low > 1;) {
            const int middle = (low + end) / 2;
            (at(middle) <= x ? low : end) = middle;
        }
    }
    return {low, std::clamp((x - at(low)) / (at(low + 1) - at(low)), Real(0), Real(1))};
}

}  // namespace detail

template <int Dim>
GridPlace place_among_centres(const Grid<Dim>& grid, int axis, Real x) noexcept {
    return detail::place_between(x, grid.cells(axis) - 1, grid.size(axis, 0),
                                 axis != Grid<Dim>::vertical || grid.uniform(),
                                 [&](int i) { return grid.centre(axis, i); });
}
template <int Dim>
GridPlace place_among_faces(const Grid<Dim>& grid, int axis, Real x) noexcept {
    return detail::place_between(x, grid.cells(axis), grid.size(axis, 0),
                                 axis != Grid<Dim>::vertical || grid.uniform(),
                                 [&](int i) { return grid.face(axis, i); });
}

/// Component a of a staggered field at a point: it stands on lower faces along a, in the middle of cells
/// along the others.
template <int Dim, class Number>
Real face_value(const Grid<Dim>& grid, const Field<Number>& component, int a, const Point<Dim>& x) noexcept {
    CellNumber<Dim> low{};
    PerAxis<Real, Dim> weight{};
    for (int b = 0; b < Dim; ++b) {
        const GridPlace at = b == a ? place_among_faces(grid, b, x[b]) : place_among_centres(grid, b, x[b]);
        low[b] = at.low, weight[b] = at.weight;
    }
    const Offset from = grid.layout().at(low);
    Real sum = 0;
    for (int corner = 0; corner < 1 << Dim; ++corner) {
        Real share = 1;
        Offset c = from;
        for (int b = 0; b < Dim; ++b) {
            const bool up = corner >> b & 1;
            share *= up ? weight[b] : 1 - weight[b];
            c += up ? grid.layout().stride[b] : 0;
        }
        if (share > 0) sum += share * static_cast<Real>(component[c]);
    }
    return sum;
}

}  // namespace abrade
