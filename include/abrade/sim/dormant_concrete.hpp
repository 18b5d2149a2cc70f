#pragma once
// Which concrete goes to sleep, which bodies that takes out, and which it brings back.

#include <abrade/sim/advance.hpp>

namespace abrade {

namespace detail {

inline std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }

/// Marks on sites, taken off again when done: no look at all of them.
class SiteMarks {
public:
    explicit SiteMarks(std::vector<char>& marks) : marks_(marks) {}
    ~SiteMarks() {
        for (const Index site : all_) marks_[at(site)] = 0;
    }
    SiteMarks(const SiteMarks&) = delete;
    SiteMarks& operator=(const SiteMarks&) = delete;

    bool has(Index site) const noexcept { return marks_[at(site)] != 0; }
    void add(Index site) {
        if (!std::exchange(marks_[at(site)], 1)) all_.push_back(site);
    }
    const std::vector<Index>& all() const noexcept { return all_; }
    void sort() { std::sort(all_.begin(), all_.end()); }

private:
    std::vector<char>& marks_;
    std::vector<Index> all_;
};

/// Whether a body can set concrete in motion: anything that moves and is no standing concrete.
template <class P>
bool may_load(const State<P>& state, Index body) {
    return state.particles.inverse_mass[at(body)] > 0 && state.particles.kind[at(body)] != Kind::concrete &&
           !state.sleep.asleep(body);
}

/// Whether a body may touch concrete that stands still and be held by it: one that sleeps on it, or standing
/// concrete that has lost bonds.
template <class P>
bool may_lean(const State<P>& state, Index body) {
    return state.particles.inverse_mass[at(body)] > 0 &&
           (state.sleep.asleep(body) || !state.keeps_its_place(body));
}

/// Marks the sites whose spheres are nearer than `skin` [m] to one of a body; `particles` must be as of now.
template <class P>
void mark_near(const State<P>& state, Index body, Real skin, SiteMarks& marks) {
    const Particles& p = state.particles;
    const Dormancy& dormancy = state.dormancy;
    const Lattice& lattice = state.concrete.lattice();
    const Periodic space = state.scene.periodic();
    for (Index s = p.first_sphere[at(body)]; s < p.first_sphere[at(body)] + p.sphere_count[at(body)]; ++s) {
        const Real reach = p.radius[at(s)] + lattice.radius + skin;
        const auto look = [&](const Vec3& x) {
            dormancy.sites.each_about(x, reach + dormancy.furthest, [&](Index site) {
                if (state.concrete.gone(site) || marks.has(site)) return;
                const Index own = dormancy.body_of[at(site)];
                const Vec3& centre = own < 0 ? dormancy.place[at(site)] : p.position[at(own)];
                if ((centre - x).squaredNorm() < square(reach)) marks.add(site);
            });
        };
        look(p.centre[at(s)]);
        each_shift(
            space.period, [](int, int) { return true; },
            [&](const ImageShift& shift) { look(p.centre[at(s)] + shift.times(space.period)); });
    }
}

/// The same for all bodies that are `wanted(body)`.
template <class P, class Wanted>
void mark_near_all(const State<P>& state, Real skin, SiteMarks& marks, Wanted&& wanted) {
    for (Index b = 0; b < state.particles.bodies(); ++b)
        if (wanted(b)) mark_near(state, b, skin, marks);
}

/// Marks what can be reached from the marked sites over `radius` bonds.
inline void spread(const Ties& ties, Index radius, SiteMarks& marks) {
    std::size_t from = 0;
    for (Index n = 0; n < radius; ++n) {
        const std::size_t to = marks.all().size();
        for (; from < to; ++from)
            for (const Ties::End& end : ties.of(marks.all()[from])) marks.add(end.other);
    }
}

/// Of a standing sphere that moves, and is as `particles` has it: from now on it does not. What it loses of
/// its kinetic energy is booked.
template <class P>
void hold_still(State<P>& state, Index body) {
    Particles& p = state.particles;
    const Index site = p.site[at(body)];
    const Real mass = p.mass[at(body)];
    const Vec3 rim = state.concrete.lattice().radius * p.angular_velocity(body);
    state.accounts.lost_asleep +=
        mass * (0.5 * p.velocity[at(body)].squaredNorm() + 0.2 * state.dormancy.gears.add(site, rim));
    state.dormancy.potential += state.potential_energy(body, p.position[at(body)]);
    p.inverse_mass[at(body)] = 0, p.inverse_inertia[at(body)].setZero();
    p.velocity[at(body)].setZero(), p.angular_momentum[at(body)].setZero();
    state.dormancy.quiet[at(site)] = 0;
    state.dormancy.place[at(site)] = p.position[at(body)];
    Vec3 way = p.position[at(body)] - state.concrete.lattice().sites[at(site)].centre;
    for (int a = 0; a < 3; ++a)  // it may have been taken back over a periodic edge
        if (const Real period = state.scene.periodic().period[a]; period > 0)
            way[a] -= period * std::round(way[a] / period);
    state.dormancy.furthest = std::max(state.dormancy.furthest, way.norm());
    state.sleep.changed = true;  // what rests on it
    --state.dormancy.awake;
}

/// The body of a site, made where there is none. It stands still.
template <class P>
Index standing_body(State<P>& state, Index site) {
    Dormancy& dormancy = state.dormancy;
    Index& body = dormancy.body_of[at(site)];
    if (body >= 0) return body;
    Particles& p = state.particles;
    const Index next_id = p.next_id;
    body = p.add(dormancy.sphere, state.scene.concrete->density,
                 {.position = dormancy.place[at(site)], .material = state.scene.concrete->material},
                 Kind::fixed);
    p.site.back() = site, p.id.back() = site;  // as when it was built: concrete came first
    p.next_id = next_id;
    if (dormancy.may_move(site)) p.kind.back() = Kind::concrete;
    return body;
}

/// Sets a standing sphere free to move, and wakes its bonds.
template <class P>
void wake_site(State<P>& state, Index site) {
    Dormancy& dormancy = state.dormancy;
    const Index body = standing_body(state, site);
    Particles& p = state.particles;
    if (p.inverse_mass[at(body)] > 0 || !dormancy.may_move(site)) return;
    p.inverse_mass[at(body)] = dormancy.inverse_mass;
    p.inverse_inertia[at(body)] = dormancy.inverse_inertia;
    p.angular_momentum[at(body)] =
        0.4 * p.mass[at(body)] * state.concrete.lattice().radius * dormancy.gears.rim(site);
    dormancy.gears.remove(site);
    dormancy.potential -= state.potential_energy(body, p.position[at(body)]);
    state.sleep.changed = true;  // what rests on it
    ++dormancy.awake;
    if constexpr (P::has_bonds)
        for (const Ties::End& end : state.network.ties().of(site)) {
            const auto& bond = state.network.bond(end.tie);
            if (!bond.rests || bond.dropped) continue;
            const auto sphere = [&](Index member) {
                return p.first_sphere[at(standing_body(state, member))];
            };
            const Index first = sphere(bond.members.first), second = sphere(bond.members.second);
            state.network.wake(end.tie, {first, second}, p);
        }
}

}  // namespace detail

