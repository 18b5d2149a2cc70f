#pragma once
// A simulation of a scene by its laws: its run, what can be asked of it, and changes between runs.

// First, so that a message about a law shows a short way to what it misses.
#include <abrade/sim/slots.hpp>

#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/sim/scene_limits.hpp>
#include <abrade/sim/snapshot.hpp>

#include <chrono>
#include <iosfwd>

namespace abrade {

/// Made by `simulate(scene)`, completed by `.contact()`, `.bond()`, `.wear()`, `.fluid()` and `.force()`,
/// then run. The policies are part of the type; an absent one costs nothing.
template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
class Simulation : public Slots<C, B, W, F, D, U> {
    using Laws = Slots<C, B, W, F, D, U>;
    using Laws::scene_, Laws::contact_, Laws::bond_, Laws::wear_, Laws::fluid_, Laws::drag_, Laws::force_;

public:
    using Laws::Laws;

    // --- running -------------------------------------------------------------------------------

    /// Runs to `end_time`; may be called again to go on. `observer(const simulation&)` sees the start, every
    /// `observe_every`, and the end. Throws InputError before the first step when options or scene cannot
    /// be used, RunError when a step goes wrong.
    template <class Observer>
    void run(const RunOptions& options, Observer&& observer) {
        static_assert(!std::same_as<C, ContactLawIsMissing>,
                      "a simulation needs a contact law: simulate(scene).contact(law)");
        if constexpr (!std::same_as<C, ContactLawIsMissing>) advance(options, observer);
    }
    void run(const RunOptions& options) {
        run(options, [](const Simulation&) {});
    }

    // --- changes between two runs ------------------------------------------------------------------
    // Contacts keep their memory. What is put in is the ledger's `fed_*`, what is taken out its `left_*`. All
    // throw std::logic_error before the first run, when the scene is what to change, and InputError for what
    // cannot be, which changes nothing. A body or a wall that overlaps what is there ends the next run in its
    // first step.

    /// Adds a body; returns its id.
    Index add_stone(Clump clump, const BodyState& state, Real density = 2650);
    Index add_sphere(Real radius, const BodyState& state, Real density = 2650);
    void remove(Index id);
    /// Returns the wall's number.
    Index add_wall(const Vec3& point, const Vec3& normal, Index material = 0);
    void remove_wall(Index number);
    void set_gravity(const Vec3& gravity);
    /// Lets go a stone that is fixed, and holds one that moves, where it is.
    void let_go(Index id);
    void hold(Index id);

    // --- saving and going on later ---------------------------------------------------------------

    /// Makes of the scene what a run would begin with, without running: what a restart reads into
    /// (io/restart.hpp). Throws InputError where the scene cannot be used.
    void build();
    /// All of it that lasts. Between steps, as in `RunOptions::stop`, and between runs.
    static void fields(auto&& field) {
        field("world", &Simulation::world_), field("ledger", &Simulation::ledger_),
            field("last_good", &Simulation::last_good_), field("time", "s", &Simulation::time_),
            field("time_step", "s", &Simulation::time_step_), field("step", &Simulation::step_),
            field("remembered", &Simulation::remembered_), field("shortened", &Simulation::shortened_),
            field("opened", &Simulation::opened_), field("has_grains", &Simulation::has_grains_),
            field("wall_seconds", "s", &Simulation::wall_seconds_), field("run", &Simulation::run_);
    }
    /// A run that was under way goes on if it is asked for again; another one begins at the restored time.
    void restored() noexcept { resumes_ = run_.under_way; }

    // --- what came of it -----------------------------------------------------------------------

    Real time() const noexcept { return time_; }  ///< [s]
    Index steps() const noexcept { return step_; }
    Real time_step() const noexcept { return time_step_; }                  ///< [s]
    const StableStep& stable_time_step() const { return limits().stable; }  ///< of dense surroundings
    /// What contacts and bonds allow as they stand, and a first touch of each body.
    StableStep stable_step_now() const;
    Index times_shortened() const noexcept { return shortened_; }  ///< the step, for contacts as they stood
    bool stopped() const noexcept { return stopped_; }             ///< by RunOptions::stop
    Real wall_seconds() const noexcept { return wall_seconds_; }
    const Ledger& ledger() const noexcept { return ledger_; }  ///< as of the last observation
    // These throw std::logic_error before the first run: there is nothing to show yet.
    const Particles& particles() const { return world().particles(); }
    const Concrete& concrete() const { return world().concrete(); }
    /// Where the sphere of a site of the concrete is, a body or not; where it was built if it left [m].
    Vec3 concrete_place(Index site) const { return world().state().place_of(site); }
    Index bonds_broken() const { return world().state().bonds_broken(); }
    Index spheres_let_go() const { return world().state().let_go_count; }  ///< of concrete that stood
    /// The time acceleration at which the largest collision so far would have worn half of its sphere's cell
    /// [-], from where on the map of docs/verification/convergence.md loses wear to overflow; infinite where
    /// nothing wore. More stones may bring a larger collision.
    Real largest_safe_acceleration() const requires AcceleratedWear<W> {
        return Concrete::safe_collision_share * wear_.params().acceleration /
               concrete().largest_collision_share();
    }
    /// The flow counter, net downstream: solid volume of stones [m3].
    Real sediment_passed() const { return world().cumulative_discharge(); }
    const auto& world() const {
        if (!world_) throw std::logic_error("Simulation: run it before asking for its state");
        return *world_;
    }
    const Feed* feed() const noexcept {
        return world_ && world_->state().feed ? &*world_->state().feed : nullptr;
    }
    const Snapshot& last_good() const noexcept { return last_good_; }

