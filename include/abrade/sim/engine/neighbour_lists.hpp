#pragma once
// The Verlet list and the inner list: how long they last, and what happens when they are renewed. Then bodies
// also come (feed, concrete that came loose) and go (outlet, worn out concrete, what a user takes out).

#include <abrade/sim/motion/fragments.hpp>
#include <abrade/sim/motion/wrap.hpp>
#include <abrade/sim/rest/sleep.hpp>
#include <abrade/sim/rest/standing_concrete.hpp>
#include <abrade/sim/scene/period.hpp>

#include <chrono>
#include <numeric>

namespace abrade {

/// The Verlet list holds pairs within a skin and lasts until bodies may have crossed it. The inner list,
/// pairs of it within a thinner, inner skin, is picked anew every few dozen steps, and only inner pairs are
/// looked at in a step.
template <class P>
class NeighbourLists {
public:
    /// The time after which supply and departures are seen to, although nothing outran the lists [steps].
    static constexpr Index longest_life = 400;

    void set_skin(Real skin) noexcept { skin_ = skin; }

    /// Tells of a step done: no body moved further than `way` [m] in it, and no wall where bodies are than
    /// `way_of_walls`.
    void note_step(Real way, Real way_of_walls) noexcept {
        moved_ += way + way_of_walls, walls_moved_ += way_of_walls, walls_way_ = way_of_walls, ++age_;
    }

    /// Makes the lists good for the places of now. Steps are of dt.
    void freshen(State<P>& state, Real t, Real dt) {
        const bool traffic =
            state.feed || state.scene.outlet || state.sites.recede() || !state.sites.worn_out.empty();
        const bool due = state.feed && age_ >= shortest_life && state.feed->due(t);
        if ((traffic && age_ >= longest_life) || due || state.events.lists_due)
            renew(state, t, dt);
        else if ((2 * moved_ > inner_skin_ || state.flight.drifts > state.flight.horizon) &&
                 !refine(state, dt))
            renew(state, t, dt);
        else if (state.sleep.stirred && wake_stirred(state))
            repack(state);
    }

    /// Renews what changes seldom, stage by stage: who is near concrete that stands, who leaves, who arrives;
    /// then all are sorted, paired and looked at for who is active.
    void renew(State<P>& state, Real t, Real dt) {
        const auto start = std::chrono::steady_clock::now();
        land(state);
        if (!state.flight.sound) return;  // the step that follows tells
        wrap(state);
        if (state.feed || has_broken_bonds(state) || state.sites.stand) publish_places(state);
        choose_skin(state, dt);
        detail::SiteMarks near(state.sites.marks);
        look_at_sites(state, near);
        const Departure departure = departing(state, dt, near);
        take_out(state, departure);
        bring_in(state, departure, near, t, dt);
        sort(state, departure);
        find_flyers(state);
        find_pairs(state);
        begin_life(state);
        refine(state, dt);
        seconds_ += std::chrono::duration<Real>(std::chrono::steady_clock::now() - start).count();
    }
    /// Sorts contacts by who rests, as far as lists are good.
    void repack(State<P>& state) {
        land(state);
        mark_resting(state);
        state.contacts.refine(state.store.lines, state.scene.walls, inner_skin_ + film(state),
                              state.sleep.rests);
        take_off(state, 2 * inner_life_ * dt_);
    }
    Real skin() const noexcept { return list_skin_; }   ///< of the Verlet list [m]
    Real seconds() const noexcept { return seconds_; }  ///< that renewals took, refining apart
    /// Whether bodies are too fast for any skin that the period of space has room for.
    bool outrun() const noexcept { return outrun_; }

    static void fields(auto&& field) {
        field("skin", "m", &NeighbourLists::skin_), field("list_skin", "m", &NeighbourLists::list_skin_),
            field("inner_skin", "m", &NeighbourLists::inner_skin_),
            field("moved", "m", &NeighbourLists::moved_), field("seconds", "s", &NeighbourLists::seconds_),
            field("inner_life", &NeighbourLists::inner_life_), field("outrun", &NeighbourLists::outrun_),
            field("dt", "s", &NeighbourLists::dt_), field("age", &NeighbourLists::age_),
            field.bytes("near_sites", &NeighbourLists::near_sites_),
            field("built_at", "m", &NeighbourLists::built_at_), field("passive", &NeighbourLists::passive_),
            field("walls_moved", "m", &NeighbourLists::walls_moved_),
            field("walls_way", "m", &NeighbourLists::walls_way_);
    }

private:
    /// Steps that lists last at least.
    static constexpr Real shortest_life = 8;

