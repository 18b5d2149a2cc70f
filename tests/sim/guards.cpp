// Runs that go wrong are stopped in the step in which they do, with the id, the place and the last good
// state.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

/// A spring that answers with a NaN once it is pressed beyond a limit.
struct Faulty {
    static constexpr std::string_view name = "Faulty";
    using Params = NoParams;
    template <class Number>
    struct Memory {};
    explicit Faulty(Params = {}) {}
    const Params& params() const noexcept {
        static constexpr Params none{};
        return none;
    }
    ContactResponse<Real, Memory<Real>> respond(const ContactKinematics<Real>& c,
                                                const Memory<Real>&) const noexcept {
        const Real force = c.overlap > 1e-5 ? std::nan("") : 1e6 * std::max(c.overlap, 0.0);
        return {{force * c.normal, 0, 0, 0}, {}};
    }
    Real stable_dt(Real, Real) const noexcept { return 1e-3; }
    ContactRigidity rigidity(Real) const noexcept { return {1e6, 0, 0}; }
};
static_assert(ContactLaw<Faulty>);

template <class Simulation>
RunError error_of(Simulation& sim, const RunOptions& options) {
    try {
        sim.run(options);
    } catch (const RunError& error) {
        return error;
    }
    FAIL("no RunError");
    throw 0;
}

bool says(const RunError& error, const std::string& what) {
    return std::string(error.what()).find(what) != std::string::npos;
}

template <class Simulation>
void check_sound(const Simulation& sim, const RunError& error) {
    const Snapshot& good = sim.last_good();
    CHECK(good.step < error.step);
    CHECK(good.time < error.time);
    CHECK(good.id.size() == good.position.size());
    REQUIRE(!good.id.empty());
    for (const auto* column : {&good.position, &good.velocity, &good.angular_momentum})
        for (const Vec3& value : *column) CHECK(value.allFinite());
    for (const Quaternion& turned : good.orientation) CHECK(turned.coeffs().allFinite());
    CHECK(says(error, "step " + std::to_string(error.step)));
    const std::string what = error.what(), before = "the last good state is that of t = ";
    REQUIRE(what.find(before) != std::string::npos);
    // Rounded, to be read.
    CHECK(std::abs(std::stod(what.substr(what.find(before) + before.size())) - good.time) <=
          1e-3 * good.time);
}

}  // namespace

TEST_CASE("a NaN from a law is caught in its own step, with the id of the body") {
    Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(0.01, {.position = {5, 0, 5}});
    scene.add_sphere(0.01, {.position = {0, 0, 0.0105}, .velocity = {0, 0, -1}});
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    auto sim = simulate(scene).contact(Faulty{});
    // 0.5 mm of gap at 1e-5 m a step: touches in step 50, overlaps by 1e-5 in step 51, by more in step 52 at
    // the latest. The force of the places that a step led to acts in the next.
    const RunError error = error_of(sim, {.end_time = 0.1, .time_step = 1e-5});
    CHECK(error.step >= 51);
    CHECK(error.step <= 53);
    CHECK(error.time == doctest::Approx(error.step * 1e-5).scale(0));
    CHECK(error.id == 1);
    CHECK(says(error, "velocity of stone with id 1 is not finite"));
    check_sound(sim, error);
}

TEST_CASE("a body that leaves the bounds is caught in the step in which it does") {
    Scene scene;
    scene.gravity.setZero();
    scene.bounds = {{-1, -1, -1}, {1, 1, 1}};
    scene.add_sphere(0.01, {.position = {0.5, 0, 0}, .velocity = {1, 0, 0}});
    scene.add_sphere(0.01, {.position = {0, 0.9985, 0}, .velocity = {0, 1, 0}});
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1e5}});
    const RunError error = error_of(sim, {.end_time = 1, .time_step = 1e-4});
    CHECK(error.step == 16);  // 0.9985 + 15 x 1e-4 is the bound itself; round-off decides about 15
    CHECK(error.id == 1);
    CHECK(says(error, "stone with id 1 left the world's bounds"));
    CHECK(says(error, "speed 1 m/s"));
    check_sound(sim, error);
}

TEST_CASE("a runaway overlap is caught: springs too soft for the impact") {
    Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(0.01, {.position = {0, 0, 0.0101}, .velocity = {0, 0, -20}});
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1e3}});
    const RunError error = error_of(sim, {.end_time = 0.1, .time_step = 1e-6});
    // 0.1 mm of gap and 20 % of the radius at 2e-5 m a step, slowed a little.
    CHECK(error.step >= 105);
    CHECK(error.step < 115);
    CHECK(error.id == 0);
    CHECK(says(error, "overlaps Scene.walls[0] by 20"));
    CHECK(says(error, "they met at 20 m/s"));
    CHECK(says(error, "no time step is enough"));
    check_sound(sim, error);
}

