// Whether concrete that stands breaks as concrete that moves does, under the same stones.
#include "../../bench/charts/struck_patch.hpp"

#include <doctest/doctest.h>

using namespace abrade;
using namespace abrade::charts;

namespace {

PatchAnswers struck(ConcreteLevel level, Real tensile, Index cluster = 0) {
    Patch patch{.seed = 1,
                .stones = 12,
                .dashpot = false,
                .level = level,
                .cluster = cluster,
                .worn_out = WornOut::fines,
                .overflow = FillCrater{}};
    patch.lattice.layers = 4;
    // The contact alone decides how a stone rebounds.
    patch.bond.tensile = tensile, patch.bond.stiffness = 64 * patch.contact.stiffness;
    patch.wear.acceleration = 1e-3;
    return run(patch);
}

}  // namespace

TEST_CASE("sound concrete holds at both levels, and wears alike") {
    const PatchAnswers stands = struck(ConcreteLevel::quasi_static, 2.7e6),
                       moves = struck(ConcreteLevel::dynamic, 2.7e6);
    CHECK(stands.loosened == 0);
    CHECK(moves.loosened == 0);
    CHECK(stands.fed == moves.fed);
    // Rebounds differ by a few percent, and paths from then on.
    CHECK(stands.worn == doctest::Approx(moves.worn).epsilon(0.1).scale(0));
}

TEST_CASE("weak concrete breaks less where it stands, and the less the smaller the cluster is") {
    const auto broken = [](Index cluster) {
        return struck(ConcreteLevel::quasi_static, 0.3e6, cluster).bonds_broken;
    };
    const Real alone = broken(0), with_neighbours = broken(1), wider = broken(2);
    const PatchAnswers moves = struck(ConcreteLevel::dynamic, 0.3e6);
    MESSAGE("bonds broken: " << alone << ", " << with_neighbours << ", " << wider << "; dynamic "
                             << moves.bonds_broken);
    CHECK(alone > 0);
    CHECK(with_neighbours > alone);
    CHECK(wider > with_neighbours);
    CHECK(moves.bonds_broken > wider);
}
