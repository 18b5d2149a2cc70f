// Spheres in still water, through the whole engine, with a fluid written here as a user would.
#include "still_liquid.hpp"

#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

const LinearSpring law{{.stiffness = 1}};  // nothing touches: as soft as the steps want it

auto drop(Real radius, Real density, Real time, StillParams water, BodyState state = {}) {
    Scene scene;
    scene.add_sphere(radius, state, density);
    auto sim = simulate(scene).contact(law).fluid(Still{water});
    sim.run({.end_time = time, .time_step = time / 20'000});
    return sim;
}

}  // namespace

TEST_CASE("terminal velocity: where drag carries the submerged weight") {
    struct Case {
        Real radius, density, viscosity, time;
    };
    // From Stokes to Newton: Re from 1e-4 to 1e5.
    for (const Case& c : {Case{1e-3, 2650, 10, 0.02},
                          {1e-3, 2650, 6e-3, 0.5},
                          {2.5e-3, 2650, 1e-3, 1},
                          {0.02, 2650, 1e-3, 5}}) {
        const auto sim = drop(c.radius, c.density, c.time, {.viscosity = c.viscosity});
        const Real speed = -sim.particles().velocity[0].z(),
                   weight = (c.density - 1000) * standard_gravity * 4.0 / 3 * pi * cube(c.radius);
        const Real re = 1000 * speed * 2 * c.radius / c.viscosity;
        MESSAGE("Re " << re << ", terminal velocity " << speed << " m/s");
        const Real drag = 0.5 * 1000 * CliftGauvin{}.coefficient(re) * pi * square(c.radius) * square(speed);
        CHECK(drag == doctest::Approx(weight).epsilon(1e-5).scale(0));  // after ten or more time constants
        CHECK(sim.ledger().residual_relative() < 1e-12);
        // All the weight's work less buoyancy's goes into drag and motion.
        const Ledger& e = sim.ledger();
        CHECK(e.gravity_work + e.buoyancy_work ==
              doctest::Approx(e.lost_drag() + e.kinetic).epsilon(1e-10).scale(0));
        CHECK(e.drag_input == 0);
    }
}

TEST_CASE("neutral buoyancy: a sphere as heavy as water stays where it is put") {
    const auto sim = drop(0.01, 1000, 1, {});
    CHECK(sim.particles().position[0].norm() < 1e-12);
    CHECK(sim.particles().velocity[0].norm() < 1e-12);
}

TEST_CASE("a light sphere floats at Archimedes' draft, bobbing to rest") {
    const Real radius = 0.05, density = 600;
    const auto sim = drop(radius, density, 40, {.viscosity = 0.5, .surface = 0}, {.position = {0, 0, 0.01}});
    CHECK(std::abs(sim.particles().velocity[0].z()) < 1e-4);
    CHECK(submerged_share(-sim.particles().position[0].z(), radius) ==
          doctest::Approx(0.6).epsilon(0.001).scale(0));
}

TEST_CASE("a sphere dropped from above falls freely until it touches the water") {
    const auto sim = drop(0.01, 2650, 0.1, {.surface = -1});
    CHECK(sim.particles().velocity[0].z() == doctest::Approx(-standard_gravity * 0.1).epsilon(1e-12));
    CHECK(sim.ledger().lost_drag() == 0);
    CHECK(sim.ledger().buoyancy_work == 0);
}
