// A law for each pair of materials.
#include <abrade/dem/laws/material_pairs.hpp>
#include <abrade/dem/laws/rolling_resistance.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include "../message_of.hpp"

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

using Table = MaterialPairs<LinearSpring>;

static_assert(ContactPolicy<Table> && ContactPolicy<LinearSpring>);
static_assert(!ContactLaw<Table>);  // alone it answers no contact
static_assert(!ContactPolicy<MaterialPairs<LinearSpring>::Params>);
static_assert(ContactPolicy<MaterialPairs<RollingResistance<LinearSpring>>>);
static_assert(std::same_as<PairLaw<Table>, LinearSpring> &&
              std::same_as<PairLaw<LinearSpring>, LinearSpring>);

namespace {

LinearSpring::Params bounces(Real restitution) {
    return {.stiffness = 1e6, .restitution = restitution, .friction = 0.5};
}
Table three() {
    return Table{{.materials = {"stone", "steel", "rubber"},
                  .pairs = {{"stone", "stone", bounces(0.6)},
                            {"stone", "steel", bounces(0.7)},
                            {"steel", "steel", bounces(0.9)},
                            {"rubber", "stone", bounces(0.5)},
                            {"steel", "rubber", bounces(0.4)},
                            {"rubber", "rubber", bounces(0.3)}}}};
}
/// A crowd that falls into a corner; `material` says what each is made of.
template <class Material>
Scene crowd(Material&& material) {
    Scene scene;
    scene.add_wall({0, 0, 0}, {0, 0, 1}, material(60));
    scene.add_wall({-0.011, 0, 0}, {1, 0, 0}, material(61));
    for (int n = 0; n < 60; ++n) {
        const BodyState state{
            .position = {0.025 * (n % 4), 0.023 * (n / 4 % 4) + 0.001 * (n % 3), 0.0105 + 0.021 * (n / 16)},
            .velocity = {-0.2, 0.05 * (n % 5), -0.3},
            .material = material(n)};
        if (n % 4)
            scene.add_sphere(0.01, state);
        else
            scene.add_stone(make_clump("twin", {{{-0.004, 0, 0}, 0.007}, {{0.004, 0, 0}, 0.008}}), state);
    }
    return scene;
}

}  // namespace

TEST_CASE("each pair of materials bounces with its own restitution, in either order; so do walls") {
    const Table table = three();
    Scene scene;
    scene.gravity.setZero();
    std::vector<Real> expected;
    for (Index a = 0; a < 3; ++a)
        for (Index b = 0; b < 3; ++b) {
            const Real y = 0.1 * static_cast<Real>(expected.size());
            scene.add_sphere(0.01, {.position = {0, y, 1}, .velocity = {1, 0, 0}, .material = a});
            scene.add_sphere(0.01, {.position = {0.0202, y, 1}, .velocity = {-1, 0, 0}, .material = b});
            expected.push_back(table.between(MaterialPair::of(a, b)).params().restitution);
        }
    for (Index a = 0; a < 3; ++a)
        scene.add_sphere(0.01, {.position = {1, 0.1 * a, 0.0102}, .velocity = {0, 0, -1}, .material = a});
    scene.add_wall({0, 0, 0}, {0, 0, 1}, table.number("rubber"));
    auto sim = simulate(scene).contact(table);
    sim.run({.end_time = 0.005, .safety = 0.05});
    const Particles& p = sim.particles();
    for (std::size_t n = 0; n < expected.size(); ++n)
        CHECK((p.velocity[2 * n + 1] - p.velocity[2 * n]).x() / 2 ==
              doctest::Approx(expected[n]).epsilon(0.005).scale(0));
    CHECK(p.velocity[18].z() == doctest::Approx(0.5).epsilon(0.005).scale(0));
    CHECK(p.velocity[19].z() == doctest::Approx(0.4).epsilon(0.005).scale(0));
    CHECK(p.velocity[20].z() == doctest::Approx(0.3).epsilon(0.005).scale(0));
    CHECK(sim.ledger().residual_relative() < 1e-12);
}

