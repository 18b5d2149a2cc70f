// A floating sphere's period of heave over cells to its diameter and the length of steps: the table of
// docs/verification/resolved_bodies.md. The reference's gate is 10 %.
#include "heave.hpp"

#include <doctest/doctest.h>

using namespace heave;

TEST_CASE("the period of heave over cells and steps") {
    struct Case {
        Real cells, off, step;
    };
    for (const ReferenceRow& row : reference_table("cpl09_floating_sphere_archimedes.csv")) {
        if (row.at("density_ratio") != 0.5) continue;
        for (const Case& c : {Case{4, 0.2, 0.2}, Case{4, 0.2, 0.1}, Case{4, 0.2, 0.05}, Case{4, 0.2, 0.025},
                              Case{4, 0.8, 0.025}, Case{6, 0.2, 0.025}, Case{6, 0.8, 0.025},
                              Case{8, 0.2, 0.025}, Case{8, 0.8, 0.025}, Case{12, 0.2, 0.025}}) {
            const Heave found = heave_of(0.5, c.cells, c.off, c.step);
            const Real deviates = found.period / period_of(row) - 1;
            MESSAGE(c.cells << " cells, " << c.off << " off, steps of " << c.step << " sqrt(R / g): period "
                            << found.period << ", " << 100 * deviates << " %; left " << found.decay);
            CHECK(std::abs(deviates) < (c.step > 0.05 ? 0.16 : 0.1));
        }
    }
}
