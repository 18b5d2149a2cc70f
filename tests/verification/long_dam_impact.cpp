// A column of water runs against a wall: finer grids, three dimensions, and what the walls' friction does.
#include "dam_impact.hpp"

#include <doctest/doctest.h>

using namespace dam_impact;

namespace {

template <int Dim>
void report(const std::string& name, GridFluid<Dim> flow) {
    const std::vector<Pressure> here = run(flow, 5), there = measured();
    MESSAGE(name << ": arrival " << 100 * (arrival(here) / arrival(there) - 1) << " %, peak "
                 << peak(here) / peak(there) << " of the measured one, mean from T = 3.5 to 5 "
                 << mean(here, 3.5, 5) / mean(there, 3.5, 5));
    WARN(std::abs(arrival(here) / arrival(there) - 1) < 0.03);
    WARN(std::abs(mean(here, 3.5, 5) / mean(there, 3.5, 5) - 1) < 0.1);
    CHECK(peak(here) > 0.5 * peak(there));
    CHECK(peak(here) < 2 * peak(there));
}

}  // namespace

TEST_CASE("walls without friction") {
    for (const int n : {20, 40, 60}) report(std::to_string(n) + " cells", dam<2>(n));
    report("20 cells in three dimensions", dam<3>(20));
}

TEST_CASE("walls with friction") {
    for (const int n : {20, 40, 60}) {
        auto params = dam<2>(n).params();
        params.sides = Sides<2>::all(Side::wall);
        report(std::to_string(n) + " cells, no slip", GridFluid<2>(params));
        // The source names no roughness: 0.2 mm shows how much hangs on it.
        params.wall_law = {WallLaw::Kind::logarithmic, 2e-4};
        report(std::to_string(n) + " cells, 0.2 mm rough", GridFluid<2>(params));
    }
}
