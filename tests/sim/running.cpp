// Running on, stopping, observing; threads and skins that change nothing; policies that cost nothing.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/fluid/uniform_flow.hpp>
#include <abrade/sim/print.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <doctest/doctest.h>

#include <cstring>
#include <random>
#include <sstream>

using namespace abrade;

namespace {

const LinearSpring law{{.stiffness = 1e6, .restitution = 0.6, .friction = 0.4}};

/// Stones thrown about in a box of six walls.
Scene box_of_stones(int stones, Real speed = 2) {
    Scene scene;
    std::mt19937 random(3);
    std::uniform_real_distribution<Real> u(-1, 1);
    // One by one: in which order arguments are evaluated is up to the compiler.
    const auto any = [&] {
        const Real z = u(random), y = u(random), x = u(random);
        return Vec3(x, y, z);
    };
    for (int n = 0; n < stones; ++n) {
        const Vec3 at(0.12 * (n % 3 - 1), 0.12 * (n / 3 % 3 - 1), 0.12 * (n / 9) - 0.12);
        scene.add_stone(make_stone(n % 2 ? StoneShape::angular : StoneShape::sphere, 0.05),
                        {.position = at, .velocity = speed * any(), .angular_velocity = 10 * any()});
    }
    for (int axis = 0; axis < 3; ++axis)
        for (const Real side : {-1.0, 1.0})
            scene.add_wall(0.25 * side * Vec3::Unit(axis), -side * Vec3::Unit(axis));
    return scene;
}

/// A spring that needs to remember nothing.
struct BareSpring {
    static constexpr std::string_view name = "BareSpring";
    using Params = NoParams;
    template <class Number>
    struct Memory {};
    explicit BareSpring(Params = {}) {}
    const Params& params() const noexcept {
        static constexpr Params none{};
        return none;
    }
    template <class Number>
    ContactResponse<Number, Memory<Number>> respond(const ContactKinematics<Number>& c,
                                                    const Memory<Number>&) const noexcept {
        const Number overlap = max(c.overlap, Number(0));
        return {{Number(1e6) * overlap * c.normal, Number(0.5e6) * overlap * overlap, Number(0), Number(0)},
                {}};
    }
    Real stable_dt(Real mass, Real) const noexcept { return 0.2 * std::sqrt(mass / 1e6); }
    ContactRigidity rigidity(Real) const noexcept { return {1e6, 0, 0}; }
};

/// Every bit of what moves.
std::vector<Real> state(const Particles& p) {
    std::vector<Real> all;
    for (std::size_t b = 0; b < p.position.size(); ++b) {
        all.push_back(p.id[b]);
        for (const Vec3* v : {&p.position[b], &p.velocity[b], &p.angular_momentum[b]})
            all.insert(all.end(), v->data(), v->data() + 3);
        all.insert(all.end(), p.orientation[b].coeffs().data(), p.orientation[b].coeffs().data() + 4);
    }
    return all;
}
bool same_bits(const std::vector<Real>& a, const std::vector<Real>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Real)) == 0;
}

constexpr Real step = 0x1p-16;  // 1.5e-5 s; sums of it are exact, so two runs see the same times

}  // namespace

TEST_CASE("a run ends exactly at its end time, and may be asked to end there again") {
    for (int n = 1; n <= 50; ++n) {
        const Real end = 1e-3 * n / 7;
        Scene scene;
        scene.add_sphere(0.01, {});
        auto sim = simulate(scene).contact(law);
        sim.run({.end_time = end, .time_step = 1.3e-6});
        CHECK(sim.time() == end);
        const Index steps = sim.steps();
        sim.run({.end_time = end, .time_step = 1.3e-6});
        CHECK(sim.steps() == steps);
    }
}

