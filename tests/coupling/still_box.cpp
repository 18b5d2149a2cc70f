// Water at rest that no step of its own calls for: bodies in it, or in a stream past them, meet it all the
// same.
#include "stone_tank.hpp"

#include <doctest/doctest.h>

#include <type_traits>

using namespace stone_tank;

namespace {

template <class Surface = FullBox>
auto tank_with(const Tank& tank, Scene scene) {
    return simulate(std::move(scene))
        .contact(LinearSpring({.stiffness = 1e5, .restitution = 0.5, .friction = 0.3}))
        .fluid(water_in<Surface>(tank));
}
constexpr Real diameter = 0.05;

}  // namespace

TEST_CASE("a stone at rest on the floor of a full box at rest is carried, one lighter than water rises") {
    for (const Real resolved_from : {3.0, 100.0}) {
        const Tank tank{.cells = {16, 16, 24}, .resolved_from = resolved_from};
        for (const Real density : {500.0, stone_density}) {
            Scene scene = walls_of(tank);
            scene.add_sphere(0.5 * diameter, {.position = {0.001, 0.002, 0.5 * diameter}}, density);
            auto sim = tank_with(tank, std::move(scene));
            sim.run({.end_time = 0.2});
            const Real carried = sim.world().state().in_fluid.load[0].force.z();
            const Real height = sim.particles().position[0].z();
            MESSAGE(density << " kg/m3: carried " << carried / (water_density * g * pi / 6 * cube(diameter))
                            << " of rho g V, height " << height << " m");
            if (density > water_density) {
                CHECK(carried == doctest::Approx(water_density * g * pi / 6 * cube(diameter)).epsilon(3e-3));
                CHECK(height < 0.5 * diameter);
            } else {
                CHECK(height > 2 * diameter);
            }
        }
    }
}

TEST_CASE_TEMPLATE("bodies that are let go meet the water at once", Surface, FullBox, HeightSurface) {
    Tank tank{.cells = {16, 16, 24}};
    if (!std::is_same_v<Surface, FullBox>) tank.level = 0.18;
    for (const Real resolved_from : {3.0, 100.0})
        for (const Real ratio : {0.5, 1.0, 2.65}) {
            tank.resolved_from = resolved_from;
            Scene scene = walls_of(tank);
            scene.add_sphere(0.5 * diameter, {.position = {0.001, 0.002, 0.1}}, ratio * water_density);
            auto sim = tank_with<Surface>(tank, std::move(scene));
            constexpr Real end = 0.02;
            sim.run({.end_time = end});
            const Real speed = sim.particles().velocity[0].z();
            const Real allowed = -(ratio - 1) * g / (ratio + 0.5) * end;
            MESSAGE(ratio << " of the water's density: " << speed << " m/s, by added mass " << allowed);
            CHECK(std::abs(speed - allowed) < 2e-4 + 0.06 * std::abs(allowed));
        }
}

TEST_CASE("where nothing moves the water runs to the end, observed or not") {
    for (const Real every : {0.0, 0.05}) {
        const Tank tank{.level = 0.12};
        Scene scene = walls_of(tank);
        scene.add_sphere(0.5 * diameter, {.position = {0.001, 0.002, 0.1}}, stone_density);
        scene.stones[0].fixed = true;
        auto sim = tank_with<HeightSurface>(tank, std::move(scene));
        sim.run({.end_time = 0.2, .observe_every = every});
        CHECK(sim.fluid_model().time() == doctest::Approx(0.2).epsilon(1e-12));
        CHECK(sim.world().state().in_fluid.load[0].force.z() >
              0.5 * water_density * g * pi / 6 * cube(diameter));
    }
}

TEST_CASE("a stone that goes through a side of the water ends the run in that step, with the remedy") {
    const Tank tank{.level = 0.12};
    Scene scene = walls_of(tank, false);
    scene.add_sphere(0.5 * diameter, {.position = {0, 0, 0.03}}, stone_density);
    auto sim = tank_with<HeightSurface>(tank, std::move(scene));
    CHECK_THROWS_WITH_AS(sim.run({.end_time = 2}), doctest::Contains("closed side at z = 0 m"), RunError);
}

TEST_CASE("no air is left for what a stone displaces: said so") {
    const Tank tank{.level = 1};
    Scene scene = walls_of(tank);
    scene.add_sphere(0.5 * diameter, {.position = {0, 0, 0.1}}, stone_density);
    auto sim = tank_with<HeightSurface>(tank, std::move(scene));
    CHECK_THROWS_WITH_AS(sim.run({.end_time = 0.2}), doctest::Contains("leave air above it"), RunError);
}
