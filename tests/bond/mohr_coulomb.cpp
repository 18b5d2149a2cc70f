// Bonds that yield on the Mohr-Coulomb line, as a pure function.
#include <abrade/bond/mohr_coulomb.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <random>

using namespace abrade;

namespace {

using Params = MohrCoulomb::Params;
using Memory = MohrCoulomb::Memory;

constexpr Real radius = 0.01, dt = 1e-6, kn = 4e8, ks = 0.2 * kn;
const Real tan_phi = std::tan(radians(35.0));
const Real area = pi * radius * radius;

MohrCoulomb law(Real damping = 0) {
    return MohrCoulomb{{.tensile = 2.7e6,
                        .friction_angle = 35,
                        .stiffness = kn,
                        .stiffness_ratio = 0.2,
                        .damping = damping}};
}

BondKinematics at(Real compression, const Vec3& velocity = Vec3::Zero()) {
    return {.normal = Vec3(0, 0, 1),
            .compression = compression,
            .velocity = velocity,
            .radius = radius,
            .effective_mass = 0.005,
            .time_step = dt,
            .displacement = dt * velocity};
}

/// Pulls in small steps; the force in the last step before it breaks.
Real tension_at_break(const MohrCoulomb& bond, Real left) {
    Memory memory{};
    Real last = 0;
    for (Real stretch = 0;; stretch += 1e-9) {
        const auto answer = bond.respond(at(-stretch), left, memory);
        if (answer.failure != FailureMode::intact) {
            CHECK(answer.failure == FailureMode::tension);
            CHECK(answer.load.force == Vec3::Zero());
            CHECK(answer.memory.broken);
            return last;
        }
        last = -answer.load.force.z();
        memory = answer.memory;
    }
}

/// Shears in small steps under a constant compression; the shear force in the last step before it breaks.
Real shear_at_break(const MohrCoulomb& bond, Real left, Real compression) {
    Memory memory{};
    const Real speed = 1e-3;  // 1e-9 m a step
    for (Real last = 0;;) {
        const auto answer = bond.respond(at(compression, {speed, 0, 0}), left, memory);
        if (answer.failure != FailureMode::intact) {
            CHECK(answer.failure == FailureMode::shear);
            return last;
        }
        last = answer.load.force.head<2>().norm();
        memory = answer.memory;
    }
}

}  // namespace

TEST_CASE("an intact bond is a spring in both directions, in tension too") {
    const auto push = law().respond(at(1e-6), 1, {});
    CHECK((push.load.force - Vec3(0, 0, 400)).norm() < 1e-10);
    CHECK(push.load.stored == doctest::Approx(0.5 * kn * 1e-12).scale(0));
    const auto pull = law().respond(at(-1e-6), 1, {});
    CHECK((pull.load.force + Vec3(0, 0, 400)).norm() < 1e-10);
    CHECK(pull.load.stored == push.load.stored);
    const auto sheared = law().respond(at(0), 1, {Vec3(1e-6, 0, 0), false});
    CHECK((sheared.load.force + Vec3(80, 0, 0)).norm() < 1e-10);
    for (const auto& answer : {push, pull, sheared}) {
        CHECK(answer.failure == FailureMode::intact);
        CHECK(answer.load.lost_bond + answer.load.lost_normal + answer.load.lost_tangential == 0);
    }
}

TEST_CASE("tension breaks at A sigma_t, less by what is worn") {
    // Steps of 1e-9 m are 0.4 N, of 848 N: within 0.05 %.
    for (const Real left : {1.0, 0.5, 0.1})
        CHECK(tension_at_break(law(), left) == doctest::Approx(left * area * 2.7e6).epsilon(0.001));
    CHECK(tension_at_break(law(), 0) < 1);
    const MohrCoulomb square_area{{.tensile = 2.7e6, .stiffness = kn, .area = MohrCoulomb::Area::square}};
    CHECK(tension_at_break(square_area, 1) == doctest::Approx(4 * radius * radius * 2.7e6).epsilon(0.001));
    CHECK(square_area.capacity(radius) / law().capacity(radius) == doctest::Approx(4 / pi));
}

