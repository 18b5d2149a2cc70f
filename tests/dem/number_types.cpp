// One source of the contact law for several number types.
#include <abrade/dem/linear_spring.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

const LinearSpring law{{.stiffness = 1e6, .restitution = 0.6, .friction = 0.5}};

}  // namespace

TEST_CASE("float answers as double does, to float's precision") {
    std::mt19937 random(23);
    std::uniform_real_distribution<Real> u(-1, 1);
    for (int n = 0; n < 1000; ++n) {
        const Vec3 normal = Vec3(u(random), u(random), u(random)).normalized(),
                   velocity(u(random), u(random), u(random));
        const Vec3 held = 1e-6 * Vec3(u(random), u(random), u(random));
        const Real overlap = 5e-4 + 4e-4 * u(random);
        const auto wide = law.respond(ContactKinematics<Real>{normal, overlap, velocity, 0.01, 0.005, 1e-5},
                                      LinearSpring::Memory<Real>{held});
        const auto narrow =
            law.respond(ContactKinematics<float>{normal.cast<float>(), static_cast<float>(overlap),
                                                 velocity.cast<float>(), 0.01f, 0.005f, 1e-5},
                        LinearSpring::Memory<float>{held.cast<float>()});
        const Real size = 1e6 * overlap;
        // Float's 6e-8, times what is cancelled: the tangential part of a velocity, a root of a difference.
        REQUIRE((narrow.load.force.cast<Real>() - wide.load.force).norm() < 1e-4 * size);
        REQUIRE(std::abs(static_cast<Real>(narrow.load.lost_tangential) - wide.load.lost_tangential) <
                1e-4 * size * 1e-5 * velocity.norm());
        REQUIRE(std::abs(static_cast<Real>(narrow.load.stored) - wide.load.stored) < 1e-4 * size * overlap);
    }
}

TEST_CASE("at rest float's smaller range makes no 0/0") {
    const auto still = law.respond(ContactKinematics<float>{{0, 0, 1}, 1e-4f, {0, 0, 0}, 0.01f, 0.005f, 1e-5},
                                   LinearSpring::Memory<float>{});
    CHECK(static_cast<Real>(still.load.force.z()) == doctest::Approx(100).epsilon(1e-5));
    CHECK(still.load.force.head<2>().norm() == 0.0f);
    CHECK(still.load.lost_tangential == 0.0f);
}