TEST_CASE("the last step of a run is looked at, too, and so is a state before it becomes the last good one") {
    Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(0.01, {.position = {0, 0, 0.0125}, .velocity = {0, 0, -5}});
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    // 2.5 mm of gap and 5 mm a step: apart, then an overlap of a quarter of the radius at the end.
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1e3}});
    const RunError error = error_of(sim, {.end_time = 1e-3, .time_step = 1e-3});
    CHECK(error.step == 1);
    CHECK(error.time == 1e-3);
    CHECK(says(error, "overlaps Scene.walls[0] by 25 %"));
    check_sound(sim, error);
}

TEST_CASE("a body that moves by more than its radius in a step is caught before it passes through another") {
    const auto meeting = [](Real speed, bool free_flight) {
        Scene scene;
        scene.gravity.setZero();
        scene.add_sphere(0.05, {.position = {-10, 0, 0}});
        scene.add_sphere(0.01, {.position = {0.1, 0, 0}, .velocity = {-speed, 0, 0}});
        scene.add_sphere(0.01, {.position = {-0.1, 0, 0}, .velocity = {speed, 0, 0}});
        auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1e3}});
        return error_of(sim, {.end_time = 0.1, .time_step = 1e-4, .free_flight = free_flight});
    };
    for (const bool free_flight : {false, true}) {
        const RunError fast = meeting(150, free_flight);
        CHECK(fast.step == 1);
        CHECK((fast.id == 1 || fast.id == 2));
        CHECK(says(fast, "moves 1.5 of its radius in a step"));
        CHECK(says(fast, "take a step of at most 6.66e-05 s"));
        // Just slow enough: they meet, and are seen to.
        CHECK(says(meeting(99, free_flight), "overlaps"));
    }
}

TEST_CASE("two stones: the message names both, and the limit is that of the smaller") {
    Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(0.05, {.position = {0, 0, 0}});
    scene.add_sphere(0.01, {.position = {0.0601, 0, 0}, .velocity = {-20, 0, 0}});
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1e3}});
    const RunError error = error_of(sim, {.end_time = 0.1, .time_step = 1e-6});
    CHECK(error.step < 115);
    CHECK(says(error, "stone with id 0"));
    CHECK(says(error, "stone with id 1"));
}

namespace {

/// The number that stands after a text in a message.
Real number_after(const RunError& error, const std::string& text) {
    const std::string what = error.what();
    REQUIRE(what.find(text) != std::string::npos);
    return std::stod(what.substr(what.find(text) + text.size()));
}

/// A sphere of 1 cm that hits one of 2 cm off its line of centres, while both fly.
Scene impact(Real speed) {
    Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(0.02, {.velocity = {1, 0, 0}});
    scene.add_sphere(0.01, {.position = {0.0305, 0.004, 0}, .velocity = {1 - speed, 0, 0}});
    return scene;
}

/// A clump that hits a wall with one end.
Scene clump_on_wall(Real speed) {
    Scene scene;
    scene.gravity.setZero();
    scene.add_stone(make_clump("twin", {{{-0.006, 0, 0}, 0.009}, {{0.006, 0, 0}, 0.01}}),
                    {.position = {0, 0, 0.02},
                     .velocity = {0, 0, -speed},
                     .orientation = Quaternion(Eigen::AngleAxis<Real>(0.5, Vec3::UnitY()))});
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    return scene;
}

}  // namespace

TEST_CASE("springs too soft: the message has the speed, and the stiffness and the speed that run through") {
    const auto check = [](auto scene, Real speed, auto law, auto params, Real& stiffness, Real share) {
        auto sim = simulate(scene(speed)).contact(law(params));
        sim.run({.end_time = 0});
        const Real dt = share * sim.stable_time_step().seconds;
        const RunError error = error_of(sim, {.end_time = 0.1, .time_step = dt});
        INFO(std::string(error.what()));
        CHECK(says(error, "no time step is enough"));
        CHECK(number_after(error, "they met at ") == doctest::Approx(speed).epsilon(0.05));
        const Real stiffer = number_after(error, "springs "), step = number_after(error, "with a step of "),
                   slower = number_after(error, "or a speed of ");
        CHECK(stiffer > 1);
        CHECK_NOTHROW(simulate(scene(slower)).contact(law(params)).run({.end_time = 0.1, .time_step = dt}));
        const Real soft = std::exchange(stiffness, stiffness * stiffer);
        CHECK_NOTHROW(simulate(scene(speed)).contact(law(params)).run({.end_time = 0.1, .time_step = step}));
        // It is not more than needed either.
        stiffness = soft * (1 + 0.7 * (stiffer - 1));
        if (stiffer > 1.3)
            CHECK_THROWS_AS(
                simulate(scene(speed)).contact(law(params)).run({.end_time = 0.1, .time_step = step}),
                RunError);
    };
    const auto linear = [](const LinearSpring::Params* p) { return LinearSpring(*p); };
    const auto hertz = [](const HertzMindlin::Params* p) { return HertzMindlin(*p); };
    for (const Real share : {0.9, 0.3, 0.05})
        for (const Real restitution : {1.0, 0.4}) {
            CAPTURE(share);
            CAPTURE(restitution);
            LinearSpring::Params soft{.stiffness = 2e5, .restitution = restitution};
            check(impact, 20, linear, &std::as_const(soft), soft.stiffness, share);
            HertzMindlin::Params soft_hertz{
                .youngs = 2e7, .restitution = restitution, .largest_overlap = 0.2};
            check(impact, 10, hertz, &std::as_const(soft_hertz), soft_hertz.youngs, share);
        }
    LinearSpring::Params soft{.stiffness = 1e5};
    check(clump_on_wall, 20, linear, &std::as_const(soft), soft.stiffness, 0.1);
}