TEST_CASE("an end that is less than a step away is reached") {
    Scene scene;
    scene.add_sphere(0.01, {});
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 1e-3, .time_step = 1e-5});
    for (const Real ahead : {1e-18, 1e-12, 1e-6}) {
        const Index steps = sim.steps();
        const Real end = sim.time() + ahead;
        sim.run({.end_time = end, .time_step = 1e-5});
        CHECK(sim.time() == end);
        CHECK(sim.steps() - steps == 1);
    }
    CHECK(sim.ledger().residual_relative() < 1e-12);
    // Springs so soft that the stable step is longer than the whole run.
    auto soft = simulate(scene).contact(LinearSpring{{.stiffness = 1e-9}});
    soft.run({.end_time = 0.01});
    CHECK(soft.time() == 0.01);
    CHECK(soft.particles().velocity[0].z() == doctest::Approx(-0.01 * standard_gravity).scale(0));
}

TEST_CASE("run() twice is run() once") {
    const auto run = [](std::vector<Real> ends) {
        auto sim = simulate(box_of_stones(9)).contact(law);
        for (const Real end : ends) sim.run({.end_time = end, .time_step = step});
        CHECK(sim.steps() == 8192);
        CHECK(sim.time() == 0.125);
        std::vector<Real> all = state(sim.particles());
        for (const Real e : {sim.ledger().lost_normal, sim.ledger().lost_sliding,
                             sim.ledger().interaction_work, sim.ledger().kinetic_start})
            all.push_back(e);
        return all;
    };
    const auto once = run({0.125});
    CHECK(same_bits(once, run({0.0625, 0.125})));
    CHECK(same_bits(once, run({0.0, 0.03125, 0.03125, 0.125, 0.125})));
}

TEST_CASE("the skin of the neighbour list changes no bit of the motion") {
    // Were a contact found a step late, the motion would differ. In free flight lists decide how many steps
    // are taken as one, which moves the last digit; so without.
    const auto run = [](Real skin) {
        auto sim = simulate(box_of_stones(18, 8)).contact(law);
        sim.run({.end_time = 0.125, .time_step = step, .skin = skin, .free_flight = false});
        return state(sim.particles());
    };
    const auto wide = run(0.05);
    CHECK(same_bits(wide, run(0.02)));
    CHECK(same_bits(wide, run(0.005)));
    CHECK(same_bits(wide, run(0.001)));
    CHECK(same_bits(wide, run(0.0002)));  // 1.6 steps of the fastest
}

TEST_CASE("two that race towards each other from just beyond the skin are found in time") {
    // They leave their places by more than half a skin in the very step in which they touch.
    const auto run = [](Real skin) {
        Scene scene;
        scene.gravity.setZero();
        // 64 steps of 0.1 mm.
        scene.add_sphere(0.01, {.position = {-0.0101 - 1e-7, 0, 0}, .velocity = {7, 0, 0}});
        scene.add_sphere(0.01, {.position = {0.0101 + 1e-7, 0, 0}, .velocity = {-7, 0, 0}});
        auto sim = simulate(std::move(scene)).contact(law);
        sim.run({.end_time = 0.0009765625, .time_step = step, .skin = skin, .free_flight = false});
        return state(sim.particles());
    };
    const auto wide = run(0.01);
    CHECK(same_bits(wide, run(0.0004)));
    CHECK(same_bits(wide, run(0.0003)));
    CHECK(same_bits(wide, run(0.00025)));
    // A skin that two steps outrun, 2 x 0.107 mm, cannot be kept by renewing: it must be widened.
    CHECK(same_bits(wide, run(0.0002)));
    CHECK(same_bits(wide, run(0.0001)));
}

TEST_CASE("the run ends on time, and the observer sees start, intervals and end") {
    auto sim = simulate(box_of_stones(2)).contact(law);
    std::vector<Real> seen;
    sim.run({.end_time = 0.1, .time_step = 3e-5, .observe_every = 0.02},
            [&](const auto& s) { seen.push_back(s.time()); });
    CHECK(sim.time() == 0.1);
    CHECK(sim.time_step() <= 3e-5);
    REQUIRE(seen.size() == 6);
    for (std::size_t n = 0; n < 6; ++n)
        CHECK(std::abs(seen[n] - 0.02 * static_cast<Real>(n)) <= sim.time_step());
    seen.clear();
    sim.run({.end_time = 0.2}, [&](const auto& s) { seen.push_back(s.time()); });
    CHECK(seen.size() == 2);  // start and end
    CHECK(seen.back() == 0.2);
}

