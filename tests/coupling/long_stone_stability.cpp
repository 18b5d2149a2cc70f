// 500 stones fall as a heap into still water, come to rest and wear nothing then.
#include "stone_pile.hpp"

using namespace stone_tank;

TEST_CASE("500 stones piled in still water come to rest and wear nothing, resolved and averaged") {
    for (const Real from : {0.0, 99.0}) {
        const Tank tank{.cells = {32, 32, 56}, .level = 0.64, .largest_step = 4e-3, .resolved_from = from};
        const Rest rest = pile<HeightSurface>(tank, 500, 0.05, 4, 5);
        CHECK(rest.fastest < 1e-3);
        CHECK(rest.kinetic < 1e-4);  // a few on top still roll
        CHECK(rest.crept < 1e-4);
        CHECK(rest.worn < 1e-3);
        CHECK(rest.residual < 1e-12);
        CHECK(rest.most_iterations <= 12);
    }
}
