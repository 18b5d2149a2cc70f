// Bodies in one fluid with the water, at its surface: rest, draft, a stone that falls in.
#include "pool.hpp"

#include <abrade/coupling/exchange/one_fluid.hpp>

#include <doctest/doctest.h>

using namespace resolved;

TEST_CASE_TEMPLATE("a stone that lies on the floor: nothing streams", Solids, MixtureSolids, DirectForcing) {
    auto water = pool<Solids>();
    Ball ball({0.515, 0.49, 0.1}, 0.1, 2650);
    advance(water, ball, 2);
    CHECK(fastest(water) < 0.01);
    CHECK(ball.body.load.force.z() == doctest::Approx(1000 * g * ball.body.volume).epsilon(3e-3));
}

TEST_CASE("a ball that rises swims as deep as Archimedes has it; no water is lost") {
    for (const Real ratio : {0.05, 0.1, 0.3, 0.5}) {
        auto water = pool<MixtureSolids>();
        Ball ball({0.515, 0.49, 0.5}, 0.1, 1000 * ratio);
        advance(water, ball, 0.05);
        const Real volume = water.liquid().volume();
        advance(water, ball, 3);
        const Real middle = advance(water, ball, 7);
        const Real draft = volume + ratio * ball.body.volume - (middle - 0.1), exact = draft_of(ratio);
        CAPTURE(ratio);
        MESSAGE("draft " << draft << " m, exact " << exact << " m");
        CHECK(std::abs(draft - exact) < 0.25 * h);
        CHECK(water.liquid().volume() == doctest::Approx(volume).epsilon(1e-13));
    }
}

TEST_CASE_TEMPLATE("a stone dropped into the pool goes to the floor; no void, no water lost", Solids,
                   MixtureSolids, DirectForcing) {
    auto water = pool<Solids>();
    Ball ball({0.515, 0.49, 0.85}, 0.1, 2650);
    advance(water, ball, 3);
    CHECK(ball.body.position.z() < 0.1 + 1e-3);
    CHECK(ball.body.load.force.z() == doctest::Approx(1000 * g * ball.body.volume).epsilon(0.1));
    CHECK(water.liquid().volume() == doctest::Approx(level).epsilon(1e-12));
    for (int i = 0; i < 20; ++i)
        for (int j = 0; j < 20; ++j)
            CHECK(std::abs(water.liquid().height(water.liquid().columns().column(i, j)) - level) < 2 * h);
}
