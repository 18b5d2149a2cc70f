// Volume of fluid: shapes that a flow deforms and brings back, against published errors; order of
// convergence.
#include "volume_of_fluid.hpp"

#include <doctest/doctest.h>

#include "published_shapes.hpp"

using namespace returning_shapes;

TEST_CASE("a circle in a single vortex, there and back in 2 s: second order") {
    Real coarse = 0;
    for (const int cells : {32, 64, 128}) {
        const Returned r = single_vortex(cells, 2, 0.25);
        CAPTURE(cells);
        check_conserved(r);
        if (coarse > 0) CHECK(std::log2(coarse / r.error) > 1.9);
        coarse = r.error;
    }
    CHECK(coarse < 1.6e-4);  // measured 1.42e-4
}

TEST_CASE("Zalesak's slotted disc after one turn") {
    const Returned r = zalesak(200);
    check_conserved(r);
    // The best and the worst of methods that reconstruct planes lie at 0.97 and 1.56 %.
    CHECK(r.relative < published("slotted_disc", 200, &Published::largest));
    CHECK(r.relative < 1.1 * published("slotted_disc", 200, &Published::median));
}

TEST_CASE("a circle in a single vortex, there and back in 8 s") {
    const Returned r = single_vortex(64, 8, 0.5);
    check_conserved(r);
    CHECK(r.error < published("single_vortex", 64, &Published::largest));
}

TEST_CASE("LeVeque's deformation of a sphere, on the coarsest published grid") {
    const Returned r = deformation(32, 0.5);
    check_conserved(r);
    CHECK(r.error < published("deformation", 32, &Published::largest));
}
