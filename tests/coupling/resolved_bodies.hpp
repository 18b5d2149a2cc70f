#pragma once
// Bodies alone with water that resolves them: moved by their weight and the water's loads, no contacts.

#include <abrade/coupling/monolithic.hpp>
#include <abrade/fluid/grid_fluid.hpp>

#include <algorithm>
#include <vector>

namespace resolved {

using namespace abrade;

using Water = GridFluid<3, FullBox, Limited, Real, NoTurbulence, MonolithicSolids>;

/// A sphere that is free, or fixed where its density is 0 [kg/m3].
struct Ball {
    Sphere sphere;
    FlowBody body;
    Real floor = -1e9;  ///< on which it stops [m]

    Ball(const Vec3& centre, Real radius, Real density, Index id = 0) : sphere{centre, radius} {
        body.id = id, body.position = centre, body.volume = 4.0 / 3 * pi * cube(radius);
        if (density == 0) return;
        const Real mass = density * body.volume;
        body.inverse_mass = 1 / mass;
        body.inverse_inertia = Mat3::Identity() / (0.4 * mass * square(radius));
    }
    /// By what acts between two exchanges.
    void move(Real dt, const Vec3& gravity) {
        if (body.inverse_mass > 0) body.velocity += dt * (gravity + body.inverse_mass * body.load.force);
        body.angular_velocity += dt * body.inverse_inertia * body.load.torque;
        body.position += dt * body.velocity;
        if (body.position.z() < floor + sphere.radius)
            body.position.z() = floor + sphere.radius, body.velocity.z() = std::max(body.velocity.z(), 0.0);
        sphere.centre = body.position;
    }
};

/// One step of both.
template <class Flow>
void step(Flow& water, std::vector<Ball>& balls, Real dt) {
    std::vector<FlowBody> bodies;
    for (Ball& ball : balls) {
        ball.move(dt, water.params().gravity);
        ball.body.spheres = {&ball.sphere, 1};
        bodies.push_back(ball.body);
    }
    water.advance(water.time() + dt, bodies);
    for (std::size_t b = 0; b < balls.size(); ++b) balls[b].body = bodies[b];
}

}  // namespace resolved
