// Columns of water run against a wall: finer grids, three dimensions, and what the walls' friction does.
#include "dam_impact.hpp"

#include <doctest/doctest.h>

using namespace dam_impact;

namespace {

template <int Dim>
Impact report(const Tank& tank, const std::string& name, GridFluid<Dim> flow) {
    const std::vector<Sample> seen = run(tank, flow, last_time);
    const Impact here = impact(tank, seen), there = impact(tank, measured(tank));
    const Real u = front_speed(tank, seen);
    MESSAGE(
        name << ": arrival " << 100 * (here.arrival / there.arrival - 1) << " %, first peak "
             << here.first.height / there.first.height << " of the measured one, mean from T = 3.5 to 5 "
             << here.plateau / there.plateau << ", second peak " << here.second.height / there.second.height
             << ", later by " << 100 * (here.second.time / there.second.time - 1) << " %; front " << u
             << " sqrt(g H), u^2 / 2g = " << 0.5 * u * u << " H, run-up " << largest_run_up(seen) << " H");
    return {.arrival = here.arrival / there.arrival,
            .first = {here.first.height / there.first.height, 1},
            .plateau = here.plateau / there.plateau,
            .second = {here.second.height / there.second.height, here.second.time / there.second.time}};
}

void all_walls(const Tank& tank) {
    for (const int n : {20, 40, 80}) {
        report(tank, std::to_string(n) + " cells, slip", dam<2>(tank, n));
        for (const Real roughness : {0.0, 2e-5, 2e-4})
            report(tank, std::to_string(n) + " cells, roughness " + std::to_string(1000 * roughness) + " mm",
                   dam_between_rough_walls(tank, n, roughness));
    }
}

}  // namespace

TEST_CASE("Lobovsky") { all_walls(lobovsky); }
TEST_CASE("Lobovsky 3D") { report(lobovsky, "20 cells in three dimensions", dam<3>(lobovsky, 20)); }
TEST_CASE("Buchner") { all_walls(buchner); }
TEST_CASE("Buchner 3D") { report(buchner, "20 cells in three dimensions", dam<3>(buchner, 20)); }
