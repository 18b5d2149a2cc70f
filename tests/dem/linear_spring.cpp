// The linear spring-dashpot-slider as a pure function.
#include <abrade/dem/laws/linear_spring.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <random>

using namespace abrade;

namespace {

using Memory = LinearSpring::Memory<Real>;

ContactKinematics<Real> head_on(Real overlap, Real approach, Real dt = 1e-5) {
    return {Vec3(0, 0, 1), overlap, Vec3(0, 0, -approach), 100, 200, dt};
}

LinearSpring law(Real restitution = 0.6, Real friction = 0.5) {
    return LinearSpring{{.stiffness = 1e6, .restitution = restitution, .friction = friction}};
}

struct Random {
    std::mt19937 engine{23};
    Real uniform(Real low, Real high) { return std::uniform_real_distribution<Real>(low, high)(engine); }
    Real size(Real low_exponent, Real high_exponent) {
        return std::pow(10, uniform(low_exponent, high_exponent));
    }
    Vec3 any() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }
};

/// Restitution of x'' = -2 zeta x' - x from x = 0, x' = 1 until the force falls to zero, by Runge-Kutta.
Real restitution_by_integration(Real zeta) {
    Real x = 0, v = 1;
    const Real dt = 1e-4;
    const auto a = [&](Real at, Real speed) { return -at - 2 * zeta * speed; };
    while (x == 0 || a(x, v) < 0) {
        const Real k1 = a(x, v), k2 = a(x + 0.5 * dt * v, v + 0.5 * dt * k1),
                   k3 = a(x + 0.5 * dt * (v + 0.5 * dt * k1), v + 0.5 * dt * k2),
                   k4 = a(x + dt * (v + 0.5 * dt * k2), v + dt * k3);
        x += dt * v + dt * dt / 6 * (k1 + k2 + k3);
        v += dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return -v;
}

}  // namespace

TEST_CASE("at rest: a spring's push, its energy, no loss") {
    const auto [load, memory] = law().respond(head_on(1e-4, 0), Memory{});
    CHECK((load.force - Vec3(0, 0, 100)).norm() < 1e-12);
    CHECK(load.stored == doctest::Approx(0.005).scale(0));
    CHECK(load.lost_normal == 0);
    CHECK(load.lost_tangential == 0);
    CHECK(memory.spring == Vec3::Zero());
}

TEST_CASE("the force on i points along the normal, from j to i: pushed apart") {
    for (const Vec3& n : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(Vec3(1, 2, 3).normalized())}) {
        ContactKinematics<Real> contact = head_on(1e-4, 0);
        contact.normal = n;
        contact.velocity = -0.5 * n;  // approaching
        const auto load = law().respond(contact, Memory{}).load;
        CHECK(load.force.dot(n) > 100);  // spring and dashpot
        CHECK(load.force.cross(n).norm() < 1e-9);
        CHECK(load.lost_normal > 0);
    }
}

TEST_CASE("friction opposes the slip of i over j") {
    ContactKinematics<Real> contact = head_on(1e-4, 0);
    contact.velocity = {0.3, 0, 0};
    contact.displacement = contact.time_step * contact.velocity;
    const auto [load, memory] = law().respond(contact, Memory{});
    CHECK(load.force.x() < 0);
    CHECK(load.lost_tangential > 0);
    CHECK(memory.spring.x() > 0);
}

TEST_CASE("an open contact: no force, memory cleared, what it held is lost once") {
    const Memory held{Vec3(2e-6, 0, 0)};
    ContactKinematics<Real> contact = head_on(-1e-6, -1);
    const auto [load, memory] = law().respond(contact, held);
    CHECK(load.force == Vec3::Zero());
    CHECK(load.stored == 0);
    CHECK(load.lost_normal == 0);
    CHECK(load.lost_tangential ==
          doctest::Approx(0.5 * law().tangential_stiffness() * 4e-12).epsilon(1e-14).scale(0));
    CHECK(memory.spring == Vec3::Zero());
    CHECK(law().respond(contact, memory).load.lost_tangential == 0);
    contact.overlap = 0;  // touching in a point is not a contact
    CHECK(law().respond(contact, Memory{}).load.force == Vec3::Zero());
}

