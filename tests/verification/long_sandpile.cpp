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

