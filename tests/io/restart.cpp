// A run that was saved in its middle goes on to the same bits, with any number of threads.
#include "../verification/ledger_scenes.hpp"

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/fluid/shallow_water/shallow_water.hpp>
#include <abrade/fluid/uniform_flow.hpp>
#include <abrade/io/restart.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <doctest/doctest.h>

#include <cstring>

using namespace ledger_scenes;

namespace {

/// All that an observer sees of bodies, ledger and concrete.
template <class Sim>
void append_state(std::vector<Real>& all, const Sim& sim) {
    const Particles& p = sim.particles();
    all.insert(all.end(), {sim.time(), Real(sim.steps()), sim.sediment_passed(), Real(sim.bonds_broken()),
                           sim.last_good().time});
    for (std::size_t b = 0; b < p.position.size(); ++b) {
        all.push_back(p.id[b]);
        for (const Vec3* v :
             {&p.position[b], &p.velocity[b], &p.angular_momentum[b], &p.force[b], &p.torque[b]})
            all.insert(all.end(), v->data(), v->data() + 3);
        const auto& turned = p.orientation[b].coeffs();
        all.insert(all.end(), turned.data(), turned.data() + 4);
    }
    sim.ledger().visit([&](std::string_view, Real value) { all.push_back(value); });
    for (Index s = 0; s < sim.concrete().sites(); ++s) all.push_back(sim.concrete().fracture(s));
}
bool same_bits(const std::vector<Real>& a, const std::vector<Real>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Real)) == 0;
}

/// Runs `make()` as `options` say: whole, and with a break each time that somebody looks whether to stop.
template <class Make>
void check_restarts(const std::string& name, const Make& make, RunOptions options) {
    CAPTURE(name);
    std::vector<Real> whole;
    int looks = 0;
    options.stop = [&] { return ++looks, false; };
    auto sim = make();
    sim.run(options, [&](const auto& now) { append_state(whole, now); });
    REQUIRE(looks > 3);

    const std::string path = name + ".h5";
    for (const int threads : {1, 2, 3}) {
        const int before = thread_count();
        std::vector<Real> parts;
        bool done = false;
        for (int pieces = 0; !done; ++pieces) {
            REQUIRE(pieces < 5);
            set_thread_count(pieces % 2 ? threads : 1);
            auto piece = make();
            if (pieces > 0) {
                piece.build();
                restore_state(path, name, StatePart{"simulation", piece});
            }
            const int pause = pieces < 3 ? looks / 4 : 1 << 30;
            int seen = 0;
            RunOptions some = options;
            std::vector<Real> of_piece;
            std::size_t kept = 0;
            some.stop = [&] {
                if (++seen < pause) return false;
                save_state(path, name, StatePart{"simulation", piece});
                kept = of_piece.size();
                return true;
            };
            piece.run(some, [&](const auto& now) { append_state(of_piece, now); });
            done = !piece.stopped();
            // What was seen only because it stopped is seen by nobody.
            parts.insert(parts.end(), of_piece.begin(),
                         done ? of_piece.end() : of_piece.begin() + static_cast<std::ptrdiff_t>(kept));
        }
        set_thread_count(before);
        CAPTURE(threads);
        CHECK(parts.size() == whole.size());
        CHECK(same_bits(parts, whole));
    }
}

const LinearSpring linear{{.stiffness = 5e5, .restitution = 0.8, .friction = 0.3}};
const HertzMindlin hertz{{.youngs = 5e8, .restitution = 0.8, .friction = 0.3}};

}  // namespace

TEST_CASE("a body that was taken out before a checkpoint is gone after it") {
    const auto two = [] {
        Scene scene;
        scene.gravity = {0, 0, -9.81};
        scene.add_wall({0, 0, 0}, {0, 0, 1});
        for (const Real x : {0.0, 0.1}) scene.add_sphere(0.02, {.position = {x, 0, 0.05}});
        return simulate(scene).contact(linear);
    };
    auto sim = two();
    sim.run({.end_time = 0.05});
    sim.remove(0);
    save_state("removed.h5", "removed", StatePart{"simulation", sim});
    auto restored = two();
    restored.build();
    restore_state("removed.h5", "removed", StatePart{"simulation", restored});
    std::vector<Real> there, here;
    sim.run({.end_time = 0.2}), append_state(there, sim);
    restored.run({.end_time = 0.2}), append_state(here, restored);
    CHECK(sim.particles().bodies() == 1);
    CHECK(same_bits(there, here));
}

