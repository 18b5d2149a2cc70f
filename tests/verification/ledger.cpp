// The energy ledger of many bodies: exact to round-off in every scene, off the continuous one by the square
// of the time step. docs/verification/ledger.md shows the same scenes.
#include "ledger_scenes.hpp"

#include <doctest/doctest.h>

using namespace ledger_scenes;

namespace {

constexpr LinearSpring::Params linear{.stiffness = 5e5, .restitution = 0.8, .friction = 0.3};
constexpr HertzMindlin::Params hertz{.youngs = 5e8, .restitution = 0.8, .friction = 0.3};

/// Runs a scene; the residual is looked at throughout, over the energy that has passed through until then.
struct Account {
    Ledger ledger{};
    long contacts_begun = 0;
    Real worst_residual = 0;
};
template <ContactLaw Law>
Account account(const Scene& scene, const typename Law::Params& params, Real end_time, Real safety = 0.5) {
    const Counted<Law> law(params);
    Account a;
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = end_time, .safety = safety, .observe_every = end_time / 20}, [&](const auto& now) {
        a.worst_residual = std::max(a.worst_residual, now.ledger().residual_relative());
    });
    a.ledger = sim.ledger(), a.contacts_begun = law.begun();
    return a;
}

template <ContactLaw Law>
void check_gas(const typename Law::Params& params) {
    const Account a = account<Law>(gas(11), params, 0.6);
    MESSAGE(Law::name << ": " << a.contacts_begun << " collisions, residual " << a.worst_residual
                      << ", integration residue over losses "
                      << a.ledger.integration_residue() / a.ledger.lost());
    CHECK(a.contacts_begun >= 10'000);
    CHECK(a.worst_residual < 1e-12);
    CHECK(a.ledger.lost_normal > 0.1 * a.ledger.kinetic_start);
    CHECK(a.ledger.lost_sliding > 0.1 * a.ledger.kinetic_start);
    CHECK(std::abs(a.ledger.integration_residue()) < 0.01 * a.ledger.lost());
}

template <ContactLaw Law>
void check_bed(typename Law::Params params) {
    params.restitution = 0.5, params.friction = 0.5;
    const Account a = account<Law>(bed(3, 4), params, 1.5);
    const Ledger& e = a.ledger;
    MESSAGE(Law::name << ": kinetic energy left " << e.kinetic / e.throughput() << ", residual "
                      << a.worst_residual << ", integration residue over losses "
                      << e.integration_residue() / e.lost());
    CHECK(e.kinetic < 1e-9 * e.throughput());  // it lies
    CHECK(e.stored_contacts > 0);
    CHECK(a.contacts_begun > 500);
    CHECK(a.worst_residual < 1e-12);
    CHECK(e.lost_normal > 0.1 * e.lost());
    CHECK(e.lost_sliding > 0.1 * e.lost());
    CHECK(std::abs(e.integration_residue()) < 0.02 * e.lost());
}

}  // namespace

TEST_CASE("a granular gas of 10,000 collisions closes its ledger to round-off") {
    check_gas<LinearSpring>(linear);
    check_gas<HertzMindlin>(hertz);
}

TEST_CASE("a bed of clumps that has come to rest closes its ledger to round-off") {
    check_bed<LinearSpring>(linear);
    check_bed<HertzMindlin>(hertz);
}

