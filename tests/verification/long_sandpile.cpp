// The published pile of 3000 discs: docs/verification/sandpile.md. Some minutes for each model.
#include "reference_table.hpp"
#include "sandpile.hpp"

#include <doctest/doctest.h>

using namespace sandpile;

namespace {

/// Of a published curve, at the time nearest to t [s].
Real published(const std::string& model, Real t) {
    Real height = 0, nearest = 1e300;
    for (const auto& row : reference_table("dem13_sandpile_height_rolling_friction.csv"))
        if (row.is("model", model) && std::abs(row.at("t_s") - t) < nearest)
            nearest = std::abs(row.at("t_s") - t), height = row.at("height_m");
    return height;
}

Real height_at(const Run& run, Real t) {
    std::size_t n = 0;
    while (n + 1 < run.time.size() && run.time[n] < t - 1e-9) ++n;
    return run.height[n];
}

}  // namespace

TEST_CASE("spring, dashpot and slider: the pile stands; constant torque: it is lower and sinks") {
    const Run holds = pour({}, 16.5, 0.1);
    const Real height = height_at(holds, 21), drift = height / height_at(holds, 11) - 1;
    const Real error = height / published("epsd_model", 20) - 1;
    MESSAGE("height " << height << " m, " << 100 * error << " % off the published one; drift over 10 s "
                      << 100 * drift << " %");
    CHECK(std::abs(drift) < 0.01);
    CHECK(holds.off_plane == 0);
    CHECK(holds.residual < 1e-12);
    // The published height within 5 %: not reached, nor by Lethe; docs/verification/sandpile.md says by how
    // much and what was tried.
    WARN(std::abs(error) < 0.05);

    const Run sinks = pour({.model = Law::Model::constant_torque}, 16.5, 0.1);
    CHECK(sinks.height.back() < holds.height.back());
    CHECK(height_at(sinks, 21) < height_at(sinks, 11));
    MESSAGE("constant torque: " << sinks.height.back() << " m; published "
                                << published("constant_model", 19.7) << " m");
}
