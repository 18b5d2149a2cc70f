#pragma once
// A pool of water below a height, and a ball that moves up and down in it.
#include "resolved_bodies.hpp"

namespace resolved {

template <class Solids, class Surface = HeightSurface>
using PoolAmong = GridFluid<3, Among<Solids, Surface>>;

constexpr Real h = 0.05, level = 0.613;

/// A box of 1 m x 1 m, filled up to `level`.
template <class Solids = MonolithicSolids<>, class Surface = HeightSurface>
PoolAmong<Solids, Surface> pool() {
    return PoolAmong<Solids, Surface>({.grid = {.cells = {20, 20, 24}, .spacing = Vec3::Constant(h)},
                                       .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                                       .water = [](const Vec3& x) { return level - x.z(); },
                                       .gravity = {0, 0, -g},
                                       .density = 1000,
                                       .viscosity = 1e-3,
                                       .tolerance = 1e-8});
}
Real fastest(const auto& water) {
    Real most = 0;
    for (int a = 0; a < 3; ++a)
        water.grid().for_each([&](const auto&, Offset c) {
            if (water.liquid().fraction()[c] == 1) most = std::max(most, std::abs(water.velocity()[a][c]));
        });
    return most;
}
/// Up and down alone, onto the floor; returns how high the ball was in the mean.
Real advance(auto& water, Ball& ball, Real end) {
    std::vector<Ball> balls{ball};
    balls[0].floor = 0;
    const Vec3 place = ball.body.position;
    Real sum = 0, time = 0;
    while (water.time() < end - 1e-9) {
        FlowBody& body = balls[0].body;
        body.velocity.head<2>().setZero(), body.load.force.head<2>().setZero();
        body.position.head<2>() = place.head<2>();
        const Real dt = std::min(water.stable_step().seconds, end - water.time());
        step(water, balls, dt);
        sum += dt * body.position.z(), time += dt;
    }
    ball = balls[0];
    return sum / time;
}
/// Of a ball whose lowest point lies `depth` below the surface.
inline Real cap(Real radius, Real depth) { return pi * square(depth) * (radius - depth / 3); }

/// How deep a ball of radius 0.1 swims.
inline Real draft_of(Real ratio) {
    Real low = 0, high = 0.2;
    for (int k = 0; k < 60; ++k) {
        const Real depth = 0.5 * (low + high);
        (cap(0.1, depth) < ratio * cap(0.1, 0.2) ? low : high) = depth;
    }
    return low;
}

}  // namespace resolved
