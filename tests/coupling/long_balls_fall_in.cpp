// Balls thrown into a pool, by exchange, on eight seeds.
#include "balls_fall_in.hpp"

#include <abrade/coupling/exchange/one_fluid.hpp>

using namespace resolved;

TEST_CASE_TEMPLATE("eight balls fall in and come to rest", Surface, HeightSurface, FreeSurface) {
    for (unsigned seed = 0; seed < 8; ++seed) {
        check_balls<MonolithicSolids<>, Surface>(seed, 0.3, 3, 3);
        check_balls<MonolithicSolids<>, Surface>(seed, 2, 3, 3);
        check_balls<MonolithicSolids<>, Surface>(seed, 0.5, 3, 3, MonolithicSolids<>({.resolved_from = 0}));
        check_balls<MixtureSolids, Surface>(seed, 0.5, 3, 3);
    }
}
