#pragma once
// Free flight: bodies that are in no inner pair take many steps as one.

#include <abrade/sim/motion/motion.hpp>
#include <abrade/sim/state/state.hpp>

namespace abrade {

namespace detail {

/// What the fluid does to a body halfway through its flight, and the acceleration that follows.
struct FlightLoad {
    FluidLoad fluid;
    Vec3 acceleration = Vec3::Zero();  ///< [m/s2]
};

/// Explicit midpoint rule: second order in the length of the flight, and the kicks' own leapfrog where that
/// is a single step. `position` [m] and `velocity` [m/s] are those with which the body took off.
template <class P>
FlightLoad flight_load(const State<P>& state, Index body, const Vec3& position, const Vec3& velocity,
                       const FreeFlight& flight) noexcept {
    FlightLoad found;
    found.acceleration = state.scene.gravity;
    if constexpr (P::has_fluid && !P::fluid_resolves)  // which lets nobody fly
        if (state.feels_fluid(body)) {
            const Real inverse_mass = state.particles.inverse_mass[static_cast<std::size_t>(body)];
            const auto fluid_on = [&](const Vec3& x, const Vec3& v, Real t) {
                FluidLoad load = state.fluid_on(body, x, v, t, 0);
                take_along(load, Vec3::Zero(), 1 / inverse_mass, state.scene.gravity);
                return load;
            };
            const FluidLoad first = fluid_on(position, velocity, flight.start);
            const Vec3 half =
                velocity + 0.5 * flight.kicks * (state.scene.gravity + inverse_mass * force_of(first));
            const Real to_middle = 0.5 * (flight.drifts - flight.last);
            found.fluid = fluid_on(position + to_middle * half, half, flight.start + to_middle);
            found.acceleration += inverse_mass * force_of(found.fluid);
        }
    return found;
}

/// Moves a clump in flight on over `drift` [s], its members left behind; turns of at most a tenth of a
/// radian at a time. Its velocity is taken as it is.
inline void fly_on(MovingClump& clump, const Vec3& to, Real drift) noexcept {
    constexpr Real most = 0.1;  // [rad]
    const Real rotation = drift * clump.angular_velocity(clump.angular_momentum).norm();
    const int parts = static_cast<int>(std::clamp(std::ceil(rotation / most), 1.0, 1e6));
    for (int n = 0; n < parts; ++n) turn_freely(clump, drift / parts);
    clump.position = to;
}

/// Works of a body's flight.
template <class P>
void add_flight(const State<P>& state, Index body, const FlightLoad& load, const Vec3& displacement,
                Real kicks, MotionSums& sums) noexcept {
    sums.mass_displacement = sums.mass_displacement +
                             quad(Vec3(state.particles.mass[static_cast<std::size_t>(body)] * displacement));
    if constexpr (P::has_fluid)
        sums.add(load.fluid, displacement, Vec3::Zero(), kicks);  // torques do not fly
}

}  // namespace detail

/// Sees which slots could fly, once the store is arranged.
template <class P>
void find_flyers(State<P>& state) {
    state.mode_if_alone.resize(static_cast<std::size_t>(state.store.spheres()));
    parallel_for(state.store.spheres(), [&](Index slot) {
        const Index body = state.particles.body[static_cast<std::size_t>(state.store.sphere_of(slot))];
        const bool bonded = P::has_bonds && !state.sites.stand &&
                            state.particles.kind[static_cast<std::size_t>(body)] == Kind::concrete;
        state.mode_if_alone[static_cast<std::size_t>(slot)] =
            state.flight.allowed && !bonded ? IntegrationMode::flying : IntegrationMode::every_step;
    });
}

/// Brings all that flies up to the present, and books what its weight and the fluid did.
template <class P>
void land(State<P>& state) {
    FreeFlight& flight = state.flight;
    if (state.mode.empty()) flight.begin();  // nobody was there
    if (flight.kicks == 0 && flight.drifts == 0) return;
    SphereStore& store = state.store;
    const auto flies = [&](Index slot) {
        return state.mode[static_cast<std::size_t>(slot)] == IntegrationMode::flying &&
               store.lines.motion[static_cast<std::size_t>(slot)].inverse_mass > 0;
    };
    const auto note = [&](Index body, const Vec3& after, const Vec3& acceleration) {
        if constexpr (P::has_fluid)
            state.in_fluid.velocity[static_cast<std::size_t>(body)] = after - flight.last * acceleration;
    };
    MotionSums sums = parallel_sum<MotionSums>(store.spheres(), [&](Index slot) {
        MotionSums one;
        const Index body = state.body_in(slot);
        if (!flies(slot) || store.clump_of(body) >= 0) return one;
        SphereMotion& motion = store.lines.motion[static_cast<std::size_t>(slot)];
        SpherePlace& place = store.lines.place[static_cast<std::size_t>(slot)];
        const detail::FlightLoad load =
            detail::flight_load(state, body, place.centre, motion.velocity, flight);
        detail::add_flight(state, body, load, flight.displacement(motion.velocity, load.acceleration),
                           flight.kicks, one);
        place.centre = flight.place(place.centre, motion.velocity, load.acceleration);
        motion.velocity = flight.velocity(motion.velocity, load.acceleration);
        note(body, motion.velocity, load.acceleration);
        return one;
    });
    sums += parallel_sum<MotionSums>(
        static_cast<Index>(store.clumps.size()),
        [&](Index c) {
            MotionSums one;
            MovingClump& clump = store.clumps[static_cast<std::size_t>(c)];
            if (!flies(clump.first_slot)) return one;
            const detail::FlightLoad load =
                detail::flight_load(state, clump.body, clump.position, clump.velocity, flight);
            detail::add_flight(state, clump.body, load,
                               flight.displacement(clump.velocity, load.acceleration), flight.kicks, one);
            const Vec3 to = flight.place(clump.position, clump.velocity, load.acceleration);
            clump.velocity = flight.velocity(clump.velocity, load.acceleration);
            note(clump.body, clump.velocity, load.acceleration);
            if (!(flight.drifts > 0)) return one;
            // Members' velocities are those of the last step: it is taken as any other.
            if (const Real before = flight.drifts - flight.last; before > 0) {
                detail::fly_on(clump, to - flight.last * clump.velocity, before);
                store.place_members(clump, state.particles, Vec3::Zero(), flight.last);
            }
            drift(clump, flight.last, store, state.particles);
            return one;
        },
        block_of_bodies);
    book(state.accounts, sums, state.scene.gravity);
    flight.sound &= detail::first_three(sums.mass_displacement).allFinite();
    flight.begin();
    store.refresh_images();
}

/// Positions, and velocities as the lines have them.
template <class P>
void publish_places(State<P>& state) {
    land(state);
    const SphereStore& store = state.store;
    if (store.spheres() == 0) return;  // nothing has moved yet
    Particles& particles = state.particles;
    parallel_for(particles.bodies(), [&](Index body) {
        const auto b = static_cast<std::size_t>(body);
        if (particles.first_sphere[b] >= store.spheres()) return;  // it has just come
        particles.position[b] = store.position_of(particles, body);
        particles.velocity[b] = store.velocity_of(particles, body);
        const auto first = static_cast<std::size_t>(particles.first_sphere[b]);
        for (std::size_t s = first; s < first + static_cast<std::size_t>(particles.sphere_count[b]); ++s)
            particles.centre[s] =
                store.lines.place[static_cast<std::size_t>(store.slot_of(static_cast<Index>(s)))].centre;
    });
}

namespace detail {

/// What flyers may come to.
struct FlightBounds {
    Real fastest = 0, hardest = 0;                        ///< [m/s], [m/s2]
    Real margin = std::numeric_limits<Real>::infinity();  ///< to the nearest bound of space [m]
    bool in_fluid = false;                                ///< somebody whose drag changes
    FlightBounds& operator+=(const FlightBounds& o) noexcept {
        in_fluid |= o.in_fluid;
        fastest = std::max(fastest, o.fastest), hardest = std::max(hardest, o.hardest);
        margin = std::min(margin, o.margin);
        return *this;
    }
};

/// How hard the fluid can push a body in a flight no longer than the horizon; nothing where drag would change
/// by more than a tenth in that time, where the body goes into the fluid or out of it, and where the fluid's
/// answer is no number: such a body takes each step.
template <class P>
std::optional<Real> hardest_in_flight(const State<P>& state, Index body, const Vec3& position,
                                      const Vec3& velocity) noexcept {
    Real hardest = state.scene.gravity.norm();
    if constexpr (P::has_fluid && !P::fluid_resolves)
        if (state.feels_fluid(body)) {
            const Real inverse_mass = state.particles.inverse_mass[static_cast<std::size_t>(body)],
                       horizon = state.flight.horizon;
            const FluidLoad here = state.fluid_on(body, position, velocity, state.flight.now, 0),
                            there = state.fluid_on(body, position + horizon * velocity, velocity,
                                                   state.flight.now + horizon, 0);
            const auto wet = [](const FluidLoad& load) { return !load.buoyancy.isZero(0); };
            if (wet(here) != wet(there)) return std::nullopt;
            Real strongest = 0;
            for (const FluidLoad& load : {here, there}) {
                const Real against = (load.fluid_velocity - velocity).norm(),
                           drag = inverse_mass * load.drag.norm();
                // Of quadratic drag, twice the force over the speed against the fluid. Not a number is too
                // much.
                if (!(2 * drag * horizon <= 0.1 * against)) return std::nullopt;
                strongest =
                    std::max(strongest, drag + inverse_mass * (load.buoyancy.norm() + load.inertial.norm()));
            }
            hardest += 2 * strongest;  // drag itself may double where the fluid is faster
        }
    return hardest;
}

}  // namespace detail

/// Lets fly what is in no inner pair; `land` must have been called. No flight is to be longer than
/// `horizon` [s].
template <class P>
void take_off(State<P>& state, Real horizon) {
    const auto at = [](Index i) { return static_cast<std::size_t>(i); };
    SphereStore& store = state.store;
    std::vector<IntegrationMode>& mode = state.mode;
    FreeFlight& flight = state.flight;
    flight.horizon = horizon;
    mode = state.mode_if_alone;
    if (state.sleep.count > 0)
        for (Index slot = 0; slot < store.spheres(); ++slot)
            if (state.sleep.asleep(state.body_in(slot))) mode[at(slot)] = IntegrationMode::asleep;
    // All spheres of a clump have the integration mode of its first.
    const auto set_mode = [&](Index body, IntegrationMode to) {
        const Index first = state.first_slot_of(body);
        for (Index n = 0; n < state.particles.sphere_count[at(body)]; ++n) mode[at(first + n)] = to;
    };
    flight.held = 0;
    const auto ground = [&](Index slot) {
        if (slot < 0 || slot >= store.phantom()) return;
        const Index owner = store.owner_of(slot);
        if (mode[at(owner)] != IntegrationMode::flying) return;
        const Index body = state.body_in(owner);
        set_mode(body, IntegrationMode::every_step);
        if (store.lines.motion[at(owner)].inverse_mass > 0)
            flight.held += state.particles.sphere_count[at(body)];
    };
    state.contacts.each_inner_pair([&](const SlotPair& pair) {
        ground(pair.first), ground(pair.second);
        if (const Index other = state.awake_beside_sleeper(pair); other >= 0)
            set_mode(other, IntegrationMode::beside_sleeper);
    });
    if constexpr (P::has_bonds)
        state.network.each_bond(
            [&](const auto& bond) { ground(bond.slots.first), ground(bond.slots.second); });
    const Box space = state.scene.open_bounds();
    const bool bounded = space.low.array().isFinite().any() || space.high.array().isFinite().any();
    const auto all = parallel_sum<detail::FlightBounds>(
        state.particles.bodies(),
        [&](Index body) {
            detail::FlightBounds one;
            const Index first = state.first_slot_of(body);
            const SphereMotion& motion = store.lines.motion[at(first)];
            if (mode[at(first)] != IntegrationMode::flying || motion.inverse_mass == 0) return one;
            const Vec3 position = store.position_of(state.particles, body),
                       velocity = store.velocity_of(state.particles, body);
            const std::optional<Real> hardest = detail::hardest_in_flight(state, body, position, velocity);
            if (!hardest) {
                set_mode(body, IntegrationMode::every_step);
                return one;
            }
            one.hardest = *hardest, one.fastest = velocity.norm(), one.in_fluid = state.feels_fluid(body);
            if (const Index c = store.clump_of(body); c >= 0) {
                const MovingClump& clump = store.clumps[at(c)];
                const Real spin = clump.angular_velocity(clump.angular_momentum).norm();
                Real reach = 0;
                for (Index n = 0; n < clump.count; ++n)
                    reach = std::max(
                        reach, state.particles.offset[at(state.particles.first_sphere[at(body)] + n)].norm());
                one.fastest += 1.5 * spin * reach;  // it may turn faster about another axis
            }
            if (bounded)
                for (Index n = first; n < first + state.particles.sphere_count[at(body)]; ++n) {
                    const Vec3& x = store.lines.place[at(n)].centre;
                    one.margin =
                        std::min({one.margin, (x - space.low).minCoeff(), (space.high - x).minCoeff()});
                }
            return one;
        },
        block_of_bodies);
    if (!all.in_fluid) flight.horizon = std::numeric_limits<Real>::infinity();
    flight.margin = all.margin, flight.fastest = all.fastest, flight.hardest = all.hardest;
}

}  // namespace abrade
