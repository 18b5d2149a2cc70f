// Walls that move as functions of time, and their work.

#include "../message_of.hpp"

#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/dem/laws/rolling_resistance.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

const LinearSpring law{{.stiffness = 1e5, .restitution = 0.5, .friction = 0.4}};

/// A ball on a plate that shakes so slowly that the ball stays on it; the work that is accounted for by no
/// state.
Real residue_of_shaking(Real safety) {
    Scene scene;
    scene.add_moving_wall({0, 0, 0}, {0, 0, 1}, [](Real t) {
        return PlanePlace{.displacement = {0, 0, 1e-3 * (1 - std::cos(80 * t))}};  // up to 0.65 g
    });
    scene.add_sphere(0.01, {.position = {0, 0, 0.01 - 2650 * 4.0 / 3 * pi * 1e-6 * standard_gravity / 1e5}});
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0.0417, .safety = safety});  // past the first top
    const Ledger& ledger = sim.ledger();
    CHECK(ledger.residual_relative() < 1e-12);
    CHECK(sim.particles().position[0].z() ==
          doctest::Approx(0.01 + 1e-3 * (1 - std::cos(80 * 0.0417))).epsilon(1e-3).scale(0));
    const Real gained = ledger.kinetic + ledger.potential + ledger.stored_contacts + ledger.lost() -
                        ledger.potential_start - ledger.stored_start;
    CHECK(ledger.wall_work == doctest::Approx(gained).epsilon(2e-3).scale(0));
    return ledger.integration_residue();
}

}  // namespace

TEST_CASE("a plate lifts a ball: its work is what the ball has gained, to second order in the step") {
    const Real coarse = residue_of_shaking(0.4), fine = residue_of_shaking(0.1);
    CHECK(std::abs(coarse) > 8 * std::abs(fine));
}

TEST_CASE("a belt drags a ball to 2/7 of its speed, and loses as much to sliding as the ball gains") {
    Scene scene;
    scene.add_moving_wall({0, 0, 0}, {0, 0, 1}, [](Real t) { return PlanePlace{.displacement = {t, 0, 0}}; });
    scene.add_sphere(0.01, {.position = {0, 0, 0.01}});
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0.5});
    const Real mass = sim.particles().mass[0];
    CHECK(sim.particles().velocity[0].x() == doctest::Approx(2.0 / 7).epsilon(1e-3).scale(0));
    CHECK(sim.ledger().wall_work == doctest::Approx(2.0 / 7 * mass).epsilon(5e-3).scale(0));
    CHECK(sim.ledger().lost_sliding == doctest::Approx(mass / 7).epsilon(5e-3).scale(0));
    CHECK(sim.ledger().residual_relative() < 1e-12);
}

TEST_CASE("a flap turns about its hinge and lifts what lies on it") {
    Scene scene;
    const auto turn = [](Real t) { return PlanePlace{.rotation = {0, -0.2 * square(std::sin(t)), 0}}; };
    scene.add_moving_wall({0, 0, 0}, {0, 0, 1}, turn);
    for (int n = 1; n < 6; ++n) scene.add_sphere(0.01, {.position = {0.1 * n, 0, 0.01}});
    auto sim =
        simulate(scene).contact(RollingResistance<LinearSpring>{{.contact = law.params(), .friction = 0.3}});
    sim.run({.end_time = 1});
    const Ledger& ledger = sim.ledger();
    CHECK(ledger.residual_relative() < 1e-12);
    CHECK(std::abs(ledger.integration_residue()) < 1e-3 * ledger.wall_work);
    CHECK(ledger.potential > ledger.potential_start);
    const Plane flap = turn(1.0).of({});
    for (const Vec3& x : sim.particles().position)
        CHECK(flap.distance(x) == doctest::Approx(0.01).epsilon(1e-2).scale(0));
}

TEST_CASE("a wall that could move and does not is one that cannot") {
    const auto run = [](bool could) {
        Scene scene;
        scene.gravity = {2, 1, -9.81};
        if (could)
            scene.add_moving_wall({0, 0, 0}, {0, 0, 1}, [](Real) { return PlanePlace{}; });
        else
            scene.add_wall({0, 0, 0}, {0, 0, 1});
        for (int n = 0; n < 5; ++n)
            scene.add_sphere(0.01,
                             {.position = {0.03 * n, 0, 0.02 + 0.01 * n}, .angular_velocity = {0, 20, 5}});
        auto sim = simulate(scene).contact(law);
        sim.run({.end_time = 0.3});
        return std::pair(sim.particles().position, sim.ledger());
    };
    const auto [still, at_rest] = run(false);
    const auto [places, ledger] = run(true);
    for (std::size_t b = 0; b < still.size(); ++b) CHECK((still[b] - places[b]).norm() < 1e-12);
    CHECK(ledger.wall_work == 0);
}

TEST_CASE("a wall outruns no list: a piston of 20 m/s catches a ball that is far from it") {
    Scene scene;
    scene.gravity.setZero();
    scene.add_moving_wall({0, 0, 0}, {0, 0, 1}, [](Real t) {
        return PlanePlace{.displacement = {0, 0, 20 * t}};
    });
    scene.add_sphere(0.01, {.position = {0, 0, 1}});
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1e6, .restitution = 0.5}});
    sim.run({.end_time = 0.1, .safety = 0.1});
    CHECK(sim.particles().velocity[0].z() == doctest::Approx(30).epsilon(2e-3).scale(0));  // 20 (1 + e)
    CHECK(sim.ledger().residual_relative() < 1e-12);
}

TEST_CASE("a place that is no number is named") {
    Scene scene;
    scene.add_moving_wall({0, 0, 0}, {0, 0, 1}, [](Real t) {
        return PlanePlace{.displacement = {0, 0, t > 0.05 ? std::nan("") : 0}};
    });
    scene.add_sphere(0.01, {.position = {0, 0, 0.01}});
    auto sim = simulate(scene).contact(law);
    const std::string said = message_of([&] { sim.run({.end_time = 0.1}); });
    CHECK(said.find("Scene.moving_walls: wall 0 at t = 0.05") != std::string::npos);
    CHECK(said.find("displacement.z") != std::string::npos);
    scene.moving_walls[0].place = {};
    CHECK(message_of([&] {
              simulate(scene).contact(law).run({.end_time = 0.1});
          }).starts_with("Scene.moving_walls[0] must be a wall's number and a function"));
}
