// Concrete that no load reaches sleeps: what that changes, against everything awake, and that the untouched
// costs nothing.
#include "struck_concrete.hpp"

#include <doctest/doctest.h>

using namespace abrade;

namespace {

/// Hit once, in the middle.
StruckConcrete impact(Real along, Real down, Real tensile = 2.7e6) {
    return {.side = 0.7,
            .patch = 0.01,
            .stones = 1,
            .interval = 8e-3,
            .along = along,
            .down = down,
            .tensile = tensile};
}

}  // namespace

TEST_CASE("a single impact breaks the same bonds and wears the same to 1e-6") {
    for (StruckConcrete scene : {impact(0, 1), impact(2, 1), impact(3, 6, 2e5)}) {
        const Outcome all = run(scene);
        scene.wake_force = 0.03, scene.wake_radius = 10;
        const Outcome near = run(scene);
        CAPTURE(scene.along);
        CAPTURE(scene.down);
        MESSAGE("worn off by " << near.worn / all.worn - 1 << ", " << all.broken << " bonds broken, "
                               << 100 * near.awake << " % awake");
        CHECK(std::abs(near.worn / all.worn - 1) < 1e-6);
        CHECK(near.which == all.which);
        CHECK((all.broken > 0) == (scene.tensile < 1e6));
        CHECK(near.awake < 1);
        CHECK(near.residual < 1e-13);
    }
}

TEST_CASE("bonds break alike where spheres wake one by one") {
    StruckConcrete scene = impact(3, 6, 2e5);
    const Outcome all = run(scene);
    CHECK(all.broken > 0);
    for (const Real wake_force : {0.1, 10.0}) {
        // With 10 N, damaged concrete falls asleep while it touches its like.
        scene.wake_force = wake_force, scene.wake_radius = 0;
        const Outcome near = run(scene);
        MESSAGE(wake_force << " N: worn off by " << near.worn / all.worn - 1 << ", " << near.broken
                           << " bonds broken of " << all.broken);
        CHECK(std::abs(near.worn / all.worn - 1) < (wake_force < 1 ? 1e-3 : 0.01));
        CHECK((near.which == all.which || wake_force > 1));
        CHECK(std::abs(near.ledger.integration_residue()) < 0.01 * near.ledger.lost());
    }
}

TEST_CASE("stones one after the other wear the same within half a per cent") {
    // Two hundred of them, with three seeds: long_dormant_concrete.
    StruckConcrete scene{.stones = 10};
    const Outcome all = run(scene);
    scene.wake_force = 10;
    const Outcome near = run(scene);
    MESSAGE("worn " << all.worn * 1e6 << " and " << near.worn * 1e6 << " cm3, broken " << all.broken
                    << " and " << near.broken << ", awake " << near.awake);
    CHECK(std::abs(near.worn / all.worn - 1) < 0.005);
    CHECK(near.residual < 1e-12);
}

TEST_CASE("what is never touched is no body, and changes nothing") {
    StruckConcrete scene = impact(1, 1);
    scene.wake_force = 3;
    const Outcome small = run(scene);
    scene.side = 3.1;  // as many columns more on either side of the one that is hit
    const Outcome large = run(scene);
    CHECK(std::abs(large.worn / small.worn - 1) < 1e-13);
    CHECK(large.bodies == small.bodies);
    CHECK(large.steps == small.steps);
    CHECK(large.awake < 0.2 * small.awake);
}
