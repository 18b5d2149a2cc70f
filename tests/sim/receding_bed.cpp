// Concrete whose worn spheres sink: the surface that stones meet follows the record, between collisions.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/core/parallel.hpp>
#include <abrade/dem/laws/linear_hysteretic.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <doctest/doctest.h>

#include "../message_of.hpp"

#include <cstring>

using namespace abrade;

namespace {

constexpr Real d = 0.02, radius = 0.008;
const LinearHysteretic law{{.stiffness = 2e6, .restitution = 0.6, .friction = 0.4}};
const MohrCoulomb strong{{.tensile = 1e12, .stiffness = 4e6}};

SubParticleAbrasion abrasion(Real beta) {
    return SubParticleAbrasion{{.coefficient = 1.1e-7, .acceleration = beta}};
}
std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// A stone smaller than a sphere falls straight on the middle one of 5 x 5 in three layers.
Scene on_the_middle(WornOut worn_out) {
    Scene scene;
    scene.concrete = ConcreteBlock{.lattice = flat_lattice(0.1, 0.1, {.sphere_diameter = d, .layers = 3}),
                                   .level = ConcreteLevel::quasi_static,
                                   .worn_out = worn_out};
    scene.add_sphere(radius, {.position = {0, 0, 0.0085}, .velocity = {0, 0, -2}});
    return scene;
}
/// Half a cell by the first impact, which loses 0.64 of 0.0114 J.
constexpr Real half_a_cell = 1e4;
/// So much that one impact wears three cells.
constexpr Real three_cells = 6e4;

template <class Sim>
Vec3 velocity_of_stone(const Sim& sim) {
    const Particles& p = sim.particles();
    return p.velocity[static_cast<std::size_t>(std::find(p.kind.begin(), p.kind.end(), Kind::stone) -
                                               p.kind.begin())];
}
/// Where stones meet the sphere of a site, which may wait to sink.
template <class Sim>
Vec3 surface(const Sim& sim, Index site) {
    return sim.world().state().sites.place[at(site)];
}
/// What the bed has lost where its spheres have sunk or gone [m3].
template <class Sim>
Real volume_above_surface(const Sim& sim) {
    const Concrete& c = sim.concrete();
    Real volume = 0;
    for (Index s = 0; s < c.sites(); ++s)
        volume += c.gone(s) ? c.capacity(s)
                            : c.capacity(s) / d * (c.lattice().sites[at(s)].centre - surface(sim, s)).norm();
    return volume;
}

}  // namespace

TEST_CASE("a worn sphere sinks by its fracture rate, once the stone has left it") {
    auto sim =
        simulate(on_the_middle(WornOut::recedes)).contact(law).bond(strong).wear(abrasion(half_a_cell));
    const Index middle = on_the_middle(WornOut::recedes).concrete->lattice.site(2, 2, 0);
    Vec3 before = on_the_middle(WornOut::recedes).concrete->lattice.sites[at(middle)].centre;
    Index moves = 0;
    // It bounces, and is near again as it comes back: then the sphere sinks.
    sim.run({.end_time = 0.25, .time_step = 1e-5, .observe_every = 1e-5}, [&](const auto& now) {
        const Vec3 place = surface(now, middle);
        if (place == before) return;
        ++moves, before = place;
        const Real worn = now.concrete().fracture(middle);
        CHECK((place - Vec3(0, 0, -0.5 * d - worn * d)).norm() < 1e-15);
        CHECK(volume_above_surface(now) ==
              doctest::Approx(now.concrete().worn_volume()).epsilon(1e-12).scale(0));
        // Neither where it was nor where it is now does the stone touch it.
        const Particles& p = now.particles();
        for (std::size_t b = 0; b < p.kind.size(); ++b)
            if (p.kind[b] == Kind::stone) CHECK((p.position[b] - place).norm() > 0.5 * d + radius);
    });
    const Concrete& c = sim.concrete();
    CHECK(moves == 1);
    CHECK(c.fracture(middle) > 0.3);
    CHECK(c.fracture(middle) < 0.7);
    CHECK(sim.ledger().residual_relative() < 1e-12);
    CHECK(sim.ledger().left_stored == 0);
}

TEST_CASE("a stone is fed over a worn sphere where that stands, not where it will sink to") {
    auto sim =
        simulate(on_the_middle(WornOut::recedes)).contact(law).bond(strong).wear(abrasion(three_cells));
    Index waiting = 0;  // one that the crater has reached, beside the stone's own and no body yet
    sim.run({.end_time = 2e-3, .time_step = 1e-5, .observe_every = 1e-5}, [&](const auto& now) {
        const auto& state = now.world().state();
        for (Index site = 0; site < now.concrete().sites(); ++site) {
            const Vec3 place = surface(now, site);
            if (now.concrete().gone(site) || (place - state.place_of(site)).norm() < 0.1 * d) continue;
            ++waiting;
            CHECK(height_above_standing(state, place, radius) >= place.z() + 0.5 * d + radius);
        }
    });
    CHECK(waiting > 0);
}

TEST_CASE("what one collision wears does not change its rebound") {
    const auto rebound = [](WornOut worn_out, Real beta) {
        auto sim = simulate(on_the_middle(worn_out)).contact(law).bond(strong).wear(abrasion(beta));
        sim.run({.end_time = 2e-3, .time_step = 1e-5});
        CHECK(sim.ledger().residual_relative() < 1e-12);
        return std::pair(velocity_of_stone(sim), sim.concrete().worn_volume() / beta);
    };
    const auto gently = rebound(WornOut::fines, 1);
    CHECK(gently.first.z() == doctest::Approx(1.2).epsilon(0.01).scale(0));
    for (const WornOut worn_out : {WornOut::fines, WornOut::recedes})
        for (const Real beta : {half_a_cell, three_cells}) {
            const auto wearing = rebound(worn_out, beta);
            CHECK((wearing.first - gently.first).norm() < 1e-12);
            CHECK(wearing.second == doctest::Approx(gently.second).epsilon(1e-12).scale(0));
        }
}

