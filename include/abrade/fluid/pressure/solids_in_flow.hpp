#pragma once
// What water on a grid asks of solids that move in it. The null policy.

#include <abrade/core/law.hpp>
#include <abrade/fluid/flow_body.hpp>
#include <abrade/fluid/mesh/boundary_conditions.hpp>
#include <abrade/fluid/mesh/solid_parts.hpp>
#include <abrade/fluid/mesh/water_cells.hpp>
#include <abrade/fluid/pressure/poisson.hpp>

#include <concepts>
#include <string_view>

namespace abrade {

/// One step of the water's.
struct FlowStage {
    Real density = 1;    ///< [kg/m3]
    Real dt = 1;         ///< [s]
    Real viscosity = 0;  ///< kinematic [m2/s]
    const Field<Real>* liquid_fraction =
        nullptr;                ///< water and solid in each cell, as a share of it [-]; none: all full
    bool pushed = false;        ///< the old pressure has acted on velocities already
    Vec3 falls = Vec3::Zero();  ///< what the water's weight accelerates it by [m/s2]
    Real relaxation_time = 0;   ///< as long as steps have been of late [s]

    /// How much of what is found in the step goes on in the next one: a blow takes no longer in a long step
    /// than in a brief one, where it looks like a large force [-].
    Real lasts() const noexcept { return relaxation_time > dt ? dt / relaxation_time : 1; }
};

// clang-format off
/// Solids that move in water on a grid. There are two velocities at a face: the water's, which momentum is reckoned
/// with, and that of the mixture of water and solid, which advects and has no divergence. A step asks
/// - `mix_last`, `to_superficial`: from the water's velocity that of the mixture, or that of the water times its share of a face,
///   as the last step left them, and `to_interstitial`, back from it; `fluxes`: the solids' part of it, plane by plane;
/// - `place`: where they stand at its end, in water of a density, and `parts`, what they cover of cells there; of `resolved_parts` the water
///   flows around the shape;
/// - `close`, `water_share`: what they take from what faces conduct, those at the surface by their numbers, before the
///   operator is built; `find_closed_cells`, once it is: which of their cells are left without a pressure. In a full
///   box both come before the stages, below a surface after them and before `force`;
/// - `slow`: friction on the water of the first stage, that the second starts from a flow which knows of them, and
///   `give_back`: a share of it, before `force` does it all: so a steady flow does not depend on the step;
/// - `mix`: the mixture's velocity from a water's that is not known to the end yet, and `unmix`, back from it;
/// - `force`, once the water has been moved on by all but the new pressure: a force per volume on it, and from there
///   on the mixture's velocity;
/// - for each solution phi = p dt / rho of the pressure `push`, what it does to them, and `correct`, how the mixture
///   on a plane of faces that has lost the whole gradient of phi moves instead: their share is a source of divergence.
///   The `old` pressure does not push at sides where water leaves;
/// - within the search for phi `add_product`, the same for the operator, which must stay symmetric;
/// - `settle`: the water's velocity from the mixture's, and what is to be remembered; cells within solids get the
///   pressure that goes on from around them;
/// - `volumes` and `moment` for an energy account: what they, or those that the last step was the first of, take of control volumes as far as there is water, and
///   of cells, times their places [m4]; `lost_to_friction`, what friction between the two took in the step [J].
/// A body's velocity is part of the solution, so it is that of the water's and the contacts' work together.
template <class S>
concept SolidsInFlow = !S::present || requires(S& s, const S& still, FaceField<3>& u, Field<Real>& p, Poisson<3>& m,
                                               Field<float>& e, const Grid<3>& grid, const BoundaryConditions<3>& boundaries,
                                               std::span<const FlowBody> bodies, const FaceField<3>* open) {
    s.place(grid, boundaries, bodies, open, Real{});
    s.close(m, std::span<const OpenFace>{});
    { still.water_share(std::size_t{}) } -> std::same_as<Real>;
    s.find_closed_cells(m);
    s.slow(u, FlowStage{}), still.give_back(u, Real{});
    s.mix(u), still.unmix(u);
    still.mix_last(u), s.to_superficial(u), still.to_interstitial(u);
    { still.parts() } -> std::convertible_to<std::span<const SolidPart>>;
    { still.resolved_parts() } -> std::convertible_to<std::span<const SolidPart>>;
    { still.fluxes() } -> std::convertible_to<std::span<const SolidFlux>>;
    s.force(u, p, FlowStage{});
    s.push(p, Real{}), s.push(e, Real{});
    still.correct(u, p, Real{}, int{}, true), still.correct(u, e, Real{}, int{}, false);
    { s.add_product(e, e) } -> std::same_as<Real>;
    s.settle(u, p);
    { still.volumes(bool{}) } -> std::same_as<std::vector<SolidVolume>>;
    { still.moment(grid, &p, bool{}) } -> std::same_as<Vec3>;
    { still.lost_to_friction() } -> std::same_as<Real>;
    { still.fastest() } -> std::same_as<Real>;
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
