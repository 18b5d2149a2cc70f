// The same bits from run to run and for every number of threads; a clump of one sphere is a sphere.
#include "../verification/ledger_scenes.hpp"

#include <abrade/wear/sub_particle.hpp>

#include <doctest/doctest.h>

#include <cstring>

using namespace ledger_scenes;

namespace {

/// All that moves, the ledger and the wear.
template <class Simulation>
std::vector<Real> state(const Simulation& sim) {
    std::vector<Real> all;
    const Particles& p = sim.particles();
    for (std::size_t b = 0; b < p.position.size(); ++b) {
        for (const Vec3* v : {&p.position[b], &p.velocity[b], &p.angular_momentum[b], &p.force[b]})
            all.insert(all.end(), v->data(), v->data() + 3);
        if (p.sphere_count[b] == 1) continue;  // a sphere has no orientation
        const auto& turned = p.orientation[b].coeffs();
        all.insert(all.end(), turned.data(), turned.data() + 4);
    }
    sim.ledger().visit([&](std::string_view, Real value) { all.push_back(value); });
    for (Index s = 0; s < sim.concrete().sites(); ++s) all.push_back(sim.concrete().fracture(s));
    return all;
}
bool same_bits(const std::vector<Real>& a, const std::vector<Real>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Real)) == 0;
}

/// `run()` gives a state; once with one thread, then again, then with two and with three.
template <class Run>
void check_threads(const Run& run) {
    const int before = thread_count();
    const auto with = [&](int threads) {
        set_thread_count(threads);
        return run();
    };
    const auto one = with(1);
    CHECK(same_bits(one, with(1)));
    CHECK(same_bits(one, with(2)));
    CHECK(same_bits(one, with(3)));
    set_thread_count(before);
}

template <class Law>
auto run_of(const Scene& scene, const Law& law, Real end_time) {
    return [=] {
        auto sim = simulate(scene).contact(law);
        sim.run({.end_time = end_time});
        CHECK(sim.world().state().store.slabs.chunks() > 1);  // threads have something to share
        CHECK(sim.ledger().lost_sliding > 0.01 * sim.ledger().throughput());
        return state(sim);
    };
}

const LinearSpring linear{{.stiffness = 5e5, .restitution = 0.8, .friction = 0.3}};
const HertzMindlin hertz{{.youngs = 5e8, .restitution = 0.8, .friction = 0.3}};

}  // namespace

TEST_CASE("a gas in periodic space") {
    check_threads(run_of(gas(11), linear, 0.05));
    check_threads(run_of(gas(11), hertz, 0.05));
}

TEST_CASE("a bed of clumps between walls, and clumps that fall through periodic space onto a floor") {
    Scene scene = bed(4, 10);
    check_threads(run_of(scene, linear, 0.1));
    scene.walls.resize(1);
    scene.periodic_along = {true, true, false};
    scene.bounds = {{0, 0, -1}, {0.256, 0.256, 2}};
    check_threads(run_of(scene, linear, 0.1));
}

TEST_CASE("clumps that wear a floor of concrete") {
    Scene scene = bed(4, 3);
    scene.walls.clear();
    scene.concrete = ConcreteBlock{flat_lattice(0.6, 0.4, {.sphere_diameter = 0.02, .layers = 2})};
    for (Scene::Stone& stone : scene.stones) stone.state.position -= Vec3(0.128, 0.128, 0);
    check_threads([&] {
        auto sim = simulate(scene).contact(linear).wear(SubParticleAbrasion{{.acceleration = 1e3}});
        sim.run({.end_time = 0.1});
        CHECK(sim.world().state().store.slabs.chunks() > 1);
        CHECK(sim.concrete().worn_volume() > 0);
        return state(sim);
    });
}

TEST_CASE("a clump of one sphere behaves bit for bit like a sphere") {
    // Wherever the sphere stands in the clump's own frame, and however the clump is turned.
    Scene spheres = gas(6);
    spheres.gravity = {0.3, 0.1, -9.81};
    Scene clumps = spheres;
    Random random(3);
    for (Scene::Stone& stone : clumps.stones) {
        stone.clump = make_clump("one", {{random.in_cube(), stone.clump.members[0].radius}});
        stone.state.orientation = random.turned();
    }
    const auto run = [](const Scene& scene) {
        auto sim = simulate(scene).contact(hertz);
        sim.run({.end_time = 0.05});
        CHECK(sim.ledger().lost_sliding > 0.01 * sim.ledger().throughput());
        return state(sim);
    };
    CHECK(same_bits(run(spheres), run(clumps)));
}
