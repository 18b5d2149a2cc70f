#pragma once
// One body's share of a step: the kick with the works it does, and the drift.

#include <abrade/coupling/drag/drag.hpp>
#include <abrade/dem/store/sphere_store.hpp>
#include <abrade/dem/time/rotation.hpp>
#include <abrade/sim/scene/policies.hpp>
#include <abrade/sim/state/ledger.hpp>

#include <limits>

namespace abrade {

/// What moving bodies adds up to [J], and what it notices.
struct MotionSums {
    Quad interaction{};        ///< work of contacts and bonds; its first three numbers are to be added up [J]
    Quad mass_displacement{};  ///< sum of mass times displacement [kg m]; times gravity: its work
    Real drag = 0, drag_input = 0, buoyancy = 0, flow = 0, force = 0;  ///< [J]
    Real fastest2 = 0;                                                 ///< of spheres' centres [m2/s2]
    Quad low{{1e300, 1e300, 1e300, 1e300}}, high{{-1e300, -1e300, -1e300, -1e300}};  ///< of positions [m]
    Quad finite{};       ///< sum of velocities: not finite where one is not
    bool stirs = false;  ///< one beside a sleeper has become fast

    /// What the fluid did over a `displacement` [m] and for `time` [s]; one that resolves bodies turns them,
    /// too [rad].
    void add(const FluidLoad& fluid, const Vec3& displacement, const Vec3& /*rotation*/, Real time) noexcept {
        drag += fluid.drag.dot(displacement), drag_input += time * fluid.drag.dot(fluid.fluid_velocity);
        buoyancy += fluid.buoyancy.dot(displacement), flow += fluid.inertial.dot(displacement);
    }
    void add(const FlowLoad& fluid, const Vec3& displacement, const Vec3& rotation, Real /*time*/) noexcept {
        flow += fluid.force.dot(displacement) + fluid.torque.dot(rotation);
    }
    template <class FromFluid>
    void add(const WithForce<FromFluid>& load, const Vec3& displacement, const Vec3& rotation,
             Real time) noexcept {
        add(static_cast<const FromFluid&>(load), displacement, rotation, time);
        force += load.given.force.dot(displacement) + load.given.torque.dot(rotation);
    }
    /// A sphere that has moved: where it is, its velocity, and that of its surface.
    void notice(const Quad& place, const Quad& velocity, const Quad& surface_velocity) noexcept {
        const Quad squares = velocity * velocity;
        fastest2 = std::max(fastest2, squares.value[0] + squares.value[1] + squares.value[2]);
        low = least(low, place), high = most(high, place);
        finite = finite + velocity + surface_velocity;
    }

