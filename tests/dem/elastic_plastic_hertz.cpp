// The elastic-plastic contact as a pure function, and in impacts of one mass.
#include "one_contact.hpp"

#include <abrade/dem/laws/elastic_plastic_hertz.hpp>

#include <doctest/doctest.h>

#include <limits>

using namespace one_contact;

namespace {

using Memory = ElasticPlasticHertz::Memory<Real>;

ElasticPlasticHertz law(Real softening = 1, Real rest_damping = 0.02, Real friction = 0.5) {
    return ElasticPlasticHertz{{.youngs = 2.7e10,
                                .poisson = 0.2,
                                .yield_pressure = 1e8,
                                .friction = friction,
                                .youngs_other = 6e10,
                                .softening = softening,
                                .rest_damping = rest_damping}};
}
ContactKinematics<Real> at(Real overlap, Real curvature = 100, Real approach = 0, Real come = 0) {
    return {Vec3(0, 0, 1), overlap, Vec3(0, 0, -approach), 100, curvature, 1e-7, Vec3(0, 0, -come)};
}

/// The paper's formula, written anew: v_y = (pi / 2 E*)^2 sqrt(8 pi R^3 / 15 m) p_y^(5/2), and e.
struct ThorntonNing {
    Real yield_speed;
    Real restitution(Real speed) const {
        const Real r = yield_speed / speed;
        return std::sqrt(6 * std::sqrt(3.0) / 5) * std::sqrt(1 - r * r / 6) *
               std::pow(r / (r + 2 * std::sqrt(6.0 / 5 - r * r / 5)), 0.25);
    }
};
ThorntonNing thornton_ning(Real youngs, Real pressure, Real mass, Real radius) {
    return {std::pow(pi / (2 * youngs), 2) * std::sqrt(8 * pi * std::pow(radius, 3) / (15 * mass)) *
            std::pow(pressure, 2.5)};
}

/// A step that is some `steps`-th part of an elastic impact [s].
Real step_of(const ElasticPlasticHertz& hertz, Real mass, Real radius, Real speed, Real steps) {
    const Real deepest =
        std::pow(15 * mass * square(speed) / (16 * hertz.effective_youngs() * std::sqrt(radius)), 0.4);
    return 2.94 * deepest / (speed * steps);
}

}  // namespace

TEST_CASE("force over overlap: Hertz, the plastic line, Hertz of a flatter contact, and back") {
    const ElasticPlasticHertz hertz = law();
    const Real radius = 0.01, youngs = hertz.effective_youngs(), yield = hertz.yield_overlap(radius);
    CHECK(yield == doctest::Approx(square(pi * 1e8 / (2 * youngs)) * radius).epsilon(1e-13));
    const auto elastic = [&](Real overlap, Real of_radius) {
        return 4.0 / 3 * youngs * std::sqrt(of_radius) * std::pow(overlap, 1.5);
    };
    const auto virgin = [&](Real overlap) {
        return overlap < yield ? elastic(overlap, radius)
                               : elastic(yield, radius) + pi * radius * 1e8 * (overlap - yield);
    };
    Memory memory{};
    Real deepest = 0, lost = 0;
    const auto go = [&](Real to) {
        CAPTURE(to / yield);
        const auto [load, next] = hertz.respond(at(to, 1 / radius, 0, 1), memory);
        deepest = std::max(deepest, to);
        const Real most = virgin(deepest), flatter = radius * elastic(deepest, radius) / most;
        const Real dent = deepest - std::pow(3 * most / (4 * youngs * std::sqrt(flatter)), 2.0 / 3);
        const Real force = to > dent ? elastic(to - dent, flatter) : 0;
        REQUIRE(load.force.z() == doctest::Approx(force).scale(most).epsilon(1e-11));
        REQUIRE(load.stored ==
                doctest::Approx(0.4 * force * std::max(to - dent, 0.0)).scale(most * yield).epsilon(1e-11));
        // Work of the virgin line, less what can be had back.
        const Real over = std::max(deepest - yield, 0.0), first = std::min(deepest, yield);
        const Real work = 0.4 * elastic(first, radius) * first +
                          (elastic(yield, radius) + 0.5 * pi * radius * 1e8 * over) * over;
        lost += load.lost_normal;
        REQUIRE(lost ==
                doctest::Approx(work - 0.4 * most * (deepest - dent)).scale(most * yield).epsilon(1e-11));
        memory = next;
    };
    for (int n = 1; n <= 20; ++n) go(yield * 0.045 * n);  // elastic
    for (int n = 20; n >= 5; --n) go(yield * 0.045 * n);  // back along the same line
    CHECK(lost == 0);
    for (int n = 5; n <= 100; ++n) go(yield * 0.12 * n);   // yields
    for (int n = 100; n >= 85; --n) go(yield * 0.12 * n);  // unloaded in part
    for (int n = 85; n <= 200; ++n) go(yield * 0.12 * n);  // again, and beyond
    for (int n = 200; n >= 1; --n) go(yield * 0.12 * n);   // to nearly open
    for (int n = 1; n <= 250; ++n) go(yield * 0.12 * n);   // into the dent it kept
    CHECK(hertz.respond(at(yield * (1 - 1e-9), 100), {}).load.force.z() ==
          doctest::Approx(hertz.respond(at(yield * (1 + 1e-9), 100), {}).load.force.z()).epsilon(1e-8));
}

