// A checkpoint is refused by a scene or laws other than those that it was saved with, by the first thing that
// differs.
#include "../message_of.hpp"

#include <abrade/dem/laws/material_pairs.hpp>
#include <abrade/fluid/shallow_water/shallow_water.hpp>
#include <abrade/io/restart.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

const LinearSpring law{{.stiffness = 1e5, .restitution = 0.5, .friction = 0.3}};

/// Stones on a floor in a channel that is periodic along y, fed, over standing concrete.
Scene scene() {
    Scene all;
    all.bounds = {{-2, -0.5, -1}, {3, 0.5, 2}};
    all.periodic_along = {false, true, false};
    all.outlet = 2, all.flow_counter = 1;
    all.add_wall({0, 0, -0.2}, {0, 0, 1}), all.add_wall({-1, 0, 0}, {1, 0, 0});
    all.add_sphere(0.05, {.position = {0.5, 0, -0.151}}), all.add_sphere(0.04, {.position = {0.8, 0.1, 0}});
    all.concrete = ConcreteBlock{flat_lattice(0.2, 0.2, {.sphere_diameter = 0.02, .layers = 3})};
    all.concrete->level = ConcreteLevel::rigid;
    all.feed = FeedParams{.volume_rate = 1e-3,
                          .classes = {{0.04, 0.5}, {0.05, 0.5, StoneShape::angular}},
                          .region = {{-0.6, -0.1, 0.2}, {-0.4, 0.1, 0.4}},
                          .velocity = {1, 0, 0}};
    return all;
}
template <class Law = LinearSpring, class Wear = NoWear>
auto simulated(const Scene& of, const Law& contact = law, const Wear& wear = {}) {
    return simulate(of).contact(contact).wear(wear);
}

constexpr const char* path = "other_scene.h5";
const std::string about = "stones on a floor";

/// What a restart of another simulation says.
std::string answer(auto other) {
    other.build();
    return message_of([&] { restore_state(path, about, StatePart{"simulation", other}); });
}
std::string answer_to(void (*change)(Scene&)) {
    Scene other = scene();
    change(other);
    return answer(simulated(other));
}

void save() {
    auto first = simulated(scene());
    first.run({.end_time = 0.02});
    save_state(path, about, StatePart{"simulation", first});
}

}  // namespace

TEST_CASE("what stays as it is in a scene must be as it was") {
    save();
    CHECK(answer(simulated(scene())) == "nothing was thrown");
    const std::string remedy = "; build the scene and its laws as they were when it was saved";
    CHECK(answer_to([](Scene& s) { s.walls.clear(); }) ==
          "Scene.walls must be 2 as in the checkpoint, got 0" + remedy);
    CHECK(answer_to([](Scene& s) { s.walls[0].point.z() = -0.3; }) ==
          "Scene.walls[0].point.z must be -0.2 m as in the checkpoint, got -0.3 m" + remedy);

    struct Case {
        std::string says;
        void (*change)(Scene&);
    };
    const std::vector<Case> cases{
        {"Scene.walls must be 2 as in the checkpoint, got 3",
         [](Scene& s) {
             s.add_wall({9, 0, 0}, {-1, 0, 0});
         }},
        {"Scene.walls[1].normal.x must be 1",
         [](Scene& s) {
             s.walls[1].normal = {0, 0, 1};
         }},
        {"Scene.gravity.x must be 0 m/s2", [](Scene& s) { s.gravity.x() = 1; }},
        {"Scene.bounds.high.x must be 3 m", [](Scene& s) { s.bounds.high.x() = 4; }},
        {"Scene.periodic_along[1] must be 1", [](Scene& s) { s.periodic_along[1] = false; }},
        {"Scene.outlet must be 2 m as in the checkpoint, got none", [](Scene& s) { s.outlet.reset(); }},
        {"Scene.flow_counter must be 1 m as in the checkpoint, got 0.5 m",
         [](Scene& s) { s.flow_counter = 0.5; }},
        {"Scene.stones must be 2 as in the checkpoint, got 1", [](Scene& s) { s.stones.pop_back(); }},
        {"Scene.stones that are fixed must be 0", [](Scene& s) { s.stones[0].fixed = true; }},
        {"Scene.stones: mass must be", [](Scene& s) { s.stones[0].density = 2700; }},
        {"Scene.concrete must be given as in the checkpoint, got none", [](Scene& s) { s.concrete.reset(); }},
        {"Scene.concrete.level must be 2", [](Scene& s) { s.concrete->level = ConcreteLevel::dynamic; }},
        {"Scene.concrete.worn_out must be", [](Scene& s) { s.concrete->worn_out = WornOut::recorded; }},
        {"Scene.concrete.lattice.sites must be 300 as in the checkpoint, got 200",
         [](Scene& s) {
             s.concrete->lattice = flat_lattice(0.2, 0.2, {.sphere_diameter = 0.02, .layers = 2});
         }},
        {"Scene.concrete.lattice: lowest centre.x must be",
         [](Scene& s) {
             for (LatticeSite& site : s.concrete->lattice.sites) site.centre.x() += 0.01;
         }},
        {"Scene.feed must be given as in the checkpoint, got none", [](Scene& s) { s.feed.reset(); }},
        {"Feed.classes must be 2 as in the checkpoint, got 1",
         [](Scene& s) {
             s.feed->classes = {{0.04, 1}};
         }},
        {"Feed.classes[1].shape must be 2", [](Scene& s) { s.feed->classes[1].shape = StoneShape::sphere; }},
        {"Feed.velocity.x must be 1 m/s", [](Scene& s) { s.feed->velocity.x() = 2; }},
        {"Feed.seed must be 1 as in the checkpoint, got 2", [](Scene& s) { s.feed->seed = 2; }},
    };
    for (const Case& one : cases) {
        const std::string said = answer_to(one.change);
        CHECK_MESSAGE(said.starts_with(one.says), said << " does not begin with: " << one.says);
    }
}