    struct Departure {
        std::vector<char> gone;    ///< [body]
        std::vector<Index> moved;  ///< [sphere] where each will be
        bool any = false;
        std::vector<Fragment> fragments;  ///< what comes instead of some of those gone
    };

    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }

    /// Squares of the longest way since the list was made [m2], and of the highest speed [m2/s2].
    struct Extremes {
        Real way2 = 0, speed2 = 0;
        bool displaced = false;  ///< concrete that looked for nobody as the list was made has left its place
        Extremes& operator+=(const Extremes& o) noexcept {
            way2 = std::max(way2, o.way2), speed2 = std::max(speed2, o.speed2), displaced |= o.displaced;
            return *this;
        }
    };

    static bool has_broken_bonds(const State<P>& state) noexcept {
        return P::has_bonds && state.broken_tension + state.broken_shear > 0;
    }

    /// Sites of concrete that something is near or touches; worn ones of them sink.
    void look_at_sites(State<P>& state, detail::SiteMarks& near) {
        near_sites_.clear();
        if (state.sites.stand) mark_near(state, 0, near);
        if (!state.sites.worn_out.empty()) mark_touched(state, near);
        reshape(state, near);
    }

    /// Contacts, bonds and bodies of those that leave. Contacts that stay keep what they remember.
    static void take_out(State<P>& state, const Departure& departure) {
        state.accounts.sum.left_stored +=
            state.contacts.keep(state.policies.contact, state.store, state.scene.walls, departure.moved);
        if (departure.any) remove(state, departure);
        if (has_broken_bonds(state) || (P::has_bonds && departure.any))
            state.accounts.sum.left_stored +=
                state.network.prune(state.particles, departure.moved, state.particles.centre);
    }

    /// Stones that are due, pieces of concrete that go on as clumps, and bodies of standing spheres that
    /// something is near.
    void bring_in(State<P>& state, const Departure& departure, detail::SiteMarks& near, Real t, Real dt) {
        const Index known = state.particles.bodies();
        supply(state, t, dt);
        for (const Fragment& fragment : departure.fragments) add_fragment(state, fragment);
        if (state.sites.stand) {
            const auto left =
                static_cast<Index>(std::count(departure.moved.begin(), departure.moved.end(), -1));
            const auto known_spheres = static_cast<Index>(departure.moved.size());  // those after are new
            for (SitePair& pair : near_sites_)
                pair.sphere =
                    pair.sphere < known_spheres ? departure.moved[at(pair.sphere)] : pair.sphere - left;
            mark_near(state, known, near), stand_by(state, near);
        }
        state.in_fluid.grow(state.particles), state.counter.grow(state.particles);
    }

    /// Slots in the order of slabs, wide enough for the skin.
    void sort(State<P>& state, const Departure& departure) {
        state.store.arrange(state.particles, departure.moved, list_skin_ + film(state),
                            state.scene.periodic());
        const auto [smallest, largest] =
            std::minmax_element(state.particles.radius.begin(), state.particles.radius.end());
        if (largest != state.particles.radius.end())
            state.smallest_radius = *smallest, state.size_ratio = *smallest / *largest;
    }

    void begin_life(State<P>& state) {
        built_at_.resize(at(state.store.spheres()));
        parallel_for(state.store.spheres(),
                     [&](Index s) { built_at_[at(s)] = state.store.lines.place[at(s)].centre; });
        state.events.lists_due = false;
        age_ = 0, walls_moved_ = 0;
    }

