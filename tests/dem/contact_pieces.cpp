// The pieces that contact and bond laws share: turning a spring, a spring without tension, a slider.
#include <abrade/dem/laws/contact_law.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

struct Random {
    std::mt19937 engine{17};
    Real uniform(Real low, Real high) { return std::uniform_real_distribution<Real>(low, high)(engine); }
    Real size(Real low_exponent, Real high_exponent) {
        return std::pow(10, uniform(low_exponent, high_exponent));
    }
    Vec3 direction() {
        Vec3 v;
        do v = Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
        while (v.norm() > 1 || v.norm() < 0.01);
        return v.normalized();
    }
};

}  // namespace

TEST_CASE("a spring turned into the plane keeps its length and lies in the plane") {
    Random random;
    for (int n = 0; n < 10'000; ++n) {
        const Vec3 normal = random.direction(), spring = random.size(-15, 0) * random.direction();
        if (spring.normalized().cross(normal).norm() < 1e-3)
            continue;  // nearly along the normal: no direction to keep
        const Vec3 turned = turn_into_plane(spring, normal);
        REQUIRE(turned.norm() == doctest::Approx(spring.norm()).epsilon(1e-12).scale(0));
        REQUIRE(std::abs(turned.dot(normal)) < 1e-12 * spring.norm());
        REQUIRE(turned.dot(spring) > 0);
    }
    // One that already lies there stays, bit for bit in direction.
    CHECK((turn_into_plane(Vec3(1e-6, 2e-6, 0), Vec3(0, 0, 1)) - Vec3(1e-6, 2e-6, 0)).norm() < 1e-21);
}

TEST_CASE("a spring of no length, or along the normal, turns into none, without a NaN") {
    CHECK(turn_into_plane(Vec3(Vec3::Zero()), Vec3(0, 0, 1)) == Vec3::Zero());
    CHECK(turn_into_plane(Vec3(0, 0, 1e-5), Vec3(0, 0, 1)) == Vec3::Zero());
}

TEST_CASE("normal spring: at rest it pushes k delta, stores 1/2 k delta^2 and loses nothing") {
    const auto spring = NormalSpring<Real>::pushing(100, 0.005, 50, 0, 1e-5);
    CHECK(spring.force == doctest::Approx(100).epsilon(1e-15));
    CHECK(spring.stored == doctest::Approx(0.005).epsilon(1e-15).scale(0));
    CHECK(spring.lost == 0);
}

TEST_CASE("a contact has lasted for the share of the step since it began") {
    const Real dt = 1e-5, v = 2, way = v * dt;
    CHECK(begun_share(0.0, v, dt) == 0);                                    // touched just now
    CHECK(begun_share(0.5 * way, v, dt) == doctest::Approx(0.5).scale(0));  // half a step ago
    CHECK(begun_share(way * 1.000001, v, dt) == 1);                         // an older contact
    CHECK(begun_share(1e-9, -v, dt) == 1);                                  // one that parts
    CHECK(begun_share(1e-9, 0.0, dt) == 1);
    CHECK(begun_share(0.0, 0.0, dt) == 1);
}

TEST_CASE("normal spring: never pulls; what the clamp holds back is lost") {
    const Real k = 1e6, c = 500, dt = 1e-5;
    const auto spring =
        NormalSpring<Real>::pushing(k * 1e-5, 0.5 * k * 1e-10, c, -1, dt);  // push 10 N, dashpot -500 N
    CHECK(spring.force == 0);
    CHECK(spring.lost ==
          doctest::Approx(10 * 1 * dt).scale(0));  // the spring relaxes at 1 m/s against nothing

    Random random;
    for (int n = 0; n < 100'000; ++n) {
        const Real overlap = random.size(-12, -2), approach = random.uniform(-1, 1) * random.size(-6, 2);
        const Real push = random.size(3, 9) * overlap;
        const auto s = NormalSpring<Real>::pushing(push, 0.5 * push * overlap, random.size(-3, 5), approach,
                                                   random.size(-8, -3));
        REQUIRE(s.force >= 0);
        REQUIRE(s.lost >= 0);
        REQUIRE(s.stored >= 0);
        REQUIRE(std::isfinite(s.force + s.lost + s.stored));
    }
}

