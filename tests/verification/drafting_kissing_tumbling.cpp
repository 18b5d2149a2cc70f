// Drafting, kissing and tumbling of two spheres on 4 cells to a diameter, gated on the order of events.
// docs/verification/resolved_bodies.md has the table.
#include "drafting_kissing_tumbling.hpp"

#include <doctest/doctest.h>

TEST_CASE("two spheres that settle one above the other draft, kiss, tumble and part") {
    const dkt::Events events = dkt::events_of(4, 0.8);
    MESSAGE("draft " << events.draft << " s, kiss " << events.kiss << " s, tumble " << events.tumble
                     << " s, separate " << events.separate << " s; nearest " << events.nearest
                     << " diameters");
    CHECK(events.draft > 0);
    CHECK(events.kiss > events.draft);
    CHECK(events.tumble > events.kiss);
    CHECK(events.separate > events.tumble);
    CHECK(events.residual < 1e-12);
}