    /// Finds what stands near the bodies from `first` on. Of such a pair one alone comes nearer.
    void mark_near(const State<P>& state, Index first, detail::SiteMarks& near) {
        const std::size_t known = near_sites_.size();
        find_near_sites(state, first, 0.5 * (list_skin_ + film(state)), near_sites_);
        for (const SitePair& pair : std::span(near_sites_).subspan(known)) {
            near.add_near(pair.site);
            if (pair.touches) near.add_touched(pair.site);
        }
    }
    /// Marks the concrete that is in contact with anything, as of the last evaluation.
    static void mark_touched(const State<P>& state, detail::SiteMarks& near) {
        state.contacts.each_touching([&](const auto& touching) {
            for (const Index slot : {touching.pair.first, touching.pair.second})
                if (slot >= 0)
                    if (const Index site = state.particles.site[at(state.body_in(slot))]; site >= 0)
                        near.add_touched(site);
        });
    }

    /// What lists reach further for laws that act before surfaces touch [m]: planes count half of it.
    static Real film(const State<P>& state) noexcept { return 2 * range_of(state.policies.contact); }

    /// As wide as speeds ask for, and no wider than the period of space has room for.
    void choose_skin(const State<P>& state, Real dt) {
        const Real fed = state.feed ? state.feed->params().velocity.norm() : 0;
        const Real fastest = std::max(std::sqrt(fastest2(state)), fed);
        list_skin_ = std::max(skin_, 2 * shortest_life * dt * fastest);
        const Vec3 period = state.scene.periodic().period;
        if (period.isZero()) return;
        const PeriodNeed need(state.particles, state.scene.feed,
                              state.sites.stand ? state.concrete.lattice().radius : 0);
        list_skin_ = std::min(list_skin_, need.widest_skin(period) - film(state));
        outrun_ = list_skin_ < 8 * dt * fastest;  // what `refine` asks for
    }

    static Real fastest2(const State<P>& state) {
        Real fastest = parallel_sum<Extremes>(state.store.spheres(), [&](Index s) {
                           return Extremes{.speed2 = state.store.lines.motion[at(s)].velocity.squaredNorm()};
                       }).speed2;
        if (state.store.spheres() < state.particles.spheres())  // new ones are not in the store yet
            for (const Vec3& v : state.particles.velocity) fastest = std::max(fastest, v.squaredNorm());
        return fastest;
    }

    Extremes extremes(const State<P>& state) const {
        const HotArrays& lines = state.store.lines;
        return parallel_sum<Extremes>(state.store.spheres(), [&](Index slot) {
            return Extremes{
                (lines.place[at(slot)].centre - built_at_[at(slot)]).squaredNorm(),
                lines.motion[at(slot)].velocity.squaredNorm(),
                !passive_.empty() && passive_[at(slot)] && !state.keeps_its_place(state.body_in(slot))};
        });
    }

    /// Picks the inner list; false where the Verlet list would not last.
    bool refine(State<P>& state, Real dt) {
        dt_ = dt;
        land(state);
        if (!state.flight.sound) return true;
        const Extremes most = extremes(state);
        if (most.displaced && age_ > 0) return false;
        const Real left = list_skin_ - 2 * (std::sqrt(most.way2) + walls_moved_);
        const Real way = 2 * (dt * std::sqrt(most.speed2) + walls_way_);
        if (left < 4 * way && age_ > 0) return false;
        inner_skin_ = std::min(left, std::max(inner_life_ * way, 0.01 * skin_));
        moved_ = 0;
        repack(state);
        if (wake_stirred(state)) repack(state);
        choose_life(state.contacts.census(), state.store.spheres(), state.flight.held);
        return true;
    }

    /// An inner list that lives longer is picked less often, but more of its pairs do not touch, and spheres
    /// that could fly are held by them. Both cost the same at the best life. Taken from profiles, in
    /// evaluations of an inner pair that does not touch: a look at a pair or a sphere costs some ten, a
    /// sphere's step some eight.
    void choose_life(const ContactCensus& census, Index spheres, Index held) noexcept {
        const Real idle = static_cast<Real>(census.inner_pairs - census.touching);
        const Real kept = std::max(0.0, held - 2 * static_cast<Real>(census.touching));
        const Real look = 10 * (static_cast<Real>(census.near) + spheres);
        const Real best = std::sqrt(inner_life_ * look / (idle + 8 * kept + 1));
        inner_life_ =
            std::clamp(best, std::max(shortest_life, 0.5 * inner_life_), std::min(256.0, 2 * inner_life_));
    }

