// Bodies as heavy as the water in a slow shear, on finer grids, with walls farther off, and a whole turn:
// the table of docs/verification/resolved_bodies.md.
#include "shear_flow.hpp"

#include <doctest/doctest.h>

using namespace shear_flow;

TEST_CASE("a sphere turns at half the rate of the shear, wherever it is") {
    for (const Shear& shear :
         {Shear{.cells = 4}, Shear{.cells = 4, .off = {0, 0, 0}}, Shear{.cells = 4, .off = {0.5, 0.5, 0.5}},
          Shear{.cells = 4, .box = 10, .width = 6}, Shear{.cells = 6}, Shear{.cells = 8},
          Shear{.cells = 12}}) {
        const Real spin = spin_at(0, 1, shear);
        MESSAGE(shear.cells << " cells, box " << shear.box << ", " << shear.off.x()
                            << " off: " << 100 * (spin / 0.5 - 1) << " %");
        CHECK(std::abs(spin / 0.5 - 1) < 0.01);
    }
}

TEST_CASE("the period of spheroids") {
    for (const ReferenceRow& row : reference_table("cpl08_jeffery_orbit_analytic.csv")) {
        const Real aspect = row.at("aspect_ratio"), exact = row.at("T_times_G");
        if (aspect < 2 || aspect > 3) continue;
        for (const Real cells : {8.0, 12.0, 16.0}) {
            const Shear shear{.cells = cells, .box = 4, .width = 3};
            const Real period = period_by_spins(aspect, shear);
            MESSAGE("aspect " << aspect << ", " << cells
                              << " cells to its length, by spins: " << 100 * (period / exact - 1) << " %");
            CHECK(std::abs(period / exact - 1) < (aspect < 3 ? 0.04 : 0.12));
        }
        const Real period = period_of_turn(aspect, {.cells = 8, .box = 4, .width = 3, .rate = 1});
        MESSAGE("aspect " << aspect << ", 8 cells, a whole turn: " << 100 * (period / exact - 1) << " %");
        CHECK(std::abs(period / exact - 1) < (aspect < 3 ? 0.04 : 0.12));
    }
}
