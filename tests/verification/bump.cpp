// A stream over a frictionless bump, slow before it and fast behind: what its head has lost there. The bed
// cuts the grid at every angle. docs/verification/grid_fluid.md has the table.
#include "water_flows.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace water_flows;

namespace {

/// Energy over weight at a place, of water that runs alike in all of its depth [m].
Real head(const Bump& flow, Real x) {
    const auto right = std::lower_bound(flow.x.begin() + 1, flow.x.end(), x) - flow.x.begin();
    const auto i = static_cast<std::size_t>(right);
    const Real along = (x - flow.x[i - 1]) / (flow.x[i] - flow.x[i - 1]);
    const Real level = flow.surface[i - 1] + along * (flow.surface[i] - flow.surface[i - 1]);
    return level + square(Bump::discharge / (level - Bump::bed(x))) / (2 * Bump::gravity);
}

template <class Surface>
void check(const std::string& surface, int cells, Real most) {
    const Bump flow = bump<Surface, Koren>(cells, {});
    const Real before = head(flow, -1), behind = head(flow, 0.9);
    MESSAGE(surface << ", " << cells << " cells: head " << before << " m before, " << behind << " m behind, "
                    << 100 * (behind / before - 1) << " %");
    CHECK(std::abs(behind / before - 1) < most);
}

}  // namespace

TEST_CASE("behind a bump the stream has the head that it had before") {
    check<FreeSurface>("volume of fluid", 60, 0.05);
    check<HeightSurface>("height", 60, 0.05);
    check<FreeSurface>("volume of fluid", 120, 0.02);
    check<HeightSurface>("height", 120, 0.02);
}
