// Bodies as heavy as the water in a slow shear: a sphere turns at half its rate (gate of the reference: 2 %),
// a spheroid of aspect 2 in Jeffery's period (5 % on 16 cells). docs/verification/resolved_bodies.md has the
// table.
#include "shear_flow.hpp"

#include <doctest/doctest.h>

using namespace shear_flow;

TEST_CASE("a sphere turns at half the rate of the shear") {
    for (const Real cells : {4.0, 8.0}) {
        const Real spin = spin_at(0, 1, {.cells = cells});
        MESSAGE(cells << " cells: " << 100 * (spin / 0.5 - 1) << " % off");
        CHECK(std::abs(spin / 0.5 - 1) < 0.01);  // the box's walls and the next spheres take some of it
    }
}

TEST_CASE("the period of a spheroid by the spins that it takes up at four angles") {
    for (const ReferenceRow& row : reference_table("cpl08_jeffery_orbit_analytic.csv")) {
        if (row.at("aspect_ratio") != 2) continue;
        const Real period = period_by_spins(2, {.cells = 8}), exact = row.at("T_times_G");
        MESSAGE("8 cells to its length: " << 100 * (period / exact - 1) << " % off");
        CHECK(std::abs(period / exact - 1) < 0.04);
    }
}