TEST_CASE("a table of one material gives the bits of its law alone") {
    const auto run = [](auto law) {
        Scene scene = crowd([](int) { return 0; });
        scene.concrete =
            ConcreteBlock{.lattice = flat_lattice(0.1, 0.1, {.sphere_diameter = 0.02, .layers = 1})};
        for (LatticeSite& site : scene.concrete->lattice.sites) site.centre.z() -= 0.02;
        for (Scene::Stone& stone : scene.stones) stone.state.position.z() += 0.02;
        scene.walls[0].point.z() -= 0.1;
        auto sim = simulate(scene).contact(law).wear(SubParticleAbrasion{{.acceleration = 1e4}});
        sim.run({.end_time = 0.2, .safety = 0.3});
        return sim;
    };
    const auto plain = run(LinearSpring{bounces(0.6)});
    const auto table = run(Table{{.materials = {"stone"}, .pairs = {{"stone", "stone", bounces(0.6)}}}});
    CHECK(plain.steps() == table.steps());
    CHECK(plain.ledger().lost_sliding > 0);
    CHECK(plain.ledger().lost_normal == table.ledger().lost_normal);
    CHECK(plain.ledger().lost_sliding == table.ledger().lost_sliding);
    CHECK(plain.concrete().worn_volume() > 0);
    CHECK(plain.concrete().worn_volume() == table.concrete().worn_volume());
    for (std::size_t b = 0; b < plain.particles().position.size(); ++b) {
        REQUIRE(plain.particles().position[b] == table.particles().position[b]);
        REQUIRE(plain.particles().angular_momentum[b] == table.particles().angular_momentum[b]);
    }
}

TEST_CASE("materials of one law move as one material does, over many renewals of the lists") {
    // Only the order of sums differs. Were a contact's memory lost or mixed up, sticking springs would jump.
    std::mt19937 random(4);
    std::vector<Index> made_of;
    for (int n = 0; n < 62; ++n) made_of.push_back(static_cast<Index>(random() % 3));
    Table::Params same = three().params();
    for (auto& pair : same.pairs) pair.law = bounces(0.6);
    auto plain = simulate(crowd([](int) { return 0; })).contact(LinearSpring{bounces(0.6)});
    auto mixed =
        simulate(crowd([&](int n) { return made_of[static_cast<std::size_t>(n)]; })).contact(Table{same});
    const RunOptions options{.end_time = 0.05, .safety = 0.3, .skin = 2e-4};
    plain.run(options), mixed.run(options);
    CHECK(plain.ledger().lost_sliding > 0);
    Real furthest = 0;
    for (std::size_t b = 0; b < 60; ++b)
        furthest = std::max(furthest, (plain.particles().position[b] - mixed.particles().position[b]).norm());
    CHECK(furthest < 1e-9);
    CHECK(mixed.ledger().lost_sliding == doctest::Approx(plain.ledger().lost_sliding).epsilon(1e-6).scale(0));
    CHECK(mixed.ledger().residual_relative() < 1e-12);
}

TEST_CASE("an observer sees each contact under its own law") {
    Scene scene;
    scene.gravity.setZero();
    Table::Params params = three().params();
    params.pairs[3].law.stiffness = 2e6;  // rubber on stone
    for (Index a = 0; a < 3; ++a) scene.add_sphere(0.01, {.position = {0.1 * a, 0, 0.0099}, .material = a});
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    auto sim = simulate(scene).contact(Table{params});
    sim.run({.end_time = 0});
    std::vector<Real> force(3, 0);
    sim.world().each_contact([&](Index first, Index, const auto&, const auto& load) {
        force[static_cast<std::size_t>(first)] = load.force.z();
    });
    CHECK(force[0] == doctest::Approx(100));
    CHECK(force[1] == doctest::Approx(100));
    CHECK(force[2] == doctest::Approx(200));
}

TEST_CASE("the step suits the stiffest pair") {
    Table::Params params = three().params();
    const Real soft = Table{params}.stable_dt(0.1, 0.01);
    params.pairs[2].law.stiffness = 16e6;
    CHECK(Table{params}.stable_dt(0.1, 0.01) == LinearSpring{params.pairs[2].law}.stable_dt(0.1, 0.01));
    CHECK(Table{params}.stable_dt(0.1, 0.01) < soft);
    CHECK(Table{params}.rigidity(0.01).normal == 16e6);
}