    /// Timed steps stand for all.
    TimeShares time_shares() const noexcept {
        if (!world_) return {};
        return shares_of(wall_seconds_, world_->timed(), world_->renewal_seconds(), world_->fluid_seconds());
    }

    template <class... All>
    friend std::ostream& operator<<(std::ostream& out, const Simulation<All...>& sim);  // sim/print.hpp

    /// As it stands now, where it changes.
    const F& fluid_model() const noexcept { return world_ ? world_->state().policies.fluid : fluid_; }

private:
    using Clock = std::chrono::steady_clock;
    static constexpr Index steps_between_checks = 64, steps_between_snapshots = 400;
    /// Share of what contacts allow as they stand that is taken where `safety` would have taken more [-].
    static constexpr Real share_of_now = 0.9;

    static Real seconds_since(Clock::time_point start) {
        return std::chrono::duration<Real>(Clock::now() - start).count();
    }

    const SceneLimits& limits() const {
        if (!limits_) throw std::logic_error("Simulation: run it before asking for its stable step");
        return *limits_;
    }
    void advance(const RunOptions& options, auto&& observer) {
        const bool resumes = std::exchange(resumes_, false) && run_.options.asks_the_same_as(options);
        if (resumes)
            stopped_ = false;
        else
            prepare(options);
        const auto clock_start = Clock::now();
        const Real wall_before = wall_seconds_;
        const auto show = [&] {
            wall_seconds_ = wall_before + seconds_since(clock_start);
            balance();
            observer(std::as_const(*this));
        };
        const auto plan = [&] {
            run_.begun = time_, run_.done = 0,
            run_.steps = limits().steps(options.end_time - time_, time_step_, step_);
            if (run_.steps > 0)
                time_step_ = (options.end_time - run_.begun) / run_.steps;  // so that the last ends on time
        };
        if (!resumes) {
            run_ = {.options = options, .next_observation = time_ + options.observe_every};
            run_.options.stop = {};
            plan();
            show();
        }
        run_.under_way = true;
        while (run_.done < run_.steps && !stopped_ && !concrete().worn_through()) {
            do_step(run_.begun + run_.done * time_step_);
            const bool last = ++run_.done == run_.steps;
            if (last) time_ = options.end_time;
            const bool seen =
                last || concrete().worn_through() ||
                (options.observe_every > 0 && time_ >= run_.next_observation - 0.5 * time_step_);
            if (seen) {
                run_.next_observation += options.observe_every;
                show();
            }
            const bool look = step_ % steps_between_snapshots == 0 && !last;
            const bool grains = !last && (look || world_->state().let_go_count > 0);
            const bool follows = grains && follow_grains(options, look);
            if ((look && shorten(options)) || follows) plan();
            // Last: what is saved here goes on as if nobody had asked.
            if (step_ % steps_between_checks == 0 && options.stop && options.stop()) {
                stopped_ = true;
                if (!seen) show();
            }
        }
        run_.under_way = false;
        wall_seconds_ = wall_before + seconds_since(clock_start);
    }

    /// Sees whether contacts, as they stand, still allow the step. One that was asked for is not changed.
    bool shorten(const RunOptions& options);

    /// Grains of standing concrete are lighter than stones: the step is theirs while there are any.
    bool follow_grains(const RunOptions& options, bool look);
    Real usual_step(const RunOptions& options) const {
        return options.safety * limits().stable_seconds(has_grains_);
    }

    StableStep stable_now(Real most) const;

    Index changed(auto&& change) {
        if (!opened_) throw std::logic_error("Simulation: change the scene instead, before the first run");
        Index found = 0;
        world_->change([&](auto changes) { found = change(changes); });
        limits_.emplace(*world_);
        resumes_ = false;
        return found;
    }

