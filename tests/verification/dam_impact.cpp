// A column of water runs against a wall, on a coarse grid: when it arrives, and the pressure's peak.
#include "dam_impact.hpp"

#include <doctest/doctest.h>

using namespace dam_impact;

TEST_CASE("the wall's pressure on 20 cells to the column's height") {
    auto flow = dam<2>(20);
    const Real volume = flow.liquid().volume();
    const std::vector<Pressure> here = run(flow, 5), there = measured();
    MESSAGE("arrival at T = " << arrival(here) << ", measured " << arrival(there));
    MESSAGE("peak over 0.05 " << peak(here) << ", measured " << peak(there));
    MESSAGE("mean from T = 3.5 to 5 " << mean(here, 3.5, 5) << ", measured " << mean(there, 3.5, 5));
    CHECK(std::abs(arrival(here) / arrival(there) - 1) < 0.03);
    CHECK(peak(here) > 0.5 * peak(there));
    CHECK(peak(here) < 2 * peak(there));
    // Walls without friction: a layer of rough wall lowers it (long_dam_impact).
    WARN(std::abs(mean(here, 3.5, 5) / mean(there, 3.5, 5) - 1) < 0.1);
    CHECK(flow.liquid().volume() == doctest::Approx(volume).epsilon(1e-7).scale(0));
}