TEST_CASE(
    "what misses a law is refused before the first step, by both names; what cannot meet may be missed") {
    Table::Params params = three().params();
    params.pairs.erase(params.pairs.begin() + 4);  // steel with rubber
    const auto run = [&](Index first, Index second, Index wall) {
        Scene scene;
        scene.add_sphere(0.01, {.position = {0, 0, 0.02}, .material = first});
        scene.add_sphere(0.01, {.position = {0.1, 0, 0.02}, .material = second});
        scene.add_wall({0, 0, 0}, {0, 0, 1}, wall);
        simulate(scene).contact(Table{params}).run({.end_time = 0});
    };
    const std::string missing =
        "MaterialPairs.pairs must be complete for what can meet in the scene, got none for "
        "steel with rubber; add a law for these two";
    CHECK(message_of([&] { run(1, 2, 0); }) == missing);
    CHECK(message_of([&] { run(2, 2, 1); }) == missing);
    CHECK(message_of([&] { run(0, 2, 2); }) == "nothing was thrown");
    // Rubber alone does not meet itself.
    params.pairs.pop_back();
    CHECK(message_of([&] { run(0, 2, 0); }) == "nothing was thrown");
    CHECK(message_of([&] { run(2, 2, 0); }).find("none for rubber with rubber") != std::string::npos);
    CHECK(message_of([&] { run(0, 3, 0); }) ==
          "BodyState.material must be the number of a material, below 3, got 3; MaterialPairs::number(name) "
          "gives it");
    CHECK(message_of([&] { run(0, 0, -1); }).starts_with("Plane.material must be the number of a material"));

    Scene fed;
    fed.concrete = ConcreteBlock{.lattice = flat_lattice(0.1, 0.1, {.sphere_diameter = 0.02, .layers = 1}),
                                 .material = 1};
    fed.feed = FeedParams{.volume_rate = 1e-5,
                          .classes = {{.size = 0.02, .fraction = 1, .material = 2}},
                          .region = {{0, 0, 0.02}, {0.1, 0.1, 0.1}}};
    CHECK(message_of([&] { simulate(fed).contact(Table{three().params()}).run({.end_time = 0}); }) ==
          "nothing was thrown");
    CHECK(message_of([&] {
              simulate(fed).contact(Table{params}).run({.end_time = 0});
          }).find("got none for") != std::string::npos);
}

TEST_CASE("stones fed are of their class's material") {
    Scene scene;
    scene.add_wall({0, 0, 0}, {0, 0, 1}, 1);
    scene.feed = FeedParams{.volume_rate = 1e-4,
                            .classes = {{.size = 0.02, .fraction = 1, .material = 2}},
                            .region = {{0, 0, 0.02}, {0.2, 0.2, 0.1}}};
    auto sim = simulate(scene).contact(three());
    sim.run({.end_time = 0.3, .safety = 0.3});
    REQUIRE(sim.particles().bodies() > 3);
    for (const Index material : sim.particles().material) CHECK(material == 2);
}

TEST_CASE("a table that makes no sense is refused") {
    const auto of = [](std::vector<std::string> materials, std::vector<Table::Pair> pairs) {
        return message_of([&] { Table{{.materials = materials, .pairs = pairs}}; });
    };
    CHECK(of({}, {}) ==
          "MaterialPairs.materials must be at least one name, got 0; name what bodies are made of, such as "
          "stone");
    CHECK(of({"a", "a"}, {}) ==
          "MaterialPairs.materials must be different names, got a twice; rename or remove one");
    CHECK(of({"a", "b"}, {{"a", "c", bounces(1)}}) ==
          "MaterialPairs: a material must be one of a, b, got c; mend its spelling or add it to "
          "MaterialPairs.materials");
    CHECK(of({"a", "b"}, {{"a", "b", bounces(1)}, {"b", "a", bounces(0.5)}}) ==
          "MaterialPairs.pairs must be one law for each two materials, got two for b with a; remove one: "
          "their order does not matter");
    CHECK(of({"a", "b"}, {{"a", "b", bounces(2)}}) ==
          "MaterialPairs, a with b: LinearSpring.restitution must be in (0, 1], got 2; 1 loses nothing, 0.5 "
          "three quarters of the energy");
    CHECK_THROWS_AS(three().number("wood"), InputError);
    CHECK(describe(Table{{.materials = {"a"}, .pairs = {{"a", "a", {.stiffness = 1e6}}}}}) ==
          "MaterialPairs(a-a.stiffness = 1e+06 N/m, a-a.restitution = 1, a-a.friction = 0, "
          "a-a.tangential_ratio = 0.2857142857142857, a-a.damping_mass_free = 0)");
}
