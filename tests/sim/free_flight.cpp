// Bodies in free flight take many steps as one: the same way, the same ledger, the same bits for every
// thread.
#include <abrade/fluid/uniform_flow.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

const LinearSpring law{{.stiffness = 1e5, .restitution = 0.9, .friction = 0.3}};

/// Spheres thrown about in a box with a floor, few enough to fly most of the time.
Scene thrown(int count) {
    Scene scene;
    std::mt19937 random(3);
    const auto uniform = [&] { return std::uniform_real_distribution<Real>(-1, 1)(random); };
    scene.periodic_along = {true, true, false};
    scene.bounds = {{-1, -1, -1}, {1, 1, 100}};
    for (int n = 0; n < count; ++n)
        scene.add_sphere(
            0.01, {.position = {0.1 * (n % 20) - 0.95, 0.1 * (n / 20 % 20) - 0.95, 0.05 + 0.05 * (n / 400)},
                   .velocity = {uniform(), uniform(), uniform()},
                   .angular_velocity = {uniform(), 0, 5}});
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    return scene;
}

}  // namespace

TEST_CASE("a thrown sphere follows the parabola of leapfrog, whatever observes it") {
    const auto fly = [](Real observe_every, bool free_flight = true) {
        Scene scene;
        scene.add_sphere(0.01, {.position = {0, 0, 10}, .velocity = {1, 2, 3}});
        scene.add_sphere(0.01, {.position = {5, 0, 10}, .velocity = {0, 0, -1}});
        auto sim = simulate(scene).contact(law);
        sim.run(
            {.end_time = 0.5, .time_step = 1e-4, .observe_every = observe_every, .free_flight = free_flight});
        return sim;
    };
    const auto sim = fly(0);
    const Vec3 expected = Vec3(0, 0, 10) + 0.5 * Vec3(1, 2, 3) + 0.125 * Vec3(0, 0, -standard_gravity);
    CHECK((sim.particles().position[0] - expected).norm() < 1e-12);
    CHECK((sim.particles().velocity[0] - Vec3(1, 2, 3 - 0.5 * standard_gravity)).norm() < 1e-12);
    CHECK(sim.ledger().residual_relative() < 1e-13);
    CHECK(std::abs(sim.ledger().integration_residue()) < 1e-12 * sim.ledger().gravity_work);
    CHECK((fly(0, false).particles().position[0] - sim.particles().position[0]).norm() < 1e-12);
    CHECK(fly(0.01).particles().position[0] == sim.particles().position[0]);
}

TEST_CASE("thrown spheres that meet, bounce and cross periodic edges: the ledger closes") {
    auto sim = simulate(thrown(600)).contact(law);
    sim.run({.end_time = 1, .time_step = 2e-5});
    const Ledger& e = sim.ledger();
    CHECK(e.lost_normal > 0.01 * e.kinetic_start);
    CHECK(e.residual_relative() < 1e-12);
    CHECK(std::abs(e.integration_residue()) < 2e-3 * e.lost());
    for (const Vec3& x : sim.particles().position) CHECK(x.z() > 0.008);
}

TEST_CASE("the same bits with one thread and with two") {
    const auto run = [](int threads) {
        const int before = thread_count();
        set_thread_count(threads);
        auto sim = simulate(thrown(3000)).contact(law);
        sim.run({.end_time = 0.3, .time_step = 5e-5});
        set_thread_count(before);
        return sim.particles().position;
    };
    const auto one = run(1);
    CHECK(one == run(2));
    CHECK(one == run(1));
}

TEST_CASE("a flying body that leaves the bounds is caught in the step in which it does") {
    Scene scene;
    scene.gravity.setZero();
    scene.bounds = {{-1, -1, -1}, {1, 1, 1}};
    scene.add_sphere(0.01, {.position = {0, 0, 0.5}, .velocity = {0, 0, 1}});
    auto sim = simulate(scene).contact(law);
    try {
        sim.run({.end_time = 1, .time_step = 1e-4});
        FAIL("not noticed");
    } catch (const RunError& error) {
        CHECK(error.time == doctest::Approx(0.5).epsilon(1e-3).scale(0));
    }
}

namespace {

/// Clumps and spheres thrown into a flow, high enough to stay off the floor for a while.
Scene in_water() {
    Scene scene;
    for (int n = 0; n < 12; ++n) {
        const BodyState state{.position = {0.3 * n, 0, 0.15},
                              .velocity = {1.0 + 0.1 * n, 0.2, 0.5},
                              .angular_velocity = {30, 5.0 * n, 20}};
        if (n % 3 == 0)
            scene.add_sphere(0.02, state);
        else
            scene.add_stone(make_clump("pair", {{{-0.01, 0, 0}, 0.015}, {{0.012, 0, 0}, 0.012}}), state);
    }
    return scene;
}
const UniformFlow water{{.section = {.length = 10}, .discharge = 0.5}};

auto fly_in_water(Real time_step, Real observe_every = 0, bool free_flight = true, Real skin = 0.02) {
    auto sim = simulate(in_water()).contact(law).fluid(water, CliftGauvin{});
    sim.run({.end_time = 0.1,
             .time_step = time_step,
             .observe_every = observe_every,
             .skin = skin,
             .free_flight = free_flight});
    return sim;
}
Real furthest_apart(const auto& a, const auto& b) {
    Real most = 0;
    for (std::size_t n = 0; n < a.particles().position.size(); ++n) {
        most = std::max(most, (a.particles().position[n] - b.particles().position[n]).norm());
        most =
            std::max(most, 0.01 * a.particles().orientation[n].angularDistance(b.particles().orientation[n]));
    }
    return most;
}

}  // namespace

