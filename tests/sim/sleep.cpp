// Bodies at rest take no steps: what that saves, what it changes, and when they wake.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <numeric>
#include <random>

using namespace abrade;

namespace {

const LinearSpring law{{.stiffness = 5e4, .restitution = 0.3, .friction = 0.5}};

const Clump brick = make_clump("brick", {{{-0.008, -0.008, 0}, 0.01},
                                         {{0.008, -0.008, 0}, 0.01},
                                         {{-0.008, 0.008, 0}, 0.01},
                                         {{0.008, 0.008, 0}, 0.01}});

Scene box(Real width) {
    Scene scene;
    scene.periodic_along = {true, true, false};
    scene.bounds = {{-0.5 * width, -0.5 * width, -1}, {0.5 * width, 0.5 * width, 2}};
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    return scene;
}

/// Layers of side x side bodies, a little out of line.
template <class Add>
void heap(int side, int layers, Real apart, Add&& add, unsigned seed = 5) {
    std::mt19937 random(seed);
    const auto uniform = [&] { return std::uniform_real_distribution<Real>(-1, 1)(random); };
    for (int layer = 0; layer < layers; ++layer)
        for (int i = 0; i < side; ++i)
            for (int j = 0; j < side; ++j) {
                // One by one: in which order arguments are evaluated is up to the compiler.
                const Real y = uniform(), x = uniform();
                add(Vec3(apart * (i - 0.5 * side + 0.5) + 1e-3 * x, apart * (j - 0.5 * side + 0.5) + 1e-3 * y,
                         apart * (layer + 0.5)));
            }
}

/// Where 108 spheres have come to rest, in a box of 14 cm.
using Bed = std::vector<Vec3>;
Bed settled(unsigned seed) {
    Scene scene = box(0.14);
    heap(
        6, 3, 0.0212, [&](const Vec3& x) { scene.add_sphere(0.01, {.position = x}); }, seed);
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 1.5});
    return sim.particles().position;
}
const Bed& bed() {
    static const Bed places = settled(5);
    return places;
}

struct Run {
    std::vector<Vec3> position;
    Ledger ledger;
    Real residual = 0;                   ///< the largest seen [-]
    std::vector<Index> asleep;           ///< at each observation
    std::vector<std::size_t> evaluated;  ///< contacts, likewise
    Index bodies = 0;
};

template <class Sim>
Run watch(Sim sim, const RunOptions& options) {
    Run out;
    sim.run(options, [&](const auto& now) {
        out.residual = std::max(out.residual, now.ledger().residual_relative());
        out.asleep.push_back(now.world().state().sleep.count);
        out.evaluated.push_back(now.world().contacts().census().inner_pairs);
        for (Index b = 0; b < now.particles().bodies(); ++b)
            if (now.world().state().sleep.asleep(b)) {
                REQUIRE(now.particles().velocity[static_cast<std::size_t>(b)].isZero(0));
                REQUIRE(now.particles().angular_momentum[static_cast<std::size_t>(b)].isZero(0));
            }
    });
    out.position = sim.particles().position, out.ledger = sim.ledger(), out.bodies = sim.particles().bodies();
    return out;
}

struct Options {
    Real speed = 0, observe_every = 0.01, time_step = 2e-5;  ///< of sleep [m/s]; [s], [s]
};
/// A bed, and a stone that falls on it after 0.23 s.
Run impact(const Bed& bed, const Options& options) {
    Scene scene = box(0.14);
    for (const Vec3& x : bed) scene.add_sphere(0.01, {.position = x});
    scene.add_sphere(0.01, {.position = {0.003, 0.002, 0.3}});
    return watch(simulate(scene).contact(law), {.end_time = 1,
                                                .time_step = options.time_step,
                                                .observe_every = options.observe_every,
                                                .sleep_speed = options.speed});
}

/// In a box of 14 cm, around which they may have gone.
Real mean_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    Real sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        Vec3 apart = a[i] - b[i];
        for (const int along : {0, 1}) apart[along] -= 0.14 * std::round(apart[along] / 0.14);
        sum += apart.norm();
    }
    return sum / static_cast<Real>(a.size());
}

/// A ball comes in on an arc and hits ten that lie in a row on the floor; velocities soon after.
std::vector<Vec3> blow(Real speed) {
    Scene scene;
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    for (int n = 0; n < 10; ++n) scene.add_sphere(0.01, {.position = {0.02 * n, 0, 0.01}});
    scene.add_sphere(0.01, {.position = {-0.5, 0, 0.02}, .velocity = {1, 0, 2.4}});
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0.47, .time_step = 1e-5, .sleep_speed = speed});
    CHECK(sim.world().state().sleep.count == (speed > 0 ? 10 : 0));
    sim.run({.end_time = 0.52, .time_step = 1e-5, .sleep_speed = speed});
    return sim.particles().velocity;
}

