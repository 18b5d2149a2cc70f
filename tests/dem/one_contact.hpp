#pragma once
// One contact by Verlet's method as the engine takes it: what a law answers to a fall, an impact, a path.

#include <abrade/dem/laws/contact_law.hpp>

#include <cmath>
#include <random>

namespace one_contact {

using namespace abrade;

/// A mass that moves along the normal of a contact, x its overlap.
struct Fall {
    Real mass = 1;          ///< that really moves [kg]
    Real told_mass = 0;     ///< effective mass that the law is told [kg]; 0: the same
    Real curvature = 100;   ///< [1/m]
    Real speed = 1;         ///< of approach at first [m/s]
    Real gap = 0;           ///< at first [m]
    Real weight = 0;        ///< towards the partner [N]
    Real time_step = 1e-6;  ///< [s]
};

struct Outcome {
    Real speed = 0;                 ///< of separation [m/s]
    Real lost = 0;                  ///< as the law books it [J]
    Real taken_up = 0;              ///< work on the contact until the overlap was deepest [J]
    Real deepest = 0, overlap = 0;  ///< [m]
    Real stored = 0;                ///< [J]
    Real last_lost = 0;             ///< over the last tenth of the time [J]
    long steps = 0;
};

/// Until the contact has opened and `time` [s] is over at most.
template <class Law>
Outcome run(const Law& law, const Fall& fall, Real time, bool until_open) {
    const Real dt = fall.time_step, told = fall.told_mass > 0 ? fall.told_mass : fall.mass;
    typename Law::template Memory<Real> memory{};
    Real x = -fall.gap, half = fall.speed, acceleration = fall.weight / fall.mass;
    half += 0.5 * dt * acceleration;
    Outcome end;
    bool touched = false;
    for (Real t = 0; t < time; t += dt, ++end.steps) {
        x += half * dt;
        const Real now = half + 0.5 * dt * acceleration;
        const auto [load, next] = law.respond(
            {Vec3(0, 0, 1), x, Vec3(0, 0, -now), 1 / told, fall.curvature, dt, Vec3(0, 0, -half * dt)},
            memory);
        memory = next;
        acceleration = (fall.weight - load.force.z()) / fall.mass;
        if (x >= end.deepest) end.deepest = x, end.taken_up = end.lost + load.lost_normal + load.stored;
        end.lost += load.lost_normal, end.stored = load.stored, end.overlap = x;
        if (t > 0.9 * time) end.last_lost += load.lost_normal;
        end.speed = -(half + 0.5 * dt * acceleration);
        half += dt * acceleration;
        if (touched && x <= 0 && until_open) break;
        touched = touched || x > 0;
    }
    return end;
}

/// A normal impact; the contact begins when the share `phase` of a step is over.
template <class Law>
Outcome impact(const Law& law, Fall fall, Real phase = 0.5) {
    fall.gap = phase * fall.speed * fall.time_step;
    return run(law, fall, 1e9, true);
}

/// Mean and largest |restitution - expected| over where in a step the contact begins.
struct Error {
    Real mean = 0, worst = 0, bias = 0;
};
template <class Law>
Error restitution_error(const Law& law, const Fall& fall, Real expected, int phases = 50) {
    Error error;
    for (int k = 0; k < phases; ++k) {
        const Real off = impact(law, fall, (k + 0.5) / phases).speed / fall.speed - expected;
        error.mean += std::abs(off) / phases, error.bias += off / phases;
        error.worst = std::max(error.worst, std::abs(off));
    }
    return error;
}

/// Pressed twice, the second time deeper, and sheared: |work - stored - lost| at the end of a path [J]. The
/// overlap [m] begins and ends with speed zero.
template <class Law>
Real mismatch(const Law& law, int steps, Real depth, Real slip_speed, Real* lost = nullptr) {
    const Real period = 1e-3, dt = period / steps, w = pi / period;
    typename Law::template Memory<Real> memory{};
    Real work = 0, dissipated = 0, stored = 0;
    for (int n = 0; n <= steps; ++n) {
        const Real t = n * dt, half = t - 0.5 * dt;
        // sin^2(w t) (1 + 0.6 cos(4 w t) + 0.3 w t): two hills and a valley.
        const Real s = std::sin(w * t), c = std::cos(w * t),
                   hills = 1 + 0.6 * std::cos(4 * w * t) + 0.3 * w * t;
        const Real overlap = depth * (0.02 + s * s * hills);
        const Real approach = depth * w * (2 * s * c * hills + s * s * (-2.4 * std::sin(4 * w * t) + 0.3));
        const auto slip = [&](Real at) { return slip_speed * std::sin(w * at) * std::cos(2.3 * w * at); };
        const auto [load, next] = law.respond(
            {Vec3(0, 0, 1), overlap, Vec3(slip(t), 0, -approach), 0.01, 100, dt, Vec3(dt * slip(half), 0, 0)},
            memory);
        // The path begins in touch, found pressed: its first point is where the sums begin.
        if (n > 0)
            work -= load.force.dot(Vec3(slip(t), 0, -approach)) * dt;
        else
            work += load.stored;
        dissipated += load.lost_normal + load.lost_tangential;
        stored = load.stored;
        memory = next;
    }
    if (lost) *lost = dissipated;
    return std::abs(work - dissipated - stored);
}

/// A contact that slides at `overlap` [m] for 200 steps: largest departure of its friction from mu f_n, over
/// mu f_n, and of what it lost from the work of that once it slides, over that work.
struct Sliding {
    Real force = 0, lost = 0;
};
template <class Law>
Sliding slide(const Law& law, Real overlap, Real speed) {
    typename Law::template Memory<Real> memory{};
    const Real dt = 1e-5;
    Sliding worst;
    for (int n = 0; n < 200; ++n) {
        const Vec3 slip(speed, 0, 0);
        const auto [load, next] =
            law.respond({Vec3(0, 0, 1), overlap, slip, 100, 100, dt, Vec3(dt * slip)}, memory);
        memory = next;
        if (n < 100) continue;
        const Real limit = law.params().friction * load.force.z();
        worst.force = std::max(worst.force, std::abs(load.force.x() / limit + 1));
        worst.lost = std::max(worst.lost, std::abs(load.lost_tangential / (limit * speed * dt) - 1));
    }
    return worst;
}

struct Random {
    std::mt19937 engine{23};
    Real uniform(Real low, Real high) { return std::uniform_real_distribution<Real>(low, high)(engine); }
    Real size(Real low_exponent, Real high_exponent) {
        return std::pow(10, uniform(low_exponent, high_exponent));
    }
    Vec3 any() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }
};

