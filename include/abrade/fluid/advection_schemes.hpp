#pragma once
// What value a flux carries through a face: from two cells upstream and one downstream.

#include <abrade/core/pack.hpp>

#include <algorithm>
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
///   upstream + 1/2 max(0, min(2 d1, (d1 + 2 d2) / 3, 2 d2)) for rising values,
/// d1 upstream - far, d2 downstream - upstream. B. Koren, A robust upwind discretization method for
/// advection, diffusion and source terms, Notes on Numerical Fluid Mechanics 45 (1993) 117-138.
struct Limited {
    static constexpr std::string_view name = "Limited";
    template <class Number>
    static Number at_face(Number far, Number upstream, Number downstream) noexcept {
        const Number d1 = upstream - far, d2 = downstream - upstream;
        const Number middle = (d1 + Number(2) * d2) * Number(1.0 / 3);
        const Number rise = std::max(Number(0), std::min(Number(2) * std::min(d1, d2), middle));
        const Number fall = std::min(Number(0), std::max(Number(2) * std::max(d1, d2), middle));
        return upstream + Number(0.5) * (rise + fall);
    }
};

static_assert(AdvectionScheme<Upwind> && AdvectionScheme<Central> && AdvectionScheme<Limited>);

}  // namespace abrade
