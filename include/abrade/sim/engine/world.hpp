#pragma once
// Everything that moves, and one step of it.

#include <abrade/sim/engine/changes.hpp>
#include <abrade/sim/engine/neighbour_lists.hpp>
#include <abrade/sim/guards/diagnosis.hpp>
#include <abrade/sim/motion/advance.hpp>
#include <abrade/sim/motion/exchange.hpp>

namespace abrade {

/// Between steps the lines of the store (`HotArrays`) hold places of now and velocities half a step old.
/// Forces of now are either evaluated already, for an observation, or will be at the start of the next step,
/// slab by slab, each slab moved on while it is in cache. Both ways give the same bits.
template <class P>
class World {
public:
    /// Overlap over the smaller radius beyond which a run is wrong, whatever it computes.
    static constexpr Real overlap_limit = 0.2;

    explicit World(State<P> state) : state_(std::move(state)) {}

    /// Before a step to `t`: a fluid that changes goes there, one among bodies follows them.
    void advance_fluid(Real t);

    /// Lists and forces at the start, over no time; the ledger begins.
    void open(Real t);

    /// From t to t + dt: v(t + dt/2) = v(t - dt/2) + a(t) dt, x(t + dt) = x(t) + v(t + dt/2) dt.
    void step(Real t, Real dt, bool timed);

    /// Writes the present state into `particles()` and the ledger. What moves is left as it is.
    const Ledger& publish();

    /// Between steps: `change(Changes)` is checked first, then made of velocities and particles that are
    /// those of now; then forces are found anew, over no time, with what contacts remember.
    void change(auto&& change) {
        using Acts = typename Changes<P>::Acts;
        publish();
        change(Changes<P>(state_, Acts::no));
        make_whole();
        publish();
        land(state_);  // what flies has flown under what was there until now
        rouse_all(state_);
        change(Changes<P>(state_, Acts::yes));
        state_.outline.renew(state_.scene, state_.policies);
        state_.events.lists_due = true;
        evaluated_ = false, led_here_ = kicked_ = last_kick_ = 0;
    }

    /// Places, and velocities as the lines have them, for what cannot wait for forces.
    void publish_places() { abrade::publish_places(state_); }

    void set_skin(Real skin) noexcept { lists_.set_skin(skin); }
    void set_free_flight(bool allowed);
    /// As RunOptions says.
    void set_sleep(Real speed, Real after);
    Failure take_failure() noexcept { return std::exchange(failure_, {}); }

    const State<P>& state() const noexcept { return state_; }
    const Scene& scene() const noexcept { return state_.scene; }
    const Particles& particles() const noexcept { return state_.particles; }  ///< as last published
    const ContactList<PairLaw<decltype(P::contact)>>& contacts() const noexcept { return state_.contacts; }
    const Network<decltype(P::bond)>& network() const noexcept { return state_.network; }
    const Concrete& concrete() const noexcept { return state_.concrete; }
    /// Solid that passed the flow counter, net downstream [m3].
    Real cumulative_discharge() const noexcept { return state_.counter.passed(); }
    StepSeconds timed() const noexcept { return timed_; }
    Real renewal_seconds() const noexcept { return lists_.seconds(); }
    Real fluid_seconds() const noexcept { return fluid_seconds_; }

    /// Calls `visit(body, other, contact, load)` for each contact that touches, as things were published
    /// last; `other` is negative for a wall. Dashpots act there with velocities half a step old.
    template <class Visit>
    void each_contact(Visit&& visit) const {
        state_.contacts.each_touching([&](const auto& touching) {
            const SlotPair& pair = touching.pair;
            const auto& law = law_between(state_.policies.contact, touching.materials);
            const auto contact = contact_seen_by(law, state_.store.lines, state_.scene.walls, touching, 0);
            visit(body_in(pair.first), body_in(pair.second), contact,
                  law.respond(contact, touching.memory).load);
        });
    }

