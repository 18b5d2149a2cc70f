// Hops of stones are found as they were made, and the regression gives the figures that it was quoted with.
#include "../../examples/common/saltation.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace abrade;
using namespace abrade::examples;

TEST_CASE("a stone that bounces on a plane: each hop is a parabola") {
    // Speeds u along and w normal, gravity g; each bounce keeps half of w. Looks are 1e-4 s apart, and a
    // touch lasts three of them.
    constexpr Real u = 2, g = 6, dt = 1e-4, radius = 0.02;
    Flights flights;
    Real x = 0.5, w = 0.4;
    const auto touch = [&](bool first) {
        std::optional<Hop> hop;
        for (int n = 0; n < 3; ++n)
            if (const auto found = flights.look(7, x, radius, true)) {
                CHECK(n == 0);
                hop = found;
            }
        CHECK(hop.has_value() == !first);
        return hop;
    };
    // It is fed in the air: what it does until it first touches is no hop.
    for (int n = 0; n < 50; ++n) CHECK_FALSE(flights.look(7, x - 0.1, radius + 0.3, false));
    touch(true);
    for (int bounce = 0; bounce < 3; ++bounce, w *= 0.5) {
        const Real lasts = 2 * w / g, from = x;
        for (Real t = dt; t < lasts - 0.5 * dt; t += dt)
            CHECK_FALSE(flights.look(7, from + u * t, radius + w * t - 0.5 * g * t * t, false));
        x = from + u * lasts;
        const auto hop = touch(false);
        REQUIRE(hop);
        CHECK(hop->length == doctest::Approx(u * lasts));
        CHECK(hop->height == doctest::Approx(w * w / (2 * g)).epsilon(1e-3));  // between two looks
    }
}

TEST_CASE("stones are told apart, and one that rolls hops nowhere") {
    Flights flights;
    for (int n = 0; n < 100; ++n) {
        CHECK_FALSE(flights.look(3, 0.01 * n, 0.05, true));
        const auto hop = flights.look(1, 0.02 * n, n % 10 == 0 ? 0.1 : 0.3, n % 10 == 0);
        CHECK(hop.has_value() == (n > 0 && n % 10 == 0));
        if (hop) CHECK(hop->height == doctest::Approx(0.2));
        if (hop) CHECK(hop->length == doctest::Approx(0.2));
    }
}

TEST_CASE("the regression at the shear of the channel") {
    // 59 Pa, tau*_c = 0.03 (0.045): 1.9 (1.3) m/s for 0.04 m, 1.7 (1.1) for 0.05 m, 0.8 (none) for 0.1 m,
    // none for 0.15 m.
    const auto speed = [](Real diameter, Real critical) {
        return Saltation{.shear = 59, .critical = critical}.speed({diameter, 2650});
    };
    CHECK(std::abs(speed(0.04, 0.03) - 1.9) < 0.05);
    CHECK(std::abs(speed(0.04, 0.045) - 1.3) < 0.05);
    CHECK(std::abs(speed(0.05, 0.03) - 1.7) < 0.05);
    CHECK(std::abs(speed(0.05, 0.045) - 1.1) < 0.05);
    CHECK(std::abs(speed(0.1, 0.03) - 0.8) < 0.05);
    CHECK(std::isnan(speed(0.1, 0.045)));
    CHECK(std::isnan(speed(0.15, 0.03)));
    // T = 2: sqrt(R g D) 1.56, and 1.44 diameters high.
    const Saltation twice{.shear = 2 * 0.03 * 1650 * standard_gravity * 0.04};
    CHECK(twice.speed({0.04, 2650}) == doctest::Approx(1.56 * std::sqrt(1.65 * standard_gravity * 0.04)));
    CHECK(twice.height({0.04, 2650}) == doctest::Approx(1.44 * 0.04));
}
