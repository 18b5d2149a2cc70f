// Where runs go wrong, and the guard or column that names it: a step too long, tunnelling, lost tangential
// memory, energy drift.
#include "../../bench/charts/stability_failures.hpp"

#include <doctest/doctest.h>

using namespace abrade;
using namespace abrade::charts;

namespace {

std::string error_of(auto& sim, const RunOptions& options) {
    try {
        sim.run(options);
    } catch (const RunError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("tunnelling: frictionless spheres pass through each other above r sqrt(8 k/m)") {
    for (const Real share : {0.1, 0.5, 0.9, 0.99})
        CHECK(parting_speed(share) == doctest::Approx(1).epsilon(1e-3).scale(0));
    for (const Real share : {1.01, 1.1, 2.0})
        CHECK(parting_speed(share) == doctest::Approx(-1).epsilon(0.01).scale(0));
}

TEST_CASE("tunnelling: the guard on overlaps stops it at a tenth of that speed, and says so") {
    // An overlap of 20 % of the radius needs a tenth of what one of two radii needs.
    for (const Real share : {0.097, 0.103, 0.5, 1.5}) {
        const Encounter meeting(share);
        auto sim = simulate(meeting.scene).contact(meeting.law);
        const std::string said =
            error_of(sim, {.end_time = 2 * ball_diameter / meeting.approach, .safety = 0.02});
        CAPTURE(said);
        CHECK((share < 0.1) == said.empty());
        if (share > 0.1) CHECK(said.find("overlaps stone with id") != std::string::npos);
    }
}

TEST_CASE("tunnelling: no stable step leaps over a contact below that speed") {
    // v dt < 2 x 2 r, the way from touch to touch on the far side, for dt < 2 / sqrt(2 k/m).
    const Encounter meeting(1);
    auto sim = simulate(meeting.scene).contact(meeting.law);
    sim.run({.end_time = 0});
    CHECK(meeting.approach * sim.stable_step_now().seconds <= 2 * ball_diameter * (1 + 1e-9));
}

TEST_CASE("tangential memory: kept once a step a stone rests on an incline; dropped, it creeps") {
    const Rest kept = rest_on_incline(Keeping::once_a_step), dropped = rest_on_incline(Keeping::never);
    MESSAGE("slid: kept " << kept.slid << " m, dropped " << dropped.slid << " m, expected "
                          << dropped.creep * dropped.duration << " m; residue of the work of gravity "
                          << dropped.residue);
    CHECK(std::abs(kept.slid) < 1e-12);
    CHECK(dropped.slid / (dropped.creep * dropped.duration) == doctest::Approx(1).epsilon(0.02).scale(0));
    // What springs forget is in no loss: the ledger's integration residue names it, to the last per cent.
    CHECK(dropped.residue / dropped.forgotten == doctest::Approx(1).epsilon(0.05).scale(0));
}

TEST_CASE("tangential memory: committed at each of two stages, an elastic contact makes energy") {
    // A ball that rolls to and fro on its tangential spring; the spring grows twice by the way of each step.
    const auto residue = [](Keeping keeping) {
        Scene scene;
        scene.add_wall({0, 0, 0}, {0, 0, 1});
        const Real mass = 4.0 / 3 * pi * cube(0.01) * stone_density;
        scene.add_sphere(
            0.01,
            {.position = {0, 0, 0.01 - mass * standard_gravity / 1e5}, .angular_velocity = {0, 0.01, 0}},
            stone_density);
        auto sim = simulate(scene).contact(
            Misremembering{{.spring = {.stiffness = 1e5, .friction = 0.5}, .keeping = keeping}});
        Real most = 0;
        sim.run({.end_time = 0.05, .observe_every = 5e-5}, [&](const auto& now) {
            most = std::max(most, std::abs(now.ledger().integration_residue()));
        });
        return most / sim.ledger().kinetic_start;
    };
    const Real once = residue(Keeping::once_a_step), twice = residue(Keeping::at_each_of_two_stages);
    MESSAGE("integration residue over the energy at the start: once " << once << ", twice " << twice);
    CHECK(once < 0.1);
    CHECK(twice > 5 * once);
}

TEST_CASE("energy drift: a million undamped steps") {
    const std::vector<int> marks{1000, 1'000'000};
    const auto bounded = [&](const std::vector<Real>& error) { return error[1] < 1.05 * error[0]; };
    const auto engine = engine_errors(marks);
    MESSAGE("engine: " << engine[0] << " in 1e3 steps, " << engine[1] << " in 1e6");
    CHECK(bounded(engine));
    CHECK(engine[0] == doctest::Approx(0.0025).epsilon(0.1).scale(0));  // (omega dt)^2 / 4
    CHECK(bounded(energy_errors<SymplecticEuler>(marks)));
    CHECK(bounded(energy_errors<McLachlan4>(marks)));
    CHECK(!bounded(energy_errors<RungeKutta4>(marks)));
    CHECK(!bounded(euler_errors(marks)));
}

TEST_CASE("a step too long for contacts as they stand: shortened where the engine chose it, else refused") {
    // A damped crystal: twelve pressed dashpots on each ball allow far less than a step to begin with.
    const Bed crystal = crystal_bed(2);
    Scene scene;
    scene.gravity.setZero();
    for (const Bed::Body& body : crystal.bodies) {
        Vec3 at = body.state.position;
        scene.add_stone(body.clump, {.position = 0.99999 * at}, stone_density);  // pressed together a little
    }
    const auto law = linear_law(0.3, 0.5);
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0});
    const Real usual = sim.stable_time_step().seconds, now = sim.stable_step_now().seconds;
    MESSAGE("to begin with " << usual << " s, as they stand " << now << " s");
    CHECK(now < 0.5 * usual);
    sim.run({.end_time = 20 * now});
    CHECK(sim.times_shortened() >= 1);
    CHECK(sim.time_step() <= now);
    auto asked = simulate(scene).contact(law);
    std::string said;
    try {
        asked.run({.end_time = 1e-3, .time_step = 1.01 * now});
    } catch (const InputError& error) {
        said = error.what();
    }
    CHECK(said.find("RunOptions.time_step must be at most the stable step of " + to_text(now) +
                    " s (contacts as they stand)") != std::string::npos);
}

TEST_CASE("a step that was asked for and grows too long while the run goes on: the run stops and says so") {
    // A ball falls into a corner: three contacts with dashpots allow less than its first touch did.
    Scene scene;
    scene.gravity = Vec3(-6, -6, -6);
    for (int axis = 0; axis < 3; ++axis) scene.add_wall(Vec3::Zero(), Vec3::Unit(axis));
    scene.add_sphere(0.01, {.position = Vec3::Constant(0.01001)}, stone_density);
    auto sim = simulate(scene).contact(linear_law(0.1, 0.5));
    sim.run({.end_time = 0});
    const std::string said =
        error_of(sim, {.end_time = 0.05, .time_step = 0.99 * sim.stable_step_now().seconds});
    CAPTURE(said);
    CHECK(said.find("as they stand, are stable up to a step of") != std::string::npos);
}
