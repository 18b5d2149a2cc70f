#pragma once
// Depth-averaged water, the arithmetic of one face and one cell: limited slopes, the flux between two states,
// friction. Written once, for a number or a pack of them.

#include <abrade/core/simd.hpp>

#include <bit>

namespace abrade {

namespace detail {

template <class Number>
Number load(const Real* from) noexcept {
    if constexpr (std::same_as<Number, Pack>)
        return Pack::load_from_anywhere(from);
    else
        return *from;
}
inline void put(Real* to, Real value) noexcept { *to = value; }
inline void put(Real* to, Pack value) noexcept { std::memcpy(to, &value.lanes, sizeof(Pack::Native)); }

/// x^(-1/3) for x from 1e-30 to 1e30, to within 3 units in the last place: an estimate from the number's
/// bits, then Newton's method.
inline Pack inverse_cube_root(Pack x) noexcept {
    using Singles [[gnu::vector_size(sizeof(float) * pack_lanes)]] = float;
    using Bits [[gnu::vector_size(sizeof(std::int32_t) * pack_lanes)]] = std::int32_t;
    const auto single = __builtin_convertvector(x.lanes, Singles);
    // The bits of a float are about its logarithm; a third of it needs no more digits than a float has.
    const Singles logarithm = __builtin_convertvector(std::bit_cast<Bits>(single), Singles);
    const Bits guess = __builtin_convertvector(1.41966e9F - 0.3333333F * logarithm, Bits);
    Pack y = __builtin_convertvector(std::bit_cast<Singles>(guess), Pack::Native);
    for (int step = 0; step < 4; ++step) y += y * (Pack(1) - x * y * y * y) * Pack(1.0 / 3);
    return y;
}
inline Real inverse_cube_root(Real x) noexcept { return 1 / std::cbrt(x); }

}  // namespace detail

/// sqrt(x) for x >= 0, fast.
template <class Number>
Number root(Number x) noexcept {
    using std::max;
    return x * rsqrt(max(x, Number(1e-200)));
}

/// Change across a cell of what changes by `before` from the cell before it and by `after` to the next one:
/// monotonised central difference (B. van Leer, J. Comput. Phys. 23 (1977) 276,
/// doi:10.1016/0021-9991(77)90095-X). Values at the cell's faces stay between those of its neighbours.
template <class Number>
Number limited_slope(Number before, Number after) noexcept {
    using std::max, std::min;
    const Number none(0), mean = Number(0.5) * (before + after);
    const Number a = before + before, b = after + after;
    return max(none, min(mean, min(a, b))) + min(none, max(mean, max(a, b)));
}

/// Water on one side of a face: depth [m], speeds through and along the face [m/s].
template <class Number>
struct WaterBeside {
    Number depth, through, along;
};

/// What passes a face, per length of it.
template <class Number>
struct WaterFlux {
    Number mass;  ///< volume [m2/s]
    Number
        low;  ///< momentum through the face over density, less the pressure g h^2/2 of its low side [m3/s2]
    Number high;   ///< the same, less that of its high side
    Number along;  ///< momentum along the face [m3/s2]
};

/// HLLC flux with the wave speeds of two rarefactions, and those of a front on a dry bed:
///   F = (b F_l - a F_h + a b (U_h - U_l)) / (b - a),  a = min(s_l, 0), b = max(s_h, 0),
///   s_l = min(u_l - c_l, u_m - c_m), s_h = max(u_h + c_h, u_m + c_m),
///   u_m = (u_l + u_h)/2 + c_l - c_h, c_m = (c_l + c_h)/2 + (u_l - u_h)/4, c = sqrt(g h);
/// the middle wave carries momentum along the face. E. F. Toro, Shock-Capturing Methods for Free-Surface
/// Shallow Flows (2001), chapter 10. Equal depths at rest give exactly nothing.
template <class Number>
WaterFlux<Number> water_flux(const WaterBeside<Number>& low, const WaterBeside<Number>& high,
                             Real gravity) noexcept {
    using std::max, std::min;
    const Number none(0), half(0.5), quarter(0.25);
    const Number c_low = root(Number(gravity) * low.depth), c_high = root(Number(gravity) * high.depth);
    // Towards a dry side water runs at u + 2c: that speed stands for the one that is not there.
    const Number u_low = select(low.depth > none, low.through, high.through - (c_high + c_high));
    const Number u_high = select(high.depth > none, high.through, low.through + (c_low + c_low));
    const Number u_middle = half * (u_low + u_high) + (c_low - c_high);
    const Number c_middle = max(none, half * (c_low + c_high) + quarter * (u_low - u_high));
    const Number a = min(none, min(u_low - c_low, u_middle - c_middle));
    const Number b = max(none, max(u_high + c_high, u_middle + c_middle));
    const Number share = reciprocal(max(b - a, Number(1e-200))), ab = a * b;
    const Number q_low = low.depth * u_low, q_high = high.depth * u_high;
    const Number risen = high.depth - low.depth;
    const Number pressure = Number(0.5 * gravity) * risen * (high.depth + low.depth);
    WaterFlux<Number> flux;
    flux.mass = share * (b * q_low - a * q_high + ab * risen);
    flux.low = share * (b * (q_low * u_low) - a * (q_high * u_high + pressure) + ab * (q_high - q_low));
    flux.high = flux.low - pressure;
    flux.along = flux.mass * select(flux.mass > none, low.along, high.along);
    return flux;
}

/// Depth that a cell shows to a face: its surface there over the bed that stands there, none below it, and no
/// more than twice its own depth, which a linear profile could not exceed. `most` is that, and 0 for a dry
/// cell.
template <class Number>
Number depth_at_face(Number surface, Number bed, Number most) noexcept {
    using std::max, std::min;
    return max(Number(0), min(surface - bed, most));
}

/// Rate at which Manning's friction slows water down, k = g n^2 |u| / h^(4/3) [1/s]: dq/dt = -k q.
template <class Number>
Number friction_rate(Number depth, Number speed, Real gravity_manning2) noexcept {
    using detail::inverse_cube_root;
    const Number root = inverse_cube_root(depth), root2 = root * root;
    return Number(gravity_manning2) * speed * (root2 * root2);
}

}  // namespace abrade