TEST_CASE("the integration residue of a gas and of a bed falls with the square of the step") {
    const auto check = [](std::string_view name, const auto& residue) {
        const Real coarse = residue(0.4), fine = residue(0.1), order = 0.5 * std::log2(coarse / fine);
        MESSAGE(name << ": " << coarse << " and " << fine << " of the energy lost, order " << order);
        CHECK(order > 1.6);
        CHECK(fine < 1e-3);
    };
    const auto of = [](const Account& a) {
        return std::abs(a.ledger.integration_residue()) / a.ledger.lost();
    };
    check("gas, LinearSpring",
          [&](Real safety) { return of(account<LinearSpring>(gas(11), linear, 0.3, safety)); });
    check("gas, HertzMindlin",
          [&](Real safety) { return of(account<HertzMindlin>(gas(11), hertz, 0.3, safety)); });
    check("bed, LinearSpring",
          [&](Real safety) { return of(account<LinearSpring>(bed(3, 4), linear, 0.5, safety)); });
    check("bed, HertzMindlin",
          [&](Real safety) { return of(account<HertzMindlin>(bed(3, 4), hertz, 0.5, safety)); });
}

TEST_CASE("elastic spheres that never part: a million steps leave the energy in its band") {
    // While contacts last, the force is smooth, and leapfrog conserves an energy that differs from the true
    // one by the square of the step.
    const auto band = [](Real safety) {
        const Counted<LinearSpring> law({.stiffness = 5e5});
        auto sim = simulate(squeezed()).contact(law);
        sim.run({.end_time = 0});
        const Real dt = safety * sim.stable_time_step().seconds, total = sim.ledger().kinetic_start;
        constexpr int steps = 1'000'000, looks = 2000;
        std::array<Real, 2> farthest{};  // in either half of the run
        int look = 0;
        sim.run({.end_time = steps * dt, .time_step = dt, .observe_every = steps / looks * dt},
                [&](const auto& now) {
                    const Ledger& e = now.ledger();
                    Real& half = farthest[look++ > looks / 2 ? 1 : 0];
                    half = std::max(
                        half,
                        std::abs(e.kinetic + e.stored_contacts - e.kinetic_start - e.stored_start) / total);
                });
        MESSAGE("band " << farthest[0] << " of the kinetic energy, then " << farthest[1] << ", residual "
                        << sim.ledger().residual_relative());
        CHECK(law.begun() == 36);
        CHECK(farthest[1] < 1.1 * farthest[0]);
        CHECK(sim.ledger().residual_relative() < 1e-12);
        return farthest[1];
    };
    const Real coarse = band(0.5), fine = band(0.25);
    CHECK(coarse < 0.2);
    CHECK(std::log2(coarse / fine) == doctest::Approx(2).epsilon(0.1).scale(0));
}

TEST_CASE("elastic spheres that part and meet: energy walks at random, as far as theory says") {
    // The spring's stiffness jumps as a contact begins and ends. Where in its step that falls, theta in [0,
    // 1], decides by how much the energy that leapfrog conserves jumps:
    //   dE = 1/2 k v^2 dt^2 (theta^2 - theta + 1/6),
    // whose mean is 0 and whose variance is (k v^2 dt^2)^2 / 720; v the normal speed. Twice a collision.
    const LinearSpring::Params params{.stiffness = 5e5};
    for (const Real safety : {0.2, 0.1}) {
        const Counted<LinearSpring> law(params);
        auto sim = simulate(handful()).contact(law);
        sim.run({.end_time = 0});
        const Real dt = safety * sim.stable_time_step().seconds;
        constexpr int steps = 1'000'000;
        Real farthest = 0;
        sim.run({.end_time = steps * dt, .time_step = dt, .observe_every = steps / 1000 * dt},
                [&](const auto& now) {
                    const Ledger& e = now.ledger();
                    farthest = std::max(farthest, std::abs(e.kinetic + e.stored_contacts - e.kinetic_start));
                });
        const Real deviation = params.stiffness * dt * dt * std::sqrt(law.speed4() / 360);
        MESSAGE(law.begun() << " collisions: energy went " << farthest / sim.ledger().kinetic_start
                            << " away at most, one standard deviation is "
                            << deviation / sim.ledger().kinetic_start);
        CHECK(farthest < 4 * deviation);
        CHECK(farthest > 0.2 * deviation);
        CHECK(sim.ledger().residual_relative() < 1e-12);
    }
}
