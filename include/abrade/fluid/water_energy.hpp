#pragma once
// The energy account of a water: what it holds, what came in and left, and what was lost to what.

#include <abrade/core/fields.hpp>
#include <abrade/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>

namespace abrade {

/// All in joules, in two dimensions per metre of width. The balance over any time is
///   kinetic + potential - (kinetic_start + potential_start)
///     = inflow - outflow + boundaries + body_force + forcing + sources + reshaped + solids
///       - viscous - turbulent - wall_friction
///       - solid_friction - numerical.
/// Every term but `numerical` is measured on its own; `numerical` is the remainder of each step: what
/// advection, time steps, the surface's reconstruction and the pressure's tolerance lose (below 0: gain).
/// In a full box `advection` measures the largest part of it on its own, from the fluxes of momentum.
struct WaterEnergy {
    // now
    Real kinetic = 0;    ///< 1/2 rho sum M V u^2
    Real potential = 0;  ///< -rho g . sum V x, x the liquid's centre of mass, from the origin; without
                         ///< gravity along periodic axes, which is `body_force`

    // when the account was opened
    Real kinetic_start = 0, potential_start = 0;

    // since then
    Real inflow = 0;          ///< kinetic and potential energy and work of the pressure, through inflows
    Real outflow = 0;         ///< the same through outflows; what comes back there is taken off
    Real boundaries = 0;      ///< work of sides that move along themselves
    Real body_force = 0;      ///< work of `body_force`, and of gravity along periodic axes
    Real forcing = 0;         ///< work of a user's force per volume (Forcing)
    Real sources = 0;         ///< what water brought that a user put in, less what it took away
    Real reshaped = 0;        ///< what `set_wall` changed, and solids that came took the place of
    Real solids = 0;          ///< work of solids that move in it, as `solids_took` has told it
    Real viscous = 0;         ///< dissipated by the molecular viscosity
    Real turbulent = 0;       ///< handed to eddies that the grid does not resolve
    Real wall_friction = 0;   ///< lost to walls inside cells and to logarithmic sides
    Real solid_friction = 0;  ///< lost between water and solids that move in it
    Real numerical = 0;       ///< the remainder

    Real advection = 0;  ///< part of `numerical`, measured: loss by the advection scheme; full boxes only

    static void fields(auto&& field) {
        field("kinetic", "J", &WaterEnergy::kinetic), field("potential", "J", &WaterEnergy::potential),
            field("kinetic_start", "J", &WaterEnergy::kinetic_start),
            field("potential_start", "J", &WaterEnergy::potential_start),
            field("inflow", "J", &WaterEnergy::inflow), field("outflow", "J", &WaterEnergy::outflow),
            field("boundaries", "J", &WaterEnergy::boundaries),
            field("body_force", "J", &WaterEnergy::body_force), field("forcing", "J", &WaterEnergy::forcing),
            field("sources", "J", &WaterEnergy::sources), field("reshaped", "J", &WaterEnergy::reshaped),
            field("solids", "J", &WaterEnergy::solids), field("viscous", "J", &WaterEnergy::viscous),
            field("turbulent", "J", &WaterEnergy::turbulent),
            field("wall_friction", "J", &WaterEnergy::wall_friction),
            field("solid_friction", "J", &WaterEnergy::solid_friction),
            field("numerical", "J", &WaterEnergy::numerical),
            field("advection", "J", &WaterEnergy::advection);
    }

    Real total() const noexcept { return kinetic + potential; }
    Real gained() const noexcept { return total() - kinetic_start - potential_start; }
    Real supplied() const noexcept {
        return inflow - outflow + boundaries + body_force + forcing + sources + reshaped + solids;
    }
    /// By physics; `numerical` is not.
    Real dissipated() const noexcept { return viscous + turbulent + wall_friction + solid_friction; }

    /// Zero but for round-off: a term that is left out of a step, or booked twice, shows here.
    Real residual() const noexcept { return gained() - supplied() + dissipated() + numerical; }
    /// The largest amount: what `residual` is to be measured by.
    Real throughput() const noexcept {
        Real most = 1e-300;
        visit([&](auto, Real x) { most = std::max(most, std::abs(x)); });
        return most;
    }
    Real residual_relative() const noexcept { return std::abs(residual()) / throughput(); }

    /// Calls `f(name, value)` for each amount.
    void visit(auto&& f) const {
        f("kinetic", kinetic), f("potential", potential);
        f("kinetic_start", kinetic_start), f("potential_start", potential_start);
        f("inflow", inflow), f("outflow", outflow), f("boundaries", boundaries), f("body_force", body_force);
        f("forcing", forcing), f("sources", sources), f("reshaped", reshaped), f("solids", solids);
        f("viscous", viscous), f("turbulent", turbulent), f("wall_friction", wall_friction);
        f("solid_friction", solid_friction);
        f("numerical", numerical), f("advection", advection);
    }
};

/// A fluid that can tell where its energy goes: `has_energy_account()`, and `energy()` where that is true.
template <class F>
concept AccountsForEnergy = requires(const F& fluid) {
    { fluid.has_energy_account() } -> std::same_as<bool>;
    { fluid.energy() } -> std::convertible_to<WaterEnergy>;
};

static_assert(!AccountsForEnergy<WaterEnergy>);

}  // namespace abrade
