// A sphere that settles in wide still water at Re 41, over cells to its diameter: the table of
// docs/verification/resolved_bodies.md. The reference's gates are 2 % of its speed and 10 % of tau95 on 16
// cells.
#include "settling_in_water.hpp"

#include <doctest/doctest.h>

using namespace settling_in_water;

TEST_CASE("Mordant & Pinton, case 1, over cells to the diameter") {
    const ReferenceRow row = reference_table("cpl04_mordant_pinton2000_case1.csv").front();
    for (const Real cells : {3.0, 4.0, 6.0, 8.0}) {
        const Settled settled = settle(row, cells);
        const Real speed = settled.speed / row.at("Vs_mps") - 1, tau = settled.tau95 / row.at("tau95_s") - 1;
        MESSAGE(cells << " cells: speed " << 100 * speed << " %, tau95 " << 100 * tau << " % off; 95 % at "
                      << settled.at_95 << " s");
        CHECK(std::abs(speed) < 0.022);
        CHECK(std::abs(tau) < (cells < 4 ? 0.22 : cells < 6 ? 0.14 : 0.1));
    }
}
