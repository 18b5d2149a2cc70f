// Concrete of bonded spheres that fractures directly: below a closed form of the blow no bond breaks, above
// it some do; sub-particle abrasion wears on either side of it.
#include "../../bench/charts/blow.hpp"

#include <doctest/doctest.h>

using namespace abrade;
using namespace abrade::charts;

namespace {

/// A small stone, so that few steps tell; the block is wide enough that its rim is not felt.
Blow small_blow(ConcreteLevel level, Real diameter) {
    return {.diameter = diameter,
            .across = 10,
            .layers = 4,
            .level = level,
            .stone = 0.02,
            .safety = level == ConcreteLevel::dynamic ? 0.8 : 0.05};
}
BlowAnswers at(Blow blow, Real share_of_critical_speed) {
    blow.speed = share_of_critical_speed * blow.critical_speed();
    return run(blow);
}

}  // namespace

TEST_CASE(
    "standing concrete: the first bonds break at f_b tan(phi) (k_n/k_s + 4), whatever the spheres' size") {
    for (const Real diameter : {0.0025, 0.005, 0.01}) {
        CAPTURE(diameter);
        const Blow blow = small_blow(ConcreteLevel::quasi_static, diameter);
        CHECK(at(blow, 0.98).broken == 0);
        CHECK(at(blow, 1.02).broken > 0);  // the peak of the force is met to a per cent
    }
    // f_b grows as d^2, and nothing else counts.
    const auto speed = [](Real diameter) {
        return small_blow(ConcreteLevel::quasi_static, diameter).critical_speed();
    };
    CHECK(speed(0.01) / speed(0.005) == doctest::Approx(4).epsilon(1e-12).scale(0));
}

TEST_CASE(
    "moving concrete: the first bonds break at 1 to 1.35 times that speed, for its neighbours give way too") {
    for (const Real diameter : {0.005, 0.01}) {
        CAPTURE(diameter);
        const Blow blow = small_blow(ConcreteLevel::dynamic, diameter);
        CHECK(at(blow, 1).broken == 0);
        CHECK(at(blow, 1.35).broken > 0);
    }
}

TEST_CASE(
    "fracture takes nothing below its threshold and whole spheres above; the wear law goes with the energy") {
    const Blow fractures = small_blow(ConcreteLevel::dynamic, 0.005);
    CHECK(at(fractures, 1).removed == 0);
    const BlowAnswers hard = at(fractures, 4);
    CHECK(hard.let_go > 0);
    const Real sphere = cube(0.005);  // a cell of the lattice
    CHECK(hard.removed == doctest::Approx(hard.let_go * sphere).epsilon(1e-9).scale(0));
    CHECK(hard.removed > 10 * Blow::abraded_volume(hard.energy));

    Blow wears = small_blow(ConcreteLevel::quasi_static, 0.02);
    wears.across = 6, wears.wears = true;
    for (const Real speed : {0.1, 1.0}) {
        wears.speed = speed;
        const BlowAnswers a = run(wears);
        CHECK(a.broken == 0);
        // [1] on half of what the contact lost: to round-off; 1 - e^2 of the energy: as far as steps resolve.
        CHECK(a.removed == doctest::Approx(0.5 * 1.1e-7 * a.lost_contact).epsilon(1e-9).scale(0));
        CHECK(a.removed == doctest::Approx(Blow::abraded_volume(a.energy)).epsilon(0.01).scale(0));
    }
}