TEST_CASE("clumps and spheres in water fly as they go step by step") {
    const auto each_step = fly_in_water(2e-5, 0, false), flown = fly_in_water(2e-5);
    // They travel some 0.2 m, and turn by some 4 rad.
    CHECK(furthest_apart(each_step, flown) < 2e-5);
    for (const auto* sim : {&each_step, &flown}) {
        CHECK(sim->ledger().residual_relative() < 1e-12);
        CHECK(sim->ledger().drag_work > 0);
        CHECK(std::abs(sim->ledger().integration_residue()) < 1e-3 * sim->ledger().throughput());
    }
    CHECK(flown.ledger().drag_work == doctest::Approx(each_step.ledger().drag_work).epsilon(1e-3));
}

TEST_CASE("a clump in flight goes on as it went where it lands as the step has changed") {
    const auto fly = [](bool free_flight) {
        Scene scene;
        scene.add_stone(make_clump("pair", {{{-0.01, 0, 0}, 0.015}, {{0.012, 0, 0}, 0.012}}),
                        {.position = {0, 0, 1}, .velocity = {1, 0, 0}, .angular_velocity = {3, 20, 40}});
        scene.add_sphere(0.01, {.position = {0, 0, 0.01}}).add_wall({0, 0, 0}, {0, 0, 1});
        auto sim = simulate(scene).contact(law);
        // The first look for those who fall asleep comes with the first of the shorter steps: all land.
        const Real first = (Sleep::steps_between_looks - 1) * 2e-5;
        RunOptions options{.end_time = first,
                           .time_step = 2e-5,
                           .free_flight = free_flight,
                           .sleep_speed = 0.1,
                           .sleep_after = 1e-3};
        sim.run(options);
        CHECK(sim.world().state().sleep.count == 0);
        options.end_time += 0.01, options.time_step = 1e-5;
        sim.run(options);
        CHECK(sim.world().state().sleep.count == 1);
        return sim;
    };
    const auto flown = fly(true), each_step = fly(false);
    CHECK(furthest_apart(flown, each_step) < 1e-7);
    CHECK(flown.ledger().residual_relative() < 1e-12);
}

TEST_CASE("flights are cut short where drag changes them, and nowhere else") {
    CHECK(std::isfinite(fly_in_water(2e-5).world().state().flight.horizon));
    auto dry = simulate(in_water()).contact(law);
    dry.run({.end_time = 0.01, .time_step = 2e-5});
    CHECK(std::isinf(dry.world().state().flight.horizon));
}

TEST_CASE("who looks on changes no bit of a flight in water") {
    const auto alone = fly_in_water(2e-5), observed = fly_in_water(2e-5, 1.3e-3);
    for (std::size_t n = 0; n < alone.particles().position.size(); ++n) {
        CHECK(alone.particles().position[n] == observed.particles().position[n]);
        CHECK(alone.particles().orientation[n].coeffs() == observed.particles().orientation[n].coeffs());
    }
    CHECK(observed.ledger().residual_relative() < 1e-12);
}

namespace {

/// Water at 5 m/s below z = 0; below `numbers_above` [m] it answers with no number.
struct Jet {
    static constexpr std::string_view name = "Jet";
    struct Params {
        Real numbers_above = -1;  // [m]
        void validate() const {}
        void visit(auto&& f) const { f("numbers_above", numbers_above, "m"); }
    };
    explicit Jet(Params params) : params_(params) {}
    const Params& params() const noexcept { return params_; }
    FluidSample sample(const Vec3& x, Real) const noexcept {
        return {{x.z() < params_.numbers_above ? std::nan("") : 5, 0, 0}, -x.z(), 1000, 1e-3};
    }

private:
    Params params_;
};
static_assert(FluidModel<Jet>);

auto into_the_jet(Jet jet, bool free_flight) {
    Scene scene;
    scene.add_sphere(0.02, {.position = {0, 0, 0.011}, .velocity = {0, 0, -1}});
    auto sim = simulate(scene).contact(law).fluid(jet, CliftGauvin{});
    sim.run({.end_time = 0.02, .time_step = 2e-5, .skin = 0.05, .free_flight = free_flight});
    return sim;
}

}  // namespace

TEST_CASE("a stone that falls into a jet takes each step as it goes in") {
    const auto flown = into_the_jet(Jet({}), true), each_step = into_the_jet(Jet({}), false);
    CHECK(each_step.particles().velocity[0].x() > 0.05);
    CHECK(furthest_apart(flown, each_step) < 1e-6);
}

TEST_CASE("a fluid that answers with no number is caught, in flight too") {
    for (const bool free_flight : {true, false})
        CHECK_THROWS_AS(into_the_jet(Jet({.numbers_above = -0.004}), free_flight), RunError);
}

TEST_CASE("grains that drag stops within a flight take each step") {
    const auto settle = [](bool free_flight) {
        Scene scene;
        scene.add_sphere(5e-5, {.position = {0, 0, 0.15}, .velocity = {0, 0, 1}});
        auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 100}}).fluid(water, CliftGauvin{});
        std::vector<Vec3> velocity;  // while it slows
        sim.run({.end_time = 2e-3,
                 .time_step = 1e-6,
                 .observe_every = 2e-4,
                 .skin = 0.01,
                 .free_flight = free_flight},
                [&](const auto& now) { velocity.push_back(now.particles().velocity[0]); });
        return velocity;
    };
    const std::vector<Vec3> flown = settle(true), each_step = settle(false);
    REQUIRE(flown.size() == each_step.size());
    // Of 5 m/s; 1.3 cm/s where they fly all the same.
    for (std::size_t n = 0; n < flown.size(); ++n) CHECK((flown[n] - each_step[n]).norm() < 5e-4);
}
