// What cannot be run is refused before the first step, with field, rule, value and remedy.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/sim/simulation.hpp>

#include "../message_of.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace abrade;

namespace {

constexpr Real nan_ = std::numeric_limits<Real>::quiet_NaN();
const std::string look = "; look for a division by 0 or an uninitialised number where it is set";
const LinearSpring law{{.stiffness = 1e6, .restitution = 0.5}};

Scene one_stone() {
    Scene scene;
    scene.add_sphere(0.02, {});
    return scene;
}

std::string run(Scene scene, RunOptions options) {
    return message_of([&] { simulate(std::move(scene)).contact(law).run(options); });
}

bool has(const std::string& text, const std::string& what) { return text.find(what) != std::string::npos; }

}  // namespace

TEST_CASE("run options: each is checked") {
    CHECK(run(one_stone(), {.end_time = 1e-3}) == "nothing was thrown");
    CHECK(has(run(one_stone(), {.end_time = -1}),
              "RunOptions.end_time must be finite and not before now (0 s), got -1 s"));
    CHECK(has(run(one_stone(), {.end_time = nan_}), "RunOptions.end_time"));
    CHECK(has(run(one_stone(), {.end_time = std::numeric_limits<Real>::infinity()}), "RunOptions.end_time"));
    for (const Real bad : {-1.0, nan_}) {
        CHECK(has(run(one_stone(), {.end_time = 1, .time_step = bad}), "RunOptions.time_step"));
        CHECK(has(run(one_stone(), {.end_time = 1, .observe_every = bad}), "RunOptions.observe_every"));
        CHECK(has(run(one_stone(), {.end_time = 1, .skin = bad}), "RunOptions.skin"));
    }
    for (const Real bad : {0.0, -0.1, 1.1, nan_})
        CHECK(has(run(one_stone(), {.end_time = 1, .safety = bad}), "RunOptions.safety must be in (0, 1]"));
}

TEST_CASE("a time step above the stable one: the message has the stable step, what sets it and the remedy") {
    auto probe = simulate(one_stone()).contact(law);
    probe.run({.end_time = 0});
    const Real stable = probe.stable_step_now().seconds;
    const std::string said = run(one_stone(), {.end_time = 1, .time_step = 1.01 * stable});
    CHECK(has(said, "RunOptions.time_step must be at most the stable step of " + to_text(stable) +
                        " s (first touch of the lightest stone), got " + to_text(1.01 * stable) + " s"));
    CHECK(has(said, "take a smaller step"));
    CHECK(run(one_stone(), {.end_time = 10 * stable, .time_step = 0.99 * stable}) == "nothing was thrown");
}

TEST_CASE("a time that has passed cannot be run to") {
    auto sim = simulate(one_stone()).contact(law);
    sim.run({.end_time = 1e-3});
    CHECK_THROWS_AS(sim.run({.end_time = 0.5e-3}), InputError);
    CHECK(sim.time() == 1e-3);  // untouched by the error
}

TEST_CASE("stones: radius, density, position, velocity") {
    for (const Real bad : {0.0, -0.02, nan_}) {
        CHECK(has(message_of([&] { Scene().add_sphere(bad, {}); }),
                  "Scene.stones[0].radius must be finite and > 0, got " + to_text(bad) + " m"));
        Scene scene;
        CHECK(has(message_of([&] {
                      simulate(scene.add_sphere(0.02, {}, bad)).contact(law).run({.end_time = 1e-3});
                  }),
                  "Scene.stones[0].density must be finite and > 0, got " + to_text(bad) + " kg/m3"));
    }
    // Whichever stone it is, it is named, with the component.
    for (int axis = 0; axis < 3; ++axis)
        for (const Real bad : {nan_, std::numeric_limits<Real>::infinity()}) {
            const auto said = [&](auto change) {
                Scene scene = one_stone();
                scene.add_sphere(0.02, {.position = {1, 0, 0}}).add_sphere(0.02, {.position = {2, 0, 0}});
                change(scene.stones[1].state);
                return run(scene, {.end_time = 1e-3});
            };
            const std::string value = std::string(".") + "xyz"[axis] + " must be finite, got " + to_text(bad);
            CHECK(said([&](BodyState& s) { s.position[axis] = bad; }) ==
                  "Scene.stones[1].position" + value + " m" + look);
            CHECK(said([&](BodyState& s) { s.velocity[axis] = bad; }) ==
                  "Scene.stones[1].velocity" + value + " m/s" + look);
            CHECK(said([&](BodyState& s) { s.angular_velocity[axis] = bad; }) ==
                  "Scene.stones[1].angular_velocity" + value + " rad/s" + look);
            CHECK(has(said([&](BodyState& s) { s.orientation.coeffs()[axis] = bad; }),
                      "Scene.stones[1].orientation must be of length 1, got "));
        }
    Scene outside = one_stone();
    outside.bounds = {{-1, -1, -1}, {1, 1, 1}};
    outside.add_sphere(0.02, {.position = {0, 3, 0}});
    CHECK(run(outside, {.end_time = 1e-3}) ==
          "Scene.stones[1].position.y must be inside Scene.bounds, from -1 to 1, got 3 m; move the stone or "
          "widen the bounds");
    // A clump is plain data: what was changed after make_clump() is looked at, too.
    for (const Real bad : {0.0, -0.01, nan_}) {
        Scene scene = one_stone();
        scene.add_stone(make_stone(StoneShape::angular, 0.02), {.position = {1, 0, 0}});
        scene.stones[1].clump.members[3].radius = bad;
        CHECK(run(scene, {.end_time = 1e-3})
                  .starts_with("Scene.stones[1].clump.members[3].radius must be finite and > 0, got " +
                               to_text(bad) + " m; "));
    }
}

