#pragma once
// Stones that fall in a tank of water on a grid, which they move or not.

#include "states.hpp"

#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/sim/simulation.hpp>

namespace same_bits {

using namespace abrade;

/// Cells of 5 cm; water that sways, below 0.41 m where there is a surface.
template <class Surface>
GridFluidParams<3> stone_tank(int along = 14) {
    GridFluidParams<3> params{.grid = {.cells = {along, 12, 14}, .spacing = Vec3::Constant(0.05)},
                              .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                              .gravity = {0, 0, -9.81}};
    if constexpr (!std::same_as<Surface, FullBox>)
        params.water = [](const Vec3& x) { return 0.41 + 0.05 * x.x() - x.z(); };
    return params;
}

/// Two of three to four cells to a diameter, `small` ones of one cell, all above a floor.
inline abrade::Scene stones_above_floor(int small) {
    abrade::Scene scene;
    scene.gravity = {0, 0, -9.81};
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    scene.add_sphere(
        0.09, {.position = {0.25, 0.3, 0.45}, .velocity = {0.2, 0, -1}, .angular_velocity = {0, 5, 0}});
    scene.add_stone(make_stone(StoneShape::angular, 0.18),
                    {.position = {0.47, 0.28, 0.11}, .velocity = {-0.3, 0, -1}});
    for (int n = 0; n < small; ++n)
        scene.add_sphere(0.025, {.position = {0.1 + 0.1 * (n % 5), 0.07 + 0.4 * (n / 5), 0.06 + 0.02 * n},
                                 .velocity = {0, 0, -0.5}});
    return scene;
}

/// So many in a tank of 70 cells that threads share them: of three cells, and below them of less than two.
inline abrade::Scene many_stones() {
    abrade::Scene scene;
    scene.gravity = {0, 0, -9.81};
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    for (int n = 0; n < 40; ++n)
        scene.add_sphere(0.08, {.position = {0.15 + 0.17 * (n % 20), 0.14 + 0.3 * (n / 20), 0.3 + 2e-3 * n},
                                .velocity = {0.1, 0, -1}});
    for (int n = 0; n < 60; ++n)
        scene.add_sphere(0.04, {.position = {0.1 + 0.11 * (n % 30), 0.1 + 0.35 * (n / 30), 0.05 + 1e-3 * n},
                                .velocity = {0, 0, -0.5}});
    return scene;
}

template <class Flow, class Drag = UsualDrag<Flow>>
Numbers fall_in(Flow flow, const abrade::Scene& scene, Real end, const Drag& drag = {}) {
    flow.open_energy_account();
    auto sim = simulate(scene)
                   .contact(LinearSpring{{.stiffness = 1e5, .restitution = 0.6, .friction = 0.3}})
                   .fluid(std::move(flow), drag);
    sim.run({.end_time = end, .time_step = 1e-4});
    return state_of(sim).with({"fastest water", "kinetic", "lost_normal"});
}

}  // namespace same_bits
