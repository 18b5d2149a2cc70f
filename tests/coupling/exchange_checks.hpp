#pragma once
// What each exchange of momentum between water and bodies has to hold.
#include "resolved_bodies.hpp"

#include <doctest/doctest.h>

namespace resolved {

inline Water::Params box(int n, Real width, Boundary side) {
    return {.grid = {.cells = {n, n, n}, .spacing = Vec3::Constant(width)},
            .boundaries = BoundaryConditions<3>::all(side),
            .gravity = {0, 0, -g},
            .density = 1000,
            .viscosity = 1e-3,
            .tolerance = 1e-8};
}

/// rho g V wherever a fixed ball is, and no torque.
template <class Solids>
void check_buoyancy() {
    for (const Real cells : {0.6, 2.0, 4.0})
        for (const Real off : {0.0, 0.3, 0.5}) {
            auto params = box(16, 0.1, Boundary::free_slip);
            params.tolerance = 1e-12;
            WaterAmong<Solids> water(params);
            std::vector<Ball> balls{
                {Vec3(0.8 + 0.1 * off, 0.8 - 0.04 * off, 0.8 + 0.07 * off), 0.05 * cells, 0}};
            for (int k = 0; k < 20; ++k) step(water, balls, 0.05);
            const FlowBody& body = balls[0].body;
            const Real weight = 1000 * g * body.volume;
            CAPTURE(cells);
            CAPTURE(off);
            CHECK((body.load.force - Vec3(0, 0, weight)).norm() < 1e-7 * weight);
            CHECK(body.load.torque.norm() < 1e-7 * weight * 0.1);
        }
}

/// Kept to the pressure's tolerance while balls cross the grid.
template <class Solids>
void check_momentum() {
    auto params = box(16, 0.1, Boundary::periodic);
    params.gravity.setZero(), params.viscosity = 2, params.tolerance = 1e-9;
    WaterAmong<Solids> water(params);
    std::vector<Ball> balls{{Vec3(0.63, 0.8, 0.78), 0.2, 2650, 0}, {Vec3(1.1, 0.81, 1.15), 0.16, 500, 1}};
    balls[0].body.velocity = {0.9, 0.2, 0}, balls[0].body.angular_velocity = {0, 3, 0};
    const auto momentum = [&] {
        Vec3 sum = Vec3::Zero();
        for (int a = 0; a < 3; ++a)
            water.grid().for_each([&](const auto&, Offset c) { sum[a] += water.velocity()[a][c]; });
        sum *= 1000 * cube(0.1);
        // The water's velocity fills the whole control volume: what of it is solid is taken off.
        const FaceColumns& f = water.solids().faces();
        for (std::size_t i = 0; i < f.count(); ++i)
            sum[f.axis[i]] -= 1000 * f.share[i] * f.volume[i] * f.at(water.velocity(), i);
        for (const Ball& ball : balls) sum += ball.body.velocity / ball.body.inverse_mass;
        return sum;
    };
    step(water, balls, 0.02);
    const Vec3 start = momentum();
    for (int k = 0; k < 50; ++k) {
        step(water, balls, 0.02);
        CHECK((momentum() - start).norm() < 1e-6 * start.norm());
    }
    CHECK(balls[0].body.position.x() > 0.9);
}

}  // namespace resolved