TEST_CASE("shear breaks on the line (f_n + f_b) tan(phi)") {
    const Real fb = area * 2.7e6;
    for (const Real left : {1.0, 0.4, 0.0})
        for (const Real compression : {-0.8e-6, 0.0, 1e-6, 5e-6}) {
            const Real fn = kn * compression, line = (fn + left * fb) * tan_phi;
            if (line <= 0) continue;
            CAPTURE(left);
            CAPTURE(compression);
            CHECK(std::abs(shear_at_break(law(), left, compression) - line) < 0.09);  // steps of 0.08 N
        }
}

TEST_CASE("strengths are joined by their mean, or by the smaller") {
    CHECK(law().strength(1, 0.5) == 0.75);
    CHECK(law().strength(0, 0) == 0);
    const MohrCoulomb weakest{{.tensile = 2.7e6, .stiffness = kn, .join = MohrCoulomb::Join::minimum}};
    CHECK(weakest.strength(1, 0.5) == 0.5);
    CHECK(weakest.strength(0.3, 0.9) == 0.3);
}

TEST_CASE("breaking under compression changes no normal force and makes no energy") {
    std::mt19937 random(31);
    std::uniform_real_distribution<Real> u(0, 1);
    int broke = 0;
    for (int n = 0; n < 20'000; ++n) {
        const MohrCoulomb bond = law(n % 2 ? 0.3 * u(random) : 0);
        const Vec3 velocity =
            std::pow(10, 3 * u(random) - 4) * Vec3(u(random) - 0.5, u(random) - 0.5, u(random) - 0.5);
        const BondKinematics now = at(std::pow(10, -9 + 4 * u(random)), velocity);
        const Memory held{std::pow(10, -7 + 3 * u(random)) * Vec3(u(random) - 0.5, u(random) - 0.5, 0),
                          false};
        const auto intact = bond.respond(now, 1e9, held);  // strong enough for anything
        const auto broken = bond.respond(now, u(random), held);
        if (broken.failure == FailureMode::intact) continue;
        ++broke;
        REQUIRE(broken.failure == FailureMode::shear);
        if (intact.load.force.z() > 0)
            REQUIRE(broken.load.force.z() == doctest::Approx(intact.load.force.z()).epsilon(1e-12));
        else
            REQUIRE(broken.load.force.z() == 0);  // a dashpot that pulled harder than the spring pushed
        REQUIRE(broken.load.force.head<2>().norm() <= tan_phi * broken.load.force.z() * (1 + 1e-12));
        REQUIRE(broken.load.stored >= 0);
        REQUIRE(broken.load.lost_bond >= 0);
        // What the normal dashpot takes in the step is work done on the bond, no release: allow what it takes
        // intact.
        REQUIRE(broken.load.stored + broken.load.lost_bond + broken.load.lost_normal +
                    broken.load.lost_tangential <=
                (intact.load.stored + intact.load.lost_bond) * (1 + 1e-12) + 1e-18);
        // And none is forgotten.
        REQUIRE(broken.load.stored + broken.load.lost_bond >= intact.load.stored * (1 - 1e-12));
    }
    CHECK(broke > 1000);
}

TEST_CASE("breaking in tension gives up all it stored, in the step it breaks") {
    const Memory held{Vec3(1e-6, 0, 0), false};
    const Real stretch = 3e-6;
    const auto broken = law().respond(at(-stretch), 1, held);
    CHECK(broken.failure == FailureMode::tension);
    CHECK(broken.load.stored == 0);
    CHECK(broken.load.lost_bond == doctest::Approx(0.5 * kn * stretch * stretch + 0.5 * ks * 1e-12).scale(0));
    // After that it is gone for good: no force, no loss, no second fate.
    const auto after = law().respond(at(-stretch), 1, broken.memory);
    CHECK(after.failure == FailureMode::intact);
    CHECK(after.memory.broken);
    CHECK(after.load.force == Vec3::Zero());
    CHECK(after.load.lost_bond + after.load.lost_normal + after.load.lost_tangential == 0);
}

