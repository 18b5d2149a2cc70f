#pragma once
// A sphere on a plane, level or inclined, that slides or rolls. Shared by incline.cpp and by
// bench/charts/incline.cpp; docs/verification/incline.md tells what is compared.

#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/sim/simulation.hpp>

#include <vector>

namespace incline {

using namespace abrade;

constexpr Real radius = 0.02, density = 2650, g = 9.81;  // [m], [kg/m3], [m/s2]
constexpr Real mass = density * 4 / 3 * pi * cube(radius);

inline LinearSpring linear(Real friction) {
    return LinearSpring{{.stiffness = 1e6, .restitution = 0.2, .friction = friction}};
}
inline HertzMindlin hertz(Real friction) {
    return HertzMindlin{{.youngs = 5e8, .restitution = 0.2, .friction = friction}};
}

/// Overlap at which a law carries a force [m].
inline Real sag(const LinearSpring& law, Real force) { return force / law.stiffness(); }
inline Real sag(const HertzMindlin& law, Real force) {
    return std::pow(0.75 * force / (law.effective_youngs() * std::sqrt(radius)), 2.0 / 3);
}

/// The sphere on its springs, in balance along the normal; x points down the slope.
template <class Law>
auto on_slope(const Law& law, Real angle, Real speed = 0, Real rim_speed = 0) {
    Scene scene;
    scene.gravity = g * Vec3(std::sin(angle), 0, -std::cos(angle));
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    scene.add_sphere(radius,
                     {.position = {0, 0, radius - sag(law, mass * g * std::cos(angle))},
                      .velocity = {speed, 0, 0},
                      .angular_velocity = {0, rim_speed / radius, 0}},
                     density);
    return simulate(std::move(scene)).contact(law);
}

template <class Sim>
Real speed_of(const Sim& sim) {
    return sim.particles().velocity[0].x();
}
template <class Sim>
Real rim_speed_of(const Sim& sim) {
    return radius * sim.particles().angular_velocity(0).y();
}

/// From the first to the second of two times, the start having died away [m/s2], [J], [m].
struct Descent {
    Real acceleration = 0, rim_acceleration = 0, lost = 0, slipped = 0;
    Ledger ledger;
};

template <class Law>
Descent descend(const Law& law, Real angle, Real from = 0.05, Real to = 0.35) {
    auto sim = on_slope(law, angle);
    sim.run({.end_time = from});
    const Real v = speed_of(sim), rim = rim_speed_of(sim), x = sim.particles().position[0].x(),
               lost = sim.ledger().lost_sliding, time = to - from;
    sim.run({.end_time = to});
    return {(speed_of(sim) - v) / time, (rim_speed_of(sim) - rim) / time, sim.ledger().lost_sliding - lost,
            // The spin grows evenly: its mean is that of start and end.
            sim.particles().position[0].x() - x - 0.5 * (rim + rim_speed_of(sim)) * time, sim.ledger()};
}

/// How slip on level ground ends. A sphere that starts with speed v0 and no spin, or with rim speed v0 and no
/// speed, slips for 2 v0 / (7 mu g) over v0^2 / (7 mu g) and loses m v0^2 / 7.
struct SlipToRoll {
    Real time = 0, speed = 0, distance = 0, slipped = 0;  ///< as slip ends [s], [m/s], [m], [m]
    Real lost = 0, lost_rolling = 0;                      ///< in all; after 1.5 times that time [J]
    std::vector<Real> times, speeds, rim_speeds, losses;  ///< history [s], [m/s], [m/s], [J]
    Ledger ledger;
};

inline Real slip_time(Real speed, Real friction) { return 2 * speed / (7 * friction * g); }

template <class Law>
SlipToRoll slip_to_roll(const Law& law, Real speed, Real rim_speed) {
    auto sim = on_slope(law, 0, speed, rim_speed);
    SlipToRoll out;
    const Real expected = slip_time(std::abs(speed - rim_speed), law.params().friction);
    Real slip_before = 0, lost_by_then = 0;
    sim.run({.end_time = 3 * expected, .observe_every = expected / 1000}, [&](const auto& now) {
        const Real v = speed_of(now), rim = rim_speed_of(now), slip = std::abs(v - rim);
        if (out.time == 0) {
            if (!out.times.empty())
                out.slipped += 0.5 * (slip + slip_before) * (now.time() - out.times.back());
            // Past this a sphere rolls; what is left of its slip the tangential spring takes up.
            if (slip <= 1e-3 * std::abs(speed - rim_speed))
                out.time = now.time(), out.speed = v, out.distance = now.particles().position[0].x();
            slip_before = slip;
        }
        if (now.time() <= 1.5 * expected) lost_by_then = now.ledger().lost_sliding;
        out.times.push_back(now.time()), out.speeds.push_back(v), out.rim_speeds.push_back(rim);
        out.losses.push_back(now.ledger().lost_sliding);
    });
    out.lost = sim.ledger().lost_sliding, out.lost_rolling = out.lost - lost_by_then,
    out.ledger = sim.ledger();
    return out;
}

}  // namespace incline
