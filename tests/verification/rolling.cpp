// Resistance to rolling against closed forms; docs/verification/sandpile.md explains them.
#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/dem/laws/rolling_resistance.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

using Linear = RollingResistance<LinearSpring>;
using Hertz = RollingResistance<HertzMindlin>;

namespace {

constexpr Real g = standard_gravity, r = 0.01, k = 1e5;
const Real mass = 4.0 / 3 * pi * cube(r) * 2650;

Linear linear(Real rolling, Real friction = 0.8, Linear::Model model = Linear::Model::elastic_plastic,
              Real damping = 0.3) {
    return Linear{{.contact = {.stiffness = k, .restitution = 0.5, .friction = friction},
                   .friction = rolling,
                   .damping = damping,
                   .model = model}};
}

/// A sphere on a plane that is tilted by `slope` about y, resting in its overlap, rolling at `speed`
/// downhill.
Scene on_plane(Real slope, Real speed = 0, Real stiffness = k) {
    Scene scene;
    scene.gravity = g * Vec3(std::sin(slope), 0, -std::cos(slope));
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    const Real overlap = mass * g * std::cos(slope) / stiffness;
    scene.add_sphere(
        r,
        {.position = {0, 0, r - overlap}, .velocity = {speed, 0, 0}, .angular_velocity = {0, speed / r, 0}});
    return scene;
}

bool is_near(Real value, Real expected, Real share) {
    return std::abs(value - expected) <= share * std::abs(expected);
}

template <class Law>
auto run(Scene scene, const Law& law, Real time, RunOptions options = {}) {
    auto sim = simulate(std::move(scene)).contact(law);
    options.end_time = time;
    sim.run(options);
    CHECK(sim.ledger().residual_relative() < 1e-12);
    CHECK(sim.ledger().lost_rolling >= 0);
    return sim;
}

}  // namespace

TEST_CASE("a rolling sphere decelerates at 5/7 mu_r g, comes to rest, and stays") {
    // f r - M = 0.4 m r^2 a/r and -f = m a, M = mu_r r m g.
    const Real mu_r = 0.1, speed = 0.2, a = 5.0 / 7 * mu_r * g;
    for (const auto model : {Linear::Model::elastic_plastic, Linear::Model::constant_torque}) {
        const Linear law = linear(mu_r, 0.8, model);
        const auto half = run(on_plane(0, speed), law, 0.5 * speed / a);
        CHECK(is_near(half.particles().velocity[0].x(), 0.5 * speed, 0.005));
        CHECK(is_near(r * half.particles().angular_velocity(0).y(), 0.5 * speed, 0.005));
        const auto rest = run(on_plane(0, speed), law, 3 * speed / a);
        // The spring's own angle is on top of the way: theta_m = delta / (2.25 mu_r R), 0.2 % of it.
        CHECK(is_near(rest.particles().position[0].x(), 0.5 * square(speed) / a, 0.005));
        CHECK(rest.ledger().kinetic < 1e-9 * rest.ledger().kinetic_start);
        CHECK(is_near(rest.ledger().lost_rolling, rest.ledger().kinetic_start, 0.005));
        CHECK(std::abs(rest.ledger().integration_residue()) < 2e-3 * rest.ledger().kinetic_start);
    }
}

TEST_CASE("a sphere rests on a slope below tan(theta) = mu_r and rolls down above it") {
    const Real mu_r = 0.2;
    for (const Real share : {0.5, 0.95}) {
        const Real slope = std::atan(share * mu_r);
        auto sim = simulate(on_plane(slope)).contact(linear(mu_r));
        sim.run({.end_time = 1});
        const Vec3 settled = sim.particles().position[0];
        sim.run({.end_time = 3});
        CAPTURE(share);
        CHECK((sim.particles().position[0] - settled).norm() < 1e-12);
        CHECK(settled.x() < 0.01 * r);
        CHECK(sim.ledger().residual_relative() < 1e-12);
    }
    const Real slope = std::atan(2 * mu_r);
    const auto sim = run(on_plane(slope), linear(mu_r), 0.5);
    const Real a = 5.0 / 7 * g * (std::sin(slope) - mu_r * std::cos(slope));
    CHECK(is_near(sim.particles().velocity[0].x(), 0.5 * a, 0.005));
    CHECK(is_near(sim.particles().position[0].x(), 0.125 * a, 0.005));
    const auto hardly = run(on_plane(std::atan(1.05 * mu_r)), linear(mu_r), 0.5);
    CHECK(hardly.particles().velocity[0].x() > 0.02);
}