    static void fields(auto&& field) {
        field("state", &World::state_), field("lists", &World::lists_), field("ledger", &World::ledger_),
            field("now", "s", &World::now_), field("time_step", "s", &World::time_step_),
            field("led_here", "s", &World::led_here_), field("kicked", "s", &World::kicked_),
            field("last_kick", "s", &World::last_kick_), field("evaluated", &World::evaluated_),
            field("whole", &World::whole_), field("stored_contacts", "J", &World::stored_contacts_),
            field("stored_bonds", "J", &World::stored_bonds_),
            field("stored_at_rest", "J", &World::stored_at_rest_), field("unlooked", &World::unlooked_),
            field("too_deep", &World::too_deep_), field("timed", &World::timed_),
            field("fluid_seconds", "s", &World::fluid_seconds_),
            field("next_fluid_step", &World::next_fluid_step_), field("wall_power", "W", &World::wall_power_);
    }
    void restored() { move_walls(led_here_); }

private:
    struct alignas(64) PassSums {
        ContactSums contacts;
        BondSums bonds;
        MotionSums motion;
        StepSeconds seconds;
        std::vector<SiteLoad> site_loads;  ///< on standing concrete
        std::vector<Index> weakened;       ///< sites
    };
    struct Published {
        MotionSums motion;
        Real kinetic = 0, potential = 0;
        Published& operator+=(const Published& o) noexcept {
            return motion += o.motion, kinetic += o.kinetic, potential += o.potential, *this;
        }
    };

    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }
    Index body_in(Index slot) const noexcept { return slot < 0 ? slot : state_.body_in(slot); }

    /// How far velocities must be taken ahead, as a share of the kicks since the last evaluation.
    Real ahead() const noexcept { return kicked_ > 0 ? 0.5 * led_here_ / kicked_ : 0; }

    Real ahead_in_fluid() const noexcept {
        return whole_ || last_kick_ == 0 ? 0 : 0.5 * led_here_ / last_kick_;
    }

    /// Before forces are evaluated, once for each time.
    void make_ready(Real dt);

    /// Brings walls that move to where they are now, in the step `led` that led here [s].
    void move_walls(Real led) {
        if (state_.scene.moving_walls.empty()) return;
        // Over a step about now, which is what the next kick is of.
        const Real dt = time_step_ > 0 ? time_step_ : 1e-6;
        wall_speed_ = 0;
        for (const MovingWall& moving : state_.scene.moving_walls) {
            Plane& wall = state_.scene.walls[at(moving.wall)];
            const PlanePlace here = moving.at(now_);
            wall = here.of(moving.start);
            wall.moves = true;
            if (led > 0) wall.last = here.since(moving.at(now_ - led), led);
            wall.now = moving.at(now_ + 0.5 * dt).since(moving.at(now_ - 0.5 * dt), dt);
            const Plane::Motion next = moving.at(now_ + dt).since(here, dt);  // what the step to come will be
            Real reach = 0;
            if (!next.spin.isZero(0))
                for (const SpherePlace& sphere :
                     std::span(state_.store.lines.place).first(at(state_.store.spheres())))
                    reach = std::max(reach, (sphere.centre - wall.point).norm());
            wall_speed_ = std::max(wall_speed_, next.velocity.norm() + reach * next.spin.norm());
        }
    }

    /// Brings forces, losses and wear up to the present.
    void catch_up() {
        if (evaluated_) return;
        make_ready(time_step_);
        pass(true, nullptr, false);
        evaluated_ = true;
    }

    /// What is missing of the last kick.
    Move to_present() const noexcept {
        return {whole_ ? 0 : 0.5 * time_step_, 0, true, now_, ahead_in_fluid()};
    }

    /// Sees who falls asleep. Forces are those of now, so nothing is lost or won in between.
    void look();
    /// Stored in contacts that are not evaluated [J].
    Real at_rest() {
        if (std::exchange(state_.sleep.changed, false)) stored_at_rest_ = stored_at_rest(state_);
        return stored_at_rest_;
    }

    /// Velocities come up to the present.
    void make_whole();
    /// Before a step of another length begins.
    void change_step(Real dt) {
        make_whole();
        time_step_ = dt;
    }

    /// Where a step to `t` is more than the fluid's, it comes to where solids are; if all stand, to `t`.
    void exchange_before(Real t);

    /// Forces, if asked for, and motion, if asked for, of all slabs. A chunk's first slab comes last: the
    /// chunk before has a say in it.
    void pass(bool evaluate, const Move* move, bool timed);

    void evaluate_slab(Index slab, const ContactStep& step, PassSums& sums, Stopwatch& watch) noexcept {
        HotArrays& lines = state_.store.lines;
        const auto observer = state_.policies.observer();
        sums.contacts += state_.contacts.section(slab).respond(state_.policies.contact, observer,
                                                               state_.scene.walls, lines, step);
        watch.lap(sums.seconds.contacts);
        if constexpr (P::has_bonds) {
            sums.bonds += state_.network.respond(slab, state_.policies.bond, observer, lines,
                                                 state_.strength_left(), step);
            watch.lap(sums.seconds.bonds);
        }
    }

