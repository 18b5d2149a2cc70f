#pragma once
// How a run is asked for, and what it throws when it goes wrong.

#include <abrade/core/fields.hpp>
#include <abrade/core/require.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

namespace abrade {

/// A run that went wrong: caught in the step where it arose. `Simulation::last_good()` holds the last state
/// known to be sound.
struct RunError : std::runtime_error {
    RunError(const std::string& what, Index step_, Real time_, Index id_)
        : std::runtime_error(what), step(step_), time(time_), id(id_) {}
    Index step;  ///< in which it arose
    Real time;   ///< [s]
    Index id;    ///< of the body; -1: it is the fluid
};

/// Where a run is.
struct RunTime {
    Index step = 0;
    Real time = 0, time_step = 0;  ///< [s]
};

/// How far a run goes, in which steps, and when it is looked at.
struct RunOptions {
    Real end_time = std::numeric_limits<Real>::quiet_NaN();  ///< [s]; must be given
    /// [s]; at most `Simulation::stable_step_now()`. 0: `safety` times the stable step of dense surroundings,
    /// and shorter where contacts as they stand need it. A run is divided into whole steps, so that the last
    /// ends at `end_time`: either step is shortened slightly where the run is no multiple of it.
    Real time_step = 0;
    Real safety = 0.5;       ///< share of the stable step that is taken [-]
    Real observe_every = 0;  ///< [s]; 0: at the start and at the end only
    Real skin = 0;           ///< of the neighbour list [m]; 0: a quarter of the smallest radius
    /// Whether bodies that nothing can touch soon take their steps as one: faster where most fly. The same
    /// but for round-off for spheres under their weight; to second order for clumps and in a fluid.
    bool free_flight = true;
    /// Bodies slower than this, centre and rim, that touch something are put to sleep: they take no steps
    /// until something stirs them [m/s]. 0: never. What they still move with is the ledger's `lost_asleep`.
    Real sleep_speed = 0;
    /// How long they must have been that slow [s]. 0: the longer of 200 sleep_speed / g, twice as long as a
    /// hundredth of gravity takes to make them faster, and of 2 sqrt(d/g), twice as long as their diameter d
    /// takes to topple.
    Real sleep_after = 0;
    /// Asked now and then between steps, while a fluid settles too; true ends the run cleanly. The place to
    /// save the simulation from (io/restart.hpp).
    std::function<bool()> stop{};

    static void fields(auto&& field) {
        field("end_time", "s", &RunOptions::end_time), field("time_step", "s", &RunOptions::time_step),
            field("safety", &RunOptions::safety), field("observe_every", "s", &RunOptions::observe_every),
            field("skin", "m", &RunOptions::skin), field("free_flight", &RunOptions::free_flight),
            field("sleep_speed", "m/s", &RunOptions::sleep_speed),
            field("sleep_after", "s", &RunOptions::sleep_after);
    }
    bool asks_the_same_as(const RunOptions& other) const {
        Same same{*this, other};
        fields(same);
        return same.so_far;
    }

private:
    struct Same {
        const RunOptions &one, &other;
        bool so_far = true;
        void operator()(std::string_view /*name*/, auto member) {
            so_far = so_far && one.*member == other.*member;
        }
        void operator()(std::string_view name, std::string_view /*unit*/, auto member) {
            (*this)(name, member);
        }
    };
};

/// A run at work: how it was asked for, and how far it is.
struct RunAtWork {
    RunOptions options{};
    Real begun = 0;             ///< when its steps were counted last [s]
    Real next_observation = 0;  ///< [s]
    Index steps = 0, done = 0;  ///< from then on
    bool under_way = false;

    static void fields(auto&& field) {
        field("options", &RunAtWork::options), field("begun", "s", &RunAtWork::begun),
            field("next_observation", "s", &RunAtWork::next_observation), field("steps", &RunAtWork::steps),
            field("done", &RunAtWork::done), field("under_way", &RunAtWork::under_way);
    }
};

/// Throws InputError: a step that was asked for is longer than `stable`, which `limit` sets [s].
[[noreturn]] inline void refuse_time_step(Real asked, Real stable, std::string_view limit) {
    fail({"RunOptions.time_step",
          "at most the stable step of " + to_text(stable) + " s (" + std::string(limit) + ")", "s",
          "take a smaller step, softer springs or heavier spheres"},
         to_text(asked));
}

/// Throws InputError for what cannot be asked for `now` [s].
inline void validate(const RunOptions& options, Real now, bool weightless) {
    if (std::isnan(options.end_time))
        fail({"RunOptions.end_time", "given", "", "run({.end_time = 1}) goes on to 1 s from the start"},
             "none");
    require(std::isfinite(options.end_time) && options.end_time >= now,
            {"RunOptions.end_time", "finite and not before now (" + to_text(now) + " s)", "s",
             "end times count from the start of the simulation"},
            options.end_time);
    require(options.safety > 0 && options.safety <= 1,
            {"RunOptions.safety", "in (0, 1]", "", "it is a share of the stable step; 0.5 is common"},
            options.safety);
    require_not_negative(options.observe_every, "RunOptions.observe_every", "s");
    require_not_negative(options.time_step, "RunOptions.time_step", "s");
    require_not_negative(options.skin, "RunOptions.skin", "m");
    require_not_negative(options.sleep_speed, "RunOptions.sleep_speed", "m/s");
    require_not_negative(options.sleep_after, "RunOptions.sleep_after", "s");
    require(options.sleep_speed == 0 || options.sleep_after > 0 || !weightless,
            {"RunOptions.sleep_after", "> 0 where bodies may sleep and there is no gravity", "s",
             "say how long a body is slow before it sleeps"},
            options.sleep_after);
}

}  // namespace abrade
