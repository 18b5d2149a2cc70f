#pragma once
// Two equal spheres settle one above the other, through the whole engine: the upper one is drawn into the
// wake of the lower one (drafting), touches it (kissing), and they turn over and part (tumbling).

#include <abrade/coupling/exchange/monolithic.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/sim/simulation.hpp>

#include <algorithm>
#include <cmath>

namespace dkt {

using namespace abrade;

/// When each event is seen first [s]; 0: never. The events are the reference's (cpl11).
struct Events {
    Real draft = 0;      ///< a tenth of a diameter nearer than at the start
    Real kiss = 0;       ///< centres within 1.1 diameters
    Real tumble = 0;     ///< the line of centres 45 degrees off the vertical
    Real separate = 0;   ///< after that, centres 1.3 diameters apart
    Real nearest = 1e9;  ///< distance of the centres [diameter]
    Real residual = 0;   ///< of the ledger [-]
};

/// Spheres of 1/6 cm and 1.14 times the water's density in a box of 1 cm x 1 cm x 4 cm, as R. Glowinski et
/// al. 2001, doi:10.1006/jcph.2000.6542, have them; frictionless contacts. Re 70 to 90.
inline Events events_of(Real cells, Real end) {
    using Flow = GridFluid<3, Among<MonolithicSolids<>, FullBox>>;
    const Real diameter = 0.01 / 6, h = diameter / cells;
    const int n = static_cast<int>(std::round(0.01 / h)), up = static_cast<int>(std::round(0.04 / h));
    const Flow water({.grid = {.cells = {n, n, up}, .spacing = Vec3(0.01 / n, 0.01 / n, 0.04 / up)},
                      .boundaries = BoundaryConditions<3>::all(Boundary::wall),
                      .gravity = {0, 0, -9.81},
                      .density = 1000,
                      .viscosity = 1e-3});
    Scene scene;
    scene.gravity = {0, 0, -9.81};
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    scene.add_wall({0, 0, 0}, {1, 0, 0}), scene.add_wall({0.01, 0, 0}, {-1, 0, 0});
    scene.add_wall({0, 0, 0}, {0, 1, 0}), scene.add_wall({0, 0.01, 0}, {0, -1, 0});
    // A hundredth of a diameter aside: on one line the pair would fall as one for long.
    scene.add_sphere(0.5 * diameter, {.position = {0.005, 0.005, 0.035}}, 1140);
    scene.add_sphere(0.5 * diameter, {.position = {0.005 + 0.01 * diameter, 0.005, 0.0316}}, 1140);
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1, .restitution = 0.8}}).fluid(water);
    Events events;
    Real start = 0;
    sim.run({.end_time = end, .observe_every = 0.002}, [&](const auto& now) {
        const auto& x = now.particles().position;
        const Vec3 apart = (x[0] - x[1]) / diameter;
        const Real distance = apart.norm(), time = now.time();
        if (start == 0) start = distance;
        const auto note = [&](Real& when, bool seen) {
            if (when == 0 && seen) when = time;
        };
        note(events.draft, distance < start - 0.1);
        note(events.kiss, distance < 1.1);
        note(events.tumble, apart.z() < std::sqrt(0.5) * distance);
        note(events.separate, events.tumble > 0 && distance > 1.3);
        events.nearest = std::min(events.nearest, distance);
        events.residual = std::max(events.residual, now.ledger().residual_relative());
    });
    return events;
}

}  // namespace dkt