TEST_CASE("contact laws: stiffness, restitution, friction") {
    for (const Real bad : {0.0, -1.0, nan_, std::numeric_limits<Real>::infinity()}) {
        CHECK(has(message_of([&] { LinearSpring{{.stiffness = bad}}; }),
                  "LinearSpring.stiffness must be finite and > 0, got " + to_text(bad) + " N/m; stones on"));
        CHECK(has(message_of([&] { HertzMindlin{{.youngs = bad}}; }),
                  "HertzMindlin.youngs must be finite and > 0, got " + to_text(bad) + " Pa; 1e7 Pa is soft"));
        CHECK(has(message_of([&] { MohrCoulomb{{.tensile = 1, .stiffness = bad}}; }),
                  "MohrCoulomb.stiffness must be finite and > 0, got " + to_text(bad) + " N/m; E A / d"));
    }
    const std::string loses = "; 1 loses nothing, 0.5 three quarters of the energy";
    for (const Real bad : {0.0, -0.5, 1.01, nan_}) {
        CHECK(message_of([&] { LinearSpring{{.stiffness = 1, .restitution = bad}}; }) ==
              "LinearSpring.restitution must be in (0, 1], got " + to_text(bad) + loses);
        CHECK(message_of([&] { HertzMindlin{{.youngs = 1e9, .restitution = bad}}; }) ==
              "HertzMindlin.restitution must be in (0, 1], got " + to_text(bad) + loses);
    }
    for (const Real bad : {-0.1, nan_}) {
        CHECK(has(message_of([&] { LinearSpring{{.stiffness = 1, .friction = bad}}; }),
                  "LinearSpring.friction must be finite and >= 0"));
        CHECK(has(message_of([&] { HertzMindlin{{.youngs = 1e7, .friction = bad}}; }),
                  "HertzMindlin.friction must be finite and >= 0"));
    }
}

TEST_CASE("walls, gravity, concrete") {
    CHECK_THROWS_AS(Scene().add_wall({0, 0, 0}, {0, 0, 0}), InputError);
    CHECK_THROWS_AS(Scene().add_wall({0, 0, 0}, {0, 0, nan_}), InputError);
    CHECK(has(message_of([&] {
                  Scene().add_wall({0, 0, 0}, {0, 0, 1}).add_wall({0, 0, 0}, {0, nan_, 1});
              }),
              "Scene.walls[1].normal must be finite"));
    Scene scene = one_stone();
    scene.add_wall({0, 0, -1}, {0, 0, 1}).add_wall({0, nan_, 1}, {0, 0, -1});
    CHECK(run(scene, {.end_time = 1e-3}) == "Scene.walls[1].point.y must be finite, got nan m" + look);
    scene = one_stone();
    scene.gravity.x() = nan_;
    CHECK(has(run(scene, {.end_time = 1e-3}), "Scene.gravity.x must be finite, got nan m/s2"));
    scene = one_stone();
    scene.concrete = ConcreteBlock{flat_lattice(0.1, 0.1, {}), -1};
    CHECK(has(run(scene, {.end_time = 1e-3}), "Scene.concrete.density"));
    scene.concrete = ConcreteBlock{};
    CHECK(has(run(scene, {.end_time = 1e-3}), "Scene.concrete.lattice must be of at least one sphere"));
}

