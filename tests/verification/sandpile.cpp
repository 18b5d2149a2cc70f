// A small pile of discs from a hopper; the published one is in long_sandpile.cpp.
#include "sandpile.hpp"

#include <doctest/doctest.h>

using namespace sandpile;

TEST_CASE(
    "a pile with elastic-plastic resistance to rolling stands still; with constant torque it never does") {
    Pile small{.discs = 200, .lengths = 0.27};
    const auto height_at = [](const Run& run, Real t) {
        std::size_t n = 0;
        while (n + 1 < run.time.size() && run.time[n] < t) ++n;
        return run.height[n];
    };
    const Run holds = pour(small, 3, 0.25);
    small.model = Law::Model::constant_torque;
    const Run creeps = pour(small, 3, 0.25);
    CHECK(std::abs(holds.height.back() / height_at(holds, gate_opens + 2) - 1) < 0.001);
    CHECK(creeps.kinetic > 1e6 * holds.kinetic);  // how high a small pile is, is chance
    for (const Run& run : {holds, creeps}) {
        CHECK(run.off_plane == 0);
        CHECK(run.residual < 1e-12);
        CHECK(run.lost_rolling > 0.1 * run.lost);
        CHECK(std::abs(run.integration_residue) < 0.05 * run.lost);
    }
    MESSAGE("heights " << holds.height.back() << " and " << creeps.height.back() << " m after " << holds.steps
                       << " steps; kinetic energy " << holds.kinetic << " and " << creeps.kinetic << " J");
}
