#pragma once
// What contacts allow as they stand, held against whether disturbances grow.

#include "../../bench/charts/stable_limit.hpp"

#include <doctest/doctest.h>

namespace abrade::charts {

/// A step just below what contacts allow as they stand is stable, one of `above` times that is not.
template <class C>
void check_limits_of(const std::string& name, const Bed& bed, const C& law, Real above) {
    const Real now = Shaken<C>(bed, law).predicted();
    CAPTURE(name);
    CAPTURE(describe(law));
    CAPTURE(now);
    CHECK(!Shaken<C>(bed, law).grows(0.98 * now, 1000));
    CHECK(Shaken<C>(bed, law).grows(above * now, 1000));
}

/// With and without damping and friction. The bound is exact for a pair and a long row; else a body that
/// moves alone is unstable at sqrt(2) times the step found, and at twice that with damping. Dashpots of e =
/// 0.1 that may not pull hide a small excess.
inline void check_limits(const std::string& name, const Bed& bed, auto law, bool exact = false) {
    for (const Real restitution : {1.0, 0.5, 0.1})
        for (const Real friction : {0.0, 1e6})
            check_limits_of(name, bed, law(restitution, friction),
                            exact              ? (restitution < 0.5 ? 1.15 : 1.03)
                            : restitution == 1 ? 1.02 * std::sqrt(2.0)
                                               : 2.02);
}

}  // namespace abrade::charts