TEST_CASE("a broken bond slides at f_n tan(phi), and pushes only") {
    const Real compression = 2e-6, fn = kn * compression, speed = 0.01;
    Memory memory{Vec3::Zero(), true};
    BondResponse<Memory> answer;
    for (int n = 0; n < 2000; ++n) {
        answer = law().respond(at(compression, {speed, 0, 0}), 1, memory);
        memory = answer.memory;
    }
    CHECK(answer.load.force.z() == doctest::Approx(fn).epsilon(1e-14));
    CHECK(answer.load.force.x() == doctest::Approx(-fn * tan_phi).epsilon(1e-12));
    CHECK(answer.load.lost_tangential == doctest::Approx(fn * tan_phi * speed * dt).epsilon(1e-9).scale(0));
    CHECK(answer.load.lost_bond == 0);
    CHECK(answer.failure == FailureMode::intact);  // a fate is told once

    // Opening: no tension, the spring's energy is lost to sliding, once.
    const auto open = law().respond(at(-1e-7), 1, memory);
    CHECK(open.load.force == Vec3::Zero());
    CHECK(open.load.lost_tangential == doctest::Approx(0.5 * ks * memory.spring.squaredNorm()).scale(0));
    CHECK(law().respond(at(-1e-7), 1, open.memory).load.lost_tangential == 0);
    // Closing again: a contact.
    CHECK(law().respond(at(1e-7), 1, open.memory).load.force.z() > 0);
}

TEST_CASE("random histories: no loss is negative, intact or broken") {
    std::mt19937 random(37);
    std::uniform_real_distribution<Real> u(-1, 1);
    int broken = 0;
    for (int n = 0; n < 2000; ++n) {
        const MohrCoulomb bond = law(0.5 + 0.5 * u(random));
        Memory memory{};
        Vec3 normal = Vec3(u(random), u(random), u(random)).normalized();
        const Real depth = std::pow(10, -8 + 3 * std::abs(u(random))),
                   speed = std::pow(10, 2 * u(random) - 1);
        for (int step = 0; step < 40; ++step) {
            normal = (normal + 0.01 * Vec3(u(random), u(random), u(random))).normalized();
            BondKinematics now = at(depth * u(random), speed * Vec3(u(random), u(random), u(random)));
            now.normal = normal;
            const auto [load, next, failure] = bond.respond(now, std::abs(u(random)), memory);
            REQUIRE(load.lost_bond >= 0);
            REQUIRE(load.lost_normal >= 0);
            REQUIRE(load.lost_tangential >= 0);
            REQUIRE(load.stored >= 0);
            REQUIRE(std::isfinite(load.force.norm() + load.lost_bond));
            REQUIRE((next.broken >= memory.broken));  // never heals
            REQUIRE((failure == FailureMode::intact) == (next.broken == memory.broken));
            memory = next;
        }
        broken += memory.broken > 0;
    }
    CHECK(broken > 500);
}

TEST_CASE("parameters that make no sense are refused, with the rule") {
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    const Params good{.tensile = 2.7e6, .stiffness = kn};
    CHECK_NOTHROW(MohrCoulomb{good});
    const auto refused = [&](auto change) {
        Params p = good;
        change(p);
        CHECK_THROWS_AS(MohrCoulomb{p}, InputError);
    };
    for (const Real bad : {0.0, -1.0, nan}) {
        refused([&](Params& p) { p.tensile = bad; });
        refused([&](Params& p) { p.stiffness = bad; });
        refused([&](Params& p) { p.stiffness_ratio = bad; });
    }
    for (const Real bad : {-1.0, 90.0, nan}) refused([&](Params& p) { p.friction_angle = bad; });
    for (const Real bad : {-0.1, 1.1, nan}) refused([&](Params& p) { p.damping = bad; });
    CHECK_THROWS_WITH_AS(MohrCoulomb({.tensile = -1, .stiffness = kn}),
                         "MohrCoulomb.tensile must be finite and > 0, got -1 Pa; concrete has 2e6 to 5e6 Pa",
                         InputError);
}
