// Drag and buoyancy of one body, as pure functions.
#include "../verification/reference_table.hpp"

#include <abrade/coupling/drag/drag.hpp>

#include <doctest/doctest.h>

#include <limits>

using namespace abrade;

namespace {
const Vec3 gravity(0, 0, -9.81);
const FluidSample deep{.velocity = Vec3(1, 0, 0), .depth = 10, .density = 1000, .viscosity = 1e-3};
constexpr Real ball(Real r) { return 4.0 / 3 * pi * r * r * r; }
}  // namespace

TEST_CASE("drag coefficient: the table of the correlation") {
    for (const auto& row : reference_table("cpl05_sphere_drag_correlations.csv"))
        CHECK(CliftGauvin{}.coefficient(row.at("Re")) ==
              doctest::Approx(row.at("CliftGauvin")).epsilon(1e-5));  // printed to six figures
}

TEST_CASE("drag coefficient: Stokes at one end, Newton at the other") {
    CHECK(CliftGauvin{}.coefficient(1e-6) ==
          doctest::Approx(24e6).epsilon(1e-4));  // 0.15 Re^0.687 = 1e-5 is left
    CHECK(CliftGauvin{}.coefficient(1e5) > 0.4);
    CHECK(CliftGauvin{}.coefficient(1e5) < 0.5);  // measured spheres: 0.4 to 0.5 before the drag crisis
    CHECK(std::isfinite(CliftGauvin{}.coefficient(0)));
    CHECK(CliftGauvin{{.shape_factor = 2}}.coefficient(100) ==
          doctest::Approx(2 * CliftGauvin{}.coefficient(100)));
    for (const Real bad : {0.0, -1.0, std::numeric_limits<Real>::quiet_NaN()})
        CHECK_THROWS_AS(CliftGauvin({.shape_factor = bad}), InputError);
}

TEST_CASE("Stokes limit: the force is 6 pi mu r u") {
    FluidSample honey = deep;
    honey.viscosity = 100;
    const Real r = 1e-3;
    const FluidLoad load = fluid_load(CliftGauvin{}, honey, {Vec3::Zero(), Vec3::Zero(), ball(r)}, gravity);
    CHECK(load.drag.x() ==
          doctest::Approx(6 * pi * 100 * r * 1).epsilon(0.02).scale(0));  // Re = 0.02: 0.15 Re^0.687 = 1 %
    CHECK(load.drag.tail<2>().norm() == 0);
}

TEST_CASE("drag acts along the relative velocity and vanishes with it") {
    const auto drag = [](const Vec3& velocity) {
        return fluid_load(CliftGauvin{}, deep, {Vec3::Zero(), velocity, ball(0.02)}, gravity).drag;
    };
    CHECK(drag({1, 0, 0}) == Vec3::Zero());
    CHECK(drag({2, 0, 0}).x() == doctest::Approx(-drag({0, 0, 0}).x()));
    const Vec3 oblique = drag({0.3, -0.4, 0.2}), relative = Vec3(1, 0, 0) - Vec3(0.3, -0.4, 0.2);
    CHECK(oblique.cross(relative).norm() < 1e-14 * oblique.norm());
    CHECK(oblique.dot(relative) > 0);
    // 1/2 rho C_d A u^2.
    const Real re = 1000 * 1 * 0.04 / 1e-3;
    CHECK(drag({0, 0, 0}).x() ==
          doctest::Approx(0.5 * 1000 * CliftGauvin{}.coefficient(re) * pi * 4e-4).epsilon(1e-12));
}

TEST_CASE("the submerged share is that of a spherical cap") {
    const Real r = 0.05;
    CHECK(submerged_share(-r, r) == 0);
    CHECK(submerged_share(-2 * r, r) == 0);
    CHECK(submerged_share(0, r) == doctest::Approx(0.5));
    CHECK(submerged_share(r, r) == 1);
    CHECK(submerged_share(5 * r, r) == 1);
    for (const Real depth : {-0.04, -0.01, 0.02, 0.045}) {
        const Real h = depth + r;  // height of the cap under water: pi h^2 (3 r - h) / 3
        CHECK(submerged_share(depth, r) ==
              doctest::Approx(pi * h * h * (3 * r - h) / 3 / ball(r)).epsilon(1e-13));
    }
}

TEST_CASE("buoyancy is the weight of the water displaced, and nothing above the surface") {
    FluidSample still = deep;
    still.velocity.setZero();
    const Immersed body{Vec3::Zero(), Vec3(0, 0, 3), ball(0.05)};
    CHECK((fluid_load(CliftGauvin{}, still, body, gravity).buoyancy - Vec3(0, 0, 1000 * 9.81 * ball(0.05)))
              .norm() < 1e-10);
    still.depth = 0;
    CHECK(fluid_load(CliftGauvin{}, still, body, gravity).buoyancy.z() ==
          doctest::Approx(0.5 * 1000 * 9.81 * ball(0.05)));
    still.depth = -0.06;
    const FluidLoad dry = fluid_load(CliftGauvin{}, still, body, gravity);
    CHECK(dry.drag == Vec3::Zero());
    CHECK(dry.buoyancy == Vec3::Zero());
}
