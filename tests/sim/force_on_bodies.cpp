// A user's force on bodies: its work is in the ledger, and it is of second order where it depends on
// velocity.

#include "../message_of.hpp"

#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

const LinearSpring law{{.stiffness = 1e5, .restitution = 0.5, .friction = 0.3}};

/// A force by its address: one simulation is compiled for all of its kind.
using Force = Vec3 (*)(const BodyView&, Real) noexcept;

Scene one_ball(const Vec3& velocity) {
    Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(0.01, {.position = {0.1, 0, 0}, .velocity = velocity});
    return scene;
}

/// Speed left of 1 m/s after 0.5 s of a drag of 2 m v per second.
Real left_of_speed(Real dt) {
    auto sim =
        simulate(one_ball({1, 0, 0})).contact(law).force([](const BodyView& body, Real) noexcept -> Vec3 {
            return -2 * body.mass * body.velocity;
        });
    sim.run({.end_time = 0.5, .time_step = dt});
    const Ledger& ledger = sim.ledger();
    CHECK(ledger.residual_relative() < 1e-12);
    CHECK(ledger.force_work ==
          doctest::Approx(ledger.kinetic - ledger.kinetic_start).epsilon(1e-12).scale(0));
    return sim.particles().velocity[0].x();
}

}  // namespace

TEST_CASE("a spring to the origin: half a period later it stands on the other side") {
    constexpr Real rate = 20;  // [1/s]
    auto sim = simulate(one_ball(Vec3::Zero()))
                   .contact(law)
                   .force(Force([](const BodyView& body, Real) noexcept -> Vec3 {
                       return -body.mass * square(rate) * body.position;
                   }));
    sim.run({.end_time = pi / rate, .time_step = 1e-5});
    CHECK(sim.particles().position[0].x() == doctest::Approx(-0.1).epsilon(1e-7).scale(0));
    // A state function that the ledger does not know: what it gives it takes back. In between that was:
    const Real given = 0.5 * sim.particles().mass[0] * square(0.1 * rate);
    CHECK(std::abs(sim.ledger().residual()) < 1e-12 * given);
    CHECK(std::abs(sim.ledger().force_work) < 1e-8 * given);
}

TEST_CASE("a force that depends on velocity is of second order") {
    const Real exact = std::exp(-1.0), coarse = left_of_speed(4e-5) - exact,
               fine = left_of_speed(2e-5) - exact;
    CHECK(coarse / fine == doctest::Approx(4).epsilon(0.02).scale(0));
    CHECK(std::abs(fine) < 1e-9);
}

TEST_CASE("a torque turns a sphere and a clump; its time is that of the step") {
    Scene scene = one_ball(Vec3::Zero());
    const Clump rod = make_clump("rod", {{{-0.02, 0, 0}, 0.01}, {{0, 0, 0}, 0.01}, {{0.02, 0, 0}, 0.01}});
    scene.add_stone(rod, {.position = {0, 1, 0}});
    auto sim = simulate(scene).contact(law).force([](const BodyView& body, Real t) noexcept -> BodyLoad {
        return {Vec3::Zero(), {0, 0, 1e-4 * body.mass * t}};
    });
    sim.run({.end_time = 1});
    const Particles& p = sim.particles();
    for (const Index b : {0, 1})
        CHECK(p.angular_momentum[static_cast<std::size_t>(b)].z() ==
              doctest::Approx(0.5e-4 * p.mass[static_cast<std::size_t>(b)]).epsilon(1e-3).scale(0));
    CHECK(sim.ledger().force_work == doctest::Approx(sim.ledger().kinetic).epsilon(1e-12).scale(0));
    CHECK(sim.ledger().residual_relative() < 1e-12);
}

TEST_CASE("pressed on a floor by a force alone, a ball stands as deep as the spring has it") {
    Scene scene;
    scene.gravity.setZero();
    scene.add_wall({0, 0, 0}, {0, 0, 1}).add_sphere(0.01, {.position = {0, 0, 0.01}});
    auto sim = simulate(scene).contact(law).force(Force([](const BodyView&, Real) noexcept -> Vec3 {
        return {0, 0, -3};
    }));
    sim.run({.end_time = 0.2});
    CHECK(sim.particles().position[0].z() == doctest::Approx(0.01 - 3e-5).epsilon(1e-7).scale(0));
    CHECK(sim.particles().force[0].norm() < 1e-3);
}

TEST_CASE("what is fixed feels nothing; who may sleep and fly is told") {
    Scene scene = one_ball(Vec3::Zero());
    scene.add_fixed(make_clump("ball", {{Vec3::Zero(), 0.01}}), {0, 1, 0});
    auto sim = simulate(scene).contact(law).force(Force([](const BodyView& body, Real) noexcept -> Vec3 {
        return body.kind == Kind::fixed ? Vec3::Constant(1e300).eval() : Vec3(0, 0, body.mass);
    }));
    CHECK(message_of([&] { sim.run({.end_time = 1, .sleep_speed = 1e-3, .sleep_after = 1}); }) ==
          "RunOptions.sleep_speed must be 0 where walls move or a force of yours acts on bodies, got 0.001 "
          "m/s; "
          "nobody knows when they would have to wake");
    sim.run({.end_time = 1});
    CHECK(sim.particles().position[0].z() == doctest::Approx(0.5).epsilon(1e-9).scale(0));
    CHECK(sim.particles().position[1] == Vec3(0, 1, 0));
}

static_assert(!ForceOnBodies<decltype([](const BodyView&, Real) { return Vec3(0, 0, 1); })>, "may throw");
