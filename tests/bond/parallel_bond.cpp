// A bond that is a short beam: its four stiffnesses, its strengths, and what happens as it breaks.
#include <abrade/bond/elastic_brittle.hpp>
#include <abrade/bond/parallel_bond.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

using Memory = ParallelBond::Memory;

// The numbers of bpm02: A = 1e-4 m2, E = 30 GPa, sigma_t = 3 MPa, l = 0.01 m.
constexpr Real area = 1e-4, youngs = 3e10, tensile = 3e6, length = 0.01, dt = 1e-7;
const Real radius = std::sqrt(area / pi);
const Real second_moment = 0.25 * pi * std::pow(radius, 4);

ParallelBond beam(Real damping = 0, Real cohesion = 1e7) {
    return ParallelBond{{.youngs = youngs,
                         .stiffness_ratio = 0.4,
                         .tensile = tensile,
                         .cohesion = cohesion,
                         .friction_angle = 35,
                         .damping = damping}};
}

BondKinematics at(Real compression, const Vec3& velocity = Vec3::Zero(), const Vec3& spin = Vec3::Zero()) {
    return {.normal = Vec3(0, 0, 1),
            .compression = compression,
            .velocity = velocity,
            .radius = radius,
            .length = length,
            .effective_mass = 0.005,
            .time_step = dt,
            .displacement = dt * velocity,
            .spin = spin,
            .rotation = dt * spin,
            .effective_inertia = 1e-7};
}

/// Turns in steps until the bond breaks; the couple of the last step before.
Real couple_at_break(const ParallelBond& law, const Vec3& axis, FailureMode expected, Real left = 1) {
    Memory memory{};
    for (Real last = 0;;) {
        const auto answer = law.respond(at(0, Vec3::Zero(), axis), left, memory);
        if (answer.failure != FailureMode::intact) {
            CHECK(answer.failure == expected);
            CHECK(answer.load.couple == Vec3::Zero());
            return last;
        }
        last = answer.load.couple.norm();
        memory = answer.memory;
    }
}

}  // namespace

TEST_CASE("along, across, bending, twisting: each is the beam's own stiffness") {
    const BondRigidity k = beam().rigidity(radius, length);
    const auto close = [](Real a, Real b) { CHECK(a == doctest::Approx(b).epsilon(1e-12).scale(0)); };
    close(k.normal, youngs * area / length);
    close(k.tangential, 0.4 * k.normal);
    close(k.bending, youngs * second_moment / length);
    close(k.twisting, 0.4 * youngs * 2 * second_moment / length);

    const Vec3 slip(3e-8, 0, 0), turn(2e-8, -1e-8, 4e-8);
    const auto answer = beam().respond(at(1e-9, slip / dt, turn / dt), 1, {});
    CHECK((answer.load.force - Vec3(-k.tangential * 3e-8, 0, k.normal * 1e-9)).norm() < 1e-12 * k.normal);
    const Vec3 couple(-k.bending * 2e-8, k.bending * 1e-8, -k.twisting * 4e-8);
    CHECK((answer.load.couple - couple).norm() < 1e-12 * couple.norm());
    close(answer.load.stored,
          0.5 * (k.normal * 1e-18 + k.tangential * 9e-16 + k.bending * 5e-16 + k.twisting * 16e-16));
    CHECK(answer.load.lost_bond == 0);
}

TEST_CASE("bpm02: a pulled bond breaks at sigma_t A, at a strain of sigma_t / E, and gives up its energy") {
    Memory memory{};
    Real force = 0, energy = 0, strain = 0;
    for (Real stretch = 0;; stretch += 1e-10) {
        const auto answer = beam().respond(at(-stretch), 1, memory);
        if (answer.failure == FailureMode::tension) {
            CHECK(answer.load.lost_bond == doctest::Approx(1.5e-4).epsilon(1e-3).scale(0));
            CHECK(answer.load.force == Vec3::Zero());
            break;
        }
        force = -answer.load.force.z(), energy = answer.load.stored, strain = stretch / length;
        memory = answer.memory;
    }
    CHECK(force == doctest::Approx(300).epsilon(1e-3).scale(0));
    CHECK(strain == doctest::Approx(1e-4).epsilon(1e-3).scale(0));
    CHECK(energy == doctest::Approx(1.5e-4).epsilon(1e-3).scale(0));
}

TEST_CASE("bent, it breaks at sigma_t I/R; twisted, at the cohesion times J/R; wear takes its share") {
    for (const Real left : {1.0, 0.3}) {
        CHECK(couple_at_break(beam(), {0.1, 0, 0}, FailureMode::tension, left) ==
              doctest::Approx(left * tensile * second_moment / radius).epsilon(1e-3).scale(0));
        CHECK(couple_at_break(beam(0, 1e6), {0, 0, 0.1}, FailureMode::shear, left) ==
              doctest::Approx(left * 1e6 * 2 * second_moment / radius).epsilon(1e-3).scale(0));
    }
}