/// The lowest z at which a sphere of radius `reach` [m] over x touches no sphere that is dormant.
template <class P>
Real height_above_dormant(const State<P>& state, const Vec3& x, Real reach) {
    const Dormancy& dormancy = state.dormancy;
    const Real both = state.concrete.lattice().radius + reach;
    Real lowest = -std::numeric_limits<Real>::infinity();
    if (!dormancy.begun) return lowest;
    const Vec3 column(both + dormancy.furthest, both + dormancy.furthest,
                      std::numeric_limits<Real>::infinity());
    dormancy.sites.each_about(x, column, [&](Index site) {
        if (dormancy.body_of[detail::at(site)] >= 0 || state.concrete.gone(site)) return;
        const Vec3& centre = dormancy.place[detail::at(site)];
        const Real room2 = square(both) - (centre - x).template head<2>().squaredNorm();
        if (room2 > 0) lowest = std::max(lowest, centre.z() + std::sqrt(room2));
    });
    return lowest;
}

/// Puts all standing concrete to sleep, before anything has moved.
template <class P>
void begin_dormancy(State<P>& state) {
    Particles& p = state.particles;
    Dormancy& dormancy = state.dormancy;
    std::vector<char> gone(p.kind.size(), 0);
    for (Index b = 0; b < p.bodies(); ++b) {
        const Index site = p.site[detail::at(b)];
        if (site < 0 || state.concrete.gone(site)) continue;
        if (p.inverse_mass[detail::at(b)] > 0) detail::hold_still(state, b);
        gone[detail::at(b)] = 1, dormancy.body_of[detail::at(site)] = -1;
    }
    if constexpr (P::has_bonds)
        state.network.let_rest([&](Index body) { return p.inverse_mass[detail::at(body)] > 0; });
    const std::vector<Index> moved = p.remove(gone);
    if constexpr (P::has_bonds) state.network.prune(p, moved, p.centre);
    state.note_sites();
}