TEST_CASE("concrete that is put together by hand: sites, cells, columns, bonds") {
    const auto said = [](auto change) {
        Scene scene = one_stone();
        scene.stones[0].state.position.z() = 1;
        scene.concrete = ConcreteBlock{flat_lattice(0.06, 0.06, {.layers = 2})};
        change(scene.concrete->lattice);
        return message_of([&] {
            simulate(scene)
                .contact(law)
                .bond(MohrCoulomb{{.tensile = 2.7e6, .stiffness = 4e6}})
                .run({.end_time = 1e-4});
        });
    };
    const std::string lattice = "Scene.concrete.lattice.";
    CHECK(said([](Lattice&) {}) == "nothing was thrown");
    for (const Real bad : {0.0, -1e-6, nan_}) {
        const std::string got = " must be finite and > 0, got " + to_text(bad);
        CHECK(said([&](Lattice& l) { l.sites[3].cell_volume = bad; }) ==
              lattice + "sites[3].cell_volume" + got +
                  " m3; give it the volume of concrete that the sphere stands for");
        CHECK(said([&](Lattice& l) { l.column_area[2] = bad; }) ==
              lattice + "column_area[2]" + got +
                  " m2; give it the area of the body's surface above the column");
        CHECK(said([&](Lattice& l) { l.radius = bad; }).starts_with(lattice + "radius" + got + " m; "));
    }
    CHECK(said([](Lattice& l) { l.sites[5].centre.y() = nan_; }) ==
          lattice + "sites[5].centre.y must be finite, got nan m" + look);
    CHECK(said([](Lattice& l) { l.sites[4].column = 9; }) ==
          lattice +
              "sites[4].column must be below the number of columns, 9, got 9; give each column its area");
    CHECK(said([](Lattice& l) { l.sites[7].centre = l.sites[2].centre; }) ==
          lattice + "sites[2] and [7]: distance must be > 0, got 0 m; take one of them out");
    // Sites 0 and 17 stand at opposite corners, 0.06 m apart.
    CHECK(said([](Lattice& l) {
              l.bonds[4] = {0, 17};
          }) == lattice +
                    "bonds[4]: length, of 0 and 17 must be below two diameters (0.04 m), got 0.06 m; bond "
                    "neighbours only: between these two another sphere has room");
    CHECK(said([](Lattice& l) { l.bonds.push_back(l.bonds[4]); }) ==
          lattice + "bonds[33] must be another pair than " + lattice +
              "bonds[4], got 1 and 7; leave one of "
              "them out");
    for (const auto& bad : {std::pair<Index, Index>{3, 3}, {5, 3}, {-1, 3}, {3, 18}})
        CHECK(said([&](Lattice& l) { l.bonds[4] = bad; }) ==
              lattice + "bonds[4] must be a pair of two sites below 18, the smaller first, got " +
                  std::to_string(bad.first) + " and " + std::to_string(bad.second) +
                  "; make it by flat_lattice() or lattice_of()");
}

TEST_CASE("no bond of a lattice that the library makes is too long: flat, invert, hexagonal, with a gap") {
    // Stretched as far as they can be: two spheres where nearly three would fit.
    for (const Lattice& lattice :
         {flat_lattice(0.0599, 0.0599, {.layers = 2}), hexagonal_lattice(0.0599, 0.0599, {.layers = 3}),
          invert_lattice({.length = 0.0599, .width = 0.3, .arc_radius = 0.15}, {.layers = 4}),
          lattice_of({{0, 0, 0}, {0.036, 0, 0}}, 0.01, 1e-5, 0.9)}) {
        CHECK(!lattice.bonds.empty());
        CHECK_NOTHROW(lattice.validate());
    }
}