TEST_CASE("e(v) is Thornton & Ning's from 1.1 to 1000 yield speeds, whatever the softening") {
    Real worst = 0, worst_formula = 0;
    const ElasticPlasticHertz hard = law();
    for (const Real softening : {1.0, 0.1, 0.001})
        for (const Real radius : {0.002, 0.03})
            for (const Real mass : {1e-3, 0.5}) {
                const ElasticPlasticHertz soft = law(softening);
                const ThorntonNing paper = thornton_ning(hard.effective_youngs(), 1e8, mass, radius);
                CHECK(soft.yield_speed(mass, radius) == doctest::Approx(paper.yield_speed).epsilon(1e-12));
                for (const Real ratio : {1.1, 1.3, 2.0, 5.0, 20.0, 100.0, 1000.0}) {
                    const Real speed = ratio * paper.yield_speed, e = paper.restitution(speed);
                    const Fall fall{.mass = mass,
                                    .curvature = 1 / radius,
                                    .speed = speed,
                                    .time_step = step_of(soft, mass, radius, speed, 200)};
                    const Outcome end = impact(soft, fall);
                    worst = std::max(worst, std::abs(end.speed / speed / e - 1));
                    worst_formula =
                        std::max(worst_formula, std::abs(soft.restitution(speed, mass, radius) / e - 1));
                    REQUIRE(end.lost / end.taken_up == doctest::Approx(1 - e * e).epsilon(1e-3));
                }
                const Real slow = 0.9 * paper.yield_speed;
                CHECK(soft.restitution(slow, mass, radius) == 1);
                const Outcome end = impact(soft, {.mass = mass,
                                                  .curvature = 1 / radius,
                                                  .speed = slow,
                                                  .time_step = step_of(soft, mass, radius, slow, 200)});
                CHECK(end.lost == 0);
                CHECK(end.speed / slow == doctest::Approx(1).epsilon(1e-5));
            }
    MESSAGE("off from the paper's formula by " << worst << ", the law's own formula by " << worst_formula);
    CHECK(worst < 1e-4);  // 200 steps an impact
    CHECK(worst_formula < 1e-12);
}

TEST_CASE("far above the yield speed e falls with v^(-1/4)") {
    const ElasticPlasticHertz hertz = law();
    const Real mass = 0.1, radius = 0.01, yield = hertz.yield_speed(mass, radius);
    const auto measured = [&](Real speed) {
        const Fall fall{.mass = mass,
                        .curvature = 1 / radius,
                        .speed = speed,
                        .time_step = step_of(hertz, mass, radius, speed, 400)};
        return impact(hertz, fall).speed / speed;
    };
    const Real slope = std::log(measured(1000 * yield) / measured(200 * yield)) / std::log(5);
    MESSAGE("slope " << slope);
    CHECK(slope == doctest::Approx(-0.25).epsilon(0.01));
    CHECK(hertz.restitution(1e6 * yield, mass, radius) ==
          doctest::Approx(1.185 * std::pow(1e-6, 0.25)).epsilon(1e-3));
}

TEST_CASE("the loss does not know what the law is told of the partner's mass") {
    const ElasticPlasticHertz hertz = law(0.01, 0.5);
    const Real e = hertz.restitution(1, 1, 0.01);
    for (const Real told : {1.0, 0.1, 1e-2, 1e-4}) {
        const Outcome end =
            impact(hertz, {.mass = 1, .told_mass = told, .time_step = step_of(hertz, 1, 0.01, 1, 500)});
        CHECK(end.lost / 0.5 == doctest::Approx(1 - e * e).epsilon(1e-4));
        CHECK(end.speed == doctest::Approx(e).epsilon(1e-4));
    }
}