/// Water that stands still, and rises from some time on.
struct Gust {
    static constexpr std::string_view name = "Gust";
    using Params = NoParams;
    Gust() = default;
    explicit Gust(Params) {}
    const Params& params() const noexcept {
        static constexpr Params none{};
        return none;
    }
    FluidSample sample(const Vec3&, Real t) const noexcept {
        return {{0, 0, t < 0.3 ? 0.0 : 2.0}, 10, 1000, 1e-3};
    }
};

}  // namespace

TEST_CASE("beds fall asleep, a stone wakes each, and they fall asleep again: the ledger closes") {
    // How spheres come to rest is chaotic, and another compiler gives other ways there: gates are on means of
    // six beds. They stand three standard deviations of such a mean from the mean of forty beds.
    constexpr Real beds = 6, speed = 3e-3;
    Real before = 0, after = 0, lost = 0;
    Real evaluated = 0, evaluated_before = 0, evaluated_after = 0;  // contacts, against all awake
    Real apart = 0, apart_at_lowest = 0;                            // logarithms, against another time step
    for (unsigned seed = 1; seed <= beds; ++seed) {
        const Bed places = settled(seed);
        const Run awake = impact(places, {}), now = impact(places, {.speed = speed});
        CHECK(now.residual < 1e-12);
        CHECK(now.ledger.lost_asleep > 0);
        // No body can take more along than it has at the threshold; a body sleeps but a few times.
        const Real mass = 2650 * 4 * pi / 3 * cube(0.01);
        CHECK(now.ledger.lost_asleep < 5 * now.bodies * 0.5 * mass * 1.4 * square(speed));
        CHECK(*std::min_element(now.asleep.begin() + 20, now.asleep.end()) < 10);
        const auto share = [&](std::size_t n) {
            return static_cast<Real>(now.evaluated[n]) / static_cast<Real>(awake.evaluated[n]);
        };
        const auto sum = [](const auto& v) { return std::accumulate(v.begin(), v.end(), Real{0}); };
        before += now.asleep[20] / beds, after += now.asleep.back() / beds;
        evaluated_before += share(20) / beds, evaluated_after += share(now.asleep.size() - 1) / beds;
        evaluated += sum(now.evaluated) / sum(awake.evaluated) / beds;
        lost += (now.ledger.lost() / awake.ledger.lost() - 1) / beds;
        const Real yardstick =
            mean_difference(impact(places, {.time_step = 1.9e-5}).position, awake.position);
        const auto against = [&](const Run& run) {
            return std::log(mean_difference(run.position, awake.position) / yardstick) / beds;
        };
        apart += against(now), apart_at_lowest += against(impact(places, {.speed = 1e-4}));
    }
    MESSAGE("asleep " << before << " before and " << after << " after; evaluated " << evaluated_before << ", "
                      << evaluated_after << ", in all " << evaluated << "; lost " << lost
                      << " more; positions differ by " << std::exp(apart) << " and "
                      << std::exp(apart_at_lowest));
    CHECK(before > 103);             // of 108, mean 106.8: few spheres still turn in their place
    CHECK(evaluated_before < 0.07);  // 0.02
    CHECK(after > 70);               // of 109, mean 96, from 10 to 109: nothing resists turning in place
    CHECK(evaluated_after < 0.42);   // 0.15
    CHECK(evaluated < 0.75);         // 0.62
    CHECK(std::abs(lost) < 0.0085);  // -0.0003, of single beds spread by 0.0067
    // As a time step that is 5 % smaller changes positions; geometric means 2.0 and 0.9, of single beds
    // spread by a factor of 2.1 and 2.3.
    CHECK(std::exp(apart) < 4.7);
    CHECK(std::exp(apart_at_lowest) < 2.4);
}

TEST_CASE("a blow runs through a row of sleepers as through one awake") {
    const std::vector<Vec3> awake = blow(0);
    CHECK(awake[10].x() < -0.5);
    CHECK(awake[9].x() > 0.1);
    // Each stands still until the one beside it is faster than the threshold.
    for (const Real speed : {1e-4, 1e-3, 1e-2}) {
        const std::vector<Vec3> now = blow(speed);
        for (std::size_t b = 0; b < now.size(); ++b) CHECK((now[b] - awake[b]).norm() < speed);
    }
}

