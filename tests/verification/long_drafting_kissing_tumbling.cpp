// Drafting, kissing and tumbling of two spheres over cells to a diameter: the table of
// docs/verification/resolved_bodies.md. Published moments of kissing on 8 and 16 cells differ by 1.7 %, of
// another set-up.
#include "drafting_kissing_tumbling.hpp"

#include <doctest/doctest.h>

TEST_CASE("drafting, kissing and tumbling over cells to a diameter") {
    for (const abrade::Real cells : {4.0, 6.0}) {
        const dkt::Events events = dkt::events_of(cells, 0.7);
        MESSAGE(cells << " cells: draft " << events.draft << " s, kiss " << events.kiss << " s, tumble "
                      << events.tumble << " s, separate " << events.separate << " s; nearest "
                      << events.nearest << " diameters");
        CHECK(events.draft > 0);
        CHECK(events.kiss > events.draft);
        CHECK(events.tumble > events.kiss);
        CHECK(events.separate > events.tumble);
    }
}
