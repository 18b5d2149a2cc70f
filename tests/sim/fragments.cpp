// Pieces of concrete that come loose go on as rigid clumps: what is kept, what is lost.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <doctest/doctest.h>

#include <numeric>
#include <random>

using namespace abrade;

namespace {

constexpr Real d = 0.02;
const LinearSpring law{{.stiffness = 1e6, .restitution = 0.6, .friction = 0.4}};
const MohrCoulomb bond{{.tensile = 1e5, .stiffness = 4e6}};

/// A beam of `count` x 2 x 2 spheres that stands out from its first section, and a stone that strikes it off.
Scene beam(int count, Fragments fragments) {
    std::vector<Vec3> centres;
    for (int n = 0; n < count; ++n)
        for (int j = 0; j < 2; ++j)
            for (int k = 0; k < 2; ++k) centres.push_back({n * d, (j - 0.5) * d, -(k + 0.5) * d});
    Lattice lattice = lattice_of(centres, 0.5 * d, static_cast<Real>(centres.size()) * cube(d));
    for (LatticeSite& site : lattice.sites) site.held = site.centre.x() < 0.5 * d;
    Scene scene;
    scene.gravity.setZero();
    scene.concrete = ConcreteBlock{.lattice = lattice, .fragments = fragments};
    scene.add_sphere(0.025, {.position = {2 * d, 0.003, 0.026}, .velocity = {0, 0, -6}});
    return scene;
}

}  // namespace

TEST_CASE("a fragment has the mass, the momentum and the angular momentum of its spheres") {
    std::mt19937 random(3);
    const auto uniform = [&] { return std::uniform_real_distribution<Real>(-1, 1)(random); };
    const auto anywhere = [&] {
        const Real x = uniform(), y = uniform(), z = uniform();
        return Vec3(x, y, z);
    };
    Scene scene;
    scene.gravity.setZero();
    for (int n = 0; n < 5; ++n)
        scene.add_sphere(0.5 * d,
                         {.position = {1.1 * d * n, 0.3 * d * n * n, 0},
                          .velocity = anywhere(),
                          .angular_velocity = 30 * anywhere()},
                         2400);
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0});
    const Particles& p = sim.particles();
    std::vector<Index> bodies(5);
    std::iota(bodies.begin(), bodies.end(), 0);
    const Fragment all = join(sim.world().state(), bodies, 2400);

    Real mass = 0, kinetic = 0;
    Vec3 momentum = Vec3::Zero(), turning = Vec3::Zero();
    for (std::size_t b = 0; b < 5; ++b) {
        mass += p.mass[b], momentum += p.mass[b] * p.velocity[b], kinetic += p.kinetic_energy(bodies[b]);
        turning += p.mass[b] * p.position[b].cross(p.velocity[b]) + p.angular_momentum[b];
    }
    const Real same = 1e-14;
    CHECK(2400 * all.clump.volume == doctest::Approx(mass).epsilon(same));
    CHECK((mass * all.state.velocity - momentum).norm() < same * momentum.norm());
    const Vec3 orbit = mass * all.state.position.cross(all.state.velocity);
    CHECK((orbit + all.angular_momentum - turning).norm() < 10 * same * turning.norm());
    CHECK(all.kinetic == doctest::Approx(kinetic).epsilon(same));
    for (std::size_t b = 0; b < 5; ++b) {
        const Vec3 centre = all.state.position + all.state.orientation * all.clump.members[b].centre;
        CHECK((centre - p.position[b]).norm() < 1e-15);
    }
    // As a body it can only have less energy: what its spheres did against each other is gone.
    Particles joined;
    joined.add(all.clump, 2400, all.state, Kind::grain);
    joined.angular_momentum[0] = all.angular_momentum;
    CHECK(joined.kinetic_energy(0) < kinetic);
    CHECK(joined.kinetic_energy(0) > 0.5 * mass * all.state.velocity.squaredNorm());
}

TEST_CASE("what is struck off a beam flies on as one body") {
    auto sim = simulate(beam(12, Fragments::clumps)).contact(law).bond(bond).wear(SubParticleAbrasion{{}});
    sim.run({.end_time = 0.01});
    const Particles& p = sim.particles();
    Index gone = 0, in_clumps = 0, clumps = 0, single = 0;
    for (Index s = 0; s < sim.concrete().sites(); ++s) gone += sim.concrete().gone(s);
    for (std::size_t b = 0; b < p.kind.size(); ++b) {
        if (p.kind[b] != Kind::grain) continue;
        if (p.sphere_count[b] > 1)
            ++clumps, in_clumps += p.sphere_count[b];
        else
            ++single;
    }
    MESSAGE(clumps << " clumps of " << in_clumps << " spheres, " << single << " grains");
    CHECK(clumps >= 1);
    CHECK(in_clumps > 20);
    CHECK(in_clumps + single == gone);
    const Ledger& e = sim.ledger();
    CHECK(e.residual_relative() < 1e-12);
    // The step's error in this impact, 0.0034 J where fragments stay bonded: joining adds none.
    CHECK(std::abs(e.integration_residue()) < 1.5e-3 * e.kinetic_start);
    CHECK(e.lost_asleep >= 0);
}

TEST_CASE("as it is by default, fragments stay bonded and may break on") {
    auto sim = simulate(beam(12, Fragments::bonded)).contact(law).bond(bond);
    sim.run({.end_time = 0.01});
    for (std::size_t b = 0; b < sim.particles().kind.size(); ++b) CHECK(sim.particles().sphere_count[b] == 1);
    CHECK(sim.bonds_broken() > 0);
    CHECK(sim.ledger().lost_asleep == 0);
}
