// Concrete that is worn out: spheres that hang by a few bonds touch others than those they are bonded to.
#include "../../bench/charts/struck_patch.hpp"

#include <doctest/doctest.h>

using namespace abrade;
using namespace abrade::charts;

TEST_CASE("what hangs by a few bonds does not pass into its neighbours") {
    // Looked for as contacts only once loose, spheres came to overlap by a radius, and the run ended in an
    // error when one of them did.
    Patch patch{.seed = 2, .stones = 160};
    patch.bond.join = MohrCoulomb::Join::minimum;
    patch.wear.acceleration = 2000;
    const PatchAnswers answers = run(patch);
    MESSAGE(answers.bonds_broken << " bonds broken, " << answers.grains << " grains");
    CHECK(answers.bonds_broken > 30);
    CHECK(answers.grains > 5);
    CHECK(answers.residual < 1e-11);
}