TEST_CASE("a run that is asked to stop stops soon, whole and continuable") {
    auto sim = simulate(box_of_stones(4)).contact(law);
    int asked = 0, observed = 0;
    sim.run({.end_time = 0.1, .time_step = step, .stop = [&] { return ++asked == 3; }},
            [&](const auto&) { ++observed; });
    CHECK(sim.stopped());
    CHECK(asked == 3);
    CHECK(observed == 2);  // start, and where it stopped
    CHECK(sim.steps() < 1000);
    CHECK(sim.time() == doctest::Approx(sim.steps() * sim.time_step()).scale(0));
    CHECK(sim.ledger().residual_relative() < 1e-12);
    sim.run({.end_time = 0.1, .time_step = step});
    CHECK(!sim.stopped());
    CHECK(sim.time() == 0.1);
}

TEST_CASE("bits do not depend on threads or on the run: concrete, stones, water, wear, supply") {
    const auto run = [](int threads) {
        const int before = thread_count();
        set_thread_count(threads);
        const Invert invert{.length = 0.4, .width = 0.4, .arc_radius = 0.6, .slope = 0.05};
        Scene scene;
        scene.gravity = invert.gravity();
        scene.concrete = ConcreteBlock{invert_lattice(invert, {.layers = 3})};
        scene.feed =
            FeedParams{.volume_rate = 0.01,
                       .classes = {{0.03, 0.5, StoneShape::sphere}, {0.04, 0.5, StoneShape::angular}},
                       .region = {{0, -0.15, 0.08}, {0.1, 0.15, 0.3}},
                       .velocity = {2, 0, -2}};
        scene.outlet = 0.38;
        auto sim = simulate(scene)
                       .contact(LinearSpring{{.stiffness = 1e5, .restitution = 0.5, .friction = 0.5}})
                       .bond(MohrCoulomb{{.tensile = 2e3, .stiffness = 1e5}})  // weak, so that bonds do break
                       .wear(SubParticleAbrasion{{.acceleration = 1e4}})
                       .fluid(UniformFlow{{.section = invert, .discharge = 0.1}});
        sim.run({.end_time = 0.12});
        set_thread_count(before);
        CHECK(sim.concrete().sites() > 1000);  // several blocks for the threads
        CHECK(sim.feed()->supplied_stones() > 10);
        CHECK(sim.bonds_broken() > 0);
        CHECK(sim.concrete().worn_volume() > 0);
        std::vector<Real> all = state(sim.particles());
        sim.ledger().visit([&](std::string_view, Real value) { all.push_back(value); });
        for (Index s = 0; s < sim.concrete().sites(); ++s) all.push_back(sim.concrete().fracture(s));
        all.push_back(sim.bonds_broken());
        return all;
    };
    const auto one = run(1);
    CHECK(same_bits(one, run(1)));
    CHECK(same_bits(one, run(2)));
    CHECK(same_bits(one, run(3)));
}

TEST_CASE("a law with an empty memory runs, whole packs at once") {
    static_assert(AnswersPacks<BareSpring>);
    auto sim = simulate(box_of_stones(18)).contact(BareSpring{});
    sim.run({.end_time = 0.2});
    CHECK(sim.ledger().residual_relative() < 1e-12);
    CHECK(std::abs(sim.ledger().integration_residue()) < 1e-3 * sim.ledger().throughput());
    CHECK(sim.ledger().interaction_work != 0);
}

TEST_CASE("policies that are absent cost no byte") {
    CHECK(sizeof(Policies<LinearSpring, NoBond, NoWear, NoFluid, NoDrag>) == sizeof(LinearSpring));
}

TEST_CASE("a simulation prints its laws, its step and why, its ledger") {
    auto sim = simulate(box_of_stones(3)).contact(law);
    std::ostringstream before, after;
    before << sim;
    CHECK(before.str().find("not run yet") != std::string::npos);
    sim.run({.end_time = 0.1});
    after << sim;
    for (const char* part : {"LinearSpring(stiffness = 1e+06 N/m", "NoBond", "NoWear", "NoFluid",
                             "contacts of the lightest stone", "lost_normal", "bodies   3", "wall"}) {
        CAPTURE(std::string(part));
        CHECK(after.str().find(part) != std::string::npos);
    }
}
