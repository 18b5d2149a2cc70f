// The linear hysteretic contact as a pure function, and in impacts of one mass.
#include "one_contact.hpp"

#include <abrade/dem/laws/linear_hysteretic.hpp>
#include <abrade/dem/laws/linear_spring.hpp>

#include <doctest/doctest.h>

#include <limits>

using namespace one_contact;

namespace {

using Memory = LinearHysteretic::Memory<Real>;

LinearHysteretic law(Real restitution = 0.6, Real friction = 0.5, Real rest_damping = 0.02) {
    return LinearHysteretic{
        {.stiffness = 1e6, .restitution = restitution, .friction = friction, .rest_damping = rest_damping}};
}
ContactKinematics<Real> at(Real overlap, Real approach = 0, Real come = 0, Real dt = 1e-6) {
    return {Vec3(0, 0, 1), overlap, Vec3(0, 0, -approach), 100, 200, dt, Vec3(0, 0, -come)};
}

}  // namespace

TEST_CASE("force over overlap: loaded, unloaded in part, loaded again, beyond, until the dent is left") {
    for (const Real e : {0.3, 0.6, 0.9, 1.0}) {
        CAPTURE(e);
        const LinearHysteretic spring = law(e);
        const Real k1 = 1e6, k2 = k1 / square(e);
        Memory memory{};
        Real deepest = 0, lost = 0;
        const auto go = [&](Real to) {
            const auto [load, next] = spring.respond(at(to, 0, 1), memory);
            deepest = std::max(deepest, to);
            const Real force = std::max(k2 * (to - (1 - square(e)) * deepest), 0.0);
            REQUIRE(load.force.z() == doctest::Approx(force).scale(100).epsilon(1e-13));
            REQUIRE(load.stored == doctest::Approx(0.5 * square(force) / k2).scale(0.01).epsilon(1e-13));
            lost += load.lost_normal;
            REQUIRE(lost ==
                    doctest::Approx(0.5 * k1 * (1 - square(e)) * square(deepest)).scale(0.01).epsilon(1e-12));
            memory = next;
        };
        for (int n = 1; n <= 50; ++n) go(2e-6 * n);   // virgin
        for (int n = 50; n >= 42; --n) go(2e-6 * n);  // unloaded in part
        for (int n = 42; n <= 80; ++n) go(2e-6 * n);  // again, and beyond
        for (int n = 80; n >= 1; --n) go(2e-6 * n);   // to nearly open
        for (int n = 1; n <= 90; ++n) go(2e-6 * n);   // into the dent it kept
    }
}

TEST_CASE("a normal impact: restitution e, the share 1 - e^2 lost, at any speed and mass") {
    Real worst = 0, worst_share = 0;
    for (const Real e : {0.2, 0.4, 0.6, 0.8, 0.95, 1.0})
        for (const Real speed : {0.01, 1.0, 30.0})
            for (const Real mass : {1e-3, 1.0}) {
                const LinearHysteretic spring = law(e);
                const Real dt = 0.01 * std::sqrt(mass / spring.unloading_stiffness());
                const Outcome end = impact(spring, {.mass = mass, .speed = speed, .time_step = dt});
                worst = std::max(worst, std::abs(end.speed / speed - e));
                worst_share = std::max(worst_share, std::abs(end.lost / end.taken_up - (1 - e * e)));
                CHECK(spring.restitution(speed, mass, 0.01) == e);
            }
    MESSAGE("restitution off by " << worst << ", share lost by " << worst_share);
    CHECK(worst < 5e-5);         // (w dt)^2 / 8 of Verlet's method where a contact begins and ends
    CHECK(worst_share < 1e-12);  // both are taken at the overlap that is deepest
}

TEST_CASE("the loss does not know the partner's mass: from fixed to light, free or held") {
    // What moves is 1 kg. The law is told the effective mass with a partner of `partner`: of a free one that
    // moves; of one that bonds hold, which does not give way, less than what really moves.
    Real worst = 0;
    for (const Real e : {0.3, 0.6, 0.9})
        for (const Real damping : {0.0, 0.02, 0.5})
            for (const Real partner : {1e12, 1.0, 0.1, 1e-2, 1e-4})
                for (const bool held : {false, true}) {
                    CAPTURE(e);
                    CAPTURE(partner);
                    const Real effective = partner / (1 + partner), moving = held ? 1 : effective;
                    const LinearHysteretic spring = law(e, 0, damping);
                    const Fall fall{.mass = moving,
                                    .told_mass = effective,
                                    .time_step = 0.01 * std::sqrt(moving / spring.unloading_stiffness())};
                    const Outcome end = impact(spring, fall);
                    const Real brought = 0.5 * moving, share = end.lost / brought;
                    worst = std::max(worst, std::abs(share - (1 - e * e)));
                    REQUIRE(end.lost / end.taken_up == doctest::Approx(1 - e * e).epsilon(1e-12));
                }
    MESSAGE("share lost of what came in off by " << worst);
    CHECK(worst < 1e-4);  // the deepest overlap is seen once a step

    // What it replaces: a dashpot sized by a light partner that bonds hold loses next to nothing.
    const LinearSpring dashpot{{.stiffness = 1e6, .restitution = 0.6}};
    const Outcome end = impact(dashpot, {.mass = 1, .told_mass = 1e-4, .time_step = 1e-5});
    CHECK(end.lost < 0.02 * 0.5);
}