TEST_CASE("clumps sleep, all of them") {
    Scene scene = box(0.168);
    heap(4, 3, 0.042, [&](const Vec3& x) {
        scene.add_stone(
            brick,
            {.position = x, .orientation = Quaternion(Eigen::AngleAxis<Real>(x.x() * 300, Vec3::UnitX()))});
    });
    scene.add_stone(brick, {.position = {0, 0, 0.2}, .velocity = {0, 0, 4}});
    const Run run =
        watch(simulate(scene).contact(law), {.end_time = 2.5, .observe_every = 0.05, .sleep_speed = 2e-3});
    CHECK(run.residual < 1e-12);
    CHECK(run.asleep[16] > 35);
    CHECK(*std::min_element(run.asleep.begin() + 16, run.asleep.end()) < 30);
    CHECK(run.asleep.back() == run.bodies);
}

TEST_CASE("what is slow for a moment does not sleep: a stone at the top of its flight") {
    for (const bool free_flight : {true, false}) {
        Scene scene;
        scene.add_sphere(0.01, {.position = {0, 0, 1}, .velocity = {0, 0, 1}});
        scene.add_wall({0, 0, 0}, {0, 0, 1});
        auto sim = simulate(scene).contact(law);
        sim.run({.end_time = 0.2,
                 .time_step = 1e-5,
                 .free_flight = free_flight,
                 .sleep_speed = 2,
                 .sleep_after = 1e-2});
        CHECK(sim.world().state().sleep.count == 0);
        CHECK(sim.particles().position[0].z() == doctest::Approx(1.2 - 0.02 * standard_gravity));
    }
}

TEST_CASE("what is slow but gets faster does not sleep: a pillar that topples") {
    const Clump pillar =
        make_clump("pillar", {{{0, 0, -0.02}, 0.01}, {{0, 0, 0}, 0.01}, {{0, 0, 0.02}, 0.01}});
    const auto topple = [&](Real speed) {
        Scene scene;
        scene.add_stone(pillar, {.position = {0, 0, 0.03},
                                 .orientation = Quaternion(Eigen::AngleAxis<Real>(1e-5, Vec3::UnitY()))});
        scene.add_wall({0, 0, 0}, {0, 0, 1});
        auto sim = simulate(scene).contact(law);
        sim.run({.end_time = 1, .time_step = 2e-5, .sleep_speed = speed});
        return sim.particles().position[0].z();
    };
    CHECK(topple(0) < 0.02);
    for (const Real speed : {1e-4, 1e-3, 1e-2}) CHECK(topple(speed) < 0.02);
}

TEST_CASE("a sleeper wakes where its load changes, however slowly that comes") {
    // Nothing here is ever faster than the threshold. One lies asleep on the floor; one comes down on it.
    const Real mass = 2650 * 4 * pi / 3 * cube(0.01), sunk = mass * standard_gravity / 5e4;
    Scene scene;
    scene.add_sphere(0.01, {.position = {0, 0, 0.01 - sunk}});
    scene.add_sphere(0.01, {.position = {0, 0, 0.0301}, .velocity = {0, 0, 0.5}});
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    auto sim = simulate(scene).contact(law);
    const RunOptions until{.end_time = 0.1, .time_step = 2e-5, .sleep_speed = 0.6, .sleep_after = 0.02};
    sim.run(until);
    CHECK(sim.world().state().sleep.asleep(0));
    CHECK_FALSE(sim.world().state().sleep.asleep(1));
    RunOptions more = until;
    more.end_time = 0.5;
    sim.run(more);
    CHECK(sim.world().state().sleep.count == 2);
    CHECK(sim.ledger().residual_relative() < 1e-12);
    CHECK(0.01 - sim.particles().position[0].z() == doctest::Approx(2 * sunk).epsilon(Sleep::allowed_change));
}

TEST_CASE("who leaves does not make others begin anew to fall asleep") {
    // The first passes the outlet before anybody sleeps; the second has lain still all along.
    Scene scene;
    scene.outlet = 1;
    scene.add_sphere(0.01, {.position = {0.995, 0, 0.5}, .velocity = {1, 0, 0}});
    scene.add_sphere(0.01,
                     {.position = {0, 0, 0.01 - 2650 * 4 * pi / 3 * cube(0.01) * standard_gravity / 5e4}});
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0.018, .time_step = 2e-5, .sleep_speed = 1e-3, .sleep_after = 0.015});
    CHECK(sim.particles().bodies() == 1);
    CHECK(sim.world().state().sleep.asleep(0));
}

