#pragma once
// What a scene, as it begins, allows: how long a step, how wide lists, how short a period.

#include <abrade/sim/engine/world.hpp>
#include <abrade/sim/failure_message.hpp>
#include <abrade/sim/guards/stability.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace abrade {

class SceneLimits {
public:
    template <class P>
    explicit SceneLimits(const World<P>& world)
        : stable(stable_step(world.state().policies.contact, world.state().policies.bond, world.particles(),
                             world.network(), world.scene().feed)),
          standing_(world.state().sites.stand ? world.concrete().lattice().radius : 0),
          period_(world.particles(), world.scene().feed, standing_) {
        who_ = stable.limit;
        if (stable.body >= 0) who_ += ", " + name_of(world.particles(), stable.body);
        const auto& radius = world.particles().radius;
        smallest_ = radius.empty() ? 0.01 : *std::min_element(radius.begin(), radius.end());
        if (standing_ == 0) return;
        smallest_ = std::min(smallest_, standing_);
        const Real mass = world.scene().concrete->density * 4.0 / 3 * pi * cube(standing_);
        loose_ = world.state().policies.contact.stable_dt(mass, standing_);
    }

    StableStep stable;  ///< of dense surroundings

    /// The same with grains of standing concrete that were let go, or without [s].
    Real stable_seconds(bool grains) const noexcept {
        return grains ? std::min(stable.seconds, loose_) : stable.seconds;
    }
    /// Of the neighbour list: what is asked for, or a quarter of the smallest radius [m]. Throws InputError
    /// where a period has no room for it.
    /// `range`: from which on the contact law acts [m].
    Real skin(Real asked, Real range, const Scene& scene) const {
        const Real skin = asked > 0 ? asked : 0.25 * smallest_;
        period_.check(scene, skin + 2 * range);
        return skin;
    }
    /// From `taken` steps so far, how many of `dt` [s] there are to go. Throws InputError where they cannot
    /// be counted.
    Index steps(Real left, Real dt, Index taken) const {
        constexpr Real most = std::numeric_limits<Index>::max();
        const Real steps = left > 0 ? std::max(std::ceil(left / dt - 1e-9), 1.0) : 0;
        require(static_cast<Real>(taken) + steps < most,
                {"RunOptions.end_time over the time step: steps", "fewer than " + to_text(most), "",
                 "run for a shorter time, or with a larger step than " + short_text(dt) +
                     " s; stable: " + short_text(stable.seconds) + " s, set by " + who_},
                steps);
        return static_cast<Index>(steps);
    }

private:
    Real standing_;  ///< radius of spheres that stand [m]; 0: there are none
    PeriodNeed period_;
    std::string who_;                                     ///< sets `stable`
    Real smallest_ = 0;                                   ///< radius of a sphere [m]
    Real loose_ = std::numeric_limits<Real>::infinity();  ///< stable step of a grain [s]
};

}  // namespace abrade
