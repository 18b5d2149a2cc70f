#pragma once
// What a simulation says of itself when it is streamed.

#include <abrade/fluid/water_energy.hpp>
#include <abrade/sim/simulation.hpp>

#include <ostream>

namespace abrade {

/// Whether bonds of concrete that stands gave way to blows rather than to wear: more than one for every four
/// cells that wore. Concrete that moves then breaks several times as many, and more of it comes loose
/// (docs/howto/standing_concrete.md). Throws std::logic_error before the first run.
template <class... All>
bool breaks_by_blows(const Simulation<All...>& sim) {
    if (!sim.world().state().sites.stand) return false;
    const Concrete& concrete = sim.concrete();
    Real cells = 0;
    for (Index site = 0; site < concrete.sites(); ++site) cells += concrete.fracture(site);
    return static_cast<Real>(sim.bonds_broken()) > 0.25 * cells;
}

/// Laws with their parameters, the step and why, the ledger and the water's account if it has one, the wear,
/// the wall time and where it went.
template <class... All>
std::ostream& operator<<(std::ostream& out, const Simulation<All...>& sim) {
    using F = std::remove_cvref_t<decltype(sim.fluid_model())>;
    using W = std::remove_cvref_t<decltype(sim.wear_law())>;
    out << "contact  " << describe(sim.contact_) << "\nbond     " << describe(sim.bond_) << "\nwear     "
        << describe(sim.wear_) << "\nfluid    " << describe(sim.fluid_);
    if constexpr (!std::same_as<F, NoFluid>) out << " with " << describe(sim.drag_);
    if (!sim.world_) return out << "\nnot run yet\n";
    const auto shares = sim.time_shares();
    const auto percent = [](Real share) {
        return std::to_string(static_cast<int>(std::lround(100 * share))) + " %";
    };
    out << "\ntime     " << short_text(sim.time_) << " s in " << sim.step_ << " steps of "
        << short_text(sim.time_step_) << " s (stable: " << short_text(sim.stable_time_step().seconds)
        << " s, set by " << sim.stable_time_step().limit << ")\nbodies   " << sim.particles().bodies()
        << ", spheres " << sim.particles().spheres() << ", near pairs "
        << sim.world_->contacts().census().near << "\n";
    if (sim.concrete().sites() > 0)
        out << "concrete " << sim.concrete().sites() << " spheres, " << sim.bonds_broken()
            << " bonds broken, worn volume " << short_text(sim.concrete().worn_volume()) << " m3\n";
    if (const Real share = sim.concrete().largest_collision_share(); share > 1) {
        out << "warning  one collision wore " << short_text(share)
            << " times its sphere's cell: the result depends on the time acceleration";
        if constexpr (AcceleratedWear<W>)
            out << ", and does not at " << short_text(sim.largest_safe_acceleration()) << " or less";
        out << "\n";
    }
    if (breaks_by_blows(sim))
        out << "warning  blows broke bonds of standing concrete: moving concrete would break several "
               "times as many, and more of it would come loose; see docs/howto/standing_concrete.md\n";
    const auto tell = [&](std::string_view name, Real value) {
        if (value != 0) out << "         " << name << std::string(22 - name.size(), ' ') << value << "\n";
    };
    out << "ledger   [J]\n";
    sim.ledger_.visit(tell);
    if constexpr (AccountsForEnergy<F>)
        if (sim.fluid_model().has_energy_account()) {
            const WaterEnergy water = sim.fluid_model().energy();
            out << "water    [J]\n";
            water.visit(tell), tell("residual", water.residual());
        }
    return out << "wall     " << short_text(sim.wall_seconds_) << " s: contacts " << percent(shares.contacts)
               << ", bonds " << percent(shares.bonds) << ", motion " << percent(shares.motion)
               << ", neighbour lists " << percent(shares.renewal)
               << (shares.fluid > 0 ? ", fluid " + percent(shares.fluid) : "") << "\n";
}

}  // namespace abrade