TEST_CASE("materials must be as they were") {
    const MaterialPairs<LinearSpring> laws{{.materials = {"stone", "steel"},
                                            .pairs = {{"stone", "stone", law.params()},
                                                      {"stone", "steel", law.params()},
                                                      {"steel", "steel", law.params()}}}};
    auto first = simulated(scene(), laws);
    first.run({.end_time = 0.02});
    save_state(path, about, StatePart{"simulation", first});
    const auto said = [&](void (*change)(Scene&)) {
        Scene other = scene();
        change(other);
        return answer(simulated(other, laws));
    };
    CHECK(said([](Scene&) {}) == "nothing was thrown");
    CHECK(said([](Scene& s) { s.walls[1].material = 1; }).starts_with("Scene.walls[1].material must be 0"));
    CHECK(said([](Scene& s) {
              s.stones[0].state.material = 1;
          }).starts_with("Scene.stones of material 0 must be 2"));
}

TEST_CASE("where stones begin is asked of nobody: the checkpoint knows where they are") {
    save();
    CHECK(answer_to([](Scene& s) { s.stones[0].state.position.x() = 0.6; }) == "nothing was thrown");
}

TEST_CASE("laws must be as they were") {
    save();
    CHECK(answer(simulated(scene(), LinearSpring{{.stiffness = 2e5, .restitution = 0.5, .friction = 0.3}}))
              .starts_with("contact law must be LinearSpring(stiffness = 100000 N/m"));
    CHECK(answer(simulated(scene(), law, SubParticleAbrasion{{.acceleration = 2}}))
              .starts_with("wear law must be NoWear as in the checkpoint, got SubParticleAbrasion("));
}

TEST_CASE("shallow water of its own is read by water on as many cells") {
    const auto water = [](Index cells) {
        ShallowWaterParams<2> params;
        params.low = {0, 0}, params.high = {1, 1}, params.cells = {cells, 10};
        params.surface = [](Real, Real) { return 0.1; };
        return ShallowWater<2>(params);
    };
    save_state("water_of_20.h5", about, StatePart{"water", water(20)});
    ShallowWater<2> same = water(20), wider = water(40);
    restore_state("water_of_20.h5", about, StatePart{"water", same});
    const std::string said = message_of([&] {
        restore_state("water_of_20.h5", about, StatePart{"water", wider});
    });
    CHECK_MESSAGE(said.find("ShallowWater.cells") != std::string::npos, said);
}