TEST_CASE("the feed") {
    const FeedParams good{.volume_rate = 1e-3,
                          .classes = {{0.04, 0.5, StoneShape::sphere}, {0.05, 0.5, StoneShape::angular}},
                          .region = {{0, 0, 0}, {1, 1, 1}}};
    const auto said = [&](auto change) {
        Scene scene;
        scene.feed = good;
        change(*scene.feed);
        return run(scene, {.end_time = 1e-3});
    };
    CHECK(said([](FeedParams&) {}) == "nothing was thrown");
    for (const Real bad : {0.0, -1.0, nan_}) {
        CHECK(has(said([&](FeedParams& f) { f.volume_rate = bad; }), "Feed.volume_rate"));
        CHECK(has(said([&](FeedParams& f) { f.density = bad; }), "Feed.density"));
        CHECK(has(said([&](FeedParams& f) { f.classes[0].size = bad; }),
                  "Feed.classes[0].size must be finite and > 0"));
    }
    CHECK(has(said([](FeedParams& f) { f.classes[1].fraction = 0.4; }),
              "Feed.classes.fraction (sum) must be 1, got 0.9; let the fractions add up to 1"));
    CHECK(has(said([](FeedParams& f) { f.classes[1].fraction = nan_; }), "Feed.classes[1].fraction"));
    CHECK(has(said([](FeedParams& f) { f.classes[0].fraction = 1.5, f.classes[1].fraction = -0.5; }),
              "Feed.classes[1].fraction must be finite and >= 0, got -0.5; check its sign"));
    CHECK(has(said([](FeedParams& f) { f.classes.clear(); }), "at least one stone class"));
    CHECK(has(said([](FeedParams& f) { f.region = {}; }), "Feed.region along x must be finite"));
    CHECK(has(said([](FeedParams& f) { f.region.high.x() = -1; }),
              "Feed.region along x must be finite and low < high, high - low, got -1 m; give both corners"));
    CHECK(
        has(said([](FeedParams& f) { f.classes[1].size = 2; }), "Feed.classes[1].size of 2 m: the stone's"));
    CHECK(has(said([](FeedParams& f) { f.velocity.y() = nan_; }),
              "Feed.velocity.y must be finite, got nan m/s"));
    CHECK(has(said([](FeedParams& f) { f.start = nan_; }), "Feed.start"));
    CHECK(has(said([](FeedParams& f) { f.region.high.z() = nan_; }), "Feed.region along z"));
}

Scene one_that_stands() {
    Scene scene;
    scene.add_fixed(make_clump("ball", {{Vec3::Zero(), 0.01}}), Vec3::Zero());
    return scene;
}

TEST_CASE("a scene in which nothing can move runs, and nothing happens; an empty one is named") {
    auto sim = simulate(one_that_stands()).contact(law);
    CHECK_NOTHROW(sim.run({.end_time = 1}));
    CHECK(sim.time() == 1);
    CHECK(sim.ledger().kinetic == 0);
    CHECK(run(Scene{}, {.end_time = 1}) ==
          "Scene.stones must be at least one, or concrete or a feed, got none; add_sphere() and add_stone() "
          "add "
          "bodies");
}

TEST_CASE("what has no meaning is named, with a remedy") {
    CHECK(run(one_stone(), {}) ==
          "RunOptions.end_time must be given, got none; run({.end_time = 1}) goes on to 1 s from the start");
    Scene scene = one_stone();
    scene.stones[0].fixed = true, scene.stones[0].state.velocity = {1, 0, 0};
    CHECK(run(scene, {.end_time = 1}) ==
          "Scene.stones[0].velocity must be 0, for it is fixed, got 1 m/s; leave it out, or let the stone "
          "move");
    scene = one_stone();
    scene.stones[0].state.material = 3;
    CHECK(run(scene, {.end_time = 1}) ==
          "Scene.stones[0].material must be 0 where one law serves all contacts, got 3; hand contact() a "
          "MaterialPairs table, whose number(name) gives it");
    CHECK(
        message_of([] { HertzMindlin{{.youngs = 70}}; }) ==
        "HertzMindlin.youngs must be at least 1000 Pa, got 70 Pa; granite has 7e10 Pa: was it meant in GPa?");
    CHECK(message_of([] {
              make_clump("two", {{{0, 0, 0}, 0.01}, {{0.03, 0, 0}, 0.01}});
          }) ==
          "Clump 'two'.members[1]: gap to those before it must be 0, so that they touch or overlap, got 0.01 "
          "m; "
          "move it nearer; ClumpParts::apart is for bodies of several pieces");
}

