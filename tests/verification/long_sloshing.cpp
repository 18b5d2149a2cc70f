// A shallow tank that sways far against the experiment, on cells that are fine enough for its crests. About
// two minutes.
#include "sloshing.hpp"

#include <doctest/doctest.h>

using namespace sloshing;

TEST_CASE("a shallow tank that sways far, on 10 cells to the depth") {
    const WideSway sway;
    GridFluid<2> flow(sway.params(10));
    const Real volume = flow.liquid().volume();
    const Found found = compare(run(sway, flow, 8.5, 11));
    CHECK(std::abs(found.crest - 1) < 0.15);
    CHECK(std::abs(found.late) < 0.05);
    CHECK(flow.liquid().volume() == doctest::Approx(volume).epsilon(1e-6).scale(0));
}
