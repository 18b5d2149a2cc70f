#pragma once
// Who falls asleep, and who wakes.

#include <abrade/sim/motion/advance.hpp>

namespace abrade {

namespace detail {

/// Calls `visit(slot)` for the spheres of a body.
template <class P>
void each_slot(const State<P>& state, Index body, auto&& visit) {
    const auto first = static_cast<std::size_t>(state.first_slot_of(body));
    const auto count = static_cast<std::size_t>(state.particles.sphere_count[static_cast<std::size_t>(body)]);
    for (std::size_t slot = first; slot < first + count; ++slot) visit(slot);
}

/// That of its fastest sphere [m2/s2].
template <class P>
Real speed_squared_of(const State<P>& state, Index body) {
    Real fastest2 = 0;
    each_slot(state, body, [&](std::size_t slot) {
        fastest2 = std::max(fastest2, speed_squared(state.store.lines.motion[slot]));
    });
    return fastest2;
}

/// Springs of contacts, and the fluid, on bodies; the strongest force among them and the weight [N].
struct Support {
    Vec3 sum = Vec3::Zero();
    Real strongest = 0;
    bool touches = false;
};

/// Of the bodies that are `wanted` [body], as if they stood still.
template <class P>
std::vector<Support> supports(const State<P>& state, const std::vector<char>& wanted, Real time) {
    const auto at = [](Index i) { return static_cast<std::size_t>(i); };
    std::vector<Support> all(wanted.size());
    const auto is_wanted = [&](Index slot) { return slot >= 0 && wanted[at(state.body_in(slot))]; };
    const auto add = [&](Index slot, const Vec3& force) {
        if (!is_wanted(slot)) return;
        Support& own = all[at(state.body_in(slot))];
        own.sum += force, own.strongest = std::max(own.strongest, force.norm()), own.touches = true;
    };
    state.contacts.each_touching(
        [&](const auto& touching) {
            auto contact = contact_between(state.store.lines, state.scene.walls, touching.pair, 0);
            contact.velocity.setZero(), contact.spin.setZero();
            const Vec3 force = law_between(state.policies.contact, touching.materials)
                                   .respond(contact, touching.memory)
                                   .load.force;
            add(touching.pair.first, force), add(touching.pair.second, -force);
        },
        [&](const SlotPair& pair) { return is_wanted(pair.first) || is_wanted(pair.second); });
    for (Index b = 0; b < static_cast<Index>(wanted.size()); ++b) {
        if (!wanted[at(b)]) continue;
        Support& own = all[at(b)];
        own.strongest = std::max(own.strongest, state.particles.mass[at(b)] * state.scene.gravity.norm());
        if constexpr (P::has_fluid)
            if (state.feels_fluid(b)) {
                const typename P::OnBody fluid =
                    state.fluid_on(b, state.store.position_of(state.particles, b), Vec3::Zero(), time, 0);
                own.sum += force_of(fluid);
            }
    }
    return all;
}

/// Bodies that may sleep at all: stones and grains, free and in no bond.
template <class P>
std::vector<char> may_sleep(const State<P>& state) {
    const Particles& p = state.particles;
    std::vector<char> may(p.kind.size());
    for (std::size_t b = 0; b < may.size(); ++b)
        may[b] = p.inverse_mass[b] > 0 && (p.kind[b] == Kind::stone || p.kind[b] == Kind::grain);
    if constexpr (P::has_bonds)
        state.network.each_bond([&](const auto& bond) {
            for (const Index body : {bond.bodies.first, bond.bodies.second})
                may[static_cast<std::size_t>(body)] = false;
        });
    return may;
}

template <class P>
void put_to_sleep(State<P>& state, Index body) {
    each_slot(state, body, [&](std::size_t slot) {
        state.store.lines.motion[slot].velocity.setZero(),
            state.store.lines.motion[slot].surface_velocity.setZero();
    });
    if (const Index c = state.store.clump_of(body); c >= 0) {
        MovingClump& clump = state.store.clumps[static_cast<std::size_t>(c)];
        clump.velocity.setZero(), clump.angular_momentum.setZero();
    }
    if constexpr (P::looks_ahead) state.in_fluid.velocity[static_cast<std::size_t>(body)].setZero();
    ++state.sleep.count, state.sleep.changed = true;
}

}  // namespace detail

/// Marks the slots of those who rest, where anybody is asleep.
template <class P>
void mark_resting(State<P>& state) {
    state.sleep.rests.clear();
    if (state.sleep.count == 0) return;
    for (Index slot = 0; slot < state.store.phantom(); ++slot) {
        const Index body = state.body_in(slot);
        state.sleep.rests.push_back(state.sleep.asleep(body) ||
                                    state.particles.inverse_mass[static_cast<std::size_t>(body)] == 0);
    }
}

/// Energy of the contacts at rest [J].
template <class P>
Real stored_at_rest(const State<P>& state) {
    Real stored = 0;
    const auto rests = [&](Index slot) {
        return slot < 0 || state.sleep.rests[static_cast<std::size_t>(slot)];
    };
    if (state.sleep.rests.empty()) return 0;
    state.contacts.each_touching(
        [&](const auto& touching) {
            stored += law_between(state.policies.contact, touching.materials)
                          .respond(contact_between(state.store.lines, state.scene.walls, touching.pair, 0),
                                   touching.memory)
                          .load.stored;
        },
        [&](const SlotPair& pair) { return rests(pair.first) && rests(pair.second); });
    return stored;
}

/// Puts to sleep who has been slow for long and touches something, and sees who has lost support, to be woken
/// before the next step. Loads must be those of now, which `half` of a kick is missing to; `interval` [s] has
/// passed since the last call. Books what that kick does to those who fall asleep in `sums`. Returns whether
/// anybody fell asleep.
template <class P>
bool fall_asleep(State<P>& state, const Move& half, Real interval, MotionSums& sums) {
    const auto at = [](Index i) { return static_cast<std::size_t>(i); };
    Sleep& sleep = state.sleep;
    const Index bodies = state.particles.bodies();
    sleep.bodies.resize(at(bodies));
    std::vector<char> wanted(at(bodies), 0), beside(at(bodies), 0);
    if (sleep.count > 0)
        state.contacts.each_inner_pair([&](const SlotPair& pair) {
            if (state.awake_beside_sleeper(pair) < 0) return;
            for (const Index slot : {pair.first, pair.second}) beside[at(state.body_in(slot))] = 1;
        });
    std::vector<char> may;
    bool any = false;
    for (Index b = 0; b < bodies; ++b) {
        Sleep::Body& own = sleep.bodies[at(b)];
        if (own.asleep) {
            const bool was_watched = std::exchange(own.watched, beside[at(b)] != 0);
            wanted[at(b)] = own.watched || was_watched || sleep.watch_all || P::has_fluid;
        } else {
            const Real speed2 = detail::speed_squared_of(state, b);
            const bool slow =
                state.mode[at(state.first_slot_of(b))] != IntegrationMode::flying && !sleep.is_fast(speed2);
            // What gets faster is about to fall, slide or roll, however slow it is yet.
            const bool slower =
                own.slow_for == 0 || speed2 <= std::max(own.slowest2, square(Sleep::still * sleep.speed));
            own.slowest2 = own.slow_for == 0 ? speed2 : std::min(own.slowest2, speed2);
            own.slow_for = slow ? own.slow_for + interval : 0;
            const Real diameter = std::cbrt(6 / pi * state.particles.volume[at(b)]);
            const Real long_enough = std::max(sleep.after, sleep.toppling * std::sqrt(diameter));
            if (!slower || own.slow_for < std::max(long_enough, 3.5 * interval)) continue;
            if (may.empty()) may = detail::may_sleep(state);
            wanted[at(b)] = may[at(b)];
        }
        any |= wanted[at(b)] != 0;
    }
    sleep.watch_all = false;
    if (!any) return false;

    const std::vector<detail::Support> supports = detail::supports(state, wanted, half.time);
    bool fell = false;
    for (Index b = 0; b < bodies; ++b) {
        if (!wanted[at(b)]) continue;
        Sleep::Body& own = sleep.bodies[at(b)];
        const detail::Support& now = supports[at(b)];
        if (own.asleep) {
            own.rouse = (now.sum - own.support).norm() > Sleep::allowed_change * own.strongest;
            sleep.stirred |= own.rouse;
        } else if (now.touches) {
            publish_body(state, b, half, sums);
            state.accounts.sum.lost_asleep += state.particles.kinetic_energy(b);
            own = {.asleep = true, .watched = true, .support = now.sum, .strongest = now.strongest};
            detail::put_to_sleep(state, b);
            fell = true;
        }
    }
    if (fell) state.store.refresh_images();
    return fell;
}

/// Wakes those who must, and whom they touch: those who lost support, and those whom a fast body may meet
/// before the inner list is picked again. Forces must not have been evaluated yet. Returns whether anybody
/// woke.
template <class P>
bool wake_stirred(State<P>& state) {
    const auto at = [](Index i) { return static_cast<std::size_t>(i); };
    Sleep& sleep = state.sleep;
    sleep.stirred = false;
    if (sleep.count == 0) return false;
    std::vector<char> wakes(sleep.bodies.size(), 0);
    bool any = false;
    for (std::size_t b = 0; b < wakes.size(); ++b)
        any |= wakes[b] = sleep.bodies[b].asleep && sleep.bodies[b].rouse;
    state.contacts.each_inner_pair([&](const SlotPair& pair) {
        const Index awake = state.awake_beside_sleeper(pair);
        if (awake < 0 || !sleep.is_fast(detail::speed_squared_of(state, awake))) return;
        const Index first = state.body_in(pair.first);
        wakes[at(first == awake ? state.body_in(pair.second) : first)] = 1;
        any = true;
    });
    if (!any) return false;
    std::vector<char> touched(wakes.size(), 0);
    state.contacts.each_touching([](const auto&) {},
                                 [&](const SlotPair& pair) {
                                     if (pair.second < 0) return false;
                                     const Index a = state.body_in(pair.first),
                                                 b = state.body_in(pair.second);
                                     if (sleep.asleep(a) && sleep.asleep(b)) {
                                         touched[at(a)] |= wakes[at(b)];
                                         touched[at(b)] |= wakes[at(a)];
                                     }
                                     return false;
                                 });
    for (Index b = 0; b < static_cast<Index>(wakes.size()); ++b) {
        if (!wakes[at(b)] && !touched[at(b)]) continue;
        sleep.bodies[at(b)] = {};
        --sleep.count;
        // What acted on it meanwhile has piled up unread.
        detail::each_slot(state, b, [&](std::size_t slot) {
            state.store.lines.load[slot].force.setZero(),
                state.store.lines.load[slot].torque_over_radius.setZero();
        });
    }
    sleep.changed = true;
    return true;
}

/// Bodies leave; others may have lost support.
template <class P>
void leave_sleepers(State<P>& state, const std::vector<char>& gone) {
    Sleep& sleep = state.sleep;
    if (sleep.bodies.empty()) return;
    sleep.bodies.resize(gone.size());
    std::size_t to = 0;
    for (std::size_t from = 0; from < gone.size(); ++from) {
        if (gone[from])
            sleep.count -= sleep.bodies[from].asleep;
        else
            sleep.bodies[to++] = sleep.bodies[from];
    }
    sleep.bodies.resize(to);
    sleep.watch_all = sleep.changed = true;
}

template <class P>
void rouse_all(State<P>& state) noexcept {
    for (Sleep::Body& body : state.sleep.bodies) body.rouse = body.asleep;
    state.sleep.stirred = state.sleep.count > 0;
}

}  // namespace abrade
