#pragma once
// Concrete that stones strike one after the other, each once: what sleep of the concrete is measured on.

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <random>
#include <vector>

namespace abrade {

/// Stones come down a straight line in a train, no gravity, so that they hit a square patch in the middle of
/// the concrete at random places and are gone before they could hit each other.
struct StruckConcrete {
    Real side = 0.3, patch = 0.2;  ///< of the concrete, and of where stones hit [m]
    Index layers = 3;
    int stones = 200;
    std::uint32_t seed = 1;
    Real interval = 0.02;      ///< between two of them [s]
    Real along = 5, down = 3;  ///< their velocity [m/s]
    Real radius = 0.025;       ///< [m]
    Real tensile = 2.7e6;      ///< [Pa]
    Real acceleration = 100;   ///< beta [-]
    Real wake_force = 0;       ///< [N]; 0: everything is awake
    Index wake_radius = 2;     ///< [bonds]

    Scene scene() const {
        Scene s;
        s.gravity.setZero();
        s.concrete = ConcreteBlock{flat_lattice(side, side, {.sphere_diameter = 0.02, .layers = layers})};
        s.outlet = 0.5 * side + 2 * radius;
        std::mt19937 random(seed);
        const auto anywhere = [&] {
            return patch * (std::uniform_real_distribution<Real>(-0.5, 0.5)(random));
        };
        for (int n = 0; n < stones; ++n) {
            const Real x = anywhere(), y = anywhere(), time = n * interval + 1e-4;
            s.add_sphere(radius, {.position = {x - along * time, y, radius + down * time},
                                  .velocity = {along, 0, -down}});
        }
        return s;
    }
    auto simulation() const {
        return simulate(scene())
            .contact(LinearSpring{{.stiffness = 1e6, .restitution = 0.6, .friction = 0.4}})
            .bond(MohrCoulomb{{.tensile = tensile, .stiffness = 4e6}})
            .wear(SubParticleAbrasion{{.acceleration = acceleration}});
    }
    /// Until the last stone has gone.
    RunOptions options() const {
        return {.end_time = stones * interval + 5e-3, .wake_force = wake_force, .wake_radius = wake_radius};
    }
};

/// What came of it.
struct Outcome {
    Real worn = 0, residual = 0, awake = 0, asleep = 0;
    Index broken = 0, bodies = 0, steps = 0;
    std::vector<Index> which;  ///< numbers of the broken bonds
    Ledger ledger;
};

template <class Sim>
Outcome outcome_of(const Sim& sim) {
    Outcome out{.worn = sim.concrete().worn_volume(),
                .residual = sim.ledger().residual_relative(),
                .awake = sim.awake_fraction_mean(),
                .asleep = sim.ledger().lost_asleep,
                .broken = sim.bonds_broken(),
                .bodies = sim.particles().bodies(),
                .steps = sim.steps(),
                .which = {},
                .ledger = sim.ledger()};
    const auto bonds = sim.world().network().bonds();
    for (std::size_t n = 0; n < bonds.size(); ++n)
        if (bonds[n].broken()) out.which.push_back(static_cast<Index>(n));
    return out;
}

inline Outcome run(const StruckConcrete& scene) {
    auto sim = scene.simulation();
    sim.run(scene.options());
    return outcome_of(sim);
}

}  // namespace abrade