TEST_CASE("restitution is of second order in the step") {
    for (const Real e : {0.3, 0.6, 0.9}) {
        const LinearHysteretic spring = law(e);
        const Real stable = spring.stable_dt(2, 0.01);  // of each of two spheres whose effective mass is 1 kg
        // How far into its last step a contact ends depends on the step alone: a mean over steps.
        const auto at_share = [&](Real share) {
            Error all;
            constexpr int steps = 16;
            for (int n = 0; n < steps; ++n) {
                const Real dt = share * stable * (1 - 0.2 * n / steps);
                const Error one = restitution_error(spring, {.mass = 1, .time_step = dt}, e);
                all.mean += one.mean / steps, all.bias += one.bias / steps;
                all.worst = std::max(all.worst, one.worst);
            }
            return all;
        };
        const std::array<Error, 3> error{at_share(0.2), at_share(0.1), at_share(0.05)};
        MESSAGE("e = " << e << ", 0.2 of the stable step: " << error[0].worst << " at worst, "
                       << error[0].mean << " as a mean, " << error[0].bias << " with its sign; half the step "
                       << error[1].mean << ", a quarter " << error[2].mean);
        CHECK(error[0].worst < 3e-3);  // (w dt)^2 / 8: of an elastic spring by the same method
        CHECK(error[0].mean < 1e-3);
        CHECK(std::abs(error[0].bias) < 1e-5);
        CHECK(std::log2(error[0].mean / error[2].mean) / 2 > 1.8);
    }
}

TEST_CASE("an oblique path accounts for its energy: work in = stored + lost, to second order in dt") {
    for (const Real friction : {1e3, 0.2})
        for (const Real e : {1.0, 0.6})
            for (const Real damping : {0.0, 0.2}) {
                CAPTURE(friction);
                CAPTURE(e);
                CAPTURE(damping);
                Real lost = 0;
                const LinearHysteretic spring = law(e, friction, damping);
                const Real coarse = mismatch(spring, 400, 1e-4, 0.02),
                           fine = mismatch(spring, 3200, 1e-4, 0.02, &lost), peak = 0.5 * 1e6 * 4e-8;
                CHECK(fine < 1e-4 * peak);
                if (coarse > 1e-7 * peak)
                    CHECK(fine < coarse / 20);  // 64 at second order, with kinks within steps
                CHECK(lost >= 0);
            }
}

TEST_CASE("random histories, oblique: friction within Coulomb's cone, no tension, never a negative loss") {
    Random random;
    Extremes all;
    for (int n = 0; n < 2000; ++n) {
        const Real k = random.size(3, 9), depth = random.size(-9, -3);
        const LinearHysteretic spring{{.stiffness = k,
                                       .restitution = random.uniform(0.05, 1),
                                       .friction = n % 9 ? random.uniform(0, 1.5) : 0,
                                       .tangential_ratio = random.uniform(0.05, 1),
                                       .rest_damping = n % 3 ? random.uniform(0, 0.5) : 0}};
        random_history(all, spring, random, depth, 100, spring.unloading_stiffness() * depth);
    }
    CHECK(all.least_loss == 0);
    CHECK(all.least_stored == 0);
    CHECK(all.least_push == 0);
    CHECK(all.steepest <= 1 + 1e-9);
    CHECK(all.steepest > 0.999);  // the cone was really reached
    CHECK(all.sliding > 1000);
    CHECK(all.dented > 1000);
    CHECK(all.opened > 1000);
}

TEST_CASE("a mass that falls on a plane comes to rest, and then loses nothing") {
    for (const Real damping : {0.02, 0.2}) {
        const LinearHysteretic spring = law(0.6, 0.5, damping);
        const Fall fall{.mass = 0.1,
                        .speed = 0,
                        .gap = 0.01,
                        .weight = 0.1 * standard_gravity,
                        .time_step = 0.05 * std::sqrt(0.1 / spring.unloading_stiffness())};
        const Outcome end = run(spring, fall, 6, false);
        const Real dropped = fall.weight * (fall.gap + end.overlap);
        MESSAGE("speed left " << end.speed << " m/s, lost in the last tenth " << end.last_lost << " J of "
                              << dropped);
        CHECK(std::abs(end.speed) < 1e-15);
        CHECK(end.last_lost < 1e-25 * dropped);  // round-off squared
        CHECK(end.lost + end.stored == doctest::Approx(dropped).epsilon(1e-4));
    }
}

TEST_CASE("what stands still loses nothing, whatever its dent") {
    Memory memory{};
    const LinearHysteretic spring = law();
    memory = spring.respond(at(2e-4), memory).memory;
    for (const Real overlap : {2e-4, 1.9e-4, 1.3e-4, 1e-4}) {
        const auto [load, next] = spring.respond(at(overlap), memory);
        CHECK(load.lost_normal == 0);
        CHECK(load.lost_tangential == 0);
        CHECK(next.deepest == 2e-4);
    }
}