    Departure departing(State<P>& state, Real dt, const detail::SiteMarks& near) const {
        Departure d;
        const Particles& p = state.particles;
        d.gone.assign(at(p.bodies()), 0);
        d.moved.resize(at(state.store.spheres()));
        std::iota(d.moved.begin(), d.moved.end(), 0);
        if (state.sites.stand) retire(state, near, d.gone);
        for (const Index body : std::exchange(state.events.removed, {})) d.gone[at(body)] = 1;
        for (const Index site : std::exchange(state.events.worn_away, {}))
            if (const Index body = state.sites.body_of[at(site)]; body >= 0) {
                if (p.inverse_mass[at(body)] > 0) leave(state, body, state.store.position_of(p, body), dt);
                d.gone[at(body)] = 1;
            }
        if constexpr (P::has_bonds)
            if (!state.events.components.empty()) {
                d.fragments = join_pieces(state, d.gone);
                state.accounts.sum.lost_bond +=
                    state.network.drop([&](Index body) { return d.gone[at(body)] != 0; });
            }
        d.any = std::find(d.gone.begin(), d.gone.end(), 1) != d.gone.end();
        if (!state.scene.outlet && !d.any) return d;
        Index to = 0;
        for (Index b = 0; b < p.bodies(); ++b) {
            const bool known = state.store.spheres() > p.first_sphere[at(b)];
            if (state.scene.outlet && known && !d.gone[at(b)] && p.inverse_mass[at(b)] > 0 &&
                p.kind[at(b)] != Kind::concrete) {
                const Vec3 x = state.store.position_of(p, b);
                if (x.x() > *state.scene.outlet) {
                    d.gone[at(b)] = 1, d.any = true;
                    leave(state, b, x, dt);
                }
            }
            if (known)
                for (Index s = p.first_sphere[at(b)]; s < p.first_sphere[at(b)] + p.sphere_count[at(b)]; ++s)
                    d.moved[at(s)] = d.gone[at(b)] ? -1 : to++;
        }
        return d;
    }

    /// Books what a body takes along. Its velocity is half a step old, so its place is taken back as far.
    static void leave(State<P>& state, Index body, const Vec3& x, Real dt) {
        const SphereStore& store = state.store;
        const Vec3 v = store.velocity_of(state.particles, body);
        Real turning = 0;
        if (const Index c = store.clump_of(body); c >= 0) {
            const MovingClump& clump = store.clumps[at(c)];
            turning = 0.5 * clump.angular_momentum.dot(clump.angular_velocity(clump.angular_momentum));
        } else {
            const Index slot = store.slot_of(state.particles.first_sphere[at(body)]);
            turning = 0.2 * state.particles.mass[at(body)] *
                      store.lines.motion[at(slot)].surface_velocity.squaredNorm();
        }
        state.accounts.sum.left_kinetic += 0.5 * state.particles.mass[at(body)] * v.squaredNorm() + turning;
        state.accounts.sum.left_potential += state.potential_energy(body, x - 0.5 * dt * v);
        state.counter.leave(state.particles, body, x.x());
    }

    static void remove(State<P>& state, const Departure& departure) {
        for (std::size_t b = 0; b < departure.gone.size(); ++b)
            if (departure.gone[b] && state.particles.site[b] >= 0)
                state.sites.body_of[at(state.particles.site[b])] = -1;
        state.particles.remove(departure.gone);
        state.note_sites();
        state.in_fluid.remove(departure.gone);
        state.counter.remove(departure.gone);
        leave_sleepers(state, departure.gone);
    }

