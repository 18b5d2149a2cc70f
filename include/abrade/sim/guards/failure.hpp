#pragma once
// What a step reports beside the ledger: what is wrong with it, and how long it took.

#include <abrade/sim/guards/impact.hpp>

#include <algorithm>
#include <chrono>

namespace abrade {

/// What the engine finds wrong with a step.
struct Failure {
    enum class Cause : std::uint8_t {
        none,
        not_finite,
        lost,
        overlap,
        long_stride,
        outran_period,
        step_too_long
    };
    Cause cause = Cause::none;
    Index body = -1, other = -1;  ///< bodies; wall w is -1 - w
    Real measure = 0;       ///< overlap over the smaller radius, stride over radius [-]; a stable step [s]
    bool bonded = false;    ///< the two are held by a bond, not by a contact
    DeepContact contact{};  ///< where it was one that overlapped
};

/// Wall time of parts of a step [s], summed over threads.
struct StepSeconds {
    Real contacts = 0, bonds = 0, motion = 0;
    static void fields(auto&& field) {
        field("contacts", "s", &StepSeconds::contacts), field("bonds", "s", &StepSeconds::bonds),
            field("motion", "s", &StepSeconds::motion);
    }
    StepSeconds& operator+=(const StepSeconds& o) noexcept {
        return contacts += o.contacts, bonds += o.bonds, motion += o.motion, *this;
    }
};

/// Shares of wall time [-]: contacts with their wear; bonds; motion with what the fluid does to it; renewal
/// of lists; a fluid that changes.
struct TimeShares {
    Real contacts = 0, bonds = 0, motion = 0, renewal = 0, fluid = 0;
};

/// `timed`: seconds of the parts of some steps; what renewal and fluid leave of the wall time goes by their
/// shares.
inline TimeShares shares_of(Real wall, const StepSeconds& timed, Real renewal, Real fluid) noexcept {
    const Real all = timed.contacts + timed.bonds + timed.motion;
    if (!(all > 0 && wall > 0)) return {};
    const Real share = std::max(0.0, wall - renewal - fluid) / all / wall;
    return {share * timed.contacts, share * timed.bonds, share * timed.motion, renewal / wall, fluid / wall};
}

/// Reads the clock in some steps only: it would cost small scenes dear.
struct Stopwatch {
    using Clock = std::chrono::steady_clock;
    explicit Stopwatch(bool on) : running(on), last(on ? Clock::now() : Clock::time_point{}) {}
    bool running;
    Clock::time_point last;
    void lap(Real& total) {
        if (!running) return;
        const auto now = Clock::now();
        total += std::chrono::duration<Real>(now - last).count();
        last = now;
    }
};

}  // namespace abrade
