#pragma once
// Depth-averaged water, the arithmetic of one face and one cell: limited slopes, the flux between two states,
// friction. Written once, for a number or a pack of them.

#include <abrade/core/simd.hpp>

#include <bit>

namespace abrade {

namespace detail {

/// sqrt(x) for normal x > 0, to eight digits at least.
inline Pack rough_root(Pack x) noexcept {
#if defined(ABRADE_AVX512)
    const Pack y = Pack::Native(_mm512_maskz_rsqrt14_pd(all_lanes, x.lanes)), t = x * y;
    return t + Pack(0.5) * t * (Pack(1) - t * y);
#else
    return sqrt(x);
#endif
}
inline Real rough_root(Real x) noexcept { return std::sqrt(x); }

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

/// Half of the change across a cell of what changes by `before` from the cell before it and by `after` to the
/// next one: monotonised central difference (B. van Leer, J. Comput. Phys. 23 (1977) 276,
/// doi:10.1016/0021-9991(77)90095-X). Values at the cell's faces stay between those of its neighbours.
template <class Number>
Number limited_half_change(Number before, Number after) noexcept {
    using std::max, std::min;
    const Number none(0), mean = Number(0.25) * (before + after);
    return max(none, min(mean, min(before, after))) + min(none, max(mean, max(before, after)));
}

/// What is left of half the change of a surface across a cell, lest it dips below the bed at either end: a
/// film above a drop would be driven by the slope of what falls beside it, and show its face no depth.
/// Nothing turns a level surface, so a shore rests.
template <class Number>
Number change_above_bed(Number change, Number bed_change, Number depth) noexcept {
    using std::max, std::min;
    const Number none(0);
    return min(max(change, min(none, bed_change - depth)), max(none, bed_change + depth));
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

/// Speed of waves sqrt(g h), for packs to eight digits: fluxes use it for what they smear, not for what they
/// carry.
template <class Number>
Number wave_speed(Number depth, Real gravity) noexcept {
    using std::max;
    return detail::rough_root(max(Number(gravity) * depth, Number(1e-30)));
}

/// HLLC flux between limits of wave speeds that also hold for a front on a dry bed (S. F. Davis, SIAM J. Sci.
/// Stat. Comput. 9 (1988) 445, doi:10.1137/0909030):
///   F = F_l - a/(b - a) (F_h - F_l - b (U_h - U_l)),
///   a = min(0, u_l - c_l, u_h - c_h), b = max(0, u_l + c_l, u_h + c_h), c = sqrt(g h);
/// what passes carries momentum along the face. E. F. Toro, Shock-Capturing Methods for Free-Surface Shallow
/// Flows (2001), chapter 10. Equal depths at rest give exactly nothing, and equal states their own flux.
template <class Number>
WaterFlux<Number> water_flux(const WaterBeside<Number>& low, const WaterBeside<Number>& high,
                             Real gravity) noexcept {
    using std::max, std::min;
    const Number none(0);
    const Number c_low = wave_speed(low.depth, gravity), c_high = wave_speed(high.depth, gravity);
    // Towards a dry side water runs at u + 2c: that speed stands for the one that is not there.
    const auto wet_low = low.depth > none, wet_high = high.depth > none;
    const Number u_low = select(wet_low, low.through, high.through - (c_high + c_high));
    const Number u_high = select(wet_high, high.through, low.through + (c_low + c_low));
    const Number a = min(none, min(u_low - c_low, u_high - c_high));
    const Number b = max(none, max(u_low + c_low, u_high + c_high));
    const Number share = a * reciprocal(a - b);  // of the high side; b - a is never 0, for c is not
    const Number q_low = low.depth * u_low, q_high = high.depth * u_high, more = q_high - q_low;
    const Number risen = high.depth - low.depth;
    const Number pressure = Number(0.5 * gravity) * risen * (high.depth + low.depth);
    const Number m_low = q_low * u_low;
    WaterFlux<Number> flux;
    flux.mass = q_low + share * (more - b * risen);
    // Not even round-off comes out of a dry side.
    flux.mass = select(wet_low, flux.mass, min(flux.mass, none));
    flux.mass = select(wet_high, flux.mass, max(flux.mass, none));
    flux.low = m_low + share * (q_high * u_high - m_low + pressure - b * more);
    flux.high = flux.low - pressure;
    flux.along = flux.mass * select(flux.mass > none, low.along, high.along);
    return flux;
}

/// The bed that both cells beside a face see there: what stands there, and no deeper than twice a cell's
/// depth below its surface, for a linear profile of depth reaches 0 then at the cell's other end. `most` is
/// twice the depth, and 0 for a dry cell. Where both surfaces are the same so are the depths above it: a
/// shore rests.
template <class Number>
Number bed_at_face(Number bed, Number surface_low, Number most_low, Number surface_high,
                   Number most_high) noexcept {
    using std::max;
    return max(bed, max(surface_low - most_low, surface_high - most_high));
}

/// Rate at which Manning's friction slows water down, k = g n^2 |u| / h^(4/3) [1/s]: dq/dt = -k q.
template <class Number>
Number friction_rate(Number depth, Number speed, Real gravity_manning2) noexcept {
    using detail::inverse_cube_root;
    const Number root = inverse_cube_root(depth), root2 = root * root;
    return Number(gravity_manning2) * speed * (root2 * root2);
}

}  // namespace abrade
