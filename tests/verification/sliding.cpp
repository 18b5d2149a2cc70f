// Friction against closed forms: a sliding block, spheres on an incline, a sphere that skids to rolling.
#include "reference_table.hpp"

#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

/// A flat four-footed body that slides without tipping.
Clump block() {
    return make_clump("block", {{{0.05, 0.05, 0}, 0.02},
                                {{0.05, -0.05, 0}, 0.02},
                                {{-0.05, 0.05, 0}, 0.02},
                                {{-0.05, -0.05, 0}, 0.02}});
}

}  // namespace

TEST_CASE("a sliding block loses mu N L") {
    const Real mu = 0.3, g = standard_gravity, speed = 1;
    Scene scene;
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    const Clump body = block();
    const Real mass = 2650 * body.volume, k = 1e6;
    scene.add_stone(body, {.position = {0, 0, 0.02 - mass * g / (4 * k)},
                           .velocity = {speed, 0, 0}});  // on its springs, in balance
    auto sim = simulate(std::move(scene))
                   .contact(LinearSpring{{.stiffness = k, .restitution = 0.3, .friction = mu}});
    sim.run({.end_time = 0.2, .time_step = 1e-5});
    const Real path = speed * 0.2 - 0.5 * mu * g * 0.04;  // still sliding
    const Particles& p = sim.particles();
    CHECK(p.position[0].x() == doctest::Approx(path).epsilon(2e-3));
    CHECK(p.velocity[0].x() == doctest::Approx(speed - mu * g * 0.2).epsilon(2e-3));
    CHECK(sim.ledger().lost_sliding == doctest::Approx(mu * mass * g * path).epsilon(2e-3));
    // By the path that it really went, more sharply; what the springs at the feet hold is not lost yet.
    CHECK(sim.ledger().lost_sliding == doctest::Approx(mu * mass * g * p.position[0].x()).epsilon(1e-3));
    CHECK(sim.ledger().residual_relative() < 1e-11);  // 4e4 equal half kicks round the same way: 4e4 x 1e-16
    // To its end: all of the kinetic energy.
    sim.run({.end_time = 1});
    CHECK(p.velocity[0].norm() < 1e-9);
    CHECK(p.position[0].x() == doctest::Approx(speed * speed / (2 * mu * g)).epsilon(2e-3));
    CHECK(sim.ledger().lost_sliding == doctest::Approx(0.5 * mass * speed * speed).epsilon(2e-3));
}

TEST_CASE("a block at rest on a slope below the angle of friction stays and loses nothing more") {
    const Real slope = radians(15);
    Scene scene;
    scene.gravity = standard_gravity * Vec3(std::sin(slope), 0, -std::cos(slope));
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    scene.add_stone(block(), {.position = {0, 0, 0.02}});
    auto sim = simulate(std::move(scene))
                   .contact(LinearSpring{{.stiffness = 1e6, .restitution = 0.3, .friction = 0.4}});
    sim.run({.end_time = 1});
    const Vec3 at = sim.particles().position[0];
    const Real lost = sim.ledger().lost_sliding;
    CHECK(at.x() < 1e-4);
    sim.run({.end_time = 2});
    CHECK((sim.particles().position[0] - at).norm() < 1e-10);
    CHECK(sim.ledger().lost_sliding - lost <= 1e-10 * lost);
}

TEST_CASE("spheres on an incline roll or slip (dem11)") {
    for (const auto& row : reference_table("dem11_sphere_incline_analytic.csv")) {
        const Real theta = radians(row.at("theta_deg")), g = 9.81, radius = 0.02, k = 1e7;
        Scene scene;
        scene.gravity = g * Vec3(std::sin(theta), 0, -std::cos(theta));
        scene.add_wall({0, 0, 0}, {0, 0, 1});
        const Real mass = 2650 * 4.0 / 3 * pi * cube(radius), sag = mass * g * std::cos(theta) / k;
        scene.add_sphere(radius, {.position = {0, 0, radius - sag}});
        auto sim = simulate(std::move(scene))
                       .contact(LinearSpring{{.stiffness = k, .restitution = 0.2, .friction = row.at("mu")}});
        sim.run({.end_time = 0.05});  // past what the start set swinging
        const Real v = sim.particles().velocity[0].x(), w = sim.particles().angular_velocity(0).y(),
                   t = sim.time();
        sim.run({.end_time = 0.35});
        CAPTURE(row.at("theta_deg"));
        CHECK((sim.particles().velocity[0].x() - v) / (sim.time() - t) ==
              doctest::Approx(row.at("a")).epsilon(0.005));
        CHECK(radius * (sim.particles().angular_velocity(0).y() - w) / (sim.time() - t) ==
              doctest::Approx(row.at("R_alpha")).epsilon(0.005));
    }
}

TEST_CASE("a skidding sphere ends rolling at 5/7 of its speed, having lost m v^2/7") {
    const Real radius = 0.02, k = 1e7, mu = 0.2, speed = 1, g = standard_gravity;
    Scene scene;
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    const Real mass = 2650 * 4.0 / 3 * pi * cube(radius);
    scene.add_sphere(radius, {.position = {0, 0, radius - mass * g / k}, .velocity = {speed, 0, 0}});
    auto sim = simulate(std::move(scene))
                   .contact(LinearSpring{{.stiffness = k, .restitution = 0.2, .friction = mu}});
    sim.run({.end_time = 1.5 * 2 * speed / (7 * mu * g)});
    CHECK(sim.particles().velocity[0].x() == doctest::Approx(5.0 / 7 * speed).epsilon(0.005));
    CHECK(radius * sim.particles().angular_velocity(0).y() ==
          doctest::Approx(5.0 / 7 * speed).epsilon(0.005));
    CHECK(sim.ledger().lost_sliding == doctest::Approx(mass * speed * speed / 7).epsilon(0.005));
}
