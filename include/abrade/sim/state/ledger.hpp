#pragma once
// The energy ledger: where every joule came from and where it went.

#include <abrade/core/fields.hpp>
#include <abrade/core/types.hpp>

#include <algorithm>
#include <cmath>

namespace abrade {

/// All in joules. Works are paired as f . (v_before + v_after)/2 dt, which is exactly the change in kinetic
/// energy; so `residual` is round-off. Stored energies are state functions. What the two differ by is the
/// `integration_residue`, O(dt^2), shown and never hidden in a loss.
struct Ledger {
    // now
    Real kinetic = 0;
    Real potential = 0;  ///< of gravity, from the origin
    Real stored_contacts = 0, stored_bonds = 0;

    // at the start
    Real kinetic_start = 0, potential_start = 0, stored_start = 0;

    // since the start
    Real lost_normal = 0;   ///< by impact, in contacts and broken bonds
    Real lost_sliding = 0;  ///< by friction and tangential dashpots, in contacts and broken bonds
    Real lost_rolling = 0;  ///< by resistance to rolling, in contacts
    Real lost_film = 0;     ///< to the liquid between surfaces that nearly touch
    Real lost_bond = 0;     ///< by damping in bonds and by breaking them
    Real lost_asleep = 0;   ///< kinetic energy that bodies still had as they were put to sleep, or against
                            ///< each other as they became one fragment
    Real drag_input = 0;    ///< drag force times fluid velocity: put in by the flow
    Real drag_work = 0;     ///< drag force times body velocity: what reached the bodies
    Real buoyancy_work = 0;
    Real flow_work = 0;  ///< of a fluid that resolves the bodies, all that it does to them; of a sampled one,
                         ///< what it does beside drag and buoyancy (WithInertia)
    Real force_work = 0;  ///< of the user's force on bodies
    Real gravity_work = 0;
    Real interaction_work = 0;  ///< done on the bodies by contacts and bonds
    Real wall_work = 0;         ///< part of that: done by walls that move
    /// Of what came: fed, added between runs, let go; and what a change of gravity gave to what was there.
    Real fed_kinetic = 0, fed_potential = 0;
    Real left_kinetic = 0, left_potential = 0, left_stored = 0;  ///< of what left or was removed

    // losses of contacts with concrete, once for each side that is concrete
    Real concrete_lost_normal = 0, concrete_lost_sliding = 0;

    static void fields(auto&& field) {
        field("kinetic", "J", &Ledger::kinetic), field("potential", "J", &Ledger::potential),
            field("stored_contacts", "J", &Ledger::stored_contacts),
            field("stored_bonds", "J", &Ledger::stored_bonds),
            field("kinetic_start", "J", &Ledger::kinetic_start),
            field("potential_start", "J", &Ledger::potential_start),
            field("stored_start", "J", &Ledger::stored_start),
            field("lost_normal", "J", &Ledger::lost_normal),
            field("lost_sliding", "J", &Ledger::lost_sliding),
            field("lost_rolling", "J", &Ledger::lost_rolling), field("lost_film", "J", &Ledger::lost_film),
            field("lost_bond", "J", &Ledger::lost_bond), field("lost_asleep", "J", &Ledger::lost_asleep),
            field("drag_input", "J", &Ledger::drag_input), field("drag_work", "J", &Ledger::drag_work),
            field("buoyancy_work", "J", &Ledger::buoyancy_work), field("flow_work", "J", &Ledger::flow_work),
            field("gravity_work", "J", &Ledger::gravity_work), field("force_work", "J", &Ledger::force_work),
            field("wall_work", "J", &Ledger::wall_work),
            field("interaction_work", "J", &Ledger::interaction_work),
            field("fed_kinetic", "J", &Ledger::fed_kinetic),
            field("fed_potential", "J", &Ledger::fed_potential),
            field("left_kinetic", "J", &Ledger::left_kinetic),
            field("left_potential", "J", &Ledger::left_potential),
            field("left_stored", "J", &Ledger::left_stored),
            field("concrete_lost_normal", "J", &Ledger::concrete_lost_normal),
            field("concrete_lost_sliding", "J", &Ledger::concrete_lost_sliding);
    }

