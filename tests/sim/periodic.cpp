// How small periodic space may be: what is let through is right, what is smaller is refused.
#include "../verification/ledger_scenes.hpp"

#include <doctest/doctest.h>

using namespace ledger_scenes;

namespace {

const LinearSpring law{{.stiffness = 5e5, .restitution = 0.8, .friction = 0.3}};
constexpr Real skin = 0.002;

/// A few spheres in a tube of this period along x, so near each other that they meet across the edge.
Scene tube(Real period) {
    Scene scene;
    scene.gravity.setZero();
    scene.periodic_along = {true, false, false};
    scene.bounds = {{0, -1, -1}, {period, 1, 1}};
    scene.add_sphere(0.01, {.position = {0.001, 0, 0}, .velocity = {1, 0.1, 0}});
    scene.add_sphere(0.009, {.position = {0.4 * period, 0.008, 0.001}, .velocity = {-1, 0, 0.1}});
    scene.add_sphere(0.008, {.position = {0.7 * period, 0.02, -0.001}, .velocity = {0.5, -1, 0}});
    scene.add_wall({0, -0.012, 0}, {0, 1, 0}).add_wall({0, 0.032, 0}, {0, -1, 0});
    return scene;
}

/// The same space, twice as long, with everything in it twice.
Scene doubled(Scene scene) {
    const Real period = scene.bounds.high.x();
    const std::vector<Scene::Stone> once = scene.stones;
    for (Scene::Stone stone : once) {
        stone.state.position.x() += period;
        scene.stones.push_back(stone);
    }
    scene.bounds.high.x() = 2 * period;
    return scene;
}

template <class Law>
auto run(const Scene& scene, const Law& contact, Real end_time) {
    auto sim = simulate(scene).contact(contact);
    sim.run({.end_time = end_time, .time_step = 0x1p-16, .skin = skin});
    return sim;
}

std::string message_of(const Scene& scene) {
    try {
        run(scene, law, 0);
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing was thrown";
}

}  // namespace

TEST_CASE("the smallest period moves as the same space twice as long does, the next smaller is refused") {
    // 2 (r_a + r_b + skin), of the two largest.
    constexpr Real least = 2 * (0.01 + 0.009 + skin);
    const Scene small = tube(least);
    const Counted<LinearSpring> counted(law.params());
    const auto one = run(small, counted, 0.02);
    const auto two = run(doubled(small), law, 0.02);
    CHECK(counted.begun() > 8);
    const Particles &a = one.particles(), &b = two.particles();
    for (std::size_t n = 0; n < 3; ++n)
        for (const std::size_t twin : {n, n + 3}) {
            Vec3 apart = b.position[twin] - a.position[n];
            apart.x() -= least * std::round(apart.x() / least);
            CHECK(apart.norm() < 1e-9);
            CHECK((b.velocity[twin] - a.velocity[n]).norm() < 1e-6);
        }
    CHECK(two.ledger().lost_sliding == doctest::Approx(2 * one.ledger().lost_sliding).epsilon(1e-6).scale(0));
    CHECK(one.ledger().residual_relative() < 1e-12);

    const std::string said = message_of(tube(0.999 * least));
    CAPTURE(said);
    CHECK(said.find("Scene.bounds along the periodic axis x must be at least " + to_text(least)) == 0);
    CHECK(said.find("got " + to_text(0.999 * least) + " m; widen the bounds") != std::string::npos);
}

TEST_CASE("a body alone must not reach its own image") {
    const Clump rod = make_clump("rod", {{{-0.03, 0, 0}, 0.01}, {{0, 0, 0}, 0.01}, {{0.03, 0, 0}, 0.01}},
                                 ClumpParts::apart);
    const auto with = [&](Real period) {
        Scene scene;
        scene.periodic_along = {true, false, false};
        scene.bounds = {{0, -1, -1}, {period, 1, 1}};
        scene.add_stone(rod, {.position = {0.01, 0, 0}});
        return message_of(scene);
    };
    const Real least = 2 * rod.bounding_radius + skin;
    CHECK(with(least + 1e-12) == "nothing was thrown");
    CHECK(with(0.999 * least).find("Scene.bounds along the periodic axis x") == 0);
}

TEST_CASE("stones that a feed will bring count too") {
    Scene scene;
    scene.periodic_along = {false, true, false};
    scene.bounds = {{-1, 0, -1}, {1, 0.1, 2}};
    scene.feed = FeedParams{.volume_rate = 1e-3,
                            .classes = {{0.05, 1.0, StoneShape::sphere}},
                            .region = {{0, 0, 0}, {0.1, 0.1, 1}}};
    CHECK(message_of(scene).find("Scene.bounds along the periodic axis y must be at least 0.104 m") == 0);
    scene.bounds.high.y() = 0.104 + 1e-12;
    CHECK(message_of(scene) == "nothing was thrown");
}

TEST_CASE("at the smallest period near pairs are those that all images give, one image each") {
    Random random(31);
    for (int n = 0; n < 200; ++n) {
        std::vector<Vec3> centre;
        std::vector<Real> radius;
        std::vector<Index> body;
        for (Index b = 0; b < 12; ++b) {
            radius.push_back(random.uniform(0.006, 0.01)), body.push_back(b);
            centre.push_back(0.02 * random.in_cube());
        }
        std::vector<Real> sorted = radius;
        std::sort(sorted.rbegin(), sorted.rend());
        const Real period = 2 * (sorted[0] + sorted[1] + skin);
        for (Vec3& x : centre) x.x() -= period * std::floor(x.x() / period);
        const std::vector<SearchRole> role(12, SearchRole::all);
        auto pairs = verlet_pairs({centre, radius, body, role, skin, {period, 0, 0}});
        std::sort(pairs.begin(), pairs.end());
        std::vector<VerletPair> expected;
        for (Index i = 0; i < 12; ++i)
            for (Index j = i + 1; j < 12; ++j) {
                int images = 0;
                for (std::int8_t k = -3; k <= 3; ++k) {
                    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
                    const Vec3 apart = centre[a] - centre[b] - Vec3(k * period, 0, 0);
                    if (!(apart.norm() < radius[a] + radius[b] + skin)) continue;
                    expected.push_back({i, j, {k, 0, 0}});
                    ++images;
                }
                REQUIRE(images <= 1);
            }
        std::sort(expected.begin(), expected.end());
        REQUIRE(pairs == expected);
    }
}

TEST_CASE("bodies too fast for the skin that the period has room for stop the run") {
    Scene scene = tube(0.0421);
    scene.stones[0].state.velocity = {0, 30, 0};  // 0.5 mm a step; the skin has room for 2 mm
    scene.walls.clear();
    auto sim = simulate(scene).contact(law);
    try {
        sim.run({.end_time = 0.01, .time_step = 0x1p-16, .skin = skin});
        FAIL("not noticed");
    } catch (const RunError& error) {
        CHECK(error.id == 0);
        CHECK(std::string(error.what()).find("than the periodic axes have room for") != std::string::npos);
    }
}

TEST_CASE("a stone that starts whole periods away starts in the period that is meant") {
    Scene near = tube(0.125), far = tube(0.125);
    near.gravity = far.gravity = {1, -2, 0};  // its potential energy must not count the periods
    far.stones[0].state.position.x() += 3 * 0.125, far.stones[2].state.position.x() -= 0.125;
    const auto one = run(near, law, 0.02), other = run(far, law, 0.02);
    for (std::size_t n = 0; n < 3; ++n) {
        CHECK((one.particles().position[n] - other.particles().position[n]).norm() < 1e-12);
        CHECK((one.particles().velocity[n] - other.particles().velocity[n]).norm() < 1e-9);
    }
    CHECK(other.ledger().potential_start ==
          doctest::Approx(one.ledger().potential_start).epsilon(1e-12).scale(0));
    CHECK(other.ledger().residual_relative() < 1e-12);
}

TEST_CASE("what is fed, and concrete, must lie within the period") {
    Scene scene = tube(0.125);
    scene.feed = FeedParams{.volume_rate = 1e-3,
                            .classes = {{0.005, 1, StoneShape::sphere}},
                            .region = {{0.1, -0.01, 0}, {0.2, 0.03, 0.05}}};
    CHECK(message_of(scene) ==
          "Feed.region.x must be inside Scene.bounds, from 0 to 0.125, along a periodic axis, got 0.2 m; "
          "move it or widen the bounds");
    scene = tube(0.125);
    scene.concrete = ConcreteBlock{flat_lattice(0.5, 0.02, {.layers = 1})};
    const std::string said = message_of(scene);
    CHECK(said.find("Scene.concrete.lattice.sites[") == 0);
    CHECK(said.find("].centre.x must be inside Scene.bounds, from 0 to 0.125, along a periodic axis") !=
          std::string::npos);
}
