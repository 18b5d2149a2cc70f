// The cube whose lid slides, at Re 1000, on a coarse grid; finer ones in long_cavity_3d.cpp.
#include "cavity_3d.hpp"

#include <doctest/doctest.h>

using namespace cavity_3d;

TEST_CASE("cube with a sliding lid at Re 1000, 32 cells: the centre lines of Albensoeder and Kuhlmann") {
    auto flow = half_cube<abrade::Central>(32);
    flow.advance(30);
    const Errors e = errors(flow);
    MESSAGE("root mean square " << 100 * e.u.root_mean_square << " % in u, " << 100 * e.w.root_mean_square
                                << " % in w; extrema " << 100 * e.u.extremum << " %, " << 100 * e.w.extremum
                                << " %");
    // The gate is 3 % on finer grids. Measured here: 3.07 and 3.83 %.
    CHECK(e.u.root_mean_square < 0.034);
    CHECK(e.w.root_mean_square < 0.042);
}
