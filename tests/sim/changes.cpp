// What a user changes between two runs: the ledger says what was put in and taken out, contacts remember.

#include "../message_of.hpp"

#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/dem/laws/material_pairs.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

const LinearSpring law{{.stiffness = 1e5, .restitution = 0.5, .friction = 0.5}};

const Clump sled = make_clump(
    "sled",
    {{{-0.02, -0.02, 0}, 0.01}, {{0.02, -0.02, 0}, 0.01}, {{-0.02, 0.02, 0}, 0.01}, {{0.02, 0.02, 0}, 0.01}},
    ClumpParts::apart);

/// A sled that friction holds on a slope of 20 degrees.
Scene slope() {
    Scene scene;
    const Real angle = radians(20);
    scene.gravity = 9.81 * Vec3(std::sin(angle), 0, -std::cos(angle));
    scene.add_wall({0, 0, 0}, {0, 0, 1}).add_stone(sled, {.position = {0, 0, 0.01}});
    return scene;
}

/// `residue`: of the time step, where bodies bounce some percent of what they lose.
void check_closed(const auto& sim, Real residue = 0.02) {
    const Ledger& ledger = sim.ledger();
    CHECK(ledger.residual_relative() < 1e-12);
    CHECK(std::abs(ledger.integration_residue()) <= residue * (ledger.throughput() + ledger.potential_start));
}

}  // namespace

TEST_CASE("contacts keep their memory while bodies come and go elsewhere") {
    auto left_alone = simulate(slope()).contact(law), changed = simulate(slope()).contact(law);
    left_alone.run({.end_time = 0.5}), left_alone.run({.end_time = 1});
    changed.run({.end_time = 0.5});
    const Index other = changed.add_sphere(0.01, {.position = {0, 1, 1}, .velocity = {0, 0, 3}});
    changed.run({.end_time = 0.75});
    CHECK(changed.particles().bodies() == 2);
    CHECK(changed.particles().id[1] == other);
    changed.remove(other);
    changed.run({.end_time = 1});
    CHECK(changed.particles().bodies() == 1);
    // Without memory the sled would slip by m g sin / (4 k_t), some 1e-5 m.
    CHECK((changed.particles().position[0] - left_alone.particles().position[0]).norm() < 1e-10);
    const Ledger& ledger = changed.ledger();
    CHECK(ledger.fed_kinetic == doctest::Approx(0.5 * 2650 * 4.0 / 3 * pi * 1e-6 * 9).scale(0));
    CHECK(ledger.left_kinetic > 0);
    check_closed(changed);
}

TEST_CASE("gravity changes in flight: two parabolas, and its potential is what it gave") {
    Scene scene;
    scene.add_sphere(0.01, {.position = {0, 0, 1}});
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0.1});
    sim.set_gravity({5, 0, 0});
    sim.run({.end_time = 0.3});
    const Vec3 expected(0.5 * 5 * 0.04, 0, 1 - 0.5 * standard_gravity * 0.01 - standard_gravity * 0.1 * 0.2);
    CHECK((sim.particles().position[0] - expected).norm() < 1e-12);
    check_closed(sim, 1e-11);
}

TEST_CASE("what was fixed is let go and falls, a clump as well as a sphere; what is held stays") {
    Scene scene;
    scene.add_fixed(make_clump("ball", {{Vec3::Zero(), 0.01}}), {0, 0, 1});
    scene.add_fixed(sled, {0, 1, 1}, Quaternion(std::cos(0.3), std::sin(0.3), 0, 0));
    scene.add_sphere(0.01, {.position = {1, 0, 1}, .velocity = {0, 0, 2}, .angular_velocity = {5, 0, 0}});
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0.1});
    const auto& p = sim.particles();
    sim.let_go(p.id[0]), sim.let_go(p.id[1]);
    const Vec3 there = p.position[2];
    const Real kinetic = p.kinetic_energy(2);
    sim.hold(p.id[2]);
    sim.run({.end_time = 0.3});
    for (const std::size_t b : {0u, 1u})
        CHECK(p.position[b].z() ==
              doctest::Approx(1 - 0.5 * standard_gravity * 0.04).epsilon(1e-10).scale(0));
    CHECK(p.position[2] == there);
    CHECK(sim.ledger().left_kinetic == doctest::Approx(kinetic).epsilon(1e-12).scale(0));
    check_closed(sim, 1e-10);
    sim.let_go(p.id[2]);
    sim.run({.end_time = 0.4});
    CHECK(p.position[2].z() ==
          doctest::Approx(there.z() - 0.5 * standard_gravity * 0.01).epsilon(1e-10).scale(0));
    check_closed(sim, 1e-10);
}

TEST_CASE("a wall that comes stops what falls; one that goes takes along what its contacts stored") {
    Scene scene;
    scene.add_sphere(0.01, {.position = {0, 0, 0.1}});
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0.05});
    const Index floor = sim.add_wall({0, 0, 0}, {0, 0, 1});
    sim.run({.end_time = 2});
    const Real weight = sim.particles().mass[0] * standard_gravity;
    CHECK(sim.particles().position[0].z() == doctest::Approx(0.01 - weight / 1e5).epsilon(1e-6).scale(0));
    sim.remove_wall(floor);
    sim.run({.end_time = 2.1});
    CHECK(sim.particles().position[0].z() ==
          doctest::Approx(0.01 - weight / 1e5 - 0.5 * standard_gravity * 0.01).epsilon(1e-4).scale(0));
    CHECK(sim.ledger().left_stored == doctest::Approx(0.5 * square(weight) / 1e5).epsilon(1e-4).scale(0));
    check_closed(sim);
}