TEST_CASE("a bond that tilts keeps what it holds") {
    const Memory held{Vec3(1e-7, 0, 0), Vec3(0, 2e-7, 0), 1e-7, false};
    BondKinematics turned = at(0);
    turned.normal = Vec3(0.6, 0, 0.8);
    const auto before = beam().respond(at(0), 1, held), after = beam().respond(turned, 1, held);
    CHECK(after.load.stored == doctest::Approx(before.load.stored).epsilon(1e-12).scale(0));
}

TEST_CASE_TEMPLATE("breaking under compression changes no normal force and makes no energy", Law,
                   ParallelBond, ElasticBrittle) {
    const auto law = [](Real damping) {
        if constexpr (std::same_as<Law, ParallelBond>)
            return beam(damping, 1e6);
        else
            return ElasticBrittle{{.tensile = tensile, .shear = 1e6, .stiffness = 3e8, .damping = damping}};
    };
    const Real friction = std::same_as<Law, ParallelBond> ? std::tan(radians(35.0)) : 0.5;
    std::mt19937 random(5);
    std::uniform_real_distribution<Real> u(0, 1);
    const auto any = [&](Real size) {
        const Real z = u(random) - 0.5, y = u(random) - 0.5, x = u(random) - 0.5;
        return Vec3(size * Vec3(x, y, z));
    };
    int broke = 0;
    for (int n = 0; n < 20'000; ++n) {
        const Law bond = law(n % 2 ? 0.3 * u(random) : 0);
        const BondKinematics now = at(std::pow(10, -9 + 3 * u(random)), any(0.1), any(10));
        typename Law::Memory held{};
        held.spring = any(std::pow(10, -8 + 3 * u(random))), held.spring.z() = 0;
        if constexpr (requires { held.bend; })
            held.bend = any(std::pow(10, -6 + 3 * u(random))), held.bend.z() = 0,
            held.twist = 1e-5 * u(random);
        const auto sound = bond.respond(now, 1e9, held), answer = bond.respond(now, u(random), held);
        if (answer.failure == FailureMode::intact) continue;
        ++broke;
        CHECK(answer.memory.broken);
        // Damping may have pulled before; the contact that is left does not.
        if (sound.load.force.z() > 0)
            CHECK(answer.load.force.z() == doctest::Approx(sound.load.force.z()).epsilon(1e-12).scale(0));
        CHECK(answer.load.couple == Vec3::Zero());
        CHECK(answer.load.force.head(2).norm() <= friction * answer.load.force.z() * (1 + 1e-12));
        CHECK(answer.load.stored <= sound.load.stored * (1 + 1e-12));
        CHECK(answer.load.lost_bond >= 0);
        CHECK(answer.load.stored + answer.load.lost_bond >= sound.load.stored * (1 - 1e-12));
    }
    CHECK(broke > 5000);
}

TEST_CASE("elastic-brittle: tension and shear alone at their strengths, together on the ellipse") {
    const ElasticBrittle law{{.tensile = 2e6, .shear = 5e6, .stiffness = 1e8, .damping = 0}};
    const Real k = 1e8, ks = 2e7;
    for (const Real angle : {0.0, 0.3, 0.8, 1.2, 1.5}) {
        const Real pull = 2e6 * area * std::cos(angle), shear = 5e6 * area * std::sin(angle);
        const auto failure = [&](Real share) {
            return law.respond(at(-share * pull / k), 1, {Vec3(share * shear / ks, 0, 0), false}).failure;
        };
        CHECK(failure(0.999) == FailureMode::intact);
        CHECK(failure(1.001) == (angle < pi / 4 ? FailureMode::tension : FailureMode::shear));
    }
    // Pressed, its shear strength is what it is.
    const auto pressed = [&](Real share) {
        return law.respond(at(1e-6), 1, {Vec3(share * 5e6 * area / ks, 0, 0), false}).failure;
    };
    CHECK(pressed(0.999) == FailureMode::intact);
    CHECK(pressed(1.001) == FailureMode::shear);
}

TEST_CASE("parameters that make no sense are refused") {
    CHECK_THROWS_AS(ParallelBond({.youngs = 0}), InputError);
    CHECK_THROWS_AS(ParallelBond({.youngs = 1e10, .tensile = 1e6, .cohesion = -1}), InputError);
    CHECK_THROWS_AS(ParallelBond({.youngs = 1e10, .tensile = 1e6, .cohesion = 1e6, .friction_angle = 90}),
                    InputError);
    CHECK_THROWS_AS(ElasticBrittle({.tensile = 1e6, .shear = 0, .stiffness = 1e8}), InputError);
    CHECK_THROWS_AS(ElasticBrittle({.tensile = 1e6, .shear = 1e6, .stiffness = 1e8, .damping = 2}),
                    InputError);
}
