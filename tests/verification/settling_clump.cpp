// A clump of two touching spheres that settles, against the sphere of its volume, on 4 cells to that one's
// diameter. docs/verification/resolved_bodies.md has the table.
#include "settling_clump.hpp"

#include <doctest/doctest.h>

using namespace settling_clump;

TEST_CASE("a doublet turns its axis level and settles slower than the sphere of its volume") {
    const Real one = terminal_speed(1), bound = terminal_speed(doublet_sphericity);
    const Real half = terminal_speed(1, diameter / std::cbrt(2.0));
    const Settled sphere = settle(false, 4, 0), level = settle(true, 4, 0), tilted = settle(true, 4, 60);
    MESSAGE("sphere " << sphere.speed / one << " of Haider & Levenspiel's, doublet " << tilted.speed / bound
                      << "; over the sphere's speed " << tilted.speed / sphere.speed << ", begun level "
                      << level.speed / sphere.speed << "; one of its spheres alone " << half / one
                      << "; axis off the horizontal " << tilted.tilt << " degrees, below 10 after "
                      << tilted.levels << " diameters; begun level " << level.tilt);
    CHECK(std::abs(sphere.speed / one - 1) < 0.05);
    // Broadside the pair drags no less than a sphere alone does, and more than a body of its surface in the
    // mean of all its directions.
    CHECK(tilted.speed < bound);
    CHECK(tilted.speed > half);
    CHECK(tilted.levels > 0);
    CHECK(tilted.tilt < 10);
    CHECK(level.tilt < 5);
    for (const Settled* s : {&sphere, &level, &tilted}) CHECK(s->residual < 1e-12);
}
