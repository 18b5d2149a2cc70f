// The laws that docs/howto/own_law.md shows, as a user wrote them.
#include "../consumer/shown/hysteretic_spring.hpp"
#include "../consumer/shown/simple_shear.hpp"
#include "../consumer/shown/specific_energy.hpp"

#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

/// The same law for one contact at a time.
struct OneByOne : HystereticSpring {
    using HystereticSpring::HystereticSpring;
    ContactResponse<Real, Memory<Real>> respond(const ContactKinematics<Real>& contact,
                                                const Memory<Real>& memory) const noexcept {
        return HystereticSpring::respond(contact, memory);
    }
};
static_assert(AnswersPacks<HystereticSpring>);
static_assert(ContactLaw<OneByOne> && !AnswersPacks<OneByOne>);

const HystereticSpring law{{.stiffness = 1e6, .restitution = 0.6}};

struct Outcome {
    Ledger ledger;
    Real separation;      ///< [m/s]
    Real effective_mass;  ///< [kg]
};

/// Two equal spheres, head-on, that have a gap [m] between them at first.
Outcome collide(Real restitution, Real speed, Real gap, Real dt) {
    Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(0.02, {.velocity = {speed, 0, 0}}).add_sphere(0.02, {.position = {0.04 + gap, 0, 0}});
    auto sim = simulate(scene).contact(HystereticSpring{{.stiffness = 1e6, .restitution = restitution}});
    sim.run({.end_time = 0.003 / speed, .time_step = dt});
    const Particles& p = sim.particles();
    return {sim.ledger(), (p.velocity[1] - p.velocity[0]).x(), 1 / (p.inverse_mass[0] + p.inverse_mass[1])};
}

}  // namespace

TEST_CASE("one collision: restitution e, 1/2 m_eff v^2 (1 - e^2) lost, the ledger closed") {
    for (const Real e : {1.0, 0.6, 0.2})
        for (const Real speed : {0.1, 1.0}) {
            CAPTURE(e);
            CAPTURE(speed);
            const Outcome end = collide(e, speed, 1e-4, 1e-6);
            const Real brought = 0.5 * square(speed) * end.effective_mass;
            CHECK(end.separation == doctest::Approx(e * speed).epsilon(1e-3).scale(0));
            CHECK(end.ledger.lost_normal == doctest::Approx((1 - e * e) * brought).epsilon(1e-4));
            CHECK(end.ledger.lost_sliding == 0);
            CHECK(end.ledger.stored_contacts == 0);
            CHECK(end.ledger.residual_relative() < 1e-12);
            CHECK(std::abs(end.ledger.integration_residue()) < 1e-4 * brought);
        }
}

TEST_CASE("the integration residue falls with the square of the step") {
    // It depends on where in a step the contact begins and on where it ends: the mean over gaps and
    // durations.
    const auto mean_residue = [](Real dt) {
        constexpr int cases = 256;
        Real sum = 0;
        for (int n = 0; n < cases; ++n) {
            const Real restitution = 0.5 + 0.2 * n / cases, gap = 1e-4 + 1e-5 * std::fmod(0.618034 * n, 1);
            sum += std::abs(collide(restitution, 1, gap, dt).ledger.integration_residue()) / cases;
        }
        return sum;
    };
    CHECK(mean_residue(5e-6) < 0.3 * mean_residue(1e-5));
}

TEST_CASE("many bounces in a box: nothing gained, the ledger closed") {
    Scene scene;
    for (int n = 0; n < 8; ++n)
        scene.add_sphere(0.01 + 0.001 * n, {.position = {0.05 * (n % 2) + 0.003 * n, 0.05 * (n / 2 % 2),
                                                         0.03 + 0.06 * (n / 4) + 0.002 * n}});
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    scene.add_wall({-0.03, 0, 0}, {1, 0, 0}).add_wall({0.1, 0, 0}, {-1, 0, 0});
    scene.add_wall({0, -0.03, 0}, {0, 1, 0}).add_wall({0, 0.1, 0}, {0, -1, 0});
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0.5, .safety = 0.2});
    const Ledger& ledger = sim.ledger();
    CHECK(ledger.lost_normal > 0.3 * (ledger.potential_start - ledger.potential));
    CHECK(ledger.residual_relative() < 1e-12);
    CHECK(std::abs(ledger.integration_residue()) < 0.01 * ledger.lost_normal);
}

