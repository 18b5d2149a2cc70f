#pragma once
// What is wrong with a step, in words, and what would have been enough.

#include <abrade/sim/engine/world.hpp>
#include <abrade/sim/guards/stability.hpp>

#include <string>

namespace abrade {

/// Says of a failure which body is the reason, where, and what helps. `world` must have its places published.
template <class World>
class FailureMessage {
public:
    FailureMessage(const World& world, Real time_step) : world_(world), time_step_(time_step) {}

    std::string name_of(Index body) const {
        if (body < 0) return "Scene.walls[" + std::to_string(-1 - body) + "]";
        static constexpr std::string_view kinds[] = {"stone", "concrete sphere", "concrete grain",
                                                     "fixed sphere"};
        const Particles& p = world_.particles();
        const auto b = static_cast<std::size_t>(body);
        return std::string(kinds[static_cast<std::size_t>(p.kind[b])]) + " with id " +
               std::to_string(p.id[b]);
    }

    std::string of(const Failure& failure) const {
        using Cause = Failure::Cause;
        const std::string who = name_of(failure.body), where = place_of(failure.body);
        std::string text;
        switch (failure.cause) {
            case Cause::step_too_long:
                return "contacts of " + who + ", as they stand, are stable up to a step of " +
                       short_text(failure.measure) + " s, " + where +
                       "; take a smaller step or softer springs";
            case Cause::lost:
                text = who + " left the world's bounds, " + where;
                break;
            case Cause::overlap:
                text = who + " overlaps " + name_of(failure.other) + " by " +
                       short_text(100 * failure.measure) + " % of the smaller radius (limit " +
                       short_text(100 * World::overlap_limit) + " %), " + where + "; " + remedy(failure);
                break;
            case Cause::long_stride:
                text = who + " moves " + short_text(failure.measure) +
                       " of its radius in a step and could pass through others unseen, " + where +
                       "; take a step of at most " + short_text(0.999 * time_step_ / failure.measure) + " s";
                break;
            case Cause::outran_period:
                text = who +
                       " is so fast that neighbour lists would need a skin wider than the periodic axes "
                       "have room for, " +
                       where + "; widen Scene.bounds or take a smaller step";
                break;
            default:
                text = "velocity of " + who + " is not finite or beyond 10 km/s, " + where;
                break;
        }
        const auto now = StableStepNow(world_.state()).of_touching(time_step_);
        if (now.seconds > 0 && now.seconds < time_step_)
            text += "; the step was above " + short_text(now.seconds) + " s, which is stable";
        return text;
    }

private:
    std::string place_of(Index body) const {
        const auto b = static_cast<std::size_t>(body);
        const Vec3& x = world_.particles().position[b];
        return "x = (" + short_text(x.x()) + ", " + short_text(x.y()) + ", " + short_text(x.z()) +
               ") m, speed " + short_text(world_.particles().velocity[b].norm()) + " m/s";
    }

    /// What would have kept the two apart.
    std::string remedy(const Failure& failure) const {
        if (failure.bonded) return "stiffer bonds or a smaller load are needed";
        const auto& law = law_between(world_.state().policies.contact, failure.contact.materials);
        const auto found = ImpactInquiry(law, failure.contact, time_step_, World::overlap_limit).remedy();
        if (found.met_at == 0) return "something presses them together: stiffer springs are needed";
        const std::string met = "they met at " + short_text(found.met_at) + " m/s along their normal: ";
        if (found.time_step > 0)
            return met + "a time step of " + short_text(0.999 * found.time_step) +
                   " s would have been enough: then they reach " + short_text(100 * found.deepest) + " %";
        return met + "no time step is enough, alone they reach " + short_text(100 * found.deepest) +
               " %; springs " + short_text(1.001 * found.times_as_stiff) +
               " times as stiff would have been, with a step of " +
               short_text(time_step_ / std::sqrt(found.times_as_stiff)) + " s, or a speed of " +
               short_text(0.999 * found.speed) + " m/s";
    }

    const World& world_;
    Real time_step_;
};

}  // namespace abrade
