#pragma once
// What water on a grid asks of solids that move in it. The null policy.

#include <abrade/core/law.hpp>
#include <abrade/fluid/flow_body.hpp>
#include <abrade/fluid/poisson.hpp>
#include <abrade/fluid/sides.hpp>

#include <concepts>
#include <string_view>

namespace abrade {

/// One step of the water's.
struct FlowStage {
    Real density = 1;           ///< [kg/m3]
    Real dt = 1;                ///< [s]
    Real viscosity = 0;         ///< kinematic [m2/s]
    Vec3 falls = Vec3::Zero();  ///< what the water's weight accelerates it by [m/s2]
};

/// Solids that move in water on a grid. There are two velocities at a face: the water's, which momentum is
/// reckoned with, and that of the mixture of water and solid, which carries and has no divergence. A step
/// asks
/// - `place`: where they stand at its end;
/// - `close`, `keep_wet`: what they take from what faces conduct, before the operator is built and after it;
/// - `mix`: the mixture's velocity from a water's that is not known to the end yet;
/// - `force`, once the water has been moved on by all but the new pressure: a force per volume on it, and
/// from
///   there on the mixture's velocity;
/// - for each solution phi = p dt / rho of the pressure `push`, what it does to them, and `correct`, how the
///   mixture on a plane of faces that has lost the whole gradient of phi moves instead: their share is a
///   source of divergence;
/// - within the search for phi `add_product`, the same for the operator, which must stay symmetric;
/// - `settle`: the water's velocity from the mixture's, and what is to be remembered.
/// A body's velocity is part of the solution, so it is that of the water's and the contacts' work together.
// clang-format off
template <class S>
concept SolidsInFlow = !S::present || requires(S& s, const S& still, FaceField<3>& u, Field<Real>& p, Poisson<3>& m,
                                               Field<float>& e, const Grid<3>& grid, const Sides<3>& sides,
                                               std::span<const FlowBody> bodies, const FaceField<3>* open) {
    s.place(grid, sides, bodies, open);
    s.close(m);
    s.keep_wet(m);
    still.mix(u);
    s.force(u, p, FlowStage{});
    s.push(p, Real{}), s.push(e, Real{});
    still.correct(u, p, Real{}, int{}), still.correct(u, e, Real{}, int{});
    { s.add_product(e, e) } -> std::same_as<Real>;
    s.settle(u, p);
    { still.bodies() } -> std::same_as<std::span<const FlowBody>>;
};
// clang-format on

/// No solids but walls: nothing is compiled for them.
struct NoSolids {
    static constexpr std::string_view name = "NoSolids";
    static constexpr bool present = false;
};
inline constexpr NoSolids no_solids{};

static_assert(SolidsInFlow<NoSolids>);

}  // namespace abrade
