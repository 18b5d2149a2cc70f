#pragma once
// How long steps have been of late.

#include <abrade/core/types.hpp>

#include <algorithm>
#include <cmath>

namespace abrade::detail {

/// How long the last step was, and the longest, less the time that has gone by since [s].
struct StepHistory {
    Real last = 0, longest = 0;

    static void fields(auto&& field) {
        field("last", "s", &StepHistory::last), field("longest", "s", &StepHistory::longest);
    }
    /// Before the first: what it may be; infinite where nothing moves.
    void expect(Real dt) noexcept { longest = std::isfinite(dt) ? dt : 0; }
    void took(Real dt) noexcept { last = dt, longest = std::max(dt, longest - dt); }
    /// Too short beside them to tell how the flow goes on.
    bool is_sub_step(Real dt) const noexcept { return dt < 0.2 * longest; }
    /// What pushed within the last step would push too much in this one: but for the water's weight, only as
    /// large an impulse is taken on.
    bool grows(Real dt) const noexcept { return last > 0 && dt > (is_sub_step(dt) ? 1 : 1.1) * last; }
    /// In which a step drives out what cells hold too much: what a long one left, no short one [s].
    Real relaxation_time(Real dt) const noexcept { return dt < 0.5 * longest ? longest : dt; }
};

}  // namespace abrade::detail