    /// Fed bodies have their velocity half a step ago, as all others.
    static void supply(State<P>& state, Real t, Real dt) {
        if (state.feed)
            state.feed->supply(
                state.particles, state.scene.walls, t,
                [&](Index body) {
                    const Vec3 before =
                        state.particles.position[at(body)] - 0.5 * dt * state.particles.velocity[at(body)];
                    state.accounts.sum.fed_kinetic += state.particles.kinetic_energy(body);
                    state.accounts.sum.fed_potential += state.potential_energy(body, before);
                },
                [&](const Vec3& x, Real reach) { return height_above_standing(state, x, reach); });
    }

    void find_pairs(State<P>& state) {
        const Particles& p = state.particles;
        std::vector<SearchRole> role(at(p.spheres()));
        parallel_for(p.spheres(), [&](Index s) {
            const Index body = p.body[at(s)];
            const bool stands = state.sites.stand && p.kind[at(body)] == Kind::concrete;
            role[at(s)] = stands                        ? SearchRole::left_out
                          : state.keeps_its_place(body) ? SearchRole::passive
                                                        : SearchRole::all;
        });
        passive_.clear();
        if (state.scene.concrete && !state.sites.stand) {
            passive_.resize(role.size());
            for (Index s = 0; s < p.spheres(); ++s)
                passive_[at(state.store.slot_of(s))] = role[at(s)] == SearchRole::passive;
        }
        std::vector<VerletPair> known;
        for (const SitePair& pair : near_sites_)
            if (const Index body = state.sites.body_of[at(pair.site)]; body >= 0 && pair.sphere >= 0)
                known.push_back({pair.sphere, p.first_sphere[at(body)], pair.shift});
        std::vector<BodyMark> marks;
        if (state.scene.concrete) {
            marks.resize(at(p.bodies()));
            for (std::size_t b = 0; b < marks.size(); ++b)
                marks[b] = {p.site[b] >= 0, p.kind[b] == Kind::concrete};
        }
        std::vector<SphereStore::ImageRequest> requests;
        if constexpr (P::has_bonds) {
            state.network.arrange(state.store);
            state.network.each_bond_by_slab([&](const auto& bond, Index slab) {
                for (const Index sphere : {bond.spheres.first, bond.spheres.second})
                    if (const auto image = image_for(state.store, sphere, slab)) requests.push_back(*image);
            });
        }
        state.contacts.rebuild(state.store,
                               {p, state.scene.walls, role, marks, known, list_skin_ + film(state),
                                state.scene.periodic().period, P::has_materials},
                               std::move(requests), [&](Index first, Index second) {
                                   return P::has_bonds && state.network.holds({first, second});
                               });
        if constexpr (P::has_bonds)
            state.network.pack(state.store.phantom(), [&](const auto& bond, Index slab) {
                const auto slot = [&](Index sphere) {
                    const auto image = image_for(state.store, sphere, slab);
                    return image ? state.store.image_slot(*image) : state.store.slot_of(sphere);
                };
                return SlotPair{slot(bond.spheres.first), slot(bond.spheres.second)};
            });
    }

    /// The image of a sphere that a bond of `slab` needs where the sphere belongs to another chunk.
    static std::optional<SphereStore::ImageRequest> image_for(const SphereStore& store, Index sphere,
                                                              Index slab) {
        const Index slot = store.slot_of(sphere), chunk = store.slabs.chunk_of(slab);
        if (store.slabs.chunk_of(store.slab_of_slot(slot)) == chunk) return std::nullopt;
        return SphereStore::ImageRequest{slot, chunk, {}};
    }

    Real skin_ = 0, list_skin_ = 0;         ///< asked for, of the present list [m]
    Real inner_skin_ = 0, moved_ = 0;       ///< of the inner list; how far anything may have come since [m]
    Real walls_moved_ = 0, walls_way_ = 0;  ///< walls since the last renewal, and in the last step [m]
    Real seconds_ = 0, inner_life_ = 32;    ///< [s], [steps]
    bool outrun_ = false;
    Real dt_ = 0;                       ///< the step [s]
    Index age_ = 0;                     ///< steps since the last renewal
    std::vector<SitePair> near_sites_;  ///< found by the last renewal
    std::vector<Vec3> built_at_;        ///< [slot] where the list was made [m]
    std::vector<char> passive_;         ///< [slot] looked for nobody then; empty but for moving concrete
};

}  // namespace abrade
