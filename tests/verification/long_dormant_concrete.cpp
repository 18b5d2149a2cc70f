// Two hundred stones on 0.3 m x 0.3 m of concrete, three times: asleep where nothing reaches it, against
// awake.
#include "struck_concrete.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace abrade;

TEST_CASE("two hundred stones wear the same within half a per cent, and break as much as seeds scatter") {
    std::vector<Index> awake;
    for (const std::uint32_t seed : {1u, 2u, 3u}) awake.push_back(run({.seed = seed}).broken);
    const auto [fewest, most] = std::minmax_element(awake.begin(), awake.end());
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
        StruckConcrete scene{.seed = seed};
        const Outcome all = run(scene);
        scene.wake_force = 10;
        const Outcome near = run(scene);
        MESSAGE("seed " << seed << ": worn " << all.worn * 1e6 << " and " << near.worn * 1e6 << " cm3, "
                        << all.broken << " and " << near.broken << " bonds broken, " << near.awake
                        << " awake");
        CHECK(std::abs(near.worn / all.worn - 1) < 0.005);
        CHECK(std::abs(near.broken - all.broken) <= *most - *fewest);
        CHECK(near.residual < 1e-12);
    }
}