TEST_CASE("a lighter stone that comes shortens the step") {
    Scene scene;
    scene.add_wall({0, 0, 0}, {0, 0, 1}).add_sphere(0.02, {.position = {0, 0, 0.02}});
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0.1});
    const Real before = sim.time_step();
    sim.add_sphere(0.005, {.position = {0, 0.1, 0.005}});
    sim.run({.end_time = 0.2});
    CHECK(sim.time_step() < 0.2 * before);
    check_closed(sim);
}

TEST_CASE("what cannot be changed is refused, and nothing has changed") {
    const MaterialPairs<LinearSpring> laws{
        {.materials = {"stone", "steel"}, .pairs = {{"stone", "stone", {.stiffness = 1e5}}}}};
    Scene scene;
    scene.add_sphere(0.01, {.position = {0, 0, 1}}).add_sphere(0.01, {.position = {0, 0, 2}});
    auto sim = simulate(scene).contact(laws);
    CHECK_THROWS_WITH_AS(sim.set_gravity({0, 0, 0}),
                         "Simulation: change the scene instead, before the first run", std::logic_error);
    sim.run({.end_time = 0.01});
    CHECK(message_of([&] { sim.remove(17); }) ==
          "Simulation: id must be of a body that is there, got 17; Particles::id has them");
    CHECK(message_of([&] {
              sim.let_go(0);
          }).starts_with("Simulation.let_go: id must be of a body that is fixed"));
    CHECK(message_of([&] {
              sim.add_wall({0, 0, 0}, {0, 0, 1}, 1);
          }).starts_with("MaterialPairs.pairs must be"));
    CHECK(message_of([&] {
              sim.add_sphere(-1, {});
          }).starts_with("Simulation.add_sphere: radius must be finite and > 0"));
    CHECK(message_of([&] {
              sim.add_sphere(0.01, {.position = {5, 0, 0}, .material = 1});
          }).starts_with("MaterialPairs.pairs must be"));
    CHECK(message_of([&] { sim.remove_wall(0); }).starts_with("Simulation.remove_wall: number must be"));
    CHECK(message_of([&] {
              sim.set_gravity(Vec3::Constant(std::nan("")));
          }).starts_with("Simulation.set_gravity"));
    sim.run({.end_time = 0.02});
    CHECK(sim.particles().bodies() == 2);
    CHECK(sim.world().scene().walls.empty());
    check_closed(sim, 1e-9);
}

TEST_CASE("a refused change leaves a run as it would have been, to the bit") {
    Scene scene;
    scene.add_wall({0, 0, 0}, {0, 0, 1}).add_sphere(0.01, {.position = {0, 0, 0.01}});
    scene.add_sphere(0.01, {.position = {0.1, 0, 0.8}, .velocity = {0.3, 0, 0}});
    const auto end_of = [&](const auto& contact, bool asks) {
        auto sim = simulate(scene).contact(contact);
        RunOptions options{.end_time = 0.2, .time_step = 1e-5, .sleep_speed = 0.01, .sleep_after = 0.02};
        sim.run(options);
        const auto& state = sim.world().state();
        REQUIRE(state.sleep.asleep(0));
        if (asks) {
            CHECK_THROWS_AS(sim.remove(17), InputError);
            CHECK_THROWS_AS(sim.remove_wall(1), InputError);
            CHECK_THROWS_AS(sim.let_go(0), InputError);
            CHECK_THROWS_AS(sim.hold(5), InputError);
            CHECK_THROWS_AS(sim.add_sphere(0.01, {.position = {0, 0, 0.5}, .material = 1}), InputError);
            CHECK_THROWS_AS(sim.add_wall({0, 0, 0}, {0, 0, 1}, 1), InputError);
            CHECK_THROWS_AS(sim.set_gravity({0, 0, std::nan("")}), InputError);
        }
        CHECK(state.sleep.asleep(0));
        options.end_time = 0.3;
        sim.run(options);
        const Index next = sim.add_sphere(0.01, {.position = {0.2, 0, 0.01}});
        return std::tuple(sim.particles(), sim.ledger().residual(), next, state.scene.walls.size());
    };
    const auto check = [&](const auto& contact) {
        const auto [asked, residual, next, walls] = end_of(contact, true);
        const auto [left_alone, residual_alone, next_alone, walls_alone] = end_of(contact, false);
        REQUIRE(asked.bodies() == left_alone.bodies());
        for (const std::size_t b : {0u, 1u}) {
            CHECK(asked.position[b] == left_alone.position[b]);
            CHECK(asked.velocity[b] == left_alone.velocity[b]);
        }
        CHECK(residual == residual_alone);
        CHECK(next == next_alone);
        CHECK(walls == walls_alone);
    };
    check(law);
    check(MaterialPairs<LinearSpring>{
        {.materials = {"stone", "steel"}, .pairs = {{"stone", "stone", {.stiffness = 1e5}}}}});
}
