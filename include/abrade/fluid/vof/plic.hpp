#pragma once
// A plane that cuts a cell: the volume below it, and where it stands for a given volume.

#include <abrade/core/pack.hpp>
#include <abrade/core/simd.hpp>

#include <array>
#include <cmath>
#include <cstring>

namespace abrade {

/// A plane in a cell, in units of the cell: its centre is the origin, its edges have length 1. Liquid is
/// where
///   normal . xi <= distance.
/// A plane n . (x - centre) = d of a cell with edges h [m] has normal_a = n_a h_a and the same distance, so
/// cells need not be cubes. Any scale of the normal will do.
template <int Dim, class Number = Real>
struct CellPlane {
    std::array<Number, Dim> normal{};
    Number distance{};
};

namespace detail {

template <class Number>
Number magnitude(Number x) noexcept {
    return max(x, -x);
}
template <class Number>
Number positive(Number x) noexcept {
    return max(x, Number(0));
}

inline Real cube_root(Real x) noexcept { return std::cbrt(x); }
/// For 0 <= x <= 1. A third of the exponent, which is within 4 % (the bits of a number are its logarithm,
/// nearly), then three of Halley's steps, each of which cubes the error.
inline Pack cube_root(Pack x) noexcept {
    using Bits [[gnu::vector_size(sizeof(Pack::Native))]] = long long;
    x = max(x, Pack(1e-200));
    constexpr Real two_thirds_of_one = 4607182418800017408.0 / 3 * 2 - 1.6e14;
    Bits bits;
    std::memcpy(&bits, &x.lanes, sizeof bits);
    const Pack third =
        Pack(__builtin_convertvector(bits, Pack::Native)) * Pack(1.0 / 3) + Pack(two_thirds_of_one);
    bits = __builtin_convertvector(third.lanes, Bits);
    Pack root;
    std::memcpy(&root.lanes, &bits, sizeof bits);
    for (int step = 0; step < 3; ++step) {
        const Pack cube = root * root * root;
        root *= (cube + Pack(2) * x) / (Pack(2) * cube + x);
    }
    return root;
}

/// |components| of a normal, sorted: m1 <= m2 <= m3 with sum 1, and the scale that made it so.
template <class Number>
struct SortedNormal {
    Number m1, m2, m3, scale;
};

template <int Dim, class Number>
SortedNormal<Number> sorted(const std::array<Number, Dim>& normal) noexcept {
    const Number a = magnitude(normal[0]), b = magnitude(normal[1]);
    const Number small = min(a, b), large = max(a, b);
    if constexpr (Dim == 2) {
        const Number scale = Number(1) / max(small + large, Number(tiny<Number>));
        return {Number(0), small * scale, large * scale, scale};
    } else {
        const Number c = magnitude(normal[2]), middle = min(large, c);
        const Number scale = Number(1) / max(small + large + c, Number(tiny<Number>));
        return {min(small, middle) * scale, max(small, middle) * scale, max(large, c) * scale, scale};
    }
}

/// Up to half of the cell: fraction below the plane that stands `reach` in from the corner, 0 <= reach <=
/// 1/2, where the plane through the opposite corner has reach 1.
///
/// The usual sums of cubes (a^3 - (a - m1)^3 - ...) / (6 m1 m2 m3) lose all digits as m1 goes to 0. With
///   G(s) = (s^3 - max(s - m1, 0)^3) / m1 = 3 s (s - m1) + m1^2   where s > m1,
/// the fraction is [G(a) - G(a - m2) - G(a - m3)] / (6 m2 m3), and a - m2, a - m3 never exceed m1 where this
/// form is used; beyond a = m1 + m2 the fraction is linear in a.
template <int Dim, class Number>
Number lower_fraction(const SortedNormal<Number>& m, Number reach) noexcept {
    const Number m12 = m.m1 + m.m2, width = max(m.m3, Number(tiny<Number>));
    const Number linear = (reach - Number(0.5) * m12) / width;
    Number corner;  // of which 6 m2 m3 is the whole
    if constexpr (Dim == 2) {
        corner = Number(3) * reach * reach;
    } else {
        const Number inverse = Number(1) / max(m.m1, Number(tiny<Number>));
        const Number beyond2 = min(positive(reach - m.m2), m.m1), beyond3 = min(positive(reach - m.m3), m.m1);
        const Number near = reach * reach * (reach * inverse);
        const Number far = Number(3) * reach * (reach - m.m1) + m.m1 * m.m1;
        corner = select(reach < m.m1, near, far) - beyond2 * beyond2 * (beyond2 * inverse) -
                 beyond3 * beyond3 * (beyond3 * inverse);
    }
    const Number cut = corner / max(Number(6) * m.m2 * width, Number(tiny<Number>));
    return min(select(reach < m12, cut, linear), Number(0.5));
}

/// Its inverse: the reach for a fraction of at most 1/2.
template <int Dim, class Number>
Number reach_of(const SortedNormal<Number>& m, Number fraction) noexcept {
    const Number m12 = m.m1 + m.m2;
    const Number linear = fraction * m.m3 + Number(0.5) * m12;
    const Number corner = Number(6) * m.m2 * m.m3 * fraction;
    if constexpr (Dim == 2) {
        return select(linear < m12, sqrt(corner * Number(1.0 / 3)), linear);
    } else {
        const Number square1 = m.m1 * m.m1;
        Number reach = Number(0.5) * (m.m1 + sqrt(positive(Number(4) * corner - square1) * Number(1.0 / 3)));
        const auto tip = corner < square1;
        if (any(tip & (linear < m12))) reach = select(tip, cube_root(corner * m.m1), reach);
        const auto bent = (linear < m12) & (reach > m.m2);
        if (any(bent)) {
            // G(a) - G(a - m2) - G(a - m3) = corner is convex in a here and its quadratic part, solved above,
            // is within 6 % of it: Newton's fourth step is below round-off.
            const Number inverse = Number(1) / max(m.m1, Number(tiny<Number>));
            const Number highest = min(m12, Number(0.5));
            Number a = min(reach, highest);
            for (int step = 0; step < 4; ++step) {
                const Number b2 = min(positive(a - m.m2), m.m1), b3 = min(positive(a - m.m3), m.m1);
                const Number r2 = b2 * inverse, r3 = b3 * inverse;
                const Number value =
                    Number(3) * a * (a - m.m1) + square1 - b2 * b2 * r2 - b3 * b3 * r3 - corner;
                const Number slope = Number(6) * a - Number(3) * m.m1 - Number(3) * (b2 * r2 + b3 * r3);
                a = min(a - value / max(slope, Number(tiny<Number>)), highest);
            }
            reach = select(bent, a, reach);
        }
        return select(linear < m12, reach, linear);
    }
}

}  // namespace detail

/// Fraction of the cell below the plane [-]. Exact to round-off for every normal: parallel to edges and
/// faces, or nearly so. Scardovelli & Zaleski 2000 (doi:10.1006/jcph.1999.6410), in a form without
/// cancellation.
template <int Dim, class Number>
Number fraction_below(const std::array<Number, Dim>& normal, Number distance) noexcept {
    const auto m = detail::sorted<Dim>(normal);
    const Number from_low = distance * m.scale + Number(0.5), from_high = Number(0.5) - distance * m.scale;
    const Number less = detail::lower_fraction<Dim>(m, detail::positive(min(from_low, from_high)));
    return select(from_low < from_high, less, Number(1) - less);
}

template <int Dim, class Number>
Number fraction_below(const CellPlane<Dim, Number>& plane) noexcept {
    return fraction_below<Dim>(plane.normal, plane.distance);
}

/// Where the plane of a given normal stands that has `fraction` of the cell below it: its distance.
template <int Dim, class Number>
Number plane_distance(const std::array<Number, Dim>& normal, Number fraction) noexcept {
    const auto m = detail::sorted<Dim>(normal);
    const Number air = Number(1) - fraction;
    const Number from_centre =
        (Number(0.5) - detail::reach_of<Dim>(m, detail::positive(min(fraction, air)))) / m.scale;
    return select(fraction < air, -from_centre, from_centre);
}

/// Liquid fraction of the slab that a face sweeps: the part of the cell that lies within `width` (of the
/// cell's edge, 0 to 1) of its face along `axis`. `side` is -1 for the lower face, +1 for the upper one. A
/// slab of no width answers the fraction of the face.
template <int Dim, class Number>
Number slab_fraction(const CellPlane<Dim, Number>& plane, int axis, Number side, Number width) noexcept {
    std::array<Number, Dim> normal = plane.normal;
    const auto a = static_cast<std::size_t>(axis);
    const Number shift = normal[a] * side * (Number(0.5) - Number(0.5) * width);
    normal[a] = normal[a] * width;
    return fraction_below<Dim>(normal, plane.distance - shift);
}

/// Fraction of a box with edges `size` [m] where n . x <= alpha, x from its lower corner.
template <int Dim>
Real fraction_below(const std::array<Real, Dim>& n, Real alpha, const std::array<Real, Dim>& size) noexcept {
    std::array<Real, Dim> normal;
    Real distance = alpha;
    for (std::size_t a = 0; a < Dim; ++a) {
        normal[a] = n[a] * size[a];
        distance -= 0.5 * normal[a];
    }
    return fraction_below<Dim>(normal, distance);
}

/// Its inverse: alpha for a given fraction.
template <int Dim>
Real plane_constant(const std::array<Real, Dim>& n, Real fraction,
                    const std::array<Real, Dim>& size) noexcept {
    std::array<Real, Dim> normal;
    Real half = 0;
    for (std::size_t a = 0; a < Dim; ++a) {
        normal[a] = n[a] * size[a];
        half += 0.5 * normal[a];
    }
    return plane_distance<Dim>(normal, fraction) + half;
}

}  // namespace abrade
