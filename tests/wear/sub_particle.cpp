// The sub-particle abrasion law against its closed forms.
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <doctest/doctest.h>

#include <limits>

using namespace abrade;

namespace {

constexpr Real coefficient = 1.1e-7;

/// A head-on impact on one body by one, stepped as the engine does: kick, drift, force at the predicted
/// velocity, kick. Worn volume off one of the two bodies.
Real worn_by_impact(Real mass, Real speed, Real restitution, const SubParticleAbrasion& wear) {
    const LinearSpring law{{.stiffness = 1e6, .restitution = restitution}};
    const Real dt = pi * std::sqrt(mass / 1e6) / 500;
    Real x = 0.3 * speed * dt, v = speed, a = 0, worn = 0;  // x: gap, closing at v
    LinearSpring::Memory<Real> memory{};
    for (int n = 0; n < 100'000 && !(v < 0 && x > 0); ++n) {
        v += 0.5 * dt * a;
        x -= dt * v;
        const Real predicted = v + 0.5 * dt * a;
        const ContactKinematics<Real> contact{Vec3(0, 0, 1), -x, Vec3(0, 0, -predicted), 1 / mass, 100, dt};
        const auto [load, next] = law.respond(contact, memory);
        const WearIncrement step = wear.increment(contact, load);
        REQUIRE(step.normal >= 0);
        REQUIRE(step.tangential == 0);
        worn += step.normal;
        memory = next;
        a = -load.force.z() / mass;
        v += 0.5 * dt * a;
    }
    CHECK(-v == doctest::Approx(restitution * speed).epsilon(0.001).scale(0));
    return worn;
}

}  // namespace

TEST_CASE("one impact wears C_w beta 1/2 of 1/2 m v^2 (1 - e^2)") {
    const SubParticleAbrasion wear{{.coefficient = coefficient, .acceleration = 4800}};
    for (const Real e : {0.9, 0.6, 0.3}) {
        const Real mass = 0.05, speed = 2, lost = 0.5 * mass * speed * speed * (1 - e * e);
        CAPTURE(e);
        CHECK(worn_by_impact(mass, speed, e, wear) == doctest::Approx(coefficient * 4800 * 0.5 * lost)
                                                          .epsilon(0.001)
                                                          .scale(0));  // 500 steps: second order, 1e-5
    }
    CHECK(worn_by_impact(0.05, 2, 1, wear) == 0);  // elastic
}

TEST_CASE("wear is linear in mass, in drop height and in beta") {
    const auto worn = [](Real mass, Real speed, Real beta) {
        return worn_by_impact(mass, speed, 0.5,
                              SubParticleAbrasion{{.coefficient = coefficient, .acceleration = beta}});
    };
    const Real one = worn(0.1, 1, 1);
    CHECK(worn(0.4, 1, 1) / one ==
          doctest::Approx(4).epsilon(1e-9));  // the same steps in units of the contact time
    CHECK(worn(0.1, std::sqrt(3.0), 1) / one == doctest::Approx(3).epsilon(1e-9));  // height goes with v^2
    CHECK(worn(0.1, 1, 4800) / one == doctest::Approx(4800).epsilon(1e-12));
}

TEST_CASE("the two kinds of loss are weighed apart") {
    const ContactLoad<Real> load{Vec3(1, 2, 3), 5, 2, 7};
    const SubParticleAbrasion paper{{.coefficient = coefficient, .acceleration = 10}};
    CHECK(paper.increment({}, load).normal ==
          doctest::Approx(0.5 * coefficient * 10 * 2).epsilon(1e-15).scale(0));
    CHECK(paper.increment({}, load).tangential ==
          doctest::Approx(0.5 * coefficient * 10 * 7).epsilon(1e-15).scale(0));
    const SubParticleAbrasion impact_only{
        {.coefficient = coefficient, .normal_weight = 2, .tangential_weight = 0}};
    CHECK(impact_only.increment({}, load).normal ==
          doctest::Approx(0.5 * coefficient * 2 * 2).epsilon(1e-15).scale(0));
    CHECK(impact_only.increment({}, load).tangential == 0);
}

TEST_CASE("a load at rest does not wear, however large") {
    const LinearSpring law{{.stiffness = 1e6, .restitution = 0.5, .friction = 0.5}};
    const SubParticleAbrasion wear{{.coefficient = coefficient, .acceleration = 4800}};
    const ContactKinematics<Real> still{Vec3(0, 0, 1), 1e-2, Vec3::Zero(), 1, 100, 1e-5};
    const auto answer = law.respond(still, LinearSpring::Memory<Real>{});
    CHECK(answer.load.force.norm() > 1e3);
    CHECK(wear.increment(still, answer.load).normal == 0);
    CHECK(wear.increment(still, answer.load).tangential == 0);
}

TEST_CASE("strength falls in a straight line with the fracture rate") {
    const SubParticleAbrasion wear{{}};
    CHECK(wear.strength_left(0) == 1);
    CHECK(wear.strength_left(0.25) == 0.75);
    CHECK(wear.strength_left(1) == 0);
    CHECK(NoWear{}.strength_left(0.5) == 1);
    CHECK(NoWear{}.increment(ContactKinematics<Real>{}, ContactLoad<Real>{Vec3::Zero(), 1, 1, 1}).normal ==
          0);
}

TEST_CASE("parameters that make no sense are refused") {
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    for (const Real bad : {-1e-7, nan}) {
        CHECK_THROWS_AS(SubParticleAbrasion({.coefficient = bad}), InputError);
        CHECK_THROWS_AS(SubParticleAbrasion({.normal_weight = bad}), InputError);
        CHECK_THROWS_AS(SubParticleAbrasion({.tangential_weight = bad}), InputError);
    }
    for (const Real bad : {0.0, -1.0, nan})
        CHECK_THROWS_AS(SubParticleAbrasion({.acceleration = bad}), InputError);
    CHECK(SubParticleAbrasion{{}}.params().coefficient == coefficient);  // the paper's
}
