// Supply, outlet and gauge.
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

#include <map>

using namespace abrade;

namespace {

const LinearSpring law{{.stiffness = 1e4, .restitution = 0.5}};

FeedParams params() {
    return {.volume_rate = 0.01,
            .classes = {{0.02, 0.3, StoneShape::sphere},
                        {0.03, 0.5, StoneShape::ellipsoid},
                        {0.05, 0.2, StoneShape::angular}},
            .region = {{0, 0, 0}, {5, 5, 5}}};
}

}  // namespace

TEST_CASE("the feed keeps its solid volume rate") {
    Feed feed(params());
    Particles p;
    for (int n = 1; n <= 100; ++n) {
        const Real t = 0.01 * n;
        feed.supply(p, {}, t, [](Index) {});
        // Behind by less than one stone of the largest class, never ahead.
        CHECK(feed.supplied_volume() <= 0.01 * t);
        CHECK(feed.supplied_volume() > 0.01 * t - pi / 6 * cube(0.05));
    }
    Real volume = 0;
    for (const Real v : p.volume) volume += v;
    CHECK(volume == doctest::Approx(feed.supplied_volume()).epsilon(1e-12).scale(0));
    CHECK(feed.supplied_stones() == p.bodies());
}

TEST_CASE("fractions are met by volume") {
    FeedParams f = params();
    f.volume_rate = 0.4;
    f.region.high = {40, 40, 40};
    Feed feed(f);
    Particles p;
    for (int n = 0; n <= 20; ++n) feed.supply(p, {}, 0.005 * n, [](Index) {});  // 0.04 m3, about 3700 stones
    std::map<Index, Real> by_shape;  // told apart by their number of spheres
    std::map<Index, int> count;
    for (std::size_t b = 0; b < p.volume.size(); ++b)
        by_shape[p.sphere_count[b]] += p.volume[b], ++count[p.sphere_count[b]];
    const Real total = feed.supplied_volume();
    // Numbers are multinomial: a class of n stones strays by 1/sqrt(n) or less; 4 sigma.
    const std::map<Index, Real> fraction{{1, 0.3}, {7, 0.5}, {9, 0.2}};
    for (const auto& [spheres, share] : fraction) {
        CHECK(count[spheres] > 50);
        CHECK(std::abs(by_shape[spheres] / total - share) <
              4 * share / std::sqrt(static_cast<Real>(count[spheres])));
    }
}

TEST_CASE("one seed, one sequence; another seed, another") {
    const auto places = [](std::uint32_t seed) {
        FeedParams f = params();
        f.seed = seed;
        Feed feed(f);
        Particles p;
        for (int n = 0; n < 50; ++n) feed.supply(p, {}, 0.01 * n, [](Index) {});
        return p.position;
    };
    CHECK(places(1) == places(1));
    CHECK(places(1) != places(2));
}

TEST_CASE(
    "stones lie whole inside the region, free of each other, turned at random, with the given velocity") {
    FeedParams f = params();
    f.region = {{1, 2, 3}, {1.6, 2.5, 3.4}};
    f.velocity = {1, 2, 3};
    Feed feed(f);
    Particles p;
    for (int n = 0; n < 40; ++n) feed.supply(p, {}, 0.005 * n, [](Index) {});
    REQUIRE(p.bodies() > 20);
    for (std::size_t s = 0; s < p.centre.size(); ++s) {
        for (int a = 0; a < 3; ++a) {
            CHECK(p.centre[s][a] - p.radius[s] >= f.region.low[a] - 1e-12);
            CHECK(p.centre[s][a] + p.radius[s] <= f.region.high[a] + 1e-12);
        }
        for (std::size_t o = 0; o < s; ++o)
            if (p.body[s] != p.body[o])
                REQUIRE((p.centre[s] - p.centre[o]).norm() >= p.radius[s] + p.radius[o]);
    }
    Vec3 mean = Vec3::Zero();
    for (std::size_t b = 0; b < p.position.size(); ++b) {
        CHECK(p.velocity[b] == f.velocity);
        mean += p.orientation[b] * Vec3::UnitX() / static_cast<Real>(p.bodies());
    }
    CHECK(mean.norm() <
          4 / std::sqrt(static_cast<Real>(p.bodies())));  // random directions: 1/sqrt(n), 4 sigma
}

TEST_CASE("region.z counts from the bed where there is one") {
    FeedParams f = params();
    f.bed = [](Real x, Real y) { return 10 * x + y; };
    Feed feed(f);
    Particles p;
    feed.supply(p, {}, 1, [](Index) {});
    REQUIRE(p.bodies() > 100);
    for (const Vec3& x : p.position) {
        CHECK(x.z() - 10 * x.x() - x.y() > 0);
        CHECK(x.z() - 10 * x.x() - x.y() < 5);
    }
}

TEST_CASE("a stone that finds no room waits, and what is due is made up for later") {
    FeedParams f = params();
    f.classes = {{0.05, 1, StoneShape::sphere}};
    f.region = {{0, 0, 0}, {0.07, 0.07, 0.07}};  // room for one
    Feed feed(f);
    Particles p;
    feed.supply(p, {}, 1, [](Index) {});
    CHECK(p.bodies() == 1);
    feed.supply(p, {}, 2, [](Index) {});
    CHECK(p.bodies() == 1);
    p.position[0].x() += 1;
    p.centre[0] = p.position[0];
    feed.supply(p, {}, 2, [](Index) {});
    CHECK(p.bodies() == 2);
    CHECK(feed.supplied_stones() == 2);
}