TEST_CASE("slider: below the limit it is a spring and a dashpot") {
    const Vec3 trial(1e-5, 0, 0), slip(0, 0.1, 0);
    const auto s = SlidingSpring<Real>::at(trial, trial, slip, 1e3, 1e6, 20, 1e-5);
    CHECK((s.force - Vec3(-10, -2, 0)).norm() < 1e-12);
    CHECK(s.spring == trial);
    CHECK(s.stored == doctest::Approx(0.5 * 1e6 * 1e-10).scale(0));
    CHECK(s.lost == doctest::Approx(20 * 0.01 * 1e-5).scale(0));
}

TEST_CASE("slider: sliding steadily at the limit loses the limit times the way") {
    const Real limit = 10, k = 1e6, v = 0.1, dt = 1e-5;
    const Vec3 before(limit / k, 0, 0), slip(v, 0, 0);
    const auto s = SlidingSpring<Real>::at(before, before + dt * slip, slip, limit, k, 20, dt);
    CHECK(s.force.x() == doctest::Approx(-limit));
    CHECK(s.spring.x() == doctest::Approx(limit / k).scale(0));
    CHECK(s.lost == doctest::Approx(limit * v * dt).epsilon(1e-12).scale(0));
}

TEST_CASE("slider: a limit that falls on a spring at rest loses what the spring releases") {
    const Vec3 trial(1e-4, 0, 0);
    const auto s =
        SlidingSpring<Real>::at(trial, trial, Vec3(Vec3::Zero()), 10, 1e6, 20, 1e-5);  // spring alone 100 N
    CHECK(s.force.x() == doctest::Approx(-10));
    CHECK(s.spring.x() == doctest::Approx(1e-5).scale(0));
    CHECK(s.lost == doctest::Approx(0.5 * 1e6 * (1e-8 - 1e-10)).scale(0));
}

TEST_CASE("slider: a dashpot that pulls the other way than the spring may use the room between") {
    // Spring at the limit, slipping back: the dashpot force opposes the spring's, all of it fits.
    const Vec3 spring(1e-5, 0, 0);
    const auto s = SlidingSpring<Real>::at(spring, spring, Vec3(-0.1, 0, 0), 10, 1e6, 20, 1e-5);
    CHECK(s.force.x() == doctest::Approx(-10 + 2));
    CHECK(s.lost == doctest::Approx(20 * 0.01 * 1e-5).scale(0));
}

TEST_CASE("slider: the limit holds and no loss is negative, whatever comes") {
    Random random;
    Real used = 0;
    for (int n = 0; n < 200'000; ++n) {
        const Vec3 trial = n % 7 ? Vec3(random.size(-12, -2) * random.direction()) : Vec3(Vec3::Zero());
        const Vec3 slip = n % 5 ? Vec3(random.size(-9, 2) * random.direction()) : Vec3(Vec3::Zero());
        const Real limit = n % 11 ? random.size(-6, 5) : 0, k = random.size(3, 9),
                   c = n % 3 ? random.size(-3, 5) : 0;
        const Real dt = random.size(-8, -3);
        const Vec3 before = trial - (n % 2 ? dt : 0) * slip;
        const auto s = SlidingSpring<Real>::at(before, trial, slip, limit, k, c, dt);
        CAPTURE(limit);
        CAPTURE(k);
        CAPTURE(c);
        // The spring and the dashpot are each rounded at their own size, up to (k s + c v).
        const Real size = k * s.spring.norm() + c * slip.norm();
        REQUIRE(s.force.norm() <= limit * (1 + 1e-12) + 1e-13 * size);
        REQUIRE(s.lost >= 0);
        REQUIRE(s.stored >= 0);
        REQUIRE(s.stored <= 0.5 * k * trial.squaredNorm() * (1 + 1e-14));
        REQUIRE(std::isfinite(s.force.norm() + s.lost));
        used = std::max(used, limit > 0 ? s.force.norm() / limit : 0);
    }
    CHECK(used > 0.999);  // the limit was really reached
}
