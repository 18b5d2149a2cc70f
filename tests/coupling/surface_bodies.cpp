// Bodies below, in and above the surface of water: rest, draft, what is displaced, what falls in.
#include "fixed_ball.hpp"

#include <doctest/doctest.h>

using namespace resolved;
using Pool = PoolAmong<MonolithicSolids<>>;

TEST_CASE("a fixed ball below the surface: all stays at rest, what it pushes up is its volume") {
    check_ball_below<HeightSurface>(1e-12);
}

TEST_CASE("a fixed ball that pierces the surface has the buoyancy of what is below it") {
    check_ball_that_pierces<HeightSurface>();
}

TEST_CASE("a surface at the height of cells' centres, where a ball pierces it, is as any other") {
    for (const Real off : {0.0, 1e-7, 1e-3})
        for (const Real z : {0.6, 0.625, 0.645})
            for (const Real ratio : {0.0, 0.5}) {
                auto params = pool().params();
                params.water = [off](const Vec3& x) { return 0.625 + off - x.z(); };
                params.largest_step = 0.005;
                Pool water(params, {}, MonolithicSolids<>({.resolved_from = 0}));
                Ball ball({0.515, 0.505, z}, 0.1, 1000 * ratio);
                advance(water, ball, 0.5);
                CAPTURE(off);
                CAPTURE(z);
                CAPTURE(ratio);
                CHECK(fastest(water) < (ratio == 0 ? 0.05 : 0.5));
                if (ratio > 0) CHECK(std::abs(ball.body.velocity.z()) < 0.5);
            }
}

TEST_CASE("a ball that rises swims as deep as Archimedes has it; no water is lost") {
    struct Start {
        Real ratio, z;
    };
    for (const Start& start :
         {Start{0.05, 0.5}, Start{0.05, 0.48}, Start{0.1, 0.5}, Start{0.3, 0.5}, Start{0.5, 0.5}}) {
        const Real ratio = start.ratio, from = start.z;
        Pool water = pool();
        Ball ball({0.515, 0.49, from}, 0.1, 1000 * ratio);
        advance(water, ball, 0.05);
        const Real volume = water.liquid().volume();
        advance(water, ball, 3);
        const Real middle = advance(water, ball, 7);
        const Real exact = draft_of(ratio);
        const Real draft = volume + ratio * ball.body.volume - (middle - 0.1);
        CAPTURE(ratio);
        CAPTURE(from);
        MESSAGE("draft " << draft << " m, exact " << exact << " m");
        CHECK(std::abs(draft - exact) < (ratio < 0.2 ? 0.3 : 0.2) * h);  // of a cell, waves included
        CHECK(water.liquid().volume() == doctest::Approx(volume).epsilon(1e-13));
    }
}

TEST_CASE("a stone dropped into the pool goes through the surface to the floor; no void, no water lost") {
    for (const Real cells : {2.0, 4.0}) {
        Pool water = pool();
        Ball ball({0.515, 0.49, 0.85}, 0.5 * cells * h, 2650);
        advance(water, ball, 2.5);
        CAPTURE(cells);
        CHECK(ball.body.position.z() < 0.5 * cells * h + 1e-3);
        CHECK(ball.body.load.force.z() == doctest::Approx(1000 * g * ball.body.volume).epsilon(0.1));
        CHECK(water.liquid().volume() == doctest::Approx(level).epsilon(1e-12));
        const auto& liquid = water.liquid();
        Real low = 1, high = 0;
        for (int i = 0; i < 20; ++i)
            for (int j = 0; j < 20; ++j) {
                const Real height = liquid.height(liquid.columns().column(i, j));
                low = std::min(low, height), high = std::max(high, height);
            }
        CHECK(low > level - 0.5 * h);
        CHECK(high < level + 0.7 * h);
    }
}