TEST_CASE("random histories: friction within Coulomb's cone, never tension, never a negative loss") {
    Random random;
    Real nearest = 0;
    for (int n = 0; n < 3000; ++n) {
        const Real k = random.size(3, 9), friction = n % 9 ? random.uniform(0, 1.5) : 0;
        const LinearSpring spring{{.stiffness = k,
                                   .restitution = random.uniform(0.01, 1),
                                   .friction = friction,
                                   .tangential_ratio = random.uniform(0.05, 1)}};
        Memory memory{};
        Vec3 normal = random.any().normalized();
        const Real mass = random.size(-6, 2), speed = random.size(-6, 1), dt = random.size(-8, -3),
                   depth = random.size(-9, -3);
        for (int step = 0; step < 30; ++step) {
            normal = (normal + 0.1 * random.any()).normalized();
            const ContactKinematics<Real> contact{
                normal, depth * random.uniform(-0.2, 1), speed * random.any(), 1 / mass, 100, dt};
            const auto [load, next] = spring.respond(contact, memory);
            const Real push = load.force.dot(normal), rub = (load.force - push * normal).norm();
            // Rounded at the size of the terms: spring, dashpot and normal force.
            const Real terms = k * depth + 10 * std::sqrt(k * mass) * speed;
            REQUIRE(push >= -1e-13 * terms);
            REQUIRE(rub <= friction * push + 1e-12 * terms);
            REQUIRE(load.lost_normal >= 0);
            REQUIRE(load.lost_tangential >= 0);
            REQUIRE(load.stored >= 0);
            REQUIRE(std::abs(next.spring.dot(normal)) <= 1e-9 * (next.spring.norm() + 1e-300));
            if (friction * push > 1e-6 * terms) nearest = std::max(nearest, rub / (friction * push));
            memory = next;
        }
    }
    CHECK(nearest > 0.999);  // the cone was really reached
}

TEST_CASE("each step accounts for its energy: work in = stored + lost, to second order in dt") {
    // A prescribed path: press, shear, release, sliding or not. With velocities that belong to the same time
    // as the positions, sum(f . v dt) is the trapezoidal rule: fourfold less error with half the step.
    const auto mismatch = [](Real friction, Real restitution, int steps, Real* lost = nullptr) {
        const LinearSpring spring{{.stiffness = 1e6, .restitution = restitution, .friction = friction}};
        const Real period = 1e-3, dt = period / steps;
        Memory memory{};
        Real work = 0, dissipated = 0, stored = 0;
        for (int n = 0; n <= steps; ++n) {
            const Real t = n * dt, s = std::sin(pi * t / period);
            // The overlap begins and ends with speed zero: no jump of the dashpot at the ends.
            const Real overlap = 1e-4 * s * s + 1e-12,
                       approach = 1e-4 * pi / period * std::sin(2 * pi * t / period);
            const Real slip = 0.02 * s * std::cos(2.3 * pi * t / period);
            const auto [load, next] =
                spring.respond({Vec3(0, 0, 1), overlap, Vec3(slip, 0, -approach), 0.01, 0.005, dt,
                                Vec3(dt * 0.02 * std::sin(pi * (t - 0.5 * dt) / period) *
                                         std::cos(2.3 * pi * (t - 0.5 * dt) / period),
                                     0, 0)},
                               memory);
            work -= load.force.dot(Vec3(slip, 0, -approach)) * dt;
            dissipated += load.lost_normal + load.lost_tangential;
            stored = load.stored;
            memory = next;
        }
        if (lost) *lost = dissipated;
        return std::abs(work - dissipated - stored);
    };
    struct Case {
        Real friction, restitution;
    };
    for (const Case& c : {Case{1e3, 1.0}, {1e3, 0.5}, {0.05, 1.0}, {0.05, 0.5}}) {
        CAPTURE(c.friction);
        CAPTURE(c.restitution);
        Real lost = 0;
        const Real coarse = mismatch(c.friction, c.restitution, 200),
                   fine = mismatch(c.friction, c.restitution, 800, &lost);
        const Real peak = 0.5 * 1e6 * 1e-8;
        CHECK(fine < 1e-4 * peak);  // (pi/800)^2 = 1.5e-5 times a factor of order one
        if (coarse > 1e-9 * peak)
            CHECK(coarse / fine > 8);  // 16 at second order; sliding begins within a step
        if (c.restitution == 1 && c.friction > 1)
            CHECK(lost < 1e-3 * peak);  // it slips at the very end only, when nothing holds it any more
        else
            CHECK(lost > 1e-5 * peak);
    }
}

