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

/// First order: the value of the cell upstream,
///   q = q_u
/// q        value at the face, of any unit
/// q_u      value of the cell upstream
/// Validity: damps all that is not smooth over many cells, as a viscosity of |u| h / 2 would
/// (u: velocity [m/s], h: cell [m]).
/// Throws nothing.
/// Source: R. Courant, E. Isaacson & M. Rees, Comm. Pure Appl. Math. 5 (1952) 243-255,
/// doi:10.1002/cpa.3160050303.
struct Upwind {
    static constexpr std::string_view name = "Upwind";
    template <class Number>
    static Number at_face(Number, Number upstream, Number) noexcept {
        return upstream;
    }
};

/// Second order, without numerical diffusion: the mean of the cells on both sides,
///   q = (q_u + q_d) / 2
/// q        value at the face, of any unit
/// q_u, q_d values of the cells upstream and downstream
/// Validity: conserves kinetic energy but for the time steps; wiggles where a cell is too coarse,
/// |u| h / nu > 2 beside walls, u the velocity [m/s], h the cell [m], nu the viscosity [m2/s].
/// Throws nothing.
/// Source: F. H. Harlow & J. E. Welch, Phys. Fluids 8 (1965) 2182-2189, doi:10.1063/1.1761178.
struct Central {
    static constexpr std::string_view name = "Central";
    template <class Number>
    static Number at_face(Number, Number upstream, Number downstream) noexcept {
        return Number(0.5) * (upstream + downstream);
    }
};

/// Second order, third where the solution is smooth along a line, limited so that no new extremes arise:
///   q = q_u + 1/2 max(0, min(2 d1, (d1 + 2 d2) / 3, 2 d2)) for rising values, likewise for falling ones
/// q        value at the face, of any unit
/// d1, d2   differences q_u - q_uu and q_d - q_u
/// q_uu, q_u, q_d  values of the cells far upstream, upstream and downstream
/// Validity: cells of one size along a line, or nearly; an extreme of the solution is flattened.
/// Throws nothing.
/// Source: B. Koren, A robust upwind discretization method for advection, diffusion and source terms, Notes
/// on Numerical Fluid Mechanics 45 (1993) 117-138.
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