TEST_CASE("restitution is of second order in the step") {
    const ElasticPlasticHertz hertz = law(0.01);
    const Real mass = 0.1, radius = 0.01, e = hertz.restitution(1, mass, radius);
    const auto at_steps = [&](Real steps) {
        Real mean = 0;
        for (int n = 0; n < 16; ++n)
            mean +=
                restitution_error(
                    hertz,
                    {.mass = mass, .time_step = step_of(hertz, mass, radius, 1, steps * (1 + 0.2 * n / 16))},
                    e, 20)
                    .mean /
                16;
        return mean;
    };
    const Real coarse = at_steps(40), fine = at_steps(160);
    MESSAGE("e = " << e << ": off by " << coarse << " at 40 steps an elastic impact, " << fine << " at 160");
    CHECK(coarse < 1e-3);
    CHECK(std::log2(coarse / fine) / 2 > 1.8);
}

TEST_CASE("flat concrete: the spheres it is made of do not matter") {
    const auto with = [](Real flat_radius) {
        return ElasticPlasticHertz{{.youngs = 2.7e10, .yield_pressure = 1e8, .flat_radius = flat_radius}};
    };
    const Real overlap = 2e-5, stone = 1 / 0.03;
    const auto push = [&](const ElasticPlasticHertz& hertz, Real curvature) {
        return hertz.respond(at(overlap, curvature), Memory{}).load.force.z();
    };
    const Real flat = push(with(0), stone);
    for (const Real radius : {0.02, 0.01, 0.005}) {
        const ElasticPlasticHertz concrete = with(radius);
        CHECK(push(concrete, stone + 1 / radius) == doctest::Approx(flat).epsilon(1e-12));
        CHECK(push(concrete, stone) == flat);  // on a plane: nothing to take out
        CHECK(push(concrete, 2 / radius) == doctest::Approx(push(with(0), 1 / radius)).epsilon(1e-12));
        CHECK(push(concrete, 1 / radius) == push(with(0), 1 / radius));  // concrete's own sphere on a plane
        CHECK(concrete.rigidity(at(overlap, stone + 1 / radius)).normal ==
              doctest::Approx(with(0).rigidity(at(overlap, stone)).normal));
    }
}

TEST_CASE("an oblique path accounts for its energy: work in = stored + lost, to second order in dt") {
    for (const Real friction : {1e3, 0.2})
        for (const Real damping : {0.0, 0.2}) {
            CAPTURE(friction);
            CAPTURE(damping);
            const ElasticPlasticHertz hertz = law(1, damping, friction);
            const Real depth = 20 * hertz.yield_overlap(0.01);
            const Real peak = hertz.respond(at(2 * depth), Memory{}).load.force.z() * depth;
            const Real slip_speed = 100 * depth / 1e-3 * 0.2;
            const Real coarse = mismatch(hertz, 400, depth, slip_speed),
                       fine = mismatch(hertz, 3200, depth, slip_speed);
            MESSAGE("friction " << friction << ": " << coarse / peak << ", " << fine / peak);
            CHECK(fine < 1e-3 * peak);
            if (coarse > 1e-7 * peak) CHECK(fine < coarse / 20);
        }
}

TEST_CASE("random histories, oblique: friction within Coulomb's cone, no tension, never a negative loss") {
    Random random;
    Extremes all;
    for (int n = 0; n < 2000; ++n) {
        const ElasticPlasticHertz hertz{{.youngs = random.size(6, 11),
                                         .poisson = random.uniform(-0.5, 0.5),
                                         .yield_pressure = random.size(4, 10),
                                         .friction = n % 9 ? random.uniform(0, 1.5) : 0,
                                         .softening = random.size(-4, 0),
                                         .flat_radius = n % 2 ? random.size(-3, 0) : 0,
                                         .rest_damping = n % 3 ? random.uniform(0, 0.5) : 0}};
        const Real depth = random.size(-9, -4), curvature = random.size(0, 3);
        random_history(all, hertz, random, depth, curvature,
                       hertz.normal_stiffness(depth, curvature) * depth);
    }
    CHECK(all.least_loss == 0);
    CHECK(all.least_stored == 0);
    CHECK(all.least_push > -1e-300);  // a spring without stiffness, apart in its dent
    CHECK(all.steepest <= 1 + 1e-9);
    CHECK(all.steepest > 0.999);
    CHECK(all.sliding > 1000);
    CHECK(all.dented > 1000);
    CHECK(all.opened > 1000);
}

TEST_CASE("a mass that falls on a plane comes to rest, and then loses nothing") {
    const ElasticPlasticHertz hertz = law(0.01);
    const Fall fall{.mass = 0.1,
                    .curvature = 50,
                    .speed = 0,
                    .gap = 0.01,
                    .weight = 0.1 * standard_gravity,
                    .time_step = step_of(hertz, 0.1, 0.02, 0.44, 100)};
    const Outcome end = run(hertz, fall, 10, false);
    const Real dropped = fall.weight * (fall.gap + end.overlap);
    MESSAGE("speed left " << end.speed << " m/s, lost in the last tenth " << end.last_lost << " J of "
                          << dropped << ", " << end.steps << " steps");
    CHECK(std::abs(end.speed) < 1e-12);
    CHECK(end.last_lost < 1e-20 * dropped);
    CHECK(end.lost + end.stored == doctest::Approx(dropped).epsilon(1e-3));
}