TEST_CASE("stones that overlap too far at the start are refused, both named") {
    Scene scene = one_stone();
    scene.add_sphere(0.01, {.position = {0.027, 0, 0}});  // 0.03 would touch
    auto sim = simulate(scene).contact(law);
    const std::string text = message_of([&] { sim.run({.end_time = 0.1}); });
    CAPTURE(text);
    CHECK(has(text, "stone with id 0"));
    CHECK(has(text, "stone with id 1"));
    CHECK(has(text, "got 29.99"));
    CHECK(has(text, "move them apart"));
    Scene sunk = one_stone();
    sunk.add_wall({-1, 0, 0}, {1, 0, 0}).add_wall({0, 0, -0.01}, {0, 0, 1});
    CHECK(has(run(sunk, {.end_time = 0.1}),
              "overlap of stone with id 0 with Scene.walls[1] must be at most 20 % of the smaller radius, "
              "got 50 %"));
}

TEST_CASE("a simulation that refused its input runs once the input is mended") {
    Scene scene = one_stone();
    scene.concrete = ConcreteBlock{flat_lattice(0.06, 0.06, {.layers = 2})};
    scene.stones[0].state.position.z() = 0.03;
    auto sim = simulate(scene).contact(law);
    CHECK(has(message_of([&] { sim.run({.end_time = 0.01, .time_step = 1}); }), "time_step"));
    sim.run({.end_time = 0.01});
    CHECK(sim.particles().bodies() == 1 + sim.concrete().sites());

    scene.stones[0].density = -1;
    auto refused = simulate(scene).contact(law);
    for (int again = 0; again < 2; ++again)
        CHECK(has(message_of([&] { refused.run({.end_time = 0.01}); }), "density"));
}

TEST_CASE("a clump of nothing is refused") {
    Scene scene;
    scene.add_stone(Clump{}, {});
    CHECK(has(run(scene, {.end_time = 0.1}), "make_clump"));
}

TEST_CASE("a step too small to count its steps is refused") {
    const std::string said = run(one_stone(), {.end_time = 1, .time_step = 1e-30});
    CHECK(has(said, "steps must be fewer than"));
    CHECK(has(said, "set by contacts of the lightest stone, stone with id 0"));
}

TEST_CASE("slots are filled before the first run") {
    auto sim = simulate(one_stone()).contact(law);
    sim.run({.end_time = 1e-3});
    CHECK_THROWS_AS(std::move(sim).wear(NoWear{}), std::logic_error);
}

TEST_CASE("bounds, outlet and gauge are checked") {
    Scene scene = one_stone();
    scene.outlet = nan_;
    CHECK(has(run(scene, {.end_time = 1e-3}), "Scene.outlet must be finite"));
    scene.outlet.reset();
    scene.flow_counter = nan_;
    CHECK(has(run(scene, {.end_time = 1e-3}), "Scene.flow_counter must be finite"));
    scene = one_stone();
    scene.stones.clear();
    scene.bounds = {{1, 1, 1}, {-1, -1, -1}};
    CHECK(has(run(scene, {.end_time = 1e-3}), "Scene.bounds along x must be low < high"));
}

TEST_CASE("walls lie along periodic axes; stones are within a million periods") {
    const auto with_wall = [](const Vec3& normal) {
        Scene scene = one_stone();
        scene.bounds = {{-1, -1, -1}, {1, 1, 1}};
        scene.periodic_along = {true, false, false};
        scene.add_wall({0, 0, -0.5}, normal);
        return scene;
    };
    CHECK_NOTHROW(simulate(with_wall({0, 1, 1})).contact(law).run({.end_time = 1e-3}));
    CHECK(has(run(with_wall({0.1, 0, 1}), {.end_time = 1e-3}),
              "Scene.walls[0].normal.x must be 0, for space is periodic along that axis"));
    Scene scene = with_wall({0, 0, 1});
    scene.stones[0].state.position.x() = 1e5;
    CHECK_NOTHROW(simulate(scene).contact(law).run({.end_time = 1e-3}));
    scene.stones[0].state.position.x() = 1e17;
    CHECK(has(run(scene, {.end_time = 1e-3}), "Scene.stones[0].position.x must be within a million periods"));
}

TEST_CASE("masses that no arithmetic can hold are refused") {
    for (const Real density : {1e-300, 1e300}) {
        Scene scene = one_stone();
        scene.stones[0].density = density;
        CHECK(has(run(scene, {.end_time = 1e-3}), "Scene.stones[0]: mass must be from 1e-30 to 1e+30 kg"));
    }
}

TEST_CASE("nothing moves: the observer is still called at its times") {
    auto sim = simulate(one_that_stands()).contact(law);
    int calls = 0;
    sim.run({.end_time = 1, .observe_every = 0.1}, [&](const auto&) { ++calls; });
    CHECK(calls == 11);
}