TEST_CASE("water that begins to rise wakes who lies in it") {
    Scene scene;
    scene.add_sphere(0.01, {.position = {0, 0, 0.01}});
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    auto sim = simulate(scene).contact(law).fluid(Gust{});
    sim.run({.end_time = 0.29, .sleep_speed = 1e-3});
    CHECK(sim.world().state().sleep.count == 1);
    sim.run({.end_time = 0.5, .sleep_speed = 1e-3});
    CHECK(sim.world().state().sleep.count == 0);
    CHECK(sim.particles().position[0].z() > 0.05);
    CHECK(sim.ledger().residual_relative() < 1e-12);
}

TEST_CASE("stones sleep on bonded concrete, which does not") {
    Scene scene;
    scene.concrete = ConcreteBlock{flat_lattice(0.1, 0.1, {.layers = 2})};
    scene.add_stone(brick, {.position = {-0.02, 0, 0.021}}).add_stone(brick, {.position = {0.02, 0, 0.03}});
    const auto run = watch(simulate(scene)
                               .contact(LinearSpring{{.stiffness = 2e5, .restitution = 0.3, .friction = 0.5}})
                               .bond(MohrCoulomb{{.tensile = 2.7e6, .stiffness = 4e6, .damping = 0.1}})
                               .wear(SubParticleAbrasion{{.coefficient = 1e-7}}),
                           {.end_time = 0.6, .observe_every = 0.02, .sleep_speed = 2e-3});
    CHECK(run.residual < 1e-12);
    CHECK(run.asleep.back() == 2);
}

TEST_CASE("the same bits for any number of threads, and however often it is observed") {
    const auto fall = [](int threads) {
        const int before = thread_count();
        set_thread_count(threads);
        // The bed, sixteen times; it sleeps as the stone comes.
        Scene scene = box(4 * 0.14);
        for (int tile = 0; tile < 16; ++tile)
            for (const Vec3& x : bed())
                scene.add_sphere(0.01, {.position = x + 0.14 * Vec3(tile % 4 - 1.5, tile / 4 - 1.5, 0)});
        scene.add_sphere(0.01, {.position = {0, 0, 0.15}, .velocity = {0.5, 0, -1.5}});
        auto sim = simulate(scene).contact(law);
        sim.run({.end_time = 0.08, .time_step = 2e-5, .sleep_speed = 1e-2, .sleep_after = 0.02});
        set_thread_count(before);
        CHECK(sim.world().state().store.slabs.chunks() > 1);
        CHECK(sim.world().state().sleep.count > 100);
        CHECK(sim.world().state().sleep.count < sim.particles().bodies() - 5);
        return sim.particles().position;
    };
    CHECK(fall(1) == fall(2));
    CHECK(impact(bed(), {.speed = 1e-3}).position ==
          impact(bed(), {.speed = 1e-3, .observe_every = 0.07}).position);
}

TEST_CASE("a run that goes on without sleep wakes everybody") {
    Scene scene = box(0.14);
    for (const Vec3& x : bed()) scene.add_sphere(0.01, {.position = x});
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0.2, .sleep_speed = 1e-3});
    CHECK(sim.world().state().sleep.count > 50);
    sim.run({.end_time = 0.21});
    CHECK(sim.world().state().sleep.count == 0);
    CHECK(sim.world().contacts().census().at_rest == 0);
    CHECK(sim.world().contacts().census().touching > 200);
    CHECK(sim.ledger().residual_relative() < 1e-12);
}

TEST_CASE("options that cannot be") {
    const auto message = [](RunOptions options, bool weightless = false) -> std::string {
        Scene scene;
        if (weightless) scene.gravity.setZero();
        scene.add_sphere(0.01, {});
        try {
            simulate(scene).contact(law).run(options);
        } catch (const InputError& error) {
            return error.what();
        }
        return "nothing was thrown";
    };
    for (const Real bad :
         {-1.0, std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity()}) {
        CHECK(message({.end_time = 1e-4, .sleep_speed = bad}).starts_with("RunOptions.sleep_speed must be"));
        CHECK(message({.end_time = 1e-4, .sleep_after = bad}).starts_with("RunOptions.sleep_after must be"));
    }
    CHECK(message({.end_time = 1e-4, .sleep_speed = 1e-3}) == "nothing was thrown");
    CHECK(message({.end_time = 1e-4, .sleep_speed = 1e-3}, true)
              .starts_with("RunOptions.sleep_after must be > 0 where"));
    CHECK(message({.end_time = 1e-4, .sleep_speed = 1e-3, .sleep_after = 0.1}, true) == "nothing was thrown");
}