    /// Loads of a slab are complete: concrete takes its wear, bodies move.
    void finish_slab(Index slab, bool evaluated, const Move* move, PassSums& sums) {
        SphereStore& store = state_.store;
        for (const SphereImage& image : store.images_of(slab))
            if (!flies(image)) store.collect(image);
        const Index first = store.first_slot(slab), last = store.first_slot(slab + 1);
        if constexpr (P::has_bonds)
            if (evaluated && state_.standing)
                for (Index slot = first; slot < store.first_clump_slot(slab); ++slot)
                    note_site_load(slot, sums.site_loads);
        if constexpr (P::has_wear)
            for (Index slot = first; slot < last; ++slot) take_wear(slot, sums.weakened);
        if (!move) return;
        sums.motion += move_spheres(state_, first, store.first_clump_slot(slab), *move);
        move_clumps(state_, store.clumps_of(slab), *move, sums.motion);
        for (const SphereImage& image : store.images_of(slab))
            if (!flies(image)) store.refresh(image);
    }

    /// What flies is in no contact, and `land` brings its image up to the present.
    bool flies(const SphereImage& image) const noexcept {
        return state_.mode[at(image.owner)] == IntegrationMode::flying;
    }

    void take_wear(Index slot, std::vector<Index>& weakened) {
        SphereLoad& load = state_.store.lines.load[at(slot)];
        if (!(load.observed > 0)) return;
        const Index site = state_.particles.site[at(body_in(slot))];
        if (site >= 0) {
            const Real before = state_.concrete.fracture(site);
            state_.concrete.wear(site, load.observed, now_, led_here_);
            state_.sites.note_worn(site);
            constexpr Real per_step = 1 / StandingBonds<decltype(P::bond)>::strength_step;
            if (state_.standing &&
                std::floor(per_step * before) != std::floor(per_step * state_.concrete.fracture(site)))
                weakened.push_back(site);
        }
        load.observed = 0;
    }

    /// The load on a standing sphere, where that is more than it bears for certain.
    void note_site_load(Index slot, std::vector<SiteLoad>& site_loads) const {
        const SphereLoad& load = state_.store.lines.load[at(slot)];
        const Real load2 = load.force.squaredNorm() + load.torque_over_radius.squaredNorm();
        if (!(load2 > 0) || state_.store.lines.motion[at(slot)].inverse_mass > 0) return;
        const Index site = state_.particles.site[at(body_in(slot))];
        if (site >= 0 && load2 > state_.standing->safe_squared(site))
            site_loads.push_back({site, {load.force, load.torque_over_radius}});
    }

    void book(const ContactSums& contacts, const BondSums& bonds) {
        Accounts& a = state_.accounts;
        a.add(&Ledger::lost_normal, contacts.lost_normal + bonds.lost_normal);
        a.add(&Ledger::lost_sliding, contacts.lost_tangential + bonds.lost_tangential);
        a.add(&Ledger::lost_rolling, contacts.lost_rolling), a.add(&Ledger::lost_film, contacts.lost_film);
        a.add(&Ledger::lost_bond, bonds.lost_bond);
        a.add(&Ledger::concrete_lost_normal, contacts.watched_lost_normal + bonds.watched_lost_normal);
        a.add(&Ledger::concrete_lost_sliding,
              contacts.watched_lost_tangential + bonds.watched_lost_tangential);
        stored_contacts_ = contacts.stored, stored_bonds_ = bonds.stored;
        state_.broken_tension += bonds.broken_tension, state_.broken_shear += bonds.broken_shear;
        state_.events.bond_broke |= bonds.broken_tension + bonds.broken_shear > 0;
        too_deep_ |= contacts.deepest > overlap_limit * (1 + state_.size_ratio);
        if (bonds.deepest > overlap_limit) report(Diagnosis(state_).crushed_bond(bonds));
    }
    void book(auto& to, const MotionSums& motion) const { abrade::book(to, motion, state_.scene.gravity); }

