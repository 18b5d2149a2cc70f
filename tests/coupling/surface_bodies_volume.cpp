// Bodies below, in and above the surface of a volume of fluid: rest, draft, what falls in, and where energy
// goes.
#include "fixed_ball.hpp"

#include <abrade/coupling/exchange/one_fluid.hpp>

#include <doctest/doctest.h>

using namespace resolved;

namespace {

template <class Solids = MonolithicSolids<>>
auto free_pool() {
    return pool<Solids, FreeSurface>();
}
/// What is no water among the lowest cells [cell].
Real voids(const auto& water, int levels) {
    Real sum = 0;
    water.grid().for_each([&](const CellNumber<3>& cell, Offset c) {
        if (cell[2] < levels) sum += 1 - water.liquid().fraction()[c];
    });
    return sum;
}

}  // namespace

TEST_CASE("a fixed ball below the surface: all stays at rest, what it pushes up is its volume") {
    check_ball_below<FreeSurface>(2e-4);
}

TEST_CASE("a fixed ball that pierces the surface has the buoyancy of what is below it") {
    check_ball_that_pierces<FreeSurface>();
}

TEST_CASE("a ball that rises swims as deep as Archimedes has it; no water is lost") {
    for (const Real ratio : {0.05, 0.1, 0.3, 0.5}) {
        auto water = free_pool();
        Ball ball({0.515, 0.49, 0.5}, 0.1, 1000 * ratio);
        advance(water, ball, 0.05);
        const Real volume = water.liquid().volume();
        advance(water, ball, 3);
        const Real middle = advance(water, ball, 7), exact = draft_of(ratio);
        const Real draft = volume + ratio * ball.body.volume - (middle - 0.1);
        CAPTURE(ratio);
        MESSAGE("draft " << draft << " m, exact " << exact << " m");
        CHECK(std::abs(draft - exact) < 0.2 * h);  // of a cell, waves included
        CHECK(water.liquid().volume() == doctest::Approx(volume).epsilon(1e-13));
    }
}

TEST_CASE("a stone dropped into the pool goes through the surface to the floor; no void, no water lost") {
    for (const Real cells : {2.0, 4.0}) {
        auto water = free_pool();
        Ball ball({0.515, 0.49, 0.85}, 0.5 * cells * h, 2650);
        advance(water, ball, 0.01);
        water.open_energy_account();
        advance(water, ball, 2.5);
        CAPTURE(cells);
        CHECK(ball.body.position.z() < 0.5 * cells * h + 1e-3);
        CHECK(ball.body.load.force.z() == doctest::Approx(1000 * g * ball.body.volume).epsilon(0.05));
        CHECK(water.liquid().volume() == doctest::Approx(level).epsilon(1e-13));
        CHECK(voids(water, 10) < 0.01);
        const WaterEnergy& e = water.energy();
        MESSAGE("numerical " << e.numerical << " J of " << e.solids << " J, residual "
                             << e.residual_relative());
        CHECK(e.residual_relative() < 1e-12);
        CHECK(e.numerical > -0.02 * e.solids);
    }
}

TEST_CASE_TEMPLATE("so it is in one fluid", Solids, MixtureSolids, DirectForcing) {
    auto water = free_pool<Solids>();
    Ball ball({0.515, 0.49, 0.85}, 0.1, 2650);
    advance(water, ball, 2.5);
    CHECK(ball.body.position.z() < 0.1 + 1e-3);
    CHECK(ball.body.load.force.z() == doctest::Approx(1000 * g * ball.body.volume).epsilon(0.05));
    CHECK(water.liquid().volume() == doctest::Approx(level).epsilon(1e-13));
    CHECK(voids(water, 10) < 0.01);
}

TEST_CASE("a stone that appears in the water displaces its volume as it leaves its place") {
    auto water = free_pool();
    water.advance(0.1);
    const Real volume = water.liquid().volume();
    Ball ball({0.515, 0.49, 0.46}, 0.1, 2650);
    advance(water, ball, 4);
    CHECK(water.liquid().volume() == doctest::Approx(volume).epsilon(1e-13));
    Real mean = 0;
    for (int i = 0; i < 20; ++i)
        for (int j = 0; j < 20; ++j) mean += water.surface_at(Vec3((i + 0.5) * h, (j + 0.5) * h, 0)) / 400;
    MESSAGE("rises by " << (mean - level) / ball.body.volume << " of its volume");
    CHECK(std::abs(mean - level - ball.body.volume) < 0.05 * ball.body.volume);
}
