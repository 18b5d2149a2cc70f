// Trains of gears in concrete: which spheres turn together, and that those asleep turn on.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

constexpr Real d = 0.02;

GearTrains trains_of(const Lattice& lattice) {
    std::vector<BondedPair> pairs;
    for (const auto& [i, j] : lattice.bonds) pairs.push_back({i, j});
    std::vector<char> held;
    for (const LatticeSite& site : lattice.sites) held.push_back(site.held);
    Ties ties;
    ties.build(pairs, held);
    GearTrains gears;
    gears.build(ties, lattice.sites);
    return gears;
}

Lattice cubic() { return flat_lattice(5 * d, 4 * d, {.sphere_diameter = d, .layers = 3}); }

Real sign(const LatticeSite& site) { return (site.along + site.across) % 2 ? -1 : 1; }

}  // namespace

TEST_CASE("layers of a cubic lattice are trains about the upright, but for the one that is held") {
    const Lattice lattice = cubic();
    for (Index layer = 0; layer < 3; ++layer) {
        GearTrains gears = trains_of(lattice);
        Real lost = 0;
        for (std::size_t s = 0; s < lattice.sites.size(); ++s) {
            const LatticeSite& site = lattice.sites[s];
            const Real up = site.layer == layer ? 3 * sign(site) : 0;
            lost += gears.add(static_cast<Index>(s), {1, 2, up});
        }
        const bool held = layer == 2;
        CHECK(lost == doctest::Approx(60 * (1 + 4) + (held ? 20 * 9 : 0)));
        CHECK(gears.rims_squared() == doctest::Approx(held ? 0 : 20 * 9));
        for (std::size_t s = 0; s < lattice.sites.size(); ++s) {
            const LatticeSite& site = lattice.sites[s];
            const Vec3 expected(0, 0, !held && site.layer == layer ? 3 * sign(site) : 0);
            CHECK((gears.rim(static_cast<Index>(s)) - expected).norm() < 1e-12);
        }
        SphereLines lines;
        CHECK(gears.hold(true, lines) == doctest::Approx(held ? 0 : 20 * 9));
        CHECK(gears.rims_squared() == 0);
    }
}

TEST_CASE("three in a ring are stuck, four are a train") {
    const auto ring = [](const std::vector<Vec3>& centres) {
        GearTrains gears =
            trains_of(lattice_of(centres, 0.5 * d, static_cast<Real>(centres.size()) * cube(d)));
        gears.add(0, {0, 0, 1});
        return gears.rims_squared();
    };
    CHECK(ring({{0, 0, 0}, {d, 0, 0}, {0.5 * d, std::sqrt(0.75) * d, 0}}) == 0);
    CHECK(ring({{0, 0, 0}, {d, 0, 0}, {d, d, 0}, {0, d, 0}}) == 1);
}

TEST_CASE("one that falls asleep shares what it turns with; one that wakes takes its share along") {
    const Lattice lattice = cubic();
    GearTrains gears = trains_of(lattice);
    const Index a = lattice.site(0, 0, 0), b = lattice.site(0, 1, 0), c = lattice.site(1, 1, 0);
    CHECK(gears.add(a, {0, 0, 1}) == 0);
    CHECK(gears.add(b, {0, 0, 0.5}) == doctest::Approx(1 + 0.25 - 2 * square(0.25)));  // against the first
    CHECK(gears.rim(a).z() == doctest::Approx(0.25));
    CHECK(gears.rim(b).z() == doctest::Approx(-0.25));
    CHECK(gears.add(c, {0, 0, 0.25}) == doctest::Approx(0));
    gears.remove(a);
    CHECK(gears.rims_squared() == doctest::Approx(2 * square(0.25)));
    gears.remove(b), gears.remove(c);
    CHECK(gears.rims_squared() == 0);
}

