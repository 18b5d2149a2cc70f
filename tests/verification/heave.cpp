// A floating sphere's period of heave, on 4 and 6 cells to its diameter: the reference's gate is 10 %.
// docs/verification/resolved_bodies.md has the table.
#include "heave.hpp"

#include <doctest/doctest.h>

using namespace heave;

TEST_CASE("a sphere of half the water's density heaves with its added mass") {
    for (const ReferenceRow& row : reference_table("cpl09_floating_sphere_archimedes.csv")) {
        if (row.at("density_ratio") != 0.5) continue;
        for (const Real cells : {4.0, 6.0}) {
            const Heave found = heave_of(0.5, cells, cells < 6 ? 0.8 : 0.2);
            MESSAGE(cells << " cells: period " << found.period << ", with added mass " << period_of(row)
                          << " sqrt(R / g); " << found.decay << " of an amplitude is left after half of it");
            CHECK(std::abs(found.period / period_of(row) - 1) < 0.1);
            CHECK(found.decay < 0.9);  // waves take energy along
            CHECK(found.decay > 0.5);
        }
    }
}