    MotionSums& operator+=(const MotionSums& o) noexcept {
        interaction = interaction + o.interaction;
        mass_displacement = mass_displacement + o.mass_displacement;
        drag += o.drag, drag_input += o.drag_input, buoyancy += o.buoyancy, flow += o.flow;
        force += o.force;
        fastest2 = std::max(fastest2, o.fastest2);
        low = least(low, o.low), high = most(high, o.high), finite = finite + o.finite;
        stirs |= o.stirs;
        return *this;
    }
    Real interaction_work() const noexcept {
        return interaction.value[0] + interaction.value[1] + interaction.value[2];
    }
    Real gravity_work(const Vec3& gravity) const noexcept {
        return gravity.dot(detail::first_three(mass_displacement));
    }
};

/// Books the works of moving bodies in a Ledger or in Accounts.
void book(auto& to, const MotionSums& motion, const Vec3& gravity) noexcept {
    add(to, &Ledger::interaction_work, motion.interaction_work());
    add(to, &Ledger::gravity_work, motion.gravity_work(gravity));
    add(to, &Ledger::drag_work, motion.drag), add(to, &Ledger::drag_input, motion.drag_input);
    add(to, &Ledger::buoyancy_work, motion.buoyancy), add(to, &Ledger::flow_work, motion.flow);
    add(to, &Ledger::force_work, motion.force);
}

/// What contacts and weight do to the water that a body takes along, its added mass. A flow that resolves
/// bodies knows of their weight.
inline void take_along(FlowLoad& fluid, const Vec3& contacts, Real mass, const Vec3& /*gravity*/) noexcept {
    if (fluid.added_mass > 0) fluid.force = fluid.force_among(contacts, mass);
}
inline void take_along(FluidLoad& fluid, const Vec3& contacts, Real mass, const Vec3& gravity) noexcept {
    share_with_added_mass(fluid, contacts + mass * gravity, mass);
}
template <class FromFluid>
void take_along(WithForce<FromFluid>& load, const Vec3& contacts, Real mass, const Vec3& gravity) noexcept {
    take_along(static_cast<FromFluid&>(load), contacts + load.given.force, mass, gravity);
}

/// What turns a body beside contacts and bonds [N m].
template <class OnBody>
inline constexpr bool turns_bodies = !std::same_as<OnBody, FluidLoad>;
inline const Vec3& torque_of(const FlowLoad& load) noexcept { return load.torque; }
inline const Vec3& torque_of(const WithForce<FluidLoad>& load) noexcept { return load.given.torque; }
inline Vec3 torque_of(const WithForce<FlowLoad>& load) noexcept { return load.torque + load.given.torque; }

/// What a kick does to a single sphere, and the works it does: a force is paired with the mean of the
/// velocities before and after, so works add up to the change in kinetic energy exactly.
struct KickedSphere {
    Quad velocity, surface_velocity;      ///< after; the fourth numbers are those of the lines
    Quad interaction, mass_displacement;  ///< as in MotionSums
};

/// v += dt (f/m + g), r omega += dt 5/2 lever/m: a solid sphere has I = 2/5 m r^2.
template <class OnBody>
KickedSphere kick(const SphereMotion& motion, const SphereLoad& load, const OnBody& fluid,
                  const Quad& gravity, Real dt) noexcept {
    const Quad& before = detail::quad(motion, 0);
    const Quad& surface_velocity = detail::quad(motion, 1);
    const Quad force = detail::three_ones * detail::quad(load, 0),
               torque_over_radius = detail::three_ones * detail::quad(load, 1);
    const Quad mass = detail::same(load.mass), per_mass = detail::same(dt * motion.inverse_mass);
    KickedSphere after;
    after.velocity = before + per_mass * (force + mass * gravity + detail::quad(force_of(fluid)));
    Quad turning = torque_over_radius;
    if constexpr (turns_bodies<OnBody>)
        turning = turning + detail::quad(Vec3(motion.curvature * torque_of(fluid)));
    after.surface_velocity = surface_velocity + detail::same(2.5) * per_mass * turning;
    const Quad displacement = detail::same(0.5 * dt) * (before + after.velocity);
    after.interaction =
        force * displacement +
        torque_over_radius * (detail::same(0.5 * dt) * (surface_velocity + after.surface_velocity));
    after.mass_displacement = detail::three_ones * mass * displacement;
    return after;
}

/// Force and torque of contacts and bonds on a clump [N], [N m].
struct ClumpLoad {
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
};

inline ClumpLoad load_of(const MovingClump& clump, const HotArrays& lines) noexcept {
    Quad force{}, torque{};
    const Quad position = detail::quad(clump.position);
    for (std::size_t m = 0; m < static_cast<std::size_t>(clump.count); ++m) {
        const std::size_t slot = static_cast<std::size_t>(clump.first_slot) + m;
        const Quad &place = detail::quad(lines.place[slot]), &on_member = detail::quad(lines.load[slot], 0);
        force = force + on_member;
        torque = torque + cross(place - position, on_member) +
                 detail::same(lines.place[slot].radius) * detail::quad(lines.load[slot], 1);
    }
    return {detail::first_three(force), detail::first_three(torque)};
}

/// What a kick does to a clump, likewise.
struct KickedClump {
    Vec3 velocity, angular_momentum;
    Vec3 displacement, rotation;  ///< [m], [rad]
    Real interaction;             ///< [J]
};

template <class OnBody>
KickedClump kick(const MovingClump& clump, const ClumpLoad& load, const OnBody& fluid, const Vec3& gravity,
                 Real dt) noexcept {
    const Vec3 velocity =
        clump.velocity + dt * clump.inverse_mass * (load.force + clump.mass * gravity + force_of(fluid));
    Vec3 momentum = clump.angular_momentum + dt * load.torque;
    if constexpr (turns_bodies<OnBody>) momentum += dt * torque_of(fluid);
    const Vec3 displacement = 0.5 * dt * (clump.velocity + velocity);
    const Vec3 rotation = 0.5 * dt * clump.angular_velocity(clump.angular_momentum + momentum);
    return {velocity, momentum, displacement, rotation,
            load.force.dot(displacement) + load.torque.dot(rotation)};
}

/// Turns a clump on which no torque acts over dt.
inline void turn_freely(MovingClump& clump, Real dt) noexcept {
    const Vec3 in_body = clump.rotation.transpose() * clump.angular_momentum;
    clump.orientation = turned(clump.orientation, midpoint_spin(in_body, clump.inverse_inertia, dt), dt);
    clump.rotation = clump.orientation.toRotationMatrix();
}

/// Turns and moves a clump and its member spheres over dt.
inline void drift(MovingClump& clump, Real dt, SphereStore& store, const Particles& particles) noexcept {
    const Vec3 before = clump.angular_velocity(clump.angular_momentum);
    turn_freely(clump, dt);
    clump.position += dt * clump.velocity;
    const Vec3 after = clump.angular_velocity(clump.angular_momentum);
    store.place_members(clump, particles, 0.5 * (before + after), dt);
}

}  // namespace abrade