    /// What is first stays, but for overlaps: the deepest counts.
    void report(const Failure& found) noexcept {
        using Cause = Failure::Cause;
        const bool deeper = found.cause == Cause::overlap && found.measure > failure_.measure;
        if (found.cause != Cause::none && (failure_.cause == Cause::none || deeper)) failure_ = found;
    }
    /// Sums of an evaluation told that something may be too deep. The lines have made `last` since then.
    void report_overlap(const Move& last) {
        if (std::exchange(too_deep_, false)) report(Diagnosis(state_).deepest(last, overlap_limit));
    }
    void check(const MotionSums& motion) {
        const Box space = state_.scene.open_bounds();
        const Vec3 low = detail::first_three(motion.low), high = detail::first_three(motion.high);
        const bool nobody = !(low.x() <= high.x());
        const bool near_bounds = state_.flight.furthest() >= state_.flight.margin;
        if (near_bounds) land(state_);
        const bool sound = state_.flight.sound &&
                           motion.fastest2 < square(Diagnosis<P>::fastest_of_this_field) &&
                           detail::first_three(motion.finite).allFinite();
        if (sound && !near_bounds && (nobody || (space.contains(low) && space.contains(high)))) return;
        report(Diagnosis(state_).unsound_or_lost());
    }

    State<P> state_;
    NeighbourLists<P> lists_;
    Ledger ledger_;                ///< as last published
    std::vector<PassSums> parts_;  ///< [chunk]
    Real now_ = 0, time_step_ = 0;
    Real led_here_ = 0;                ///< the step that led to the present places [s]
    Real kicked_ = 0, last_kick_ = 0;  ///< since the last evaluation, and last [s]
    bool evaluated_ = false;           ///< loads are those of the present places
    bool whole_ = true;                ///< velocities are those of the present, not of half a step ago
    Real stored_contacts_ = 0, stored_bonds_ = 0;  ///< in what is evaluated [J]
    Real stored_at_rest_ = 0;                      ///< [J]
    Real wall_power_ = 0, wall_speed_ = 0;  ///< of walls that move: on bodies [W], where these are [m/s]
    NextFluidStep next_fluid_step_;
    Index unlooked_ = 0;     ///< steps since the last look at who falls asleep
    bool too_deep_ = false;  ///< some contact may be, as of the last evaluation
    Failure failure_;
    StepSeconds timed_;
    Real fluid_seconds_ = 0;  ///< that a changing fluid took [s]
};

template <class P>
void World<P>::advance_fluid(Real t) {
    if constexpr (P::fluid_advances) {
        Stopwatch watch{state_.policies.fluid.time() < t};
        if (!P::fluid_resolves || t <= now_)  // to settle, nobody is in it yet
            bring_fluid_to(state_.policies.fluid, t);
        else if constexpr (P::fluid_resolves)
            exchange_before(t);
        watch.lap(fluid_seconds_);
    }
}

template <class P>
void World<P>::open(Real t) {
    now_ = t;
    lists_.renew(state_, now_, 0);
    publish();
    Ledger& start = state_.accounts.sum;
    start.kinetic_start = ledger_.kinetic;
    start.potential_start = ledger_.potential;
    start.stored_start = ledger_.stored_contacts + ledger_.stored_bonds;
    publish();
}

template <class P>
void World<P>::step(Real t, Real dt, bool timed) {
    if (dt != time_step_) change_step(dt);
    now_ = t;
    if (state_.sleep.speed > 0 && ++unlooked_ >= Sleep::steps_between_looks) look();
    if (!evaluated_) make_ready(dt);
    const Move move{whole_ ? 0.5 * dt : dt, dt, false, now_, ahead_in_fluid()};
    pass(!evaluated_, &move, timed);
    kicked_ += move.kick, last_kick_ = move.kick, led_here_ = dt, now_ = t + dt;
    evaluated_ = whole_ = false;
}

template <class P>
const Ledger& World<P>::publish() {
    catch_up();
    const Move half = to_present();
    const auto sums = parallel_sum<Published>(state_.particles.bodies(), [&](Index b) {
        Published one;
        publish_body(state_, b, half, one.motion);
        one.kinetic = state_.particles.kinetic_energy(b);
        one.potential = state_.potential_energy(b, state_.particles.position[at(b)]);
        return one;
    });
    ledger_ = state_.accounts.total();
    book(ledger_, sums.motion);
    ledger_.wall_work += half.kick * wall_power_;
    ledger_.kinetic = sums.kinetic, ledger_.potential = sums.potential;
    ledger_.stored_contacts = stored_contacts_ + at_rest();
    ledger_.stored_bonds = stored_bonds_;
    state_.counter.count(state_.particles);
    return ledger_;
}