TEST_CASE("what has no friction loses nothing to sliding") {
    const LinearSpring smooth{{.stiffness = 1e6, .restitution = 1}};
    Memory memory{};
    Real lost = 0;
    for (int n = 0; n < 100; ++n) {
        ContactKinematics<Real> contact = head_on(1e-4, 0);
        contact.velocity.x() = 0.01 * n;  // speeding up
        contact.displacement = contact.time_step * Vec3(0.01 * (n - 0.5), 0, 0);
        const auto [load, next] = smooth.respond(contact, memory);
        lost += load.lost_tangential;
        REQUIRE(load.force.x() == 0);
        memory = next;
    }
    CHECK(lost == 0);
}

TEST_CASE("damping ratio gives the restitution asked for, when the contact cannot pull") {
    CHECK(damping_ratio_without_tension(1) == 0);
    Real before = 0;
    for (const Real e : {0.99, 0.9, 0.7, 0.5, 0.3, 0.2, 0.14, 0.1, 0.05}) {
        const Real zeta = damping_ratio_without_tension(e);
        CAPTURE(e);
        CHECK(zeta > before);  // falls steadily with e, over critical damping at exp(-2) = 0.135 too
        before = zeta;
        CHECK(restitution_by_integration(zeta) ==
              doctest::Approx(e).epsilon(2e-4).scale(0));  // stops within dt = 1e-4 of the zero
    }
    CHECK(damping_ratio_without_tension(std::exp(-2.0)) == doctest::Approx(1).epsilon(1e-6).scale(0));
    for (const Real bad : {0.0, -0.5, 1.0000001, std::numeric_limits<Real>::quiet_NaN()})
        CHECK_THROWS_AS(damping_ratio_without_tension(bad), InputError);
}

TEST_CASE("the stable step falls with stiffness and damping and grows with mass") {
    const auto step = [](Real k, Real e, Real m) {
        return LinearSpring{{.stiffness = k, .restitution = e}}.stable_dt(m, 0.01);
    };
    CHECK(step(4e6, 0.5, 0.1) == doctest::Approx(0.5 * step(1e6, 0.5, 0.1)).epsilon(1e-14).scale(0));
    CHECK(step(1e6, 0.5, 0.4) == doctest::Approx(2 * step(1e6, 0.5, 0.1)).epsilon(1e-14).scale(0));
    CHECK(step(1e6, 0.3, 0.1) < step(1e6, 0.9, 0.1));
    // An undamped pair alone, the loosest case, is stable up to 2/sqrt(k / (m/2)).
    CHECK(step(1e6, 1, 0.1) < 2 / std::sqrt(1e6 / 0.05));
}

TEST_CASE("parameters that make no sense are refused, with the rule") {
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    for (const Real bad : {0.0, -1e6, nan}) {
        CHECK_THROWS_AS(LinearSpring({.stiffness = bad}), InputError);
        CHECK_THROWS_AS(LinearSpring({.stiffness = 1e6, .tangential_ratio = bad}), InputError);
    }
    for (const Real bad : {0.0, -0.1, 1.1, nan})
        CHECK_THROWS_AS(LinearSpring({.stiffness = 1e6, .restitution = bad}), InputError);
    for (const Real bad : {-0.1, nan})
        CHECK_THROWS_AS(LinearSpring({.stiffness = 1e6, .friction = bad}), InputError);
    CHECK_THROWS_WITH_AS(
        LinearSpring({.stiffness = -1}),
        "LinearSpring.stiffness must be finite and > 0, got -1 N/m; stones on concrete use 1e6 to 1e8 N/m",
        InputError);
    CHECK_THROWS_WITH_AS(LinearSpring({.stiffness = 1e6, .restitution = 1.5}),
                         "LinearSpring.restitution must be in (0, 1], got 1.5; 1 loses nothing, 0.5 three "
                         "quarters of the energy",
                         InputError);
    CHECK(describe(law()) ==
          "LinearSpring(stiffness = 1e+06 N/m, restitution = 0.6, friction = 0.5, tangential_ratio = "
          "0.2857142857142857, damping_mass_free = 0)");
}