/// Of random, oblique histories: the least of all losses and stored energies, the least push over its terms,
/// and the largest friction over mu f_n.
struct Extremes {
    Real least_loss = 0, least_stored = 0, least_push = 0, steepest = 0;
    long sliding = 0, opened = 0, dented = 0;
};
template <class Law>
void random_history(Extremes& all, const Law& law, Random& random, Real depth, Real curvature, Real force) {
    typename Law::template Memory<Real> memory{};
    Vec3 normal = random.any().normalized();
    const Real mass = random.size(-6, 2), speed = random.size(-6, 1), dt = random.size(-8, -3);
    for (int step = 0; step < 40; ++step) {
        normal = (normal + 0.1 * random.any()).normalized();
        const ContactKinematics<Real> contact{
            normal, depth * random.uniform(-0.1, 1), speed * random.any(), 1 / mass, curvature,
            dt,     dt * speed * random.any()};
        const auto [load, next] = law.respond(contact, memory);
        const Real push = load.force.dot(normal), rub = (load.force - push * normal).norm();
        all.least_loss = std::min({all.least_loss, load.lost_normal, load.lost_tangential});
        all.least_stored = std::min(all.least_stored, load.stored);
        all.least_push = std::min(all.least_push, push / force);
        if (law.params().friction * push > 1e-6 * force)
            all.steepest = std::max(all.steepest, rub / (law.params().friction * push));
        all.sliding += load.lost_tangential > 0, all.dented += load.lost_normal > 0;
        all.opened += contact.overlap <= 0;
        memory = next;
    }
}

}  // namespace one_contact