TEST_CASE("a contact that is found pressed has its dent from before; what it came in this step counts") {
    const LinearHysteretic spring = law();
    const auto found = spring.respond(at(1e-4), Memory{});
    CHECK(found.load.force.z() == doctest::Approx(100));
    CHECK(found.load.lost_normal == 0);
    CHECK(found.memory.deepest == 1e-4);
    const Real whole = 0.5e6 * 0.64 * 1e-8;
    CHECK(spring.respond(at(1e-4, 0, 2e-4), Memory{}).load.lost_normal == doctest::Approx(whole));
    CHECK(spring.respond(at(1e-4, 0, 0.5e-4), Memory{}).load.lost_normal == doctest::Approx(0.75 * whole));
}

TEST_CASE("the dashpot for rest: while loaded again only, no more than the branches leave room for") {
    const LinearHysteretic spring = law(0.6, 0, 0.5);
    const Memory dented{Vec3::Zero(), 1e-4};
    const Real k2 = spring.unloading_stiffness();
    const auto force = [&](Real overlap, Real approach) {
        return spring.respond(at(overlap, approach), dented).load.force.z();
    };
    const Real elastic = k2 * (0.8e-4 - 0.64e-4), c = std::sqrt(k2 / 100);
    CHECK(force(0.8e-4, -1) == doctest::Approx(elastic));
    CHECK(force(0.8e-4, 1e-3) == doctest::Approx(elastic + c * 1e-3));
    CHECK(force(0.8e-4, 1e3) == doctest::Approx(2 * elastic));  // twice the elastic force
    CHECK(force(0.98e-4, 1e3) == doctest::Approx(100));         // that of the deepest overlap
    CHECK(force(1e-4, 1e3) == doctest::Approx(100));            // the line of loading: none
    CHECK(force(0.6e-4, 1e3) == 0);                             // apart in the dent: none
    CHECK(spring.respond(at(0.8e-4, 1e-3), dented).load.lost_normal == doctest::Approx(c * 1e-6 * 1e-6));
}

TEST_CASE("a contact that slides: friction mu f_n, its work is what is lost") {
    const Sliding off = slide(law(), 1e-4, 0.5);
    CHECK(off.force < 1e-12);
    CHECK(off.lost < 1e-12);
}

TEST_CASE("an open contact: no force, memory cleared, what its tangential spring held is lost once") {
    const LinearHysteretic spring = law();
    const auto [load, memory] = spring.respond(at(-1e-6, -1), Memory{Vec3(2e-6, 0, 0), 1e-4});
    CHECK(load.force == Vec3::Zero());
    CHECK(load.stored == 0);
    CHECK(load.lost_normal == 0);
    CHECK(load.lost_tangential ==
          doctest::Approx(0.5 * spring.tangential_stiffness() * 4e-12).epsilon(1e-14).scale(0));
    CHECK(memory.spring == Vec3::Zero());
    CHECK(memory.deepest == 0);
}

TEST_CASE("the stable step is that of unloading") {
    CHECK(law(0.5, 0.5, 0).stable_dt(0.1, 0.01) < law(1, 0.5, 0).stable_dt(0.1, 0.01));
    CHECK(law(0.5).rigidity(0.01).normal == doctest::Approx(4e6));
    CHECK(law(0.5, 0).rigidity(0.01).tangential == 0);
}

TEST_CASE("parameters that make no sense are refused, with the rule") {
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    for (const Real bad : {0.0, -1e6, nan}) {
        CHECK_THROWS_AS(LinearHysteretic({.stiffness = bad}), InputError);
        CHECK_THROWS_AS(LinearHysteretic({.stiffness = 1e6, .tangential_ratio = bad}), InputError);
        CHECK_THROWS_AS(LinearHysteretic({.stiffness = 1e6, .restitution = bad}), InputError);
    }
    for (const Real bad : {-0.1, nan}) {
        CHECK_THROWS_AS(LinearHysteretic({.stiffness = 1e6, .friction = bad}), InputError);
        CHECK_THROWS_AS(LinearHysteretic({.stiffness = 1e6, .rest_damping = bad}), InputError);
    }
    CHECK_THROWS_WITH_AS(LinearHysteretic({.stiffness = -1}),
                         "LinearHysteretic.stiffness must be finite and > 0, got -1 N/m; stones on concrete "
                         "use 1e6 to 1e8 N/m",
                         InputError);
    CHECK_THROWS_WITH_AS(LinearHysteretic({.stiffness = 1e6, .rest_damping = 0.7}),
                         "LinearHysteretic.rest_damping must be in [0, 0.5], got 0.7; it is a share of "
                         "critical damping; 0 lets a pressed bed ring",
                         InputError);
    CHECK(describe(law()) ==
          "LinearHysteretic(stiffness = 1e+06 N/m, restitution = 0.6, friction = 0.5, tangential_ratio = "
          "0.2857142857142857, rest_damping = 0.02)");
}