TEST_CASE("constant torque holds nothing: on the slope where the spring rests, it creeps") {
    const Real slope = std::atan(0.1);
    const auto creeps = run(on_plane(slope), linear(0.2, 0.8, Linear::Model::constant_torque), 1);
    const auto rests = run(on_plane(slope), linear(0.2), 1);
    CHECK(creeps.particles().velocity[0].x() > 1e-6);
    CHECK(std::abs(rests.particles().velocity[0].x()) < 1e-12);
}

TEST_CASE("a sphere stays on top of another below tan(phi) = mu_r / 2: the effective radius is half") {
    for (const bool stays : {true, false}) {
        const Real share = stays ? 0.8 : 1.2;
        const Real mu_r = 0.4, phi = std::atan(0.5 * share * mu_r);
        Scene scene;
        scene.add_wall({0, 0, -r}, {0, 0, 1});
        scene.add_sphere(r, {.position = {0, 0, 0}}, 1e6);  // so heavy that it does not move
        const Real apart = 2 * r - mass * g * std::cos(phi) / k;
        scene.add_sphere(r, {.position = apart * Vec3(std::sin(phi), 0, std::cos(phi))});
        const auto sim = run(std::move(scene), linear(mu_r), 1, {.safety = 0.3});
        CAPTURE(share);
        const Vec3 line = sim.particles().position[1] - sim.particles().position[0];
        CHECK((std::atan2(line.x(), line.z()) < 1.05 * phi) == stays);
    }
}

TEST_CASE("the rolling spring swings at sqrt(k_r / I), and its dashpot damps it as it should") {
    // Without friction a sphere on a plane turns about its centre, I = 0.4 m r^2, k_r = 2.25 k_n (mu_r r)^2.
    const Real mu_r = 0.5, k_r = 2.25 * k * square(mu_r * r), inertia = 0.4 * mass * r * r;
    const Real c_r = 2 * 0.05 * std::sqrt(1.4 * mass * r * r * k_r);
    for (const Real damping : {0.0, 0.05}) {
        Scene scene = on_plane(0);
        scene.stones[0].state.angular_velocity = {0, 0.05, 0};
        const Real decay = damping > 0 ? 0.5 * c_r / inertia : 0;
        const Real omega = std::sqrt(k_r / inertia - square(decay)), period = 2 * pi / omega;
        auto sim = simulate(scene).contact(linear(mu_r, 0, Linear::Model::elastic_plastic, damping));
        sim.run({.end_time = 3.25 * period, .time_step = period / 400});
        // A quarter past a whole period it stands still; then it swings back through rest.
        CAPTURE(damping);
        CHECK(std::abs(sim.particles().angular_velocity(0).y()) <
              0.05 * (decay / omega + 0.002));  // that a damped one reaches its turning point earlier
        sim.run({.end_time = 3.5 * period, .time_step = period / 400});
        CHECK(
            is_near(sim.particles().angular_velocity(0).y(), -0.05 * std::exp(-decay * 3.5 * period), 0.002));
        CHECK(sim.ledger().residual_relative() < 1e-12);
        if (damping == 0) CHECK(sim.ledger().lost_rolling < 1e-9 * sim.ledger().kinetic_start);
    }
}

TEST_CASE("two spheres swing against each other at sqrt(k_r (1/I_i + 1/I_j)), about any axis across") {
    const Real mu_r = 0.5, large = 0.015, inverse_r = 1 / r + 1 / large;
    const Real m2 = mass * cube(large / r);
    const Real k_r = 2.25 * k * square(mu_r / inverse_r);
    const Real inverse_inertia = 2.5 / (mass * r * r) + 2.5 / (m2 * large * large);
    const Real period = 2 * pi / std::sqrt(k_r * inverse_inertia);
    // Pressed together by gravity between two frictionless planes would add contacts: let them be attracted
    // by a light overlap instead, elastic and slow against the swing.
    Scene scene;
    scene.gravity.setZero();
    const Vec3 axis = Vec3(0, 3, 4) / 5;
    scene.add_sphere(r, {.position = {0, 0, 0}, .velocity = {0.05, 0, 0}, .angular_velocity = 0.01 * axis});
    scene.add_sphere(large, {.position = {r + large - 1e-9, 0, 0}, .velocity = {-0.05, 0, 0}});
    const Linear law{{.contact = {.stiffness = 100, .friction = 0},
                      .friction = mu_r,
                      .damping = 0,
                      .stiffness_factor = 2.25 * k / 100}};
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 5 * period, .time_step = period / 400});
    const Vec3 spin = sim.particles().angular_velocity(0) - sim.particles().angular_velocity(1);
    CHECK((spin - 0.01 * axis).norm() < 0.01 * 0.01);
    CHECK(sim.ledger().stored_contacts > 0);
    CHECK(sim.ledger().lost_rolling < 0.01 * 0.5 * square(0.01) / inverse_inertia);
    const Real carried = 0.4 * mass * r * r * 0.01;
    const Particles& p = sim.particles();
    CHECK((p.angular_momentum[0] + p.angular_momentum[1] - carried * axis).norm() < 1e-12 * carried);
}