/// Sees which spheres move no more and hold no load that changes, and puts them to sleep; loads must be those
/// of now, which `half` of a kick is missing to. Books what that kick does to them in `sums`.
template <class P>
void quieten(State<P>& state, const Move& half, Real skin, MotionSums& sums) {
    using detail::at;
    Particles& p = state.particles;
    Dormancy& dormancy = state.dormancy;
    const auto moves = [&](Index body) { return body >= 0 && p.inverse_mass[at(body)] > 0; };
    if constexpr (!P::has_bonds) dormancy.due = true;  // nothing falls asleep, yet much is passed by
    std::vector<Index> candidates;
    for (Index b = 0; b < p.bodies(); ++b) {
        if (p.kind[at(b)] != Kind::concrete || !moves(b)) continue;
        const auto slot = at(state.first_slot_of(b));
        const SphereLoad& load = state.store.lines.load[slot];
        const Vec3 force = load.force + p.mass[at(b)] * state.scene.gravity;
        // Turning alone is no load: layers of a cubic lattice turn like gears, and nothing stops them.
        const bool quiet =
            state.store.lines.motion[slot].velocity.squaredNorm() <= square(dormancy.quiet_speed) &&
            force.norm() <= dormancy.wake_force && load.lever.norm() <= dormancy.wake_force;
        std::uint8_t& looks = dormancy.quiet[at(p.site[at(b)])];
        looks = quiet ? static_cast<std::uint8_t>(std::min(looks + 1, 255)) : std::uint8_t{0};
        if (looks >= Dormancy::quiet_looks) candidates.push_back(b);
    }
    if (candidates.empty()) return;
    detail::SiteMarks near(dormancy.marks);
    state.publish_places();
    detail::mark_near_all(state, skin, near, [&](Index b) { return detail::may_load(state, b); });
    if constexpr (P::has_bonds) detail::spread(state.network.ties(), dormancy.wake_radius, near);
    std::vector<Index> sleepers;
    for (const Index b : candidates) {
        const Index site = p.site[at(b)];
        bool sleeps = !near.has(site);
        if constexpr (P::has_bonds)
            for (const Ties::End& end : state.network.ties().of(site))
                sleeps =
                    sleeps && (!moves(dormancy.body_of[at(end.other)]) || dormancy.quiet[at(end.other)] > 0);
        if (sleeps) sleepers.push_back(b);
    }
    for (const Index b : sleepers) {
        publish_body(state, b, half, sums);
        detail::hold_still(state, b);
    }
    for (const Index b : sleepers) {
        SphereMotion& motion = state.store.lines.motion[at(state.first_slot_of(b))];
        motion.velocity.setZero(), motion.inverse_mass = 0;
        motion.rim = dormancy.gears.rim(p.site[at(b)]);
    }
    if (sleepers.empty()) return;
    state.store.refresh_images();
    dormancy.due = true;
}

/// Marks in `gone` [body] the spheres that stand still and that nothing needs; lets bonds between them rest.
template <class P>
void retire(State<P>& state, Real skin, std::vector<char>& gone) {
    using detail::at;
    const Particles& p = state.particles;
    Dormancy& dormancy = state.dormancy;
    detail::SiteMarks needed(dormancy.marks);
    detail::mark_near_all(state, skin, needed,
                          [&](Index b) { return detail::may_load(state, b) || detail::may_lean(state, b); });
    if constexpr (P::has_bonds) {
        state.network.let_rest([&](Index body) { return p.inverse_mass[at(body)] > 0; });
        state.network.each_bond(
            [&](const auto& bond) { needed.add(bond.members.first), needed.add(bond.members.second); });
    }
    // Damaged concrete that touches its like would forget the contact.
    const auto stands = [&](Index slot) {
        const auto body = slot < 0 ? std::size_t{0} : at(state.body_in(slot));
        return slot >= 0 && p.site[body] >= 0 && p.inverse_mass[body] == 0;
    };
    state.contacts.each_touching(
        [&](const auto& touching) {
            needed.add(p.site[at(state.body_in(touching.pair.first))]);
            needed.add(p.site[at(state.body_in(touching.pair.second))]);
        },
        [&](const SlotPair& pair) { return stands(pair.first) && stands(pair.second); });
    for (Index b = 0; b < p.bodies(); ++b) {
        const Index site = p.site[at(b)];
        if (site < 0 || p.inverse_mass[at(b)] > 0 || needed.has(site)) continue;
        gone[at(b)] = 1;
    }
}

