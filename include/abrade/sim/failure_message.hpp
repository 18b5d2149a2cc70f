#pragma once
// What is wrong with a step, in words, and what would have been enough. Knows no laws: what only they can
// tell is found out before (sim/guards/impact.hpp, sim/guards/stability.hpp).

#include <abrade/dem/store/particles.hpp>
#include <abrade/sim/guards/failure.hpp>
#include <abrade/sim/run_options.hpp>

#include <string>
#include <string_view>

namespace abrade {

/// "stone with id 7"; of wall w, number -1 - w, "Scene.walls[w]".
inline std::string name_of(const Particles& particles, Index body) {
    if (body < 0) return "Scene.walls[" + std::to_string(-1 - body) + "]";
    static constexpr std::string_view kinds[] = {"stone", "concrete sphere", "concrete grain",
                                                 "fixed sphere"};
    const auto b = static_cast<std::size_t>(body);
    return std::string(kinds[static_cast<std::size_t>(particles.kind[b])]) + " with id " +
           std::to_string(particles.id[b]);
}

/// A failure in its surroundings.
struct FailureMessage {
    const Failure& failure;
    const Particles& particles;  ///< their places published
    Real time_step = 0;          ///< [s]
    Real overlap_limit = 0;      ///< of the smaller radius [-]
    ImpactRemedy remedy{};       ///< of a contact that is too deep
    Real stable = 0;             ///< what contacts, as they stand, are stable up to [s]; 0: nothing touches

    std::string text() const {
        std::string found = what();
        if (failure.cause != Failure::Cause::step_too_long && stable > 0 && stable < time_step)
            found += "; the step was above " + short_text(stable) + " s, which is stable";
        return found;
    }

private:
    std::string what() const {
        using Cause = Failure::Cause;
        const std::string who = name_of(particles, failure.body), where = place();
        switch (failure.cause) {
            case Cause::step_too_long:
                return "contacts of " + who + ", as they stand, are stable up to a step of " +
                       short_text(failure.measure) + " s, " + where +
                       "; take a smaller step or softer springs";
            case Cause::lost:
                return who + " left the world's bounds, " + where;
            case Cause::overlap:
                return who + " overlaps " + name_of(particles, failure.other) + " by " +
                       short_text(100 * failure.measure) + " % of the smaller radius (limit " +
                       short_text(100 * overlap_limit) + " %), " + where + "; " + what_helps();
            case Cause::long_stride:
                return who + " moves " + short_text(failure.measure) +
                       " of its radius in a step and could pass through others unseen, " + where +
                       "; take a step of at most " + short_text(0.999 * time_step / failure.measure) + " s";
            case Cause::outran_period:
                return who +
                       " is so fast that neighbour lists would need a skin wider than the periodic axes "
                       "have room for, " +
                       where + "; widen Scene.bounds or take a smaller step";
            default:
                return "velocity of " + who + " is not finite or beyond 10 km/s, " + where;
        }
    }

    std::string place() const {
        const auto b = static_cast<std::size_t>(failure.body);
        const Vec3& x = particles.position[b];
        return "x = (" + short_text(x.x()) + ", " + short_text(x.y()) + ", " + short_text(x.z()) +
               ") m, speed " + short_text(particles.velocity[b].norm()) + " m/s";
    }

    /// What would have kept the two apart.
    std::string what_helps() const {
        if (failure.bonded) return "stiffer bonds or a smaller load are needed";
        if (remedy.met_at == 0) return "something presses them together: stiffer springs are needed";
        const std::string met = "they met at " + short_text(remedy.met_at) + " m/s along their normal: ";
        if (remedy.time_step > 0)
            return met + "a time step of " + short_text(0.999 * remedy.time_step) +
                   " s would have been enough: then they reach " + short_text(100 * remedy.deepest) + " %";
        return met + "no time step is enough, alone they reach " + short_text(100 * remedy.deepest) +
               " %; springs " + short_text(1.001 * remedy.times_as_stiff) +
               " times as stiff would have been, with a step of " +
               short_text(time_step / std::sqrt(remedy.times_as_stiff)) + " s, or a speed of " +
               short_text(0.999 * remedy.speed) + " m/s";
    }
};

/// What a run that went wrong throws; `last_good`: time of the last good state [s].
inline RunError run_error(const RunTime& now, const std::string& what, Index id, Real last_good) {
    return {"step " + std::to_string(now.step) + " (t = " + short_text(now.time) +
                " s, dt = " + short_text(now.time_step) + " s): " + what +
                "; the last good state is that of t = " + short_text(last_good) + " s",
            now.step, now.time, id};
}

}  // namespace abrade