template <class P>
void World<P>::set_free_flight(bool allowed) {
    // Each exchange asks where all are; what a force of the user's does over a flight nobody knows.
    state_.flight.allowed = allowed && !P::fluid_resolves && !P::has_force;
    find_flyers(state_);
}

template <class P>
void World<P>::set_sleep(Real speed, Real after) {
    Sleep& sleep = state_.sleep;
    const Real gravity = state_.scene.gravity.norm();
    sleep.speed = speed;
    sleep.after = after > 0 || gravity == 0 ? after : 200 * speed / gravity;
    sleep.toppling = after > 0 || gravity == 0 ? 0 : 2 / std::sqrt(gravity);
    if (speed == 0) rouse_all(state_);
}

template <class P>
void World<P>::make_whole() {
    if (whole_) return;
    catch_up();
    const Move move{0.5 * time_step_, 0, true, now_, ahead_in_fluid()};
    pass(false, &move, false);
    kicked_ += move.kick, last_kick_ = move.kick;
    whole_ = true;
}

template <class P>
void World<P>::make_ready(Real dt) {
    move_walls(led_here_);
    settle_concrete(state_, now_);
    state_.free_loose_concrete();
    lists_.freshen(state_, now_, dt);
}

template <class P>
void World<P>::pass(bool evaluate, const Move* move, bool timed) {
    const Slabs& slabs = state_.store.slabs;
    const ContactStep step{led_here_, ahead()};
    parts_.assign(at(slabs.chunks()), {});
    parallel_tasks(slabs.chunks(), [&](Index c) {
        PassSums& sums = parts_[at(c)];
        Stopwatch watch{timed};
        for (Index slab = slabs.first_slab(c); slab < slabs.first_slab(c + 1); ++slab) {
            if (evaluate) evaluate_slab(slab, step, sums, watch);
            if (slab > slabs.first_slab(c)) finish_slab(slab, evaluate, move, sums);
            watch.lap(sums.seconds.motion);
        }
    });
    parallel_tasks(slabs.chunks(), [&](Index c) {
        Stopwatch watch{timed};
        finish_slab(slabs.first_slab(c), evaluate, move, parts_[at(c)]);
        watch.lap(parts_[at(c)].seconds.motion);
    });
    PassSums all;
    for (const PassSums& part : parts_) {
        all.contacts += part.contacts, all.bonds += part.bonds, all.motion += part.motion;
        timed_ += part.seconds;
        state_.events.put(part.site_loads, part.weakened);
    }
    if (evaluate) book(all.contacts, all.bonds), kicked_ = 0, wall_power_ = all.contacts.wall_power;
    report_overlap(move ? *move : Move{});
    if (move) {
        book(state_.accounts, all.motion);
        state_.accounts.add(&Ledger::wall_work, move->kick * wall_power_);
        state_.flight.note(move->kick, move->drift, move->time);
        state_.sleep.stirred |= all.motion.stirs;
        next_fluid_step_.fastest = std::max(std::sqrt(all.motion.fastest2), state_.flight.fastest_now());
        const Real way = move->drift * next_fluid_step_.fastest;
        lists_.note_step(way, move->drift * wall_speed_);
        check(all.motion);
        if (way > state_.smallest_radius) land(state_), report(Diagnosis(state_).longest_stride(move->drift));
        if (lists_.outrun()) report(Diagnosis(state_).fastest());
    }
}

template <class P>
void World<P>::exchange_before(Real t) {
    if constexpr (P::fluid_resolves) {
        auto& fluid = state_.policies.fluid;
        if (next_fluid_step_.of(fluid) >= t) return;
        const Real to = state_.nobody_moves() ? t : now_;
        if (!(fluid.time() < to)) return;
        make_whole();
        FlowBodies<P> flow(state_);
        fluid.advance(to, flow.bodies()), ++next_fluid_step_.met;
        state_.accounts.sum.flow_work += flow.give_back(state_);
        if constexpr (requires { fluid.solids_took(Real{}); })
            fluid.solids_took(state_.accounts.sum.flow_work);
    }
}

template <class P>
void World<P>::look() {
    catch_up();
    MotionSums sums;
    const Real stored = at_rest();
    if (fall_asleep(state_, to_present(), unlooked_ * time_step_, sums)) {
        book(state_.accounts, sums);
        lists_.repack(state_);
        stored_contacts_ += stored - at_rest();
    }
    unlooked_ = 0;
}

}  // namespace abrade