TEST_CASE("an oblique impact with resistance to rolling keeps angular momentum and closes the ledger") {
    const auto collide = [](const auto& law) {
        Scene scene;
        scene.gravity.setZero();
        scene.add_sphere(
            0.02, {.position = {0, 0, 0}, .velocity = {2, 0.3, 0}, .angular_velocity = {10, -200, 30}});
        scene.add_sphere(
            0.03,
            {.position = {0.046, 0.02, 0.01}, .velocity = {-1, 0, 0.2}, .angular_velocity = {-5, 80, 120}});
        const auto carried = [](const Particles& p) {
            Vec3 sum = Vec3::Zero();
            for (std::size_t b = 0; b < 2; ++b)
                sum += p.mass[b] * p.position[b].cross(p.velocity[b]) + p.angular_momentum[b];
            return sum;
        };
        auto sim = simulate(scene).contact(law);
        sim.run({.end_time = 0, .safety = 0.1});
        const Vec3 start = carried(sim.particles());
        sim.run({.end_time = 0.02, .safety = 0.1});
        CHECK((carried(sim.particles()) - start).norm() < 1e-12 * start.norm());
        CHECK(sim.ledger().residual_relative() < 1e-12);
        CHECK(sim.ledger().stored_contacts == 0);
        CHECK(sim.ledger().lost_rolling > 1e-4 * sim.ledger().kinetic_start);
        CHECK(std::abs(sim.ledger().integration_residue()) < 1e-3 * sim.ledger().lost());
    };
    collide(linear(0.3));
    collide(linear(0.3, 0.8, Linear::Model::constant_torque));
    collide(Hertz{{.contact = {.youngs = 1e8, .restitution = 0.5, .friction = 0.5}, .friction = 0.3}});
}

TEST_CASE("a heap with resistance to rolling: nothing depends on how often lists are renewed or observed") {
    const auto heap = [](Real skin, Real observe_every) {
        Scene scene;
        scene.add_wall({0, 0, 0}, {0, 0, 1});
        for (int n = 0; n < 40; ++n) {
            const BodyState state{
                .position = {0.025 * (n % 3) + 0.001 * (n % 2), 0.023 * (n / 3 % 3), 0.011 + 0.021 * (n / 9)},
                .velocity = {0.1, 0.05 * (n % 5), 0}};
            if (n % 4)
                scene.add_sphere(r, state);
            else
                scene.add_stone(make_clump("twin", {{{-0.004, 0, 0}, 0.007}, {{0.004, 0, 0}, 0.008}}), state);
        }
        auto sim = simulate(scene).contact(linear(0.3));
        sim.run({.end_time = 0.3, .safety = 0.3, .observe_every = observe_every, .skin = skin});
        CHECK(sim.ledger().residual_relative() < 1e-12);
        CHECK(sim.ledger().lost_rolling > 0.01 * sim.ledger().lost());
        CHECK(std::abs(sim.ledger().integration_residue()) < 0.02 * sim.ledger().lost());
        return sim;
    };
    const auto often = heap(2e-4, 0), seldom = heap(4e-3, 0), seen = heap(2e-4, 0.01);
    for (std::size_t b = 0; b < 40; ++b) CHECK(often.particles().position[b] == seen.particles().position[b]);
    // Other lists add up forces in another order; collisions multiply that.
    CHECK(is_near(often.ledger().lost_rolling, seldom.ledger().lost_rolling, 0.1));
}