TEST_CASE("supply begins at its start") {
    FeedParams f = params();
    f.start = 5;
    Feed feed(f);
    Particles p;
    feed.supply(p, {}, 4.999, [](Index) {});
    CHECK(p.bodies() == 0);
    feed.supply(p, {}, 5.1, [](Index) {});
    CHECK(feed.supplied_volume() > 0.9 * 0.001);
}

TEST_CASE("through the engine: what was fed is there, has passed the gauge, or has left; the ledger closes") {
    Scene scene;
    scene.feed = FeedParams{.volume_rate = 0.005,
                            .classes = {{0.03, 0.5, StoneShape::sphere}, {0.04, 0.5, StoneShape::angular}},
                            .region = {{0, -0.2, 0.1}, {0.1, 0.2, 0.4}},
                            .velocity = {2, 0, 0}};
    scene.flow_counter = 0.5;
    scene.outlet = 1.0;
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1e6, .restitution = 0.5, .friction = 0.1}});
    sim.run({.end_time = 1.2, .time_step = 1.5e-5});
    const Particles& p = sim.particles();
    Real inside = 0, beyond_gauge = 0;
    for (std::size_t b = 0; b < p.volume.size(); ++b) {
        inside += p.volume[b];
        if (p.position[b].x() >= 0.5) beyond_gauge += p.volume[b];
        CHECK(p.position[b].x() < 1.0 + 0.1);
    }
    const Real left = sim.feed()->supplied_volume() - inside;
    CHECK(sim.feed()->supplied_volume() > 0.005 * 1.2 - 2 * pi / 6 * cube(0.04) - 0.005 * 0.02);
    CHECK(left > 0.001);
    CHECK(sim.sediment_passed() == doctest::Approx(left + beyond_gauge).epsilon(1e-12).scale(0));
    const Ledger& e = sim.ledger();
    CHECK(e.residual_relative() < 1e-11);  // 1e5 steps of a hundred stones, summed up plainly
    CHECK(e.fed_kinetic > 0);
    CHECK(e.left_kinetic > 0);
    CHECK(std::abs(e.integration_residue()) < 5e-3 * e.throughput());
    // Ids are never given twice, also when bodies leave.
    for (std::size_t b = 1; b < p.id.size(); ++b) CHECK(p.id[b] > p.id[b - 1]);
}

TEST_CASE("the gauge counts net: a stone that comes back is taken off again") {
    Scene scene;
    scene.gravity = {-10, 0, 0};
    scene.flow_counter = 0.5;
    scene.add_sphere(0.02, {.position = {0, 0, 0}, .velocity = {4, 0, 0}});  // turns at 0.8 m after 0.4 s
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0.4});
    CHECK(sim.sediment_passed() == doctest::Approx(4.0 / 3 * pi * cube(0.02)).scale(0));
    sim.run({.end_time = 0.8});
    CHECK(sim.sediment_passed() == 0);
}

TEST_CASE("stones are fed onto concrete, not into it") {
    Particles p;
    const Clump sphere = make_clump("concrete", {{Vec3::Zero(), 0.01}});
    for (int i = 0; i < 60; ++i)
        for (int j = 0; j < 10; ++j)
            p.add(sphere, 2400, {.position = {0.02 * i, 0.02 * j, 0.3 * square(0.02 * i)}},
                  j ? Kind::concrete : Kind::fixed);
    const Index concrete = p.bodies();
    FeedParams f = params();
    f.region = {{0, 0, 0}, {1.2, 0.2, 0.1}};
    Feed(f).supply(p, {}, 0.1, [](Index) {});
    CHECK(p.bodies() > concrete + 10);
    for (Index s = concrete; s < p.spheres(); ++s)
        for (Index c = 0; c < concrete; ++c) {
            const auto i = static_cast<std::size_t>(s), j = static_cast<std::size_t>(c);
            CHECK_MESSAGE((p.centre[i] - p.centre[j]).norm() > p.radius[i] + p.radius[j] - 1e-12, s, c);
        }
}

TEST_CASE("the feed keeps clear of walls, and the ledger takes what it brings") {
    FeedParams f = params();
    f.classes = {{0.05, 1, StoneShape::sphere}};
    f.region = {{0, 0, 0.0}, {1, 1, 0.1}};
    f.velocity = {0.1, 0, 0};
    Scene scene;
    scene.feed = f;
    scene.add_wall({0, 0, 0.02}, {0, 0, 1});  // 20 mm into the region
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1e4, .restitution = 0.5}});
    Real lowest = 1;
    sim.run({.end_time = 0.1, .safety = 0.1, .observe_every = 1e-3}, [&](const auto& s) {
        for (const Vec3& x : s.particles().position) lowest = std::min(lowest, x.z());
    });
    const Ledger& e = sim.ledger();
    CHECK(lowest < 0.05);
    CHECK(lowest > 0.045 - 0.006);  // a radius above the wall, less what a fall of some cm presses in
    CHECK(e.fed_kinetic > 0);
    CHECK(e.residual_relative() < 1e-12);
    CHECK(std::abs(e.integration_residue()) < 0.01 * e.gravity_work);
}