namespace detail {

/// Wakes what is near a body that may load it, and what stirred anchors call for.
template <class P>
void wake_called(State<P>& state, Real skin) {
    const Dormancy& dormancy = state.dormancy;
    SiteMarks called(state.dormancy.marks);
    if (dormancy.stirred)
        for (const Dormancy::Anchor& anchor : dormancy.anchors)
            if (anchor.stirred(0.25 * dormancy.wake_force)) called.add(anchor.site);
    if constexpr (P::has_bonds) spread(state.network.ties(), dormancy.ahead, called);
    mark_near_all(state, skin, called, [&](Index b) { return may_load(state, b); });
    if constexpr (P::has_bonds) spread(state.network.ties(), dormancy.wake_radius, called);
    called.sort();
    for (const Index site : called.all())
        if (!state.concrete.gone(site)) wake_site(state, site);
}

/// Wakes all there is: concrete no longer sleeps.
template <class P>
void wake_all(State<P>& state) {
    for (Index site = 0; site < state.concrete.sites(); ++site)
        if (!state.concrete.gone(site)) wake_site(state, site);
    state.dormancy.anchors.clear(), state.dormancy.anchor_at.clear(), state.dormancy.gears.unmesh();
    state.dormancy.begun = false;
}

/// Sets free what has come loose while it stood still.
template <class P>
void let_go(State<P>& state) {
    Dormancy& dormancy = state.dormancy;
    for (const Index site : dormancy.loosened) {
        wake_site(state, site);
        state.particles.kind[at(dormancy.body_of[at(site)])] = Kind::grain;
        --dormancy.awake;  // of what stands
    }
    dormancy.loosened.clear();
}

/// Makes bodies of what others may lean on.
template <class P>
void bring_back_support(State<P>& state, Real skin) {
    SiteMarks support(state.dormancy.marks);
    mark_near_all(state, skin, support, [&](Index b) { return may_lean(state, b); });
    support.sort();
    for (const Index site : support.all()) standing_body(state, site);
}

}  // namespace detail

/// Brings back what is wanted, awake or as support, within `skin` [m] of other bodies; `particles` must be as
/// of now.
template <class P>
void wake_concrete(State<P>& state, Real skin) {
    if (state.dormancy.on())
        detail::wake_called(state, skin);
    else
        detail::wake_all(state);
    detail::let_go(state);
    detail::bring_back_support(state, skin);
    state.dormancy.due = state.dormancy.stirred = false;
    state.sleep.changed = true;  // contacts between those that stand still rest
}

/// Finds the slots of the spheres that stand still among those that move; the store and the network must have
/// been arranged. What has acted on them so far is kept.
template <class P>
void find_anchors(State<P>& state) {
    using detail::at;
    Dormancy& dormancy = state.dormancy;
    const Particles& p = state.particles;
    const std::vector<Dormancy::Anchor> before = std::exchange(dormancy.anchors, {});
    dormancy.anchor_at.assign(at(state.store.spheres()), -1);
    if constexpr (P::has_bonds) {
        const auto stands = [&](Index body) {
            return p.kind[at(body)] == Kind::concrete && p.inverse_mass[at(body)] == 0;
        };
        std::vector<std::pair<Index, Index>>
            ends;  // site, number of the bond; -1: there may be contacts alone
        for (Index b = 0; b < p.bodies(); ++b)
            if (stands(b)) ends.emplace_back(p.site[at(b)], -1);
        for (const Index number : state.network.active()) {
            const auto& bond = state.network.bond(number);
            if (stands(bond.bodies.first)) ends.emplace_back(bond.members.first, number);
            if (stands(bond.bodies.second)) ends.emplace_back(bond.members.second, number);
        }
        std::sort(ends.begin(), ends.end());
        for (const auto& [site, number] : ends) {
            if (dormancy.anchors.empty() || dormancy.anchors.back().site != site)
                dormancy.anchors.push_back({.site = site});
            if (number >= 0) ++dormancy.anchors.back().bonds, dormancy.anchors.back().numbers += number;
        }
    }
    dormancy.gears.unmesh();
    auto old = before.begin();
    for (std::size_t n = 0; n < dormancy.anchors.size(); ++n) {
        Dormancy::Anchor& anchor = dormancy.anchors[n];
        while (old != before.end() && old->site < anchor.site) ++old;
        if (old != before.end() && old->site == anchor.site) {
            const bool same = old->bonds == anchor.bonds && old->numbers == anchor.numbers;
            anchor.force = old->force, anchor.lever = old->lever;
            anchor.change = old->change, anchor.turning = old->turning;
            anchor.fresh = old->fresh || !same;
        }
        const Index sphere = p.first_sphere[at(dormancy.body_of[at(anchor.site)])];
        const Index slot = state.store.slot_of(sphere);
        dormancy.anchor_at[at(slot)] = static_cast<Index>(n);
        dormancy.gears.mesh(anchor.site, slot, static_cast<Index>(n));
    }
}

}  // namespace abrade
