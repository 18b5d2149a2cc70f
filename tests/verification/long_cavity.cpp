// The lid-driven cavity on 128 x 128 cells, with the gates of the reference data.
#include "cavity.hpp"

#include <doctest/doctest.h>

TEST_CASE("lid-driven cavity at Re 100, 400 and 1000") {
    struct Case {
        int reynolds;
        abrade::Real end, gate;
    };
    for (const auto& [reynolds, end, gate] :
         {Case{100, 20, 0.01}, Case{400, 40, 0.02}, Case{1000, 70, 0.02}}) {
        const cavity::Errors e = cavity::errors<abrade::Koren>(128, reynolds, end);
        MESSAGE("Re " << reynolds << ": " << 100 * e.along_z << " % in u, " << 100 * e.along_x << " % in v");
        CHECK(e.along_z < gate);
        CHECK(e.along_x < gate);
    }
}
