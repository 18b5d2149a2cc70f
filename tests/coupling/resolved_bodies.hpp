#pragma once
// Bodies alone with water that resolves them: moved by their weight and the water's loads, no contacts.

#include <abrade/coupling/exchange/monolithic.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace resolved {

using namespace abrade;

constexpr Real g = 9.81;  // [m/s2]

template <class Solids>
using WaterAmong = GridFluid<3, Among<Solids, FullBox>>;
using Water = WaterAmong<MonolithicSolids<>>;

/// A sphere that is free, or fixed where its density is 0 [kg/m3].
struct Ball {
    Sphere sphere;
    FlowBody body;
    Real floor = -1e9;  ///< on which it stops [m]
    Real given = 0;     ///< work of the water on it [J]

    Ball(const Vec3& centre, Real radius, Real density, Index id = 0) : sphere{centre, radius} {
        body.id = id, body.position = centre, body.volume = 4.0 / 3 * pi * cube(radius);
        if (density == 0) return;
        const Real mass = density * body.volume;
        body.inverse_mass = 1 / mass;
        body.inverse_inertia = Mat3::Identity() / (0.4 * mass * square(radius));
    }
    /// By what acts between two exchanges.
    void move(Real dt, const Vec3& gravity) {
        const Vec3 velocity = body.velocity, spin = body.angular_velocity;
        if (body.inverse_mass > 0) body.velocity += dt * (gravity + body.inverse_mass * body.load.force);
        body.angular_velocity += dt * body.inverse_inertia * body.load.torque;
        given += 0.5 * dt * body.load.force.dot(velocity + body.velocity);
        given += 0.5 * dt * body.load.torque.dot(spin + body.angular_velocity);
        body.position += dt * body.velocity;
        if (body.position.z() < floor + sphere.radius)
            body.position.z() = floor + sphere.radius, body.velocity.z() = std::max(body.velocity.z(), 0.0);
        sphere.centre = body.position;
        body.load.added_mass = 0, body.load.shared.setZero();  // the floor stops the body alone
    }
};

inline Real kinetic(const FlowBody& body) {
    if (body.inverse_mass == 0) return 0;
    return 0.5 * (body.velocity.squaredNorm() / body.inverse_mass +
                  body.angular_velocity.dot(body.inverse_inertia.inverse() * body.angular_velocity));
}

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
    Real given = 0;
    for (std::size_t b = 0; b < balls.size(); ++b) {
        given += balls[b].given += kinetic(bodies[b]) - kinetic(balls[b].body);
        balls[b].body = bodies[b];
    }
    water.solids_took(given);
}

/// Drag of a grid that fits the sphere of such a stream, docs/benchmarks.md [-].
constexpr Real fitted_drag_at_20 = 2.802, fitted_drag_at_100 = 1.113;

/// A sphere of diameter 1 in a stream of speed 1 that is 8 wide, fixed or led along it.
struct Stream {
    Real cells = 4;       ///< to its diameter
    Real reynolds = 100;  ///< of the stream
    Real off = 0;         ///< of the sphere's centre from a corner of cells [cell]
    Real led = 0;         ///< its speed
    Real shear = 0;       ///< by which the stream is faster above its centre
    Real step = 0;        ///< largest of time; 0: what is stable
    Real courant = 0.5, tolerance = 1e-5;
};
struct Drag {
    Real mean = 0;    ///< C_d against the speed that meets it [-]
    Real lift = 0;    ///< upward force over rho V U G, G the shear; 0 without one [-]
    Real varies = 0;  ///< root mean square of its change as the sphere crosses the grid, over the mean [-]
    Index cells = 0, steps = 0;
};
/// Means over the last quarter of `end`.
template <class Solids = MonolithicSolids<>, class Eddies = NoTurbulence>
Drag drag_in(const Stream& stream, Real end, Solids solids = Solids({.resolved_from = 0}),
             const Eddies& eddies = {}) {
    using Flow = GridFluid<3, Among<Solids, Turbulent<Eddies, FullBox>>>;
    const Real h = 1 / stream.cells;
    const int across = static_cast<int>(8 * stream.cells), along = static_cast<int>(12 * stream.cells);
    typename Flow::Params params{.grid = {.cells = {along, across, across}, .spacing = Vec3::Constant(h)},
                                 .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                                 .density = 1,
                                 .viscosity = 1 / stream.reynolds,
                                 .courant = stream.courant,
                                 .largest_step = stream.step,
                                 .tolerance = stream.tolerance};
    params.boundaries[0] = {Boundary::inflow, Boundary::outflow};
    const Vec3 place = Vec3(4, 4, 4) + stream.off * h * Vec3(1, 0.37, 0.71);
    params.velocity = [shear = stream.shear, place](const Vec3& x) {
        return Vec3(1 + shear * (x.z() - place.z()), 0, 0);
    };
    params.boundary_velocity = [flow = params.velocity](const Vec3& x, Real) { return flow(x); };
    Flow water(params, eddies, std::move(solids));
    std::vector<Ball> balls{{place, 0.5, 0}};
    Real sum = 0, squares = 0, lift = 0, count = 0;
    while (water.time() < end) {
        balls[0].body.velocity.x() = stream.led;
        step(water, balls, water.stable_step().seconds);
        if (water.time() < 0.75 * end) continue;
        const Real drag = balls[0].body.load.force.x() / (pi / 8 * square(1 - stream.led));
        sum += drag, squares += square(drag), lift += balls[0].body.load.force.z(), ++count;
    }
    const Real mean = sum / count;
    return {mean, stream.shear != 0 ? lift / count / (pi / 6 * stream.shear) : 0,
            std::sqrt(std::max(squares / count - square(mean), 0.0)) / mean,
            water.grid().layout().cell_count(), water.steps()};
}

}  // namespace resolved
