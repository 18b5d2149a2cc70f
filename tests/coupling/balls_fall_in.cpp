// Balls thrown into a pool: no water is shot about, none is lost. long_balls_fall_in has more of them.
#include "balls_fall_in.hpp"

using namespace resolved;

TEST_CASE_TEMPLATE("eight balls fall in", Surface, HeightSurface, FreeSurface) {
    check_balls<MonolithicSolids<>, Surface>(1, 0.3, 3, 0.7);
    check_balls<MonolithicSolids<>, Surface>(1, 2, 3, 0.7);
}