TEST_CASE("packs, contacts one by one, and the engine's lane by lane answer alike") {
    std::mt19937 random(3);
    std::uniform_real_distribution<Real> u(-1, 1);
    const OneByOne one_by_one(law.params());
    for (int n = 0; n < 1000; ++n) {
        ContactKinematics<Pack> contact{};
        ContactPack<HystereticSpring> whole;
        ContactPack<OneByOne> lanes;
        for (int lane = 0; lane < pack_lanes; ++lane) {
            const Vec3 normal = Vec3(u(random), u(random), u(random)).normalized();
            for (int a = 0; a < 3; ++a) contact.normal[a].set(lane, normal[a]);
            contact.overlap.set(lane, 1e-4 * u(random));
            const Real deepest = 1e-4 * std::max(u(random), 0.0);  // half of them have just begun
            whole.memory.deepest.set(lane, deepest);
            lanes.memory[static_cast<std::size_t>(lane)].deepest = deepest;
        }
        const HystereticSpring::Memory<Pack> before = whole.memory;
        const PackMask all = Pack(1) > Pack(0);
        whole.touched = lanes.touched = all;
        const auto by_pack = detail::answer(law, contact, whole, all);
        const auto by_lane = detail::answer(one_by_one, contact, lanes, all);
        for (int lane = 0; lane < pack_lanes; ++lane) {
            const auto alone =
                law.respond(detail::lane_of(contact, lane),
                            detail::memory_of_lane<HystereticSpring::Memory<Real>>(before, lane));
            const auto is = [](Real value, Real size) {
                return doctest::Approx(value).scale(size).epsilon(1e-14);
            };
            for (const auto& answer : {detail::lane_of(by_pack, lane), detail::lane_of(by_lane, lane)}) {
                for (int a = 0; a < 3; ++a) REQUIRE(answer.force[a] == is(alone.load.force[a], 100));
                REQUIRE(answer.stored == is(alone.load.stored, 0.01));
                REQUIRE(answer.lost_normal == is(alone.load.lost_normal, 0.01));
            }
            REQUIRE(alone.load.lost_normal >= 0);
            REQUIRE(whole.memory.deepest[lane] == alone.memory.deepest);
            REQUIRE(lanes.memory[static_cast<std::size_t>(lane)].deepest == alone.memory.deepest);
        }
    }
}

TEST_CASE("with a wear law and a fluid of one's own") {
    Scene scene;
    scene.concrete = ConcreteBlock{flat_lattice(0.06, 0.06, {.sphere_diameter = 0.02, .layers = 1})};
    scene.add_sphere(0.01, {.position = {0, 0, 0.05}, .velocity = {0, 0, -1}});
    auto sim = simulate(scene)
                   .contact(law)
                   .wear(SpecificEnergy{{.impact = 1e6}})
                   .fluid(SimpleShear{{.rate = 2, .level = 0.5}});
    sim.run({.end_time = 0.1});
    const Ledger& ledger = sim.ledger();
    CHECK(ledger.concrete_lost_normal > 0);
    CHECK(sim.concrete().worn_volume() == doctest::Approx(0.5e-6 * ledger.concrete_lost_normal).scale(0));
    Vec3 moving = Vec3::Zero();
    for (const Vec3& velocity : sim.particles().velocity) moving += velocity;
    CHECK(moving.x() > 1e-4);  // the flow drags the sphere along; concrete is fixed
    CHECK(ledger.residual_relative() < 1e-12);
}
