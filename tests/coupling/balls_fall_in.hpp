#pragma once
// Balls of many sizes and densities that are thrown into a pool, hit each other and its sides, sink and swim.
#include "pool.hpp"

#include <doctest/doctest.h>

#include <random>

namespace resolved {

/// Within a box of 1 m x 1 m x 1.2 m: sides throw back, balls that overlap are pushed apart, and those that
/// would within `dt` hit each other before: what two bodies cover together is no water's to leave.
inline void collide(std::vector<Ball>& balls, Real dt) {
    for (Ball& ball : balls) {
        FlowBody& b = ball.body;
        const Real radius = ball.sphere.radius;
        for (int a = 0; a < 3; ++a) {
            const Real high = a == 2 ? 1.2 : 1;
            if (a < 2 && b.position[a] < radius)
                b.position[a] = radius, b.velocity[a] = 0.3 * std::abs(b.velocity[a]);
            if (b.position[a] > high - radius)
                b.position[a] = high - radius, b.velocity[a] = -0.3 * std::abs(b.velocity[a]);
        }
    }
    for (std::size_t i = 0; i < balls.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            FlowBody &a = balls[i].body, &b = balls[j].body;
            const Vec3 way = a.position - b.position;
            const Real length = way.norm(), reach = balls[i].sphere.radius + balls[j].sphere.radius;
            if (!(length > 0)) continue;
            const Vec3 n = way / length;
            const Real nearer = (b.velocity - a.velocity).dot(n);
            const Vec3 apart = std::max(reach - length, 0.0) / (a.inverse_mass + b.inverse_mass) * n;
            a.position += a.inverse_mass * apart, b.position -= b.inverse_mass * apart;
            if (nearer <= 0 || length - nearer * dt >= reach) continue;
            const Vec3 blow = 1.2 * nearer / (a.inverse_mass + b.inverse_mass) * n;
            a.velocity += a.inverse_mass * blow, b.velocity -= b.inverse_mass * blow;
        }
}

/// Eight of them; densities between `light` and `heavy` over the water's.
template <class Solids, class Surface>
void check_balls(unsigned seed, Real light, Real heavy, Real end, Solids solids = {}) {
    PoolAmong<Solids, Surface> water(pool<Solids, Surface>().params(), {}, std::move(solids));
    std::mt19937 random(seed);
    std::uniform_real_distribution<Real> unit(0, 1);
    const auto between = [&](Real low, Real high) { return low + (high - low) * unit(random); };
    std::vector<Ball> balls;
    for (Index n = 0; n < 8; ++n) {
        const Real radius = between(0.02, 0.12), x = between(0.15, 0.85), y = between(0.15, 0.85);
        const Real z = between(0.2, 1);
        Ball& ball = balls.emplace_back(Vec3(x, y, z), radius, 1000 * between(light, heavy), n);
        ball.floor = 0;
        for (int a = 0; a < 3; ++a) ball.body.velocity[a] = between(-1, 1);
    }
    Real volume = 0, most = 0;
    while (water.time() < end) {
        const Real dt = std::min(water.stable_step().seconds, 0.01);
        collide(balls, dt);
        step(water, balls, dt);
        if (volume == 0) volume = water.liquid().volume();
        for (int a = 0; a < 3; ++a)
            water.grid().for_each([&](const auto&, Offset c) {
                if (water.liquid().fraction()[c] > 0.5)
                    most = std::max(most, std::abs(water.velocity()[a][c]));
            });
    }
    CAPTURE(seed);
    CAPTURE(light);
    MESSAGE("seed " << seed << ": water of " << most << " m/s, volume off by "
                    << water.liquid().volume() / volume - 1);
    CHECK(most < 6);  // they meet it with at most 4
    CHECK(std::abs(water.liquid().volume() / volume - 1) < 1e-13);
    Real voids = 0;
    water.grid().for_each([&](const CellNumber<3>& cell, Offset c) {
        if (cell[2] < 9) voids += 1 - water.liquid().fraction()[c];
    });
    if (end > 2) CHECK(voids < 0.01);  // in cells
}

}  // namespace resolved
