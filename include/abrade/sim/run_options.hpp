#pragma once
// How a run is asked for, and what it throws when it goes wrong.

#include <abrade/core/require.hpp>

#include <cmath>
#include <functional>
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

/// How far a run goes, in which steps, and when it is looked at.
struct RunOptions {
    Real end_time = 0;  ///< [s]
    /// [s]; at most `Simulation::stable_step_now()`. 0: `safety` times the stable step of dense surroundings,
    /// and shorter where contacts as they stand need it.
    Real time_step = 0;
    Real safety = 0.5;       ///< share of the stable step that is taken [-]
    Real observe_every = 0;  ///< [s]; 0: at the start and at the end only
    Real skin = 0;           ///< of the neighbour list [m]; 0: a quarter of the smallest radius
    /// Whether bodies that nothing can touch soon take their steps as one: faster where most fly. The same but
    /// for round-off for spheres under their weight; to second order for clumps and in a fluid.
    bool free_flight = true;
    /// Bodies slower than this, centre and rim, that touch something are put to sleep: they take no steps
    /// until something stirs them [m/s]. 0: never. What they still move with is the ledger's `lost_asleep`.
    Real sleep_speed = 0;
    /// How long they must have been that slow [s]. 0: until a hundredth of gravity would have made them
    /// faster, 200 sleep_speed / g, and twice as long as their diameter d takes to topple, 2 sqrt(d/g).
    Real sleep_after = 0;
    /// Asked now and then, while a fluid settles too; true ends the run cleanly.
    std::function<bool()> stop{};
};

/// Throws InputError for what cannot be asked for `now` [s].
inline void validate(const RunOptions& options, Real now, bool weightless) {
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
