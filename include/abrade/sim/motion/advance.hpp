#pragma once
// Bodies of a simulation moved on, and written back.

#include <abrade/sim/motion/flight.hpp>

namespace abrade {

/// One move of all bodies.
struct Move {
    Real kick = 0, drift = 0;  ///< how far [s]
    bool keeps_loads = false;  ///< they are wanted again
    Real time = 0;             ///< of the loads [s]
    /// How far drag looks ahead of the velocities that the lines hold, as a share of their last change.
    Real ahead_in_fluid = 0;
};

/// Of a sphere: that of its centre or of its rim, whichever moves faster [m2/s2].
inline Real speed_squared(const SphereMotion& motion) noexcept {
    return std::max(motion.velocity.squaredNorm(), motion.surface_velocity.squaredNorm());
}

/// Kicks and drifts the single spheres in slots [first, last), and takes their loads off them.
template <class P>
[[gnu::flatten]] MotionSums move_spheres(State<P>& state, Index first, Index last,
                                         const Move& move) noexcept {
    MotionSums sums;
    const Quad gravity = detail::quad(state.scene.gravity);
    HotArrays& lines = state.store.lines;
    for (auto slot = static_cast<std::size_t>(first); slot < static_cast<std::size_t>(last); ++slot) {
        if (state.mode[slot] > IntegrationMode::beside_sleeper) continue;
        SphereMotion& motion = lines.motion[slot];
        SphereLoad& load = lines.load[slot];
        SpherePlace& place = lines.place[slot];
        const Real mass = load.mass;
        if (motion.inverse_mass > 0) {
            typename P::OnBody beside{};
            if constexpr (P::looks_ahead) {
                const auto sphere = static_cast<std::size_t>(state.store.sphere_of(static_cast<Index>(slot)));
                if (const Index body = state.particles.body[sphere];
                    P::has_force || state.feels_fluid(body)) {
                    beside = state.acting_on(body, place.centre, motion.velocity,
                                             motion.curvature * motion.surface_velocity, move.time,
                                             move.ahead_in_fluid);
                    state.in_fluid.velocity[static_cast<std::size_t>(body)] = motion.velocity;
                    take_along(beside, load.force, mass, state.scene.gravity);
                }
            }
            const KickedSphere after = kick(motion, load, beside, gravity, move.kick);
            sums.interaction = sums.interaction + after.interaction;
            sums.mass_displacement = sums.mass_displacement + after.mass_displacement;
            if constexpr (P::looks_ahead)
                sums.add(beside, 0.5 * move.kick * (motion.velocity + detail::first_three(after.velocity)),
                         0.5 * move.kick * motion.curvature *
                             (motion.surface_velocity + detail::first_three(after.surface_velocity)),
                         move.kick);
            detail::quad(motion, 0) = after.velocity, detail::quad(motion, 1) = after.surface_velocity;
            const Quad velocity = detail::three_ones * after.velocity;
            detail::quad(place) = detail::quad(place) + detail::same(move.drift) * velocity;
            sums.notice(detail::quad(place), velocity, after.surface_velocity);
            if (state.mode[slot] == IntegrationMode::beside_sleeper)
                sums.stirs |= state.sleep.is_fast(speed_squared(motion));
        }
        if (move.keeps_loads) continue;
        detail::quad(load, 0) = Quad{}, detail::quad(load, 1) = Quad{Quad::Native{0, 0, 0, mass}};
    }
    return sums;
}

/// The same for clumps and their member spheres.
template <class P>
[[gnu::flatten]] void move_clumps(State<P>& state, std::span<MovingClump> clumps, const Move& move,
                                  MotionSums& sums) noexcept {
    HotArrays& lines = state.store.lines;
    for (MovingClump& clump : clumps) {
        const auto first = static_cast<std::size_t>(clump.first_slot),
                   last = first + static_cast<std::size_t>(clump.count);
        if (state.mode[first] > IntegrationMode::beside_sleeper) continue;
        if (clump.inverse_mass > 0) {
            typename P::OnBody beside{};
            if constexpr (P::looks_ahead)
                if (P::has_force || state.feels_fluid(clump.body)) {
                    beside = state.acting_on(clump.body, clump.position, clump.velocity,
                                             clump.angular_velocity(clump.angular_momentum), move.time,
                                             move.ahead_in_fluid);
                    state.in_fluid.velocity[static_cast<std::size_t>(clump.body)] = clump.velocity;
                }
            const ClumpLoad load = load_of(clump, lines);
            take_along(beside, load.force, clump.mass, state.scene.gravity);
            const KickedClump after = kick(clump, load, beside, state.scene.gravity, move.kick);
            sums.interaction.value[0] += after.interaction;
            sums.mass_displacement =
                sums.mass_displacement + detail::quad(Vec3(clump.mass * after.displacement));
            if constexpr (P::looks_ahead) sums.add(beside, after.displacement, after.rotation, move.kick);
            clump.velocity = after.velocity, clump.angular_momentum = after.angular_momentum;
            if (move.drift > 0) drift(clump, move.drift, state.store, state.particles);
            for (std::size_t m = first; m < last; ++m)
                sums.notice(detail::quad(lines.place[m]),
                            detail::three_ones * detail::quad(lines.motion[m], 0),
                            detail::quad(lines.motion[m], 1));
            if (state.mode[first] == IntegrationMode::beside_sleeper)
                for (std::size_t m = first; m < last; ++m)
                    sums.stirs |= state.sleep.is_fast(speed_squared(lines.motion[m]));
        }
        if (move.keeps_loads) continue;
        for (std::size_t m = first; m < last; ++m)
            lines.load[m].force.setZero(), lines.load[m].torque_over_radius.setZero();
    }
}

/// The same as `publish_body`, of a clump in flight.
template <class P>
void publish_flying(State<P>& state, MovingClump clump, const Move& move, MotionSums& sums) noexcept {
    const auto b = static_cast<std::size_t>(clump.body);
    Particles& p = state.particles;
    FreeFlight flight = state.flight;
    flight.kicks += move.kick;
    const detail::FlightLoad flown =
        detail::flight_load(state, clump.body, clump.position, clump.velocity, flight);
    detail::add_flight(state, clump.body, flown, flight.displacement(clump.velocity, flown.acceleration),
                       flight.kicks, sums);
    detail::fly_on(clump, flight.place(clump.position, clump.velocity, flown.acceleration), flight.drifts);
    p.position[b] = clump.position, p.orientation[b] = clump.orientation;
    const auto first = static_cast<std::size_t>(p.first_sphere[b]);
    for (std::size_t m = first; m < first + static_cast<std::size_t>(clump.count); ++m)
        p.centre[m] = clump.position + clump.rotation * p.offset[m];
    p.velocity[b] = flight.velocity(clump.velocity, flown.acceleration);
    p.angular_momentum[b] = clump.angular_momentum;
    p.force[b] = p.mass[b] * flown.acceleration, p.torque[b].setZero();
}

/// Writes a body back into `particles`, its velocity `move.kick` further on; books the works of that kick,
/// but moves nothing.
template <class P>
void publish_body(State<P>& state, Index body, const Move& move, MotionSums& sums) noexcept {
    const auto b = static_cast<std::size_t>(body);
    Particles& p = state.particles;
    const HotArrays& lines = state.store.lines;
    const auto first = static_cast<std::size_t>(p.first_sphere[b]);
    const Index clump_index = state.store.clump_of(body);
    const auto at_rest = [&] {
        if (!state.sleep.asleep(body)) return p.inverse_mass[b] == 0;
        for (auto* column : {&p.velocity, &p.angular_momentum, &p.force, &p.torque}) (*column)[b].setZero();
        return true;
    };
    typename P::OnBody beside{};
    const auto sample = [&](const Vec3& position, const Vec3& velocity, const Vec3& spin) {
        if constexpr (P::looks_ahead)
            beside = state.acting_on(body, position, velocity, spin, move.time, move.ahead_in_fluid);
    };
    if (clump_index >= 0) {
        const MovingClump& clump = state.store.clumps[static_cast<std::size_t>(clump_index)];
        if (state.mode[static_cast<std::size_t>(clump.first_slot)] == IntegrationMode::flying && !at_rest())
            return publish_flying(state, clump, move, sums);
        for (std::size_t m = 0; m < static_cast<std::size_t>(clump.count); ++m)
            p.centre[first + m] = lines.place[static_cast<std::size_t>(clump.first_slot) + m].centre;
        p.position[b] = clump.position, p.orientation[b] = clump.orientation;
        if (at_rest()) return;
        const ClumpLoad load = load_of(clump, lines);
        sample(clump.position, clump.velocity, clump.angular_velocity(clump.angular_momentum));
        take_along(beside, load.force, clump.mass, state.scene.gravity);
        const KickedClump after = kick(clump, load, beside, state.scene.gravity, move.kick);
        p.velocity[b] = after.velocity, p.angular_momentum[b] = after.angular_momentum;
        p.force[b] = load.force + p.mass[b] * state.scene.gravity + force_of(beside);
        p.torque[b] = load.torque;
        if constexpr (turns_bodies<typename P::OnBody>) p.torque[b] += torque_of(beside);
        sums.interaction.value[0] += after.interaction;
        sums.mass_displacement = sums.mass_displacement + detail::quad(Vec3(clump.mass * after.displacement));
        sums.add(beside, after.displacement, after.rotation, move.kick);
        return;
    }
    const auto slot = static_cast<std::size_t>(state.store.slot_of(static_cast<Index>(first)));
    const SpherePlace& place = lines.place[slot];
    const SphereMotion& motion = lines.motion[slot];
    const SphereLoad& load = lines.load[slot];
    p.centre[first] = p.position[b] = place.centre;
    if (at_rest()) return;
    if (state.mode[slot] == IntegrationMode::flying) {
        FreeFlight flight = state.flight;
        flight.kicks += move.kick;
        const detail::FlightLoad flown =
            detail::flight_load(state, body, place.centre, motion.velocity, flight);
        p.centre[first] = p.position[b] = flight.place(place.centre, motion.velocity, flown.acceleration);
        p.velocity[b] = flight.velocity(motion.velocity, flown.acceleration);
        p.angular_momentum[b] = 0.4 * p.mass[b] * place.radius * motion.surface_velocity;
        p.force[b] = p.mass[b] * flown.acceleration, p.torque[b].setZero();
        detail::add_flight(state, body, flown, flight.displacement(motion.velocity, flown.acceleration),
                           flight.kicks, sums);
        return;
    }
    sample(place.centre, motion.velocity, motion.curvature * motion.surface_velocity);
    take_along(beside, load.force, p.mass[b], state.scene.gravity);
    const KickedSphere after = kick(motion, load, beside, detail::quad(state.scene.gravity), move.kick);
    p.velocity[b] = detail::first_three(after.velocity);
    p.angular_momentum[b] = 0.4 * p.mass[b] * place.radius * detail::first_three(after.surface_velocity);
    p.force[b] = load.force + p.mass[b] * state.scene.gravity + force_of(beside);
    p.torque[b] = place.radius * load.torque_over_radius;
    if constexpr (turns_bodies<typename P::OnBody>) p.torque[b] += torque_of(beside);
    sums.interaction = sums.interaction + after.interaction;
    sums.mass_displacement = sums.mass_displacement + after.mass_displacement;
    sums.add(beside, 0.5 * move.kick * (motion.velocity + p.velocity[b]),
             0.5 * move.kick * motion.curvature *
                 (motion.surface_velocity + detail::first_three(after.surface_velocity)),
             move.kick);
}

}  // namespace abrade
