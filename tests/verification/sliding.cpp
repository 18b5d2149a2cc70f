// Friction against closed forms: a block that slides, and one at rest on a slope.
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

/// A flat four-footed body that slides without tipping.
Clump block() {
    return make_clump("block",
                      {{{0.05, 0.05, 0}, 0.02},
                       {{0.05, -0.05, 0}, 0.02},
                       {{-0.05, 0.05, 0}, 0.02},
                       {{-0.05, -0.05, 0}, 0.02}},
                      ClumpParts::apart);
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
    CHECK(p.position[0].x() == doctest::Approx(path).epsilon(2e-3).scale(0));
    CHECK(p.velocity[0].x() == doctest::Approx(speed - mu * g * 0.2).epsilon(2e-3).scale(0));
    CHECK(sim.ledger().lost_sliding == doctest::Approx(mu * mass * g * path).epsilon(2e-3).scale(0));
    // By the path that it really went, more sharply; what the springs at the feet hold is not lost yet.
    CHECK(sim.ledger().lost_sliding ==
          doctest::Approx(mu * mass * g * p.position[0].x()).epsilon(1e-3).scale(0));
    CHECK(sim.ledger().residual_relative() < 1e-11);  // 4e4 equal half kicks round the same way: 4e4 x 1e-16
    // To its end: all of the kinetic energy.
    sim.run({.end_time = 1});
    CHECK(p.velocity[0].norm() < 1e-9);
    CHECK(p.position[0].x() == doctest::Approx(speed * speed / (2 * mu * g)).epsilon(2e-3).scale(0));
    CHECK(sim.ledger().lost_sliding == doctest::Approx(0.5 * mass * speed * speed).epsilon(2e-3).scale(0));
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