TEST_CASE("a lever on an anchor turns its train, with the work that becomes its energy") {
    const Lattice lattice = cubic();
    GearTrains gears = trains_of(lattice);
    for (Index along = 0; along < 5; ++along)
        for (Index across = 0; across < 4; ++across) gears.add(lattice.site(along, across, 0), {0, 0, 0.1});
    const Real mass = 0.01, dt = 1e-5, before = 0.2 * mass * gears.rims_squared();
    SphereLines lines;
    lines.resize(2);
    gears.mesh(lattice.site(2, 2, 0), 0, 0), gears.mesh(lattice.site(2, 3, 0), 1, 1);
    CHECK(gears.turn_anchors());
    const std::vector<Vec3> levers{{5, 5, 3}, {5, 5, 1}};
    const auto lever_on = [&](Index anchor) { return levers[static_cast<std::size_t>(anchor)]; };
    const Real rim = gears.rim(lattice.site(2, 2, 0)).z();
    const Real work = gears.turn(dt, 1 / mass, lever_on, lines);
    CHECK(lines.motion[0].rim.z() == doctest::Approx(rim + 2.5 * dt * (3 - 1) / (20 * mass)));
    CHECK(lines.motion[1].rim.z() == -lines.motion[0].rim.z());
    CHECK(lines.motion[0].rim.head<2>().norm() == 0);
    CHECK(0.2 * mass * gears.rims_squared() - before == doctest::Approx(work).epsilon(1e-12));
}

TEST_CASE("trains that are held stand with their anchors, and take up no turning until they are let go") {
    const Lattice lattice = cubic();
    GearTrains gears = trains_of(lattice);
    const Index a = lattice.site(0, 0, 0), b = lattice.site(0, 1, 0), c = lattice.site(1, 1, 0);
    SphereLines lines;
    lines.resize(1);
    gears.add(a, {0, 0, 1});
    gears.mesh(a, 0, 0);
    lines.motion[0].rim = gears.rim(a);
    CHECK(gears.turn_anchors());
    CHECK(gears.hold(true, lines) == doctest::Approx(1));
    CHECK_FALSE(gears.turn_anchors());
    CHECK(lines.motion[0].rim.norm() == 0);
    CHECK(gears.add(b, {0, 0, 0.5}) == doctest::Approx(0.25));
    CHECK(gears.rims_squared() == 0);
    CHECK(gears.hold(false, lines) == 0);
    CHECK(gears.turn_anchors());
    gears.add(c, {0, 0, 0.3});
    CHECK(gears.rim(c).z() == doctest::Approx(0.1));  // three share it
}

TEST_CASE("a layer that a stone has set turning turns on asleep, and wakes so") {
    // Off the middle of a sphere, so that it turns it about the upright.
    const auto turning = [](Real wake_force) {
        Scene scene;
        scene.gravity.setZero();
        scene.concrete = ConcreteBlock{flat_lattice(0.18, 0.18, {.sphere_diameter = d, .layers = 3})};
        scene.outlet = 0.1;
        scene.add_sphere(0.025, {.position = {-0.01, 0.004, 0.027}, .velocity = {5, 0, -3}});
        auto sim = simulate(scene)
                       .contact(LinearSpring{{.stiffness = 1e6, .restitution = 0.6, .friction = 0.4}})
                       .bond(MohrCoulomb{{.tensile = 2.7e6, .stiffness = 4e6, .damping = 0.3}});
        sim.run({.end_time = 0.04, .wake_force = wake_force});
        CHECK(sim.ledger().residual_relative() < 1e-12);
        CHECK(sim.awake_fraction_mean() < (wake_force > 0 ? 0.5 : 1.1));
        sim.run({.end_time = 0.0401});  // awake
        CHECK(sim.ledger().residual_relative() < 1e-12);
        const Particles& p = sim.particles();
        Real rim = 0, squares = 0;
        for (std::size_t b = 0; b < p.site.size(); ++b) {
            if (p.site[b] < 0) continue;
            const LatticeSite& site = sim.concrete().lattice().sites[static_cast<std::size_t>(p.site[b])];
            if (site.layer > 0) continue;
            const Real up = 0.5 * d * p.angular_velocity(static_cast<Index>(b)).z();
            rim += sign(site) * up / 81, squares += square(up) / 81;
        }
        MESSAGE("wake force " << wake_force << " N: rims at " << rim << " m/s, " << std::sqrt(squares)
                              << " in the mean of squares; lost asleep " << sim.ledger().lost_asleep << " J");
        return rim;
    };
    const Real expected = turning(0);
    CHECK(std::abs(expected) > 0.01);
    // Asleep and still it would be 0.
    for (const Real wake_force : {1.0, 10.0})
        CHECK(turning(wake_force) == doctest::Approx(expected).epsilon(1e-3).scale(0));
}
