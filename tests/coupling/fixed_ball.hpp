#pragma once
// A fixed ball in a pool, below its surface and through it.
#include "pool.hpp"

#include <doctest/doctest.h>

namespace resolved {

/// `within`: of the volume of the water, what its solid cells may keep beside the ball [-].
template <class Surface>
void check_ball_below(Real within) {
    auto water = pool<MonolithicSolids<>, Surface>();
    Ball ball({0.515, 0.49, 0.3}, 0.1, 0);
    advance(water, ball, 1);
    CHECK(fastest(water) < 1e-6 * std::sqrt(g * level));
    CHECK(ball.body.load.force.z() == doctest::Approx(1000 * g * ball.body.volume).epsilon(1e-7));
    CHECK(ball.body.load.force.head<2>().norm() < 1e-7 * 1000 * g * ball.body.volume);
    CHECK(water.liquid().volume() == doctest::Approx(level - ball.body.volume).epsilon(within));
}

template <class Surface>
void check_ball_that_pierces() {
    for (const Real z : {0.56, 0.6, 0.66}) {
        auto water = pool<MonolithicSolids<>, Surface>();
        Ball ball({0.515, 0.49, z}, 0.1, 0);
        advance(water, ball, 1);
        const Real below = cap(0.1, level - (z - 0.1));
        CAPTURE(z);
        MESSAGE("buoyancy " << ball.body.load.force.z() / (1000 * g * below) << ", fastest "
                            << fastest(water));
        CHECK(std::abs(ball.body.load.force.z() - 1000 * g * below) < 0.025 * 1000 * g * ball.body.volume);
        CHECK(fastest(water) < 0.02 * std::sqrt(g * level));
        CHECK(water.liquid().volume() == doctest::Approx(level - below).epsilon(1e-3));
    }
}

}  // namespace resolved