TEST_CASE("a column is worn down sphere by sphere, and the surface is as deep as the record says") {
    Scene scene = on_the_middle(WornOut::recedes);
    scene.concrete->overflow = SpreadByEpoch{.length = 0.1, .every = 0.05};
    auto sim = simulate(scene).contact(law).bond(strong).wear(abrasion(2e5));
    Real deepest = 0;
    sim.run({.end_time = 0.6}, [&](const auto&) {
        const Particles& p = sim.particles();
        for (std::size_t b = 0; b < p.kind.size(); ++b)
            if (p.kind[b] == Kind::stone) deepest = std::min(deepest, p.position[b].z());
    });
    const Concrete& c = sim.concrete();
    CHECK(c.worn_volume() > 5 * c.capacity(0));
    CHECK(deepest < -0.5 * d);
    CHECK(volume_above_surface(sim) == doctest::Approx(c.worn_volume()).epsilon(0.1));  // some wait to sink
    CHECK(std::abs(sim.ledger().integration_residue()) < 0.01 * sim.ledger().throughput());
    CHECK(sim.ledger().residual_relative() < 1e-12);
}

TEST_CASE("the same bits with one thread and with three, where stones wear a bed that recedes") {
    const auto run = [](int threads) {
        set_thread_count(threads);
        Scene scene;
        scene.concrete = ConcreteBlock{.lattice = flat_lattice(3.2, 0.6, {.sphere_diameter = d, .layers = 3}),
                                       .level = ConcreteLevel::quasi_static,
                                       .worn_out = WornOut::recedes};
        for (const Vec3& wall : {Vec3(1.6, 0, 0), Vec3(-1.6, 0, 0), Vec3(0, 0.3, 0), Vec3(0, -0.3, 0)})
            scene.add_wall(wall, -wall);
        for (int n = 0; n < 384; ++n)
            scene.add_sphere(n % 2 ? 0.02 : 0.015,
                             {.position = {0.098 * (n % 32) - 1.52, 0.046 * (n / 32) - 0.253, 0.025},
                              .velocity = {n % 3 - 1.0, 0.1 * (n % 5), -2}});
        auto sim = simulate(scene)
                       .contact(law)
                       .bond(MohrCoulomb{{.tensile = 1e4, .stiffness = 4e6}})
                       .wear(abrasion(3000));
        sim.run({.end_time = 0.06, .skin = 0.02});
        Index gone = 0;
        for (Index s = 0; s < sim.concrete().sites(); ++s) gone += sim.concrete().gone(s);
        CHECK(gone > 0);
        CHECK(sim.ledger().residual_relative() < 1e-12);
        std::vector<Real> all{static_cast<Real>(sim.bonds_broken()), static_cast<Real>(gone)};
        for (Index s = 0; s < sim.concrete().sites(); ++s)
            for (int a = 0; a < 3; ++a) all.push_back(sim.concrete_place(s)[a]);
        for (const Vec3& x : sim.particles().position) all.insert(all.end(), x.data(), x.data() + 3);
        return all;
    };
    const int before = thread_count();
    const std::vector<Real> one = run(1), three = run(3);
    set_thread_count(before);
    REQUIRE(one.size() == three.size());
    CHECK(std::memcmp(one.data(), three.data(), one.size() * sizeof(Real)) == 0);
}

TEST_CASE("a sphere that has sunk into another crumbles instead of being shot out") {
    Scene scene = on_the_middle(WornOut::recedes);
    scene.stones.clear();
    // One falls on the corner sphere, which its seat holds; another strikes it outwards once it has sunk.
    const Vec3 corner = scene.concrete->lattice.sites[at(scene.concrete->lattice.site(4, 4, 0))].centre;
    const Vec3 inwards = Vec3(-1, -1, 3).normalized(), sunk(0, 0, -0.005);
    scene.add_sphere(0.006, {.position = corner + Vec3(0, 0, 0.0165), .velocity = {0, 0, -3}});
    scene.add_sphere(0.004, {.position = corner + sunk + 0.06 * inwards, .velocity = -2 * inwards});
    auto sim = simulate(scene)
                   .contact(law)
                   .bond(MohrCoulomb{{.tensile = 1, .friction_angle = 10, .stiffness = 4e6}})
                   .wear(abrasion(5e3));
    Real fastest = 0;
    sim.run({.end_time = 0.05, .observe_every = 1e-3}, [&](const auto& now) {
        for (const Vec3& v : now.particles().velocity) fastest = std::max(fastest, v.norm());
    });
    CHECK(sim.spheres_let_go() == 1);
    CHECK(sim.concrete().detached_volume() > 0);
    CHECK(fastest < 4);
    CHECK(sim.ledger().residual_relative() < 1e-12);
}

TEST_CASE("concrete that moves does not recede") {
    Scene scene = on_the_middle(WornOut::recedes);
    scene.concrete->level = ConcreteLevel::dynamic;
    CHECK(message_of([&] {
              simulate(scene).contact(law).bond(strong).run({.end_time = 1e-4});
          }).find("Scene.concrete.worn_out") != std::string::npos);
}