TEST_CASE("a contact that slides: friction mu f_n, its work is what is lost") {
    const Sliding off = slide(law(0.01), 1e-4, 0.5);
    CHECK(off.force < 1e-12);
    CHECK(off.lost < 1e-12);
}

TEST_CASE("an open contact: no force, memory cleared, what its tangential spring held is lost once") {
    const auto [load, memory] = law().respond(at(-1e-6), Memory{Vec3(2e-6, 0, 0), 1e6, 1e-4});
    CHECK(load.force == Vec3::Zero());
    CHECK(load.stored == 0);
    CHECK(load.lost_normal == 0);
    CHECK(load.lost_tangential == doctest::Approx(0.5 * 1e6 * 4e-12).epsilon(1e-14).scale(0));
    CHECK(memory.spring == Vec3::Zero());
    CHECK(memory.stiffness == 0);
    CHECK(memory.deepest == 0);
}

TEST_CASE("a contact that is found pressed has its dent from before") {
    const Real deep = 10 * law().yield_overlap(0.01);
    const auto found = law().respond(at(deep), Memory{});
    CHECK(found.load.lost_normal == 0);
    CHECK(found.memory.deepest == deep);
    CHECK(law().respond(at(deep, 100, 0, deep), Memory{}).load.lost_normal > 0);
}

TEST_CASE("rigidity bounds the tangent of every branch") {
    const ElasticPlasticHertz hertz = law(1, 0);
    const Real yield = hertz.yield_overlap(0.01), step = 1e-6 * yield;
    for (const Real deepest : {0.5, 2.0, 10.0, 100.0})
        for (const Real share : {0.2, 0.6, 0.9, 0.999, 1.0}) {
            const Memory memory{Vec3::Zero(), 0, deepest * yield};
            const auto push = [&](Real x) { return hertz.respond(at(x), memory).load.force.z(); };
            const Real x = share * deepest * yield;
            CHECK((push(x) - push(x - step)) / step <= hertz.rigidity(at(x)).normal * (1 + 1e-5));
            CHECK((push(x + step) - push(x)) / step <= hertz.rigidity(at(x)).normal * (1 + 1e-5));
        }
    CHECK(law(0.01).stable_dt(0.1, 0.01) == doctest::Approx(10 * law().stable_dt(0.1, 0.01)).epsilon(1e-9));
}

TEST_CASE("parameters that make no sense are refused, with the rule") {
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    using Params = ElasticPlasticHertz::Params;
    const auto refused = [&](Real Params::*field, Real bad) {
        Params p{.youngs = 2.7e10, .yield_pressure = 1e8};
        p.*field = bad;
        CHECK_THROWS_AS(ElasticPlasticHertz{p}, InputError);
    };
    for (const Real bad : {0.0, -1.0, nan})
        for (const auto field :
             {&Params::youngs, &Params::yield_pressure, &Params::softening, &Params::largest_overlap})
            refused(field, bad);
    for (const Real bad : {-1.0, nan})
        for (const auto field : {&Params::friction, &Params::youngs_other, &Params::flat_radius,
                                 &Params::rest_damping, &Params::poisson, &Params::poisson_other})
            refused(field, bad);
    refused(&Params::softening, 1.1);
    CHECK_THROWS_WITH_AS(ElasticPlasticHertz({.youngs = 2.7e10}),
                         "ElasticPlasticHertz.yield_pressure must be finite and > 0, got 0 Pa; fit it to a "
                         "measured restitution",
                         InputError);
    CHECK_THROWS_WITH_AS(ElasticPlasticHertz({.youngs = 2.7e10, .yield_pressure = 1e8, .softening = 2}),
                         "ElasticPlasticHertz.softening must be in (0, 1], got 2; 1 takes the moduli as they "
                         "are, 0.01 a hundredth",
                         InputError);
    CHECK(describe(ElasticPlasticHertz{{.youngs = 2.7e10, .yield_pressure = 1e8}}) ==
          "ElasticPlasticHertz(youngs = 2.7e+10 Pa, poisson = 0.25, yield_pressure = 1e+08 Pa, friction = 0, "
          "youngs_other = 0 Pa, poisson_other = 0.25, softening = 1, flat_radius = 0 m, rest_damping = 0.02, "
          "largest_overlap = 0.01)");
}