    void prepare(const RunOptions& options);

    /// From a copy: a scene that is refused stays whole, to be asked again.
    void build_world();

    /// One that begins earlier than the solids comes up to them, unless it is stopped; later it may follow.
    void settle_fluid(const RunOptions& options);

    /// Finds the forces at the start, and what is wrong with it.
    void open();

    void do_step(Real t);

    void advance_fluid(Real t) {
        try {
            world_->advance_fluid(t);
        } catch (const FluidError& error) {
            raise(std::string(F::name) + ": " + error.what(), -1);
        }
    }

    void look_for_failure() {
        if (const Failure failure = world_->take_failure(); failure.cause != Failure::Cause::none)
            raise(failure);
    }

    [[noreturn]] void raise(const Failure& failure);
    [[noreturn]] void raise(const std::string& what, Index id) const {
        throw run_error({step_, time_, time_step_}, what, id, last_good_.time);
    }

    void balance();
    void remember();

    using PoliciesOf = Policies<std::conditional_t<ContactPolicy<C>, C, LinearSpring>, B, W, F, D, U>;
    using World = abrade::World<PoliciesOf>;

    std::optional<World> world_;
    Ledger ledger_;
    std::optional<SceneLimits> limits_;
    Snapshot last_good_;
    Real time_ = 0, time_step_ = 0;
    Index step_ = 0, remembered_ = 0, shortened_ = 0;
    bool opened_ = false, stopped_ = false, has_grains_ = false;
    Real wall_seconds_ = 0;
    RunAtWork run_;
    bool resumes_ = false;  ///< that run is to go on
};

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
Index Simulation<C, B, W, F, D, U>::add_stone(Clump clump, const BodyState& state, Real density) {
    const Scene::Stone stone{std::move(clump), density, state};
    return changed([&](auto change) { return change.add(stone); });
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
Index Simulation<C, B, W, F, D, U>::add_sphere(Real radius, const BodyState& state, Real density) {
    require_positive(radius, "Simulation.add_sphere: radius", "m");
    return add_stone(make_clump("sphere", {{Vec3::Zero(), radius}}), state, density);
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
void Simulation<C, B, W, F, D, U>::remove(Index id) {
    changed([&](auto change) { return change.remove(id), id; });
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
Index Simulation<C, B, W, F, D, U>::add_wall(const Vec3& point, const Vec3& normal, Index material) {
    return changed([&](auto change) { return change.add_wall(point, normal, material); });
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
void Simulation<C, B, W, F, D, U>::remove_wall(Index number) {
    changed([&](auto change) { return change.remove_wall(number), number; });
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
void Simulation<C, B, W, F, D, U>::set_gravity(const Vec3& gravity) {
    changed([&](auto change) { return change.set_gravity(gravity), 0; });
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
void Simulation<C, B, W, F, D, U>::let_go(Index id) {
    changed([&](auto change) { return change.let_go(id), id; });
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
void Simulation<C, B, W, F, D, U>::hold(Index id) {
    changed([&](auto change) { return change.hold(id), id; });
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
void Simulation<C, B, W, F, D, U>::build() {
    static_assert(!std::same_as<C, ContactLawIsMissing>, "a simulation needs a contact law");
    if (!world_) build_world();
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
StableStep Simulation<C, B, W, F, D, U>::stable_step_now() const {
    return stable_now(std::numeric_limits<Real>::infinity());
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
bool Simulation<C, B, W, F, D, U>::shorten(const RunOptions& options) {
    const StableStep now = StableStepNow(world_->state()).of_touching(time_step_);
    if (!(now.seconds < time_step_) || now.seconds == 0) return false;
    if (options.time_step > 0) raise({Failure::Cause::step_too_long, now.body, -1, now.seconds});
    time_step_ = share_of_now * now.seconds;
    ++shortened_;
    return true;
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
bool Simulation<C, B, W, F, D, U>::follow_grains(const RunOptions& options, bool look) {
    const auto& state = world_->state();
    if (options.time_step > 0 || !state.sites.stand || (!look && has_grains_)) return false;
    const bool grains = state.has_grains();
    if (std::exchange(has_grains_, grains) == grains) return false;
    time_step_ = usual_step(options);
    return true;
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
StableStep Simulation<C, B, W, F, D, U>::stable_now(Real most) const {
    StableStep step = StableStepNow(world().state()).of_all(most);
    if (world().state().nobody_moves())
        step.lower(limits().stable.seconds, limits().stable.limit);  // of what is to be fed
    return step;
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
void Simulation<C, B, W, F, D, U>::prepare(const RunOptions& options) {
    const Scene& scene = world_ ? world_->scene() : scene_;
    validate(options, time_, scene.gravity.isZero());
    require(options.sleep_speed == 0 || (std::same_as<U, NoForceOnBodies> && scene.moving_walls.empty()),
            {"RunOptions.sleep_speed", "0 where walls move or a force of yours acts on bodies", "m/s",
             "nobody knows when they would have to wake"},
            options.sleep_speed);
    if (!world_) build_world();
    world_->set_skin(limits().skin(options.skin, range_of(contact_), world_->scene()));
    world_->set_free_flight(options.free_flight);
    world_->set_sleep(options.sleep_speed, options.sleep_after);
    stopped_ = false;
    settle_fluid(options);
    if (!opened_) open();
    if (options.time_step > 0) {
        if (stable_now(options.time_step).seconds < options.time_step) {
            const StableStep now = stable_step_now();
            refuse_time_step(options.time_step, now.seconds, now.limit);
        }
        time_step_ = options.time_step;
    } else {
        time_step_ = usual_step(options);
        shorten(options);
    }
    if (!std::isfinite(time_step_)) {  // nothing moves
        const Real left = std::max(options.end_time - time_, 1e-300);
        time_step_ = options.observe_every > 0 ? std::min(options.observe_every, left) : left;
    }
    balance();
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
void Simulation<C, B, W, F, D, U>::build_world() {
    const bool empty = std::same_as<F, NoFluid> && scene_.stones.empty() && !scene_.concrete && !scene_.feed;
    world_.emplace(State<PoliciesOf>(scene_, PoliciesOf{contact_, bond_, wear_, fluid_, drag_, force_}));
    if (empty) {
        world_.reset();
        fail({"Scene.stones", "at least one, or concrete or a feed", "",
              "add_sphere() and add_stone() add bodies"},
             "none");
    }
    this->in_use_ = true;
    limits_.emplace(*world_);
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
void Simulation<C, B, W, F, D, U>::settle_fluid(const RunOptions& options) {
    if constexpr (AdvancingFluid<F>) {
        const auto start = Clock::now();
        while (!stopped_ && fluid_model().time() < time_ && !(ResolvedFluid<F> && opened_)) {
            const Real some = steps_between_checks * fluid_model().stable_step().seconds;
            advance_fluid(std::min(time_, fluid_model().time() + some));
            stopped_ = options.stop && options.stop();
        }
        wall_seconds_ += seconds_since(start);
    }
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
void Simulation<C, B, W, F, D, U>::open() {
    world_->open(time_);
    if (const Failure failure = world_->take_failure(); failure.cause == Failure::Cause::overlap) {
        const std::string what = "Scene: overlap of " + name_of(world_->particles(), failure.body) +
                                 " with " + name_of(world_->particles(), failure.other);
        world_.reset(), this->in_use_ = false;
        require(false,
                {what, "at most " + to_text(100 * World::overlap_limit) + " % of the smaller radius", "%",
                 "move them apart"},
                100 * failure.measure);
    }
    remember();
    opened_ = true;
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
void Simulation<C, B, W, F, D, U>::do_step(Real t) {
    if (step_ - remembered_ >= steps_between_snapshots) remember();
    advance_fluid(t + time_step_);
    world_->step(t, time_step_, step_ % steps_between_checks == 0);
    ++step_;
    time_ = t + time_step_;
    look_for_failure();
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
void Simulation<C, B, W, F, D, U>::raise(const Failure& failure) {
    world_->publish_places();
    FailureMessage message{.failure = failure,
                           .particles = particles(),
                           .time_step = time_step_,
                           .overlap_limit = World::overlap_limit,
                           .stable = StableStepNow(world_->state()).of_touching(time_step_).seconds};
    if (failure.cause == Failure::Cause::overlap && !failure.bonded)
        message.remedy =
            ImpactInquiry(law_between(world_->state().policies.contact, failure.contact.materials),
                          failure.contact, time_step_, World::overlap_limit)
                .remedy();
    raise(message.text(), particles().id[static_cast<std::size_t>(failure.body)]);
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
void Simulation<C, B, W, F, D, U>::balance() {
    ledger_ = world_->publish();
    look_for_failure();
}

template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
void Simulation<C, B, W, F, D, U>::remember() {
    world_->publish();
    look_for_failure();
    renew_snapshot(last_good_, world_->particles(), world_->concrete(), time_, step_);
    remembered_ = step_;
}

/// Starts a simulation; fill the slots, then run.
inline Simulation<> simulate(Scene scene) {
    return {std::move(scene), {}, NoBond{}, NoWear{}, NoFluid{}, NoDrag{}, NoForceOnBodies{}};
}

}  // namespace abrade