TEST_CASE("a step too coarse for the impact: the message has the step that runs through") {
    // Alone, exactly: speed sqrt(m / k) deep; 19.7 % of the radius here, with and without damping. The law
    // says that it is soft and any step stable, so that one may be taken which is not.
    struct Careless : LinearSpring {
        using LinearSpring::LinearSpring;
        Real stable_dt(Real, Real) const noexcept { return 1; }
        ContactRigidity rigidity(Real) const noexcept { return {1, 0, 0}; }
    };
    for (const Real restitution : {1.0, 0.7}) {
        CAPTURE(restitution);
        const Careless law({.stiffness = restitution < 1 ? 2.1e5 : 2.85e5, .restitution = restitution});
        // In the first, small way the error is that of a few steps; then the first that touches goes too far.
        for (const auto& try_with :
             {std::pair(1e-6, 1e-4), std::pair(1e-4, 2.2e-4), std::pair(1e-4, 4.7e-4)}) {
            const Real gap = try_with.first, coarse = try_with.second;
            if (restitution < 1 && gap < 1e-5) continue;  // just deep enough without damping only
            CAPTURE(coarse);
            Scene scene;
            scene.gravity.setZero();
            scene.add_sphere(0.01, {.position = {0, 0, 0.01 + gap}, .velocity = {0, 0, -10}});
            scene.add_wall({0, 0, 0}, {0, 0, 1});
            auto sim = simulate(scene).contact(law);
            const RunError error = error_of(sim, {.end_time = 0.01, .time_step = coarse});
            INFO(std::string(error.what()));
            const Real enough = number_after(error, "a time step of ");
            CHECK(enough < coarse);
            CHECK(enough > 1e-6);
            CHECK_NOTHROW(simulate(scene).contact(law).run({.end_time = 0.01, .time_step = enough}));
        }
    }
}

TEST_CASE("pressed, not hit: no step and no speed would have helped") {
    Scene scene;
    scene.gravity = {0, 0, -1};
    scene.add_sphere(0.01, {.position = {0, 0, 0.0099}});
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    // 0.011 kg on 0.1 N/m: its weight presses it in by a tenth of a metre, slowly.
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 0.1, .restitution = 0.5}});
    const RunError error = error_of(sim, {.end_time = 1, .time_step = 1e-3});
    CHECK(says(error, "something presses them together"));
}

TEST_CASE("a runaway overlap between bonded spheres is caught too") {
    // A stone that hits the slab far too fast for its bonds.
    Scene scene;
    scene.gravity.setZero();
    scene.concrete = ConcreteBlock{flat_lattice(0.06, 0.06, {.layers = 3})};
    scene.add_sphere(0.02, {.position = {0, 0, 0.021}, .velocity = {0, 0, -100}});
    auto sim = simulate(scene)
                   .contact(LinearSpring{{.stiffness = 1e6}})
                   .bond(MohrCoulomb{{.tensile = 1e9, .stiffness = 1e6}});
    const RunError error = error_of(sim, {.end_time = 0.1});
    check_sound(sim, error);
}

TEST_CASE("bonds crushed under their own weight are caught, without any contact") {
    Scene scene;
    scene.gravity = {0, 0, -1e6};
    scene.concrete = ConcreteBlock{flat_lattice(0.06, 0.06, {.layers = 3})};
    auto sim = simulate(scene)
                   .contact(LinearSpring{{.stiffness = 1e6}})
                   .bond(MohrCoulomb{{.tensile = 1e12, .stiffness = 1e6}});
    const RunError error = error_of(sim, {.end_time = 0.1});
    CHECK(says(error, "concrete sphere with id"));
    CHECK(says(error, "stiffer bonds or a smaller load are needed"));
    CHECK(says(error, "% of the smaller radius"));
    check_sound(sim, error);
}

TEST_CASE("after an error the last good state can be read, and the run is not silently continued") {
    Scene scene;
    scene.gravity.setZero();
    scene.bounds = {{-1, -1, -1}, {1, 1, 1}};
    scene.add_sphere(0.01, {.position = {0.99, 0, 0}, .velocity = {1, 0, 0}});
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1e5}});
    const RunError first = error_of(sim, {.end_time = 1, .time_step = 1e-4});
    const RunError second = error_of(sim, {.end_time = 1, .time_step = 1e-4});
    CHECK(second.step == first.step + 1);  // still outside: still an error
}
