#pragma once
// One body's share of a step: half a kick with the works it does, and the drift.

#include <abrade/coupling/drag.hpp>
#include <abrade/dem/particles.hpp>
#include <abrade/dem/rotation.hpp>

#include <algorithm>

namespace abrade {

/// Works done in a kick [J], and the first body whose velocity went wrong.
struct KickSums {
    Real interaction = 0, gravity = 0, drag = 0, drag_input = 0, buoyancy = 0;
    Index bad = -1;

    KickSums& operator+=(const KickSums& other) noexcept {
        interaction += other.interaction, gravity += other.gravity;
        drag += other.drag, drag_input += other.drag_input, buoyancy += other.buoyancy;
        if (bad < 0) bad = other.bad;
        return *this;
    }
};

/// What a drift notices: displacement since the list of pairs was made, speed, volume past the gauge, and the
/// first body outside the bounds.
struct DriftSums {
    Real furthest2 = 0, fastest2 = 0;  ///< [m2], [m2/s2]
    Real gauge = 0;                    ///< [m3]
    Index lost = -1;
};

/// Both, for a pass that kicks and drifts.
struct MoveSums {
    KickSums kick;
    DriftSums drift;
    MoveSums& operator+=(const MoveSums& other) noexcept {
        kick += other.kick;
        drift.furthest2 = std::max(drift.furthest2, other.drift.furthest2);
        drift.fastest2 = std::max(drift.fastest2, other.drift.fastest2);
        drift.gauge += other.drift.gauge;
        if (drift.lost < 0) drift.lost = other.drift.lost;
        return *this;
    }
};

/// What the engine finds wrong with a step.
struct Trouble {
    enum class Cause : std::uint8_t { none, not_finite, lost, overlap } cause = Cause::none;
    Index body = -1, other = -1;  ///< bodies; `other` is negative for a boundary
    Real measure = 0;             ///< overlap over the smaller radius [-]
};

/// v += dt F/m, L += dt tau for body b. Each force is paired with (v_before + v_after)/2 dt, so the works
/// add up to the change in kinetic energy exactly. `interaction` is the force of contacts and bonds, which
/// alone turn bodies; `fluid` is null where there is none.
inline KickSums kick_body(Particles& p, Index body, const Vec3& interaction, const FluidLoad* fluid,
                          const Vec3& gravity, Real dt) noexcept {
    // (10 km/s)^2: no speed of this field. Infinities exceed it, and NaN fails the comparison.
    constexpr Real too_fast2 = 1e8;
    const auto b = static_cast<std::size_t>(body);
    KickSums work;
    if (p.inverse_mass[b] == 0) return work;
    Vec3& v = p.velocity[b];
    const Vec3 before = v;
    v += dt * p.inverse_mass[b] * p.force[b];
    const Vec3 path = 0.5 * dt * (before + v);
    const Vec3 spin_before = p.angular_velocity(body);
    p.angular_momentum[b] += dt * p.torque[b];
    const Vec3 turn = 0.5 * dt * (spin_before + p.angular_velocity(body));
    work.interaction = interaction.dot(path) + p.torque[b].dot(turn);
    work.gravity = p.mass[b] * gravity.dot(path);
    if (fluid) {
        work.drag = fluid->drag.dot(path);
        work.drag_input = dt * fluid->drag.dot(fluid->fluid_velocity);
        work.buoyancy = fluid->buoyancy.dot(path);
    }
    if (!(v.squaredNorm() < too_fast2 && p.angular_momentum[b].allFinite())) work.bad = body;
    return work;
}

/// x += dt v, the orientation likewise. Then the spheres are placed, with the velocities that half a step of
/// the present acceleration promises: the force pass sees velocities of its own time.
inline void drift_body(Particles& p, Index body, Real dt) noexcept {
    const auto b = static_cast<std::size_t>(body);
    if (p.inverse_mass[b] == 0) return;
    p.position[b] += dt * p.velocity[b];
    if (p.sphere_count[b] > 1)  // how a sphere is turned nobody sees
        p.orientation[b] = turn_freely(p.orientation[b], p.angular_momentum[b], p.inverse_inertia[b], dt);
    const Vec3 velocity = p.velocity[b] + 0.5 * dt * p.inverse_mass[b] * p.force[b];
    const Vec3 momentum = p.angular_momentum[b] + 0.5 * dt * p.torque[b];
    p.place_spheres(body, velocity, p.angular_velocity(body, momentum), p.velocity[b],
                    p.angular_velocity(body, p.angular_momentum[b]));
}

}  // namespace abrade
