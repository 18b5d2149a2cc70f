#pragma once
// What value a flux carries through a face: from two cells upstream and one downstream.

#include <cmath>
#include <concepts>
#include <string_view>

namespace abrade {

/// Value at a face from the values far upstream, upstream and downstream of it, evenly spaced.
template <class S>
concept AdvectionScheme = requires(double v) {
    { S::at_face(v, v, v) }
    noexcept->std::same_as<double>;
    { S::name } -> std::convertible_to<std::string_view>;
};

/// First order: damps all that is not smooth over many cells.
struct Upwind {
    static constexpr std::string_view name = "Upwind";
    template <class Number>
    static Number at_face(Number, Number upstream, Number) noexcept {
        return upstream;
    }
};

/// Second order, no numerical diffusion: conserves kinetic energy but for the time steps; wiggles where a
/// cell is too coarse, |u| h / nu > 2 beside walls.
struct Central {
    static constexpr std::string_view name = "Central";
    template <class Number>
    static Number at_face(Number, Number upstream, Number downstream) noexcept {
        return Number(0.5) * (upstream + downstream);
    }
};

/// Second order, third where the solution is smooth along a line, limited so that no new extremes arise:
///   upstream + 1/2 max(0, min(2 d1, (d1 + 2 d2) / 3, 2 d2)) for rising values, likewise for falling ones,
/// d1 upstream - far, d2 downstream - upstream. B. Koren, A robust upwind discretization method for
/// advection, diffusion and source terms, Notes on Numerical Fluid Mechanics 45 (1993) 117-138.
struct Koren {
    static constexpr std::string_view name = "Koren";
    template <class Number>
    static Number at_face(Number far, Number upstream, Number downstream) noexcept {
        const Number d1 = upstream - far, d2 = downstream - upstream;
        // Branches choose between values and compute none: without AVX-512 g++ makes no packs of a loop in
        // which a branch might trap.
        const Number middle = std::abs((d1 + Number(2) * d2) * Number(1.0 / 3));
        const Number one = std::abs(d1), two = std::abs(d2), ends = Number(2) * (one < two ? one : two);
        const Number alike = d1 * d2 > 0 ? Number(0.5) : Number(0);
        return upstream + alike * std::copysign(ends < middle ? ends : middle, d1);
    }
};

static_assert(AdvectionScheme<Upwind> && AdvectionScheme<Central> && AdvectionScheme<Koren>);

}  // namespace abrade
