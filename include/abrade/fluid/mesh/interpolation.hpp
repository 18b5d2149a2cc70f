#pragma once
// What a field on a grid is at a point: linear between cells or faces.

#include <abrade/fluid/fluid_model.hpp>
#include <abrade/fluid/mesh/grid.hpp>

#include <algorithm>
#include <cmath>

namespace abrade {

/// Between which two numbers along an axis a place lies, and how near to the upper one [-]. Along a periodic
/// axis they may be those of ghosts.
struct GridPlace {
    int low = 0;
    Real weight = 0;
};

namespace detail {

/// `at(i)`: coordinate of number i, rising, first <= i <= last. Places beyond are taken to the end.
GridPlace place_between(Real x, int first, int last, Real gap, bool even, auto&& at) noexcept {
    if (last == first) return {first};
    int low = first;
    if (even) {
        const Real number = (x - at(first)) / gap;  // NaN: the first
        low += number > 0 ? static_cast<int>(std::min(number, static_cast<Real>(last - first - 1))) : 0;
    } else {
        for (int end = last; end - low > 1;) {
            const int middle = (low + end) / 2;
            (at(middle) <= x ? low : end) = middle;
        }
    }
    return {low, std::clamp((x - at(low)) / (at(low + 1) - at(low)), Real(0), Real(1))};
}

/// Where a place beyond a periodic box stands inside.
template <int Dim>
Real wrapped(const Grid<Dim>& grid, int axis, Real x) noexcept {
    const Real length = grid.high(axis) - grid.low(axis);
    return x - length * std::floor((x - grid.low(axis)) / length);
}

/// Over density [m5/s2] (m4/s2 in 2-D): of each cell half the mean square of the speed at its faces, times
/// its volume and what is `liquid_fraction` of it [-]; none: all.
template <int Dim, class Number>
Real kinetic_energy(const Grid<Dim>& grid, const FaceField<Dim, Number>& velocity,
                    const Field<Real>* liquid_fraction) {
    Real sum = 0;
    grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
        Real squares = 0;
        for (int a = 0; a < Dim; ++a)
            squares += square(velocity[a][c]) + square(velocity[a][c + grid.layout().stride[a]]);
        sum += 0.25 * squares * (liquid_fraction ? (*liquid_fraction)[c] : 1) * grid.volume(cell);
    });
    return sum;
}

}  // namespace detail

/// A place beyond the box is taken to its end, along a periodic axis to where it stands inside.
template <int Dim>
GridPlace place_among_centres(const Grid<Dim>& grid, int axis, Real x, bool periodic) noexcept {
    return detail::place_between(periodic ? detail::wrapped(grid, axis, x) : x, periodic ? -1 : 0,
                                 grid.cells(axis) - 1 + periodic, grid.size(axis, 0),
                                 axis != Grid<Dim>::vertical || grid.uniform(),
                                 [&](int i) { return grid.centre(axis, i); });
}
template <int Dim>
GridPlace place_among_faces(const Grid<Dim>& grid, int axis, Real x, bool periodic) noexcept {
    return detail::place_between(periodic ? detail::wrapped(grid, axis, x) : x, 0, grid.cells(axis),
                                 grid.size(axis, 0), axis != Grid<Dim>::vertical || grid.uniform(),
                                 [&](int i) { return grid.face(axis, i); });
}

/// Component a of a staggered field at a point: it stands on lower faces along a, in the middle of cells
/// along the others. Ghosts beyond periodic ends are to be filled.
template <int Dim, class Number>
Real face_value(const Grid<Dim>& grid, const PerAxis<bool, Dim>& periodic, const Field<Number>& component,
                int a, const Point<Dim>& x) noexcept {
    CellNumber<Dim> low{};
    PerAxis<Real, Dim> weight{};
    for (int b = 0; b < Dim; ++b) {
        const GridPlace at = b == a ? place_among_faces(grid, b, x[b], periodic[b])
                                    : place_among_centres(grid, b, x[b], periodic[b]);
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

namespace detail {

/// In two dimensions without y.
template <int Dim>
Point<Dim> in_plane(const Vec3& x) noexcept {
    Point<Dim> at;
    at[0] = x[0], at[Dim - 1] = x[2];
    if constexpr (Dim == 3) at[1] = x[1];
    return at;
}

/// At a place, of a velocity and of that `seconds` before; none: it does not change.
template <int Dim, class Number>
FlowChange flow_change(const Grid<Dim>& grid, const PerAxis<bool, Dim>& periodic,
                       const FaceField<Dim, Number>& u, const FaceField<Dim, Number>* before, Real seconds,
                       const Point<Dim>& x) noexcept {
    const auto of_space = [](int a) { return a == Dim - 1 ? 2 : a; };
    FlowChange change;
    Vec3 velocity = Vec3::Zero();
    for (int a = 0; a < Dim; ++a) {
        const Real now = face_value(grid, periodic, u[a], a, x);
        velocity[of_space(a)] = now;
        if (before)
            change.acceleration[of_space(a)] =
                (now - face_value(grid, periodic, (*before)[a], a, x)) / seconds;
        for (int b = 0; b < Dim; ++b) {
            const Real half = 0.5 * grid.smallest(b);
            Point<Dim> low = x, high = x;
            low[b] -= half, high[b] += half;
            if (!periodic[b])
                low[b] = std::max(low[b], grid.low(b)), high[b] = std::min(high[b], grid.high(b));
            if (!(high[b] > low[b])) continue;
            change.gradient(of_space(a), of_space(b)) =
                (face_value(grid, periodic, u[a], a, high) - face_value(grid, periodic, u[a], a, low)) /
                (high[b] - low[b]);
        }
    }
    change.acceleration += change.gradient * velocity;
    return change;
}

}  // namespace detail

}  // namespace abrade