TEST_CASE("a gas in periodic space") {
    check_restarts("gas", [] { return simulate(gas(11)).contact(hertz); },
                   {.end_time = 0.05, .observe_every = 0.01});
}

TEST_CASE("a bed of clumps that comes to rest, some of them asleep") {
    check_restarts("bed", [] { return simulate(bed(4, 4)).contact(linear); },
                   {.end_time = 0.3, .observe_every = 0.05, .sleep_speed = 0.1, .sleep_after = 0.02});
}

TEST_CASE("stones that are fed, roll in a stream over standing concrete, wear it and leave") {
    check_restarts("stream",
                   [] {
                       Scene scene;
                       scene.gravity = {0.5, 0, -9.81};
                       scene.bounds = {{-1, -1, -1}, {3, 1, 2}};
                       scene.concrete =
                           ConcreteBlock{flat_lattice(0.6, 0.3, {.sphere_diameter = 0.02, .layers = 3})};
                       scene.concrete->level = ConcreteLevel::quasi_static;
                       scene.concrete->worn_out = WornOut::recedes;
                       scene.feed = FeedParams{.volume_rate = 2e-3,
                                               .classes = {{0.04, 0.5}, {0.05, 0.5, StoneShape::angular}},
                                               .region = {{-0.3, -0.1, 0.05}, {-0.1, 0.1, 0.15}},
                                               .velocity = {1, 0, 0}};
                       scene.outlet = 0.3, scene.flow_counter = 0.0;
                       UniformFlow flow({.section = {.width = 1, .slope = 0.05}, .discharge = 0.3});
                       return simulate(scene)
                           .contact(linear)
                           .bond(MohrCoulomb{{.tensile = 2.7e5, .stiffness = 1e6}})
                           .wear(SubParticleAbrasion{{.acceleration = 2e5}})
                           .fluid(flow);
                   },
                   {.end_time = 0.6, .observe_every = 0.1});
}

TEST_CASE("bonded concrete that moves, and breaks") {
    check_restarts("blow",
                   [] {
                       Scene scene;
                       scene.concrete =
                           ConcreteBlock{flat_lattice(0.2, 0.2, {.sphere_diameter = 0.02, .layers = 3})};
                       scene.concrete->level = ConcreteLevel::dynamic;
                       scene.stones = {{make_clump("ball", {{Vec3::Zero(), 0.04}}),
                                        2650,
                                        {.position = {0, 0, 0.06}, .velocity = {1, 0, -6}}}};
                       return simulate(scene)
                           .contact(LinearSpring{{.stiffness = 5e6, .restitution = 0.6, .friction = 0.5}})
                           .bond(MohrCoulomb{{.tensile = 3e5, .stiffness = 1e6}})
                           .wear(SubParticleAbrasion{{.acceleration = 1e4}});
                   },
                   {.end_time = 0.01, .observe_every = 0.002});
}

TEST_CASE("a stone in shallow water that has settled for a while") {
    check_restarts(
        "shallow",
        [] {
            ShallowWaterParams<2> water;
            water.low = {-1, -1}, water.high = {1, 1}, water.cells = {80, 80};
            water.surface = [](Real x, Real) { return 0.3 + 0.1 * x; };
            water.start_time = -2;
            Scene scene;
            scene.add_wall({0, 0, 0}, {0, 0, 1});
            scene.stones = {{make_clump("ball", {{Vec3::Zero(), 0.04}}), 2650, {.position = {0, 0, 0.1}}}};
            return simulate(scene).contact(linear).fluid(ShallowWater<2>(water));
        },
        {.end_time = 0.3, .observe_every = 0.05});
}
