// Stones below a height surface where methods fail: shot through the surface, pressed on the bed by deep
// water, a heap that comes to rest. docs/verification/resolved_bodies.md has what was measured.
#include "stone_pile.hpp"

using namespace stone_tank;

TEST_CASE("a stone that is shot through the surface: no water is lost, energy only falls") {
    for (const Real diameter : {0.05, 0.025}) {
        const Real speed = 20, before = 0.25;
        const Tank tank{.cells = {12, 12, 24}, .level = 0.15};
        Scene scene = walls_of(tank, false);
        scene.add_sphere(0.5 * diameter, {.position = {0.001, -0.001, before}, .velocity = {0, 0, -speed}},
                         stone_density);
        auto sim = on_concrete<HeightSurface>(tank, std::move(scene));
        Real first = 0, lost = 0, residual = 0, under = 0;
        sim.run({.end_time = 0.012, .observe_every = 5e-4}, [&](const auto& now) {
            const auto& water = now.fluid_model();
            if (first == 0) first = water.liquid().volume();
            lost = std::max(lost, std::abs(water.liquid().volume() / first - 1));
            residual = std::max(residual, now.ledger().residual_relative());
            const auto& p = now.particles();
            const std::size_t stone = first_stone(now);
            if (under == 0 && p.position[stone].z() < tank.level - diameter) under = -p.velocity[stone].z();
        });
        MESSAGE((diameter / tank.h) << " cells: " << under << " m/s a diameter deep, " << fastest_stone(sim)
                                    << " m/s in the end; water lost " << lost);
        CHECK(lost < 1e-12);
        CHECK(residual < 1e-12);
        CHECK(under < speed);
        CHECK(under > 0.4 * speed);
        CHECK(fastest_stone(sim) < under);
    }
}

TEST_CASE("a metre of water on a stone that lies on the bed: it weighs as much as in a puddle") {
    for (const Real gap : {0.0, 1e-3}) {  // a twelfth of a cell is no gap for the water
        const Tank tank{.cells = {10, 10, 82}, .level = 1.0, .largest_step = 4e-3, .tolerance = 1e-8};
        const Real diameter = 0.05;
        Scene scene = walls_of(tank, false);
        scene.add_sphere(0.5 * diameter, {.position = {0.001, -0.001, 0.5 * diameter + gap}}, stone_density);
        auto sim = on_concrete<HeightSurface>(tank, std::move(scene));
        Real late = 0, high = 0, carried = 0, seen = 0;
        sim.run({.end_time = 0.8, .observe_every = 4e-3}, [&](const auto& now) {
            high = std::max(high, now.particles().position[first_stone(now)].z() - 0.5 * diameter);
            if (now.time() < 0.6) return;
            late = std::max(late, fastest_stone(now));
            carried += now.world().state().in_fluid.load[first_stone(now)].force.z() / buoyancy(diameter),
                seen += 1;
        });
        MESSAGE("let go " << gap << " m above: at most " << high << " m high, then " << late
                          << " m/s; carried " << (carried / seen) << " of rho g V");
        CHECK(high < gap + 1e-6);
        CHECK(late < 1e-7);
        CHECK(std::abs(carried / seen - 1) < 1e-4);
    }
}

TEST_CASE("a stone that presses into the floor, with a cell below it that it closes: it weighs as much") {
    constexpr Real diameter = 0.05;
    for (const Real cells : {9, 16})
        for (const Real off : {0.0, 0.5}) {  // the one cell is closed without, the other with
            const int n = static_cast<int>(3 * cells);
            const Tank tank{.cells = {n, n, n + 10}, .h = diameter / cells, .level = 3 * diameter};
            const Real deep = 0.1 * tank.h;
            const Real weight = stone_density * stone_tank::g * pi / 6 * cube(diameter);
            Scene scene = walls_of(tank);
            scene.add_sphere(0.5 * diameter,
                             {.position = {off * tank.h, 0.37 * off * tank.h, 0.5 * diameter - deep}},
                             stone_density);
            const LinearSpring spring{{.stiffness = weight / deep, .restitution = 0.3, .friction = 0.3}};
            auto sim = simulate(scene).contact(spring).fluid(water_in<HeightSurface>(tank));
            sim.run({.end_time = 0.2});
            const Real carried = sim.world().state().in_fluid.load[0].force.z() / buoyancy(diameter);
            MESSAGE(cells << " cells, " << off << " of one aside: carried " << carried << " of rho g V");
            CHECK(std::abs(carried - 1) < 3e-4);  // measured: 1e-4
        }
}

TEST_CASE("a heap of 40 stones comes to rest and wears nothing then") {
    for (const Real from : {0.0, 99.0}) {  // resolved, averaged
        const Tank tank{.cells = {16, 16, 30}, .level = 0.34, .largest_step = 4e-3, .resolved_from = from};
        const Rest rest = pile<HeightSurface>(tank, 40, 0.05, 4, 5);
        CHECK(rest.fastest < 1e-3);
        // 1e-6 to 8e-6, by compiler and flags: the last one that rolls.
        CHECK(rest.kinetic < 1e-5);
        CHECK(rest.crept < 1e-4);
        CHECK(rest.worn < 1e-3);
        CHECK(rest.residual < 1e-12);
        CHECK(rest.most_iterations <= 9);
    }
}
