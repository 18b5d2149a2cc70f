// Resistance to twisting beside a law without moments: its stiffness, its swing, and what becomes of it.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/bond/parallel_bond.hpp>
#include <abrade/bond/twist_resistance.hpp>

#include <doctest/doctest.h>

#include "../message_of.hpp"

using namespace abrade;

namespace {

using Twisting = TwistResistance<MohrCoulomb>;

constexpr Real radius = 0.01, k_n = 4e5, ratio = 0.2, dt = 1e-6;
constexpr Real k_t = ratio * k_n * radius * radius / 2;

Twisting law(Real damping = 0, Real factor = 1) {
    return Twisting{
        {.bond = {.tensile = 2.7e6, .stiffness = k_n, .stiffness_ratio = ratio, .damping = damping},
         .stiffness_factor = factor}};
}

BondKinematics at(Real compression, const Vec3& spin) {
    return {.normal = Vec3(0, 0, 1),
            .compression = compression,
            .velocity = Vec3(1e-3, 0, 2e-3),
            .radius = radius,
            .length = 2 * radius,
            .effective_mass = 0.005,
            .time_step = dt,
            .displacement = dt * Vec3(1e-3, 0, 2e-3),
            .spin = spin,
            .rotation = dt * spin,
            .effective_inertia = 2e-7};
}

}  // namespace

TEST_CASE("the force is that of the law alone; the couple is about the bond and the spring's own") {
    static_assert(BondLaw<Twisting> && CarriesMoments<Twisting> && AnswersBondPacks<Twisting>);
    const BondKinematics bond = at(1e-6, Vec3(10, -5, 4e-2 / dt));
    const auto alone = law(0.1).law().respond(bond, 1, {});
    const auto answer = law(0.1).respond(bond, 1, {});
    CHECK(answer.load.force == alone.load.force);
    CHECK(answer.memory.spring == alone.memory.spring);
    const Real dashpot = 0.2 * std::sqrt(k_t * 2e-7), rate = 4e-2 / dt;
    CHECK(answer.load.couple.x() == 0);
    CHECK(answer.load.couple.y() == 0);
    const auto close = [](Real a, Real b) { CHECK(a == doctest::Approx(b).epsilon(1e-12).scale(0)); };
    close(answer.load.couple.z(), -k_t * 4e-2 - dashpot * rate);
    close(answer.load.stored - alone.load.stored, 0.5 * k_t * square(4e-2));
    close(answer.load.lost_bond - alone.load.lost_bond, dashpot * square(rate) * dt);
    close(law(0, 3).rigidity(radius, 2 * radius).twisting, 3 * k_t);
    CHECK(law().rigidity(radius, 2 * radius).bending == 0);
}

TEST_CASE("as stiff against twisting as a beam of the same shear stiffness") {
    const Real youngs = k_n * 2 * radius / (pi * square(radius));
    const ParallelBond beam{
        {.youngs = youngs, .stiffness_ratio = ratio, .tensile = 2.7e6, .cohesion = 2.7e6}};
    CHECK(beam.rigidity(radius, 2 * radius).tangential == doctest::Approx(ratio * k_n).scale(0));
    CHECK(law().rigidity(radius, 2 * radius).twisting ==
          doctest::Approx(beam.rigidity(radius, 2 * radius).twisting).epsilon(1e-12).scale(0));
}

TEST_CASE("as the bond breaks the spring's energy is lost in it; a broken bond holds no twist") {
    typename Twisting::Memory twisted{};
    twisted.twist = 0.01;
    const auto alone = law().law().respond(at(-1, Vec3::Zero()), 1, {});
    const auto breaks = law().respond(at(-1, Vec3::Zero()), 1, twisted);
    CHECK(breaks.failure == FailureMode::tension);
    CHECK(breaks.load.couple == Vec3::Zero());
    CHECK(breaks.load.stored == 0);
    // Beside it stands the energy of a stretch of 1 m.
    CHECK(breaks.load.lost_bond - alone.load.lost_bond ==
          doctest::Approx(0.5 * k_t * 1e-4).epsilon(1e-6).scale(0));
    CHECK(breaks.memory.twist == 0);
    const auto after = law().respond(at(1e-6, Vec3(0, 0, 100)), 1, breaks.memory);
    CHECK(after.load.couple == Vec3::Zero());
    CHECK(after.memory.twist == 0);
    CHECK(after.load.lost_bond == 0);
}

TEST_CASE("a sphere on a held one swings at sqrt(k_t / I), and dies away by its share of critical damping") {
    const Real inertia = at(0, Vec3::Zero()).effective_inertia, omega = std::sqrt(k_t / inertia);
    for (const Real damping : {0.0, 0.05}) {
        const Real damped = omega * std::sqrt(1 - square(damping));
        const Twisting twisting = law(damping);
        Twisting::Memory memory{};
        const Real start = 1e-3 * omega;                         // [rad/s]
        Real spin = start, before = start, lost = 0, worst = 0;  // half a step ago
        for (int n = 1; n * dt * omega < 40; ++n) {
            BondKinematics bond = at(0, Vec3(0, 0, spin + 0.5 * (spin - before)));
            bond.velocity.setZero(), bond.displacement.setZero();
            bond.rotation = dt * Vec3(0, 0, spin);
            const auto answer = twisting.respond(bond, 1, memory);
            memory = answer.memory, lost += answer.load.lost_bond;
            const Real t = n * dt,
                       expected = start / damped * std::exp(-damping * omega * t) * std::sin(damped * t);
            worst = std::max(worst, std::abs(memory.twist - expected) * omega / start);
            before = spin, spin += dt * answer.load.couple.z() / inertia;
        }
        MESSAGE("damping " << damping << ": off by " << worst << " of the amplitude at most");
        // (omega dt)^2 / 24 of phase a radian, 3e-5 in all; zeta omega dt, 2e-4, as the dashpot starts.
        CHECK(omega * dt < 0.01);
        CHECK(worst < 1e-3);
        const Real left = 0.5 * inertia * square(spin) + 0.5 * k_t * square(memory.twist);
        CHECK(left + lost == doctest::Approx(0.5 * inertia * square(start)).epsilon(0.01).scale(0));
        CHECK((lost > 0) == (damping > 0));
    }
}

TEST_CASE("parameters that make no sense are refused") {
    CHECK(message_of([] { law(0, 0); }).find("TwistResistance.stiffness_factor must be finite and > 0") !=
          std::string::npos);
    CHECK_THROWS_AS(law(2), InputError);
}
