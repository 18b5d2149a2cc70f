// A sphere that goes slowly towards a wall, from 4 cells to less than one from it, against H. Brenner 1961.
// The reference's gate is 10 % down to a gap of 2 to 3 cells. docs/verification/resolved_bodies.md has the
// table.
#include "wall_approach.hpp"

#include <doctest/doctest.h>

using namespace wall_approach;

TEST_CASE("drag of a sphere that goes towards a wall, 8 cells to its diameter") {
    for (const ReferenceRow& row : reference_table("cpl10_brenner_wall_approach.csv")) {
        const Real gap = row.at("gap_over_radius"), exact = row.at("lambda_Brenner");
        if (gap > 1 || gap < 0.1) continue;
        const ApproachDrag drag = drag_in({.gap = gap, .cells = 8, .box = 4, .time = 0.4});
        const Real off = drag.factor / exact - 1, with_film = off + film_at(gap, 8) / exact;
        MESSAGE("a gap of " << 4 * gap << " cells: " << 100 * off << " %, with the film below the grid "
                            << 100 * with_film << " %");
        CHECK(std::abs(drag.unsteady) < 0.02);
        CHECK(std::abs(with_film) < (gap == 1 ? 0.05 : 0.1));  // the box adds 2 and 1 %
        if (gap < 0.5) CHECK(off < -0.2);                      // so the film is needed
    }
}
