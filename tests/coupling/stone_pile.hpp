#pragma once
// Stones fall as a heap onto a floor of concrete in still water, and come to rest.
#include "stone_tank.hpp"

#include <abrade/dem/laws/rolling_resistance.hpp>
#include <abrade/wear/archard.hpp>

#include <doctest/doctest.h>

#include <string>

namespace stone_tank {

/// Wears in proportion to load and distance, at any load: rest is where nothing slides.
const Archard any_slip{{.coefficient = 1e-4, .hardness = 1e9}};
/// Spheres on a floor would roll on for long.
const RollingResistance<LinearSpring> soft{
    {.contact = {.stiffness = 2e5, .restitution = 0.3, .friction = 0.5}, .friction = 0.1}};

/// The concrete is one great sphere, as flat as a floor.
template <class Surface>
auto on_concrete(const Tank& tank, Scene scene) {
    constexpr Real radius = 100;
    const LatticeSite site{.centre = {0, 0, -radius}, .cell_volume = 1};
    scene.concrete = ConcreteBlock{.lattice = Lattice{radius, 1, 1, 1, {site}, {1}}};
    return simulate(std::move(scene)).contact(soft).wear(any_slip).fluid(water_in<Surface>(tank));
}
/// Number of the first stone.
std::size_t first_stone(const auto& sim) {
    const auto& kind = sim.particles().kind;
    return static_cast<std::size_t>(std::ranges::find(kind, Kind::stone) - kind.begin());
}

struct Rest {
    Real fastest = 0;       ///< of the stones after `settled` [m/s]
    Real kinetic = 0;       ///< then, at most, over the most that they had [-]
    Real crept = 0;         ///< the most that one went since then [m]
    Real worn = 0;          ///< since then, over all before [-]
    Real residual = 0;      ///< of the ledger [-]
    Real most_kinetic = 0;  ///< [J]
    Index most_iterations = 0;
    Real iterations = 0;  ///< in the mean, as seen
};

/// `settled`, `end` [s].
template <class Surface>
Rest pile(const Tank& tank, int count, Real diameter, Real settled, Real end) {
    Scene scene = walls_of(tank, false);
    add_stones(scene, tank, count, diameter, 0.01);
    auto sim = on_concrete<Surface>(tank, std::move(scene));
    Rest rest;
    std::vector<Vec3> places;
    Real worn = 0, seen = 0;
    sim.run({.end_time = end, .observe_every = 5e-3}, [&](const auto& now) {
        const auto& report = now.fluid_model().last_projection();
        rest.most_iterations = std::max<Index>(rest.most_iterations, report.iterations);
        rest.iterations += report.iterations, seen += 1;
        rest.residual = std::max(rest.residual, now.ledger().residual_relative());
        const Real kinetic = now.ledger().kinetic;
        rest.most_kinetic = std::max(rest.most_kinetic, kinetic);
        if (now.time() < settled) return;
        const auto& p = now.particles();
        if (places.empty()) places = p.position, worn = now.concrete().worn_volume();
        rest.fastest = std::max(rest.fastest, fastest_stone(now));
        rest.kinetic = std::max(rest.kinetic, kinetic);
        for (std::size_t b = 0; b < places.size(); ++b)
            rest.crept = std::max(rest.crept, (p.position[b] - places[b]).norm());
    });
    rest.kinetic /= rest.most_kinetic, rest.iterations /= seen;
    rest.worn = sim.concrete().worn_volume() / worn - 1;
    MESSAGE(count << " stones, cells of " << tank.h << " m, resolved from " << tank.resolved_from << ": from "
                  << settled << " s on at most " << rest.fastest << " m/s, kinetic energy " << rest.kinetic
                  << " of " << rest.most_kinetic << " J, crept " << rest.crept << " m, wore " << rest.worn
                  << " of " << worn << " m3; " << rest.iterations << " iterations, at most "
                  << rest.most_iterations << "; " << sim.fluid_model().steps() << " and " << sim.steps()
                  << " steps, " << sim.wall_seconds() << " s");
    return rest;
}

}  // namespace stone_tank
