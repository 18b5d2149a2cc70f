// The lid-driven cavity at Re 100 on 64 x 64 cells; finer grids and Re 400 and 1000 in long_cavity.cpp.
#include "cavity.hpp"

#include <doctest/doctest.h>

TEST_CASE("lid-driven cavity at Re 100: the centre lines of Ghia et al.") {
    const cavity::Errors e = cavity::errors<abrade::Koren>(64, 100, 15);
    MESSAGE("64 x 64: largest error " << 100 * e.along_z << " % in u, " << 100 * e.along_x << " % in v");
    // The gate is 1 % on 128 x 128.
    CHECK(e.along_z < 0.01);
    CHECK(e.along_x < 0.01);
}