    /// Drag force times (fluid - body velocity): turned into heat and turbulence.
    Real lost_drag() const noexcept { return drag_input - drag_work; }
    Real lost() const noexcept {
        return lost_normal + lost_sliding + lost_rolling + lost_film + lost_bond + lost_asleep + lost_drag();
    }

    /// Kinetic energy against the work done: zero but for round-off.
    Real residual() const noexcept {
        return kinetic - (kinetic_start + fed_kinetic - left_kinetic + gravity_work + buoyancy_work +
                          drag_work + flow_work + force_work + interaction_work - lost_asleep);
    }

    /// Energy that passed through: what `residual` is to be measured by.
    Real throughput() const noexcept {
        return std::max({kinetic_start + fed_kinetic + drag_input, lost() + left_kinetic + kinetic,
                         std::abs(gravity_work) + std::abs(buoyancy_work) + std::abs(flow_work) +
                             std::abs(force_work) + std::abs(wall_work),
                         1e-300});
    }
    Real residual_relative() const noexcept { return std::abs(residual()) / throughput(); }

    /// Works less what the state functions and the losses account for: the integrator's error in energy.
    Real integration_residue() const noexcept {
        const Real elastic = wall_work - interaction_work -
                             (stored_contacts + stored_bonds - stored_start + left_stored) - lost_normal -
                             lost_sliding - lost_rolling - lost_film - lost_bond;
        const Real gravity = -gravity_work - (potential - potential_start - fed_potential + left_potential);
        return elastic + gravity;
    }

    /// Calls `f(name, value)` for each column and each derived figure.
    void visit(auto&& f) const {
        f("kinetic", kinetic), f("potential", potential);
        f("stored_contacts", stored_contacts), f("stored_bonds", stored_bonds);
        f("kinetic_start", kinetic_start), f("potential_start", potential_start);
        f("stored_start", stored_start);
        f("lost_normal", lost_normal), f("lost_sliding", lost_sliding), f("lost_rolling", lost_rolling),
            f("lost_film", lost_film), f("lost_bond", lost_bond), f("lost_asleep", lost_asleep),
            f("lost_drag", lost_drag());
        f("concrete_lost_normal", concrete_lost_normal);
        f("concrete_lost_sliding", concrete_lost_sliding);
        f("drag_input", drag_input), f("drag_work", drag_work);
        f("buoyancy_work", buoyancy_work), f("flow_work", flow_work), f("gravity_work", gravity_work);
        f("force_work", force_work), f("wall_work", wall_work);
        f("interaction_work", interaction_work);
        f("fed_kinetic", fed_kinetic), f("fed_potential", fed_potential);
        f("left_kinetic", left_kinetic), f("left_potential", left_potential), f("left_stored", left_stored);
        f("integration_residue", integration_residue()), f("residual", residual());
    }
};

/// A ledger that adds up over millions of steps: of each column what rounding took is kept beside the sum,
/// and counts in the total. A. Neumaier 1974, doi:10.1002/zamm.19740540106.
struct Accounts {
    Ledger sum, rounded_off;

    void add(Real Ledger::*column, Real x) noexcept {
        Real& s = sum.*column;
        const Real next = s + x;
        rounded_off.*column += std::abs(s) >= std::abs(x) ? (s - next) + x : (x - next) + s;
        s = next;
    }
    Ledger total() const {
        Ledger all = sum;
        Ledger::fields([&](auto, auto, Real Ledger::*column) { all.*column += rounded_off.*column; });
        return all;
    }
    static void fields(auto&& field) {
        field("sum", &Accounts::sum), field("rounded_off", &Accounts::rounded_off);
    }
};
/// The same of a ledger alone.
inline void add(Ledger& to, Real Ledger::*column, Real x) noexcept { to.*column += x; }
inline void add(Accounts& to, Real Ledger::*column, Real x) noexcept { to.add(column, x); }

}  // namespace abrade
