// Concrete that wears: what contacts lose is what is worn, and what lies still wears nothing.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/sim/print.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <doctest/doctest.h>

#include <sstream>

using namespace abrade;

namespace {

constexpr Real coefficient = 1.1e-7;

const LinearSpring stones{{.stiffness = 1e6, .restitution = 0.5, .friction = 0.4}};
const MohrCoulomb bonds{{.tensile = 2.7e6, .stiffness = 4e6, .damping = 0.1}};

SubParticleAbrasion abrasion(Real beta) {
    return SubParticleAbrasion{{.coefficient = coefficient, .acceleration = beta}};
}

Scene slab(Index layers = 3, Real side = 0.1) {
    Scene scene;
    scene.concrete = ConcreteBlock{.lattice = flat_lattice(side, side, {.layers = layers}),
                                   .worn_out = WornOut::grain,
                                   .overflow = DropOverflow{}};
    return scene;
}

/// A stone that falls on the middle of the slab from the given height, a little off and turning.
template <class Bond>
auto drop(Real height, Real beta, const Bond& bond, StoneShape shape = StoneShape::angular,
          Real time = 0.15) {
    Scene scene = slab();
    scene.add_stone(make_stone(shape, 0.05), {.position = {0.003, -0.004, 0.035},
                                              .velocity = {0.3, 0, -std::sqrt(2 * standard_gravity * height)},
                                              .angular_velocity = {3, 20, 1}});
    auto sim = simulate(std::move(scene)).contact(stones).bond(bond).wear(abrasion(beta));
    sim.run({.end_time = time});
    return sim;
}

}  // namespace

TEST_CASE("worn volume is C_w beta 1/2 of what contacts with concrete lost") {
    for (const Real beta : {1.0, 100.0}) {
        const auto sim = drop(0.5, beta, bonds);
        const Ledger& e = sim.ledger();
        CHECK(e.concrete_lost_normal > 0.1);
        CHECK(e.concrete_lost_sliding > 0.01);
        CHECK(sim.concrete().overflow_volume() == 0);
        CHECK(sim.concrete().worn_volume() ==
              doctest::Approx(coefficient * beta * 0.5 * (e.concrete_lost_normal + e.concrete_lost_sliding))
                  .epsilon(1e-12)
                  .scale(0));
        CHECK(e.residual_relative() < 1e-12);
        // One side of each of these contacts is concrete, so nothing is counted twice.
        CHECK(e.concrete_lost_normal == doctest::Approx(e.lost_normal).epsilon(1e-12).scale(0));
    }
}

TEST_CASE("what hits spheres that are already worn is booked as overflow, and nothing gets lost") {
    const auto sim = drop(0.5, 5e5, bonds);
    const Ledger& e = sim.ledger();
    CHECK(sim.concrete().overflow_volume() > 0);
    CHECK(sim.concrete().worn_volume() + sim.concrete().overflow_volume() ==
          doctest::Approx(coefficient * 5e5 * 0.5 * (e.concrete_lost_normal + e.concrete_lost_sliding))
              .epsilon(1e-12)
              .scale(0));
    for (Index s = 0; s < sim.concrete().sites(); ++s) CHECK(sim.concrete().fracture(s) <= 1);
    CHECK(sim.bonds_broken() > 0);  // fully worn spheres hold nothing
    CHECK(e.residual_relative() < 1e-12);
}

TEST_CASE("a rigid bed of concrete wears by the same rule") {
    Scene scene = slab(1);
    scene.add_sphere(0.02, {.position = {0.01, 0.01, 0.025}, .velocity = {0, 0, -2}});
    auto sim = simulate(std::move(scene)).contact(stones).wear(abrasion(1));
    sim.run({.end_time = 0.05});
    const Ledger& e = sim.ledger();
    CHECK(e.concrete_lost_normal > 0.01);
    CHECK(sim.concrete().worn_volume() ==
          doctest::Approx(coefficient * 0.5 * (e.concrete_lost_normal + e.concrete_lost_sliding))
              .epsilon(1e-12)
              .scale(0));
}

TEST_CASE(
    "one head-on impact on a rigid sphere: C_w beta 1/2 of 1/2 m v^2 (1 - e^2), for several masses and "
    "heights") {
    for (const Real radius : {0.02, 0.04})
        for (const Real speed : {1.0, 3.0}) {
            Scene scene = slab(1, 0.02);  // one sphere, at (0, 0, -0.01)
            scene.gravity.setZero();
            scene.add_sphere(radius, {.position = {0, 0, radius + 1.3e-4}, .velocity = {0, 0, -speed}});
            auto sim = simulate(std::move(scene)).contact(stones).wear(abrasion(10));
            sim.run({.end_time = 0.02, .time_step = 2e-6});
            const Real lost = 0.5 * sim.particles().mass.back() * square(speed) * 0.75;
            CHECK(sim.ledger().lost_normal ==
                  doctest::Approx(lost).epsilon(1e-3).scale(0));  // 300 steps or more a contact
            CHECK(sim.concrete().worn_volume() ==
                  doctest::Approx(coefficient * 10 * 0.5 * lost).epsilon(1e-3).scale(0));
            CHECK(sim.ledger().lost_sliding < 1e-28);  // round-off of a unit vector, squared
        }
}

TEST_CASE("beta speeds up wear, never the motion") {
    const auto slow = drop(0.3, 1, bonds), fast = drop(0.3, 50, bonds);
    REQUIRE(slow.bonds_broken() == 0);
    REQUIRE(fast.bonds_broken() == 0);
    for (std::size_t b = 0; b < slow.particles().position.size(); ++b)
        REQUIRE(slow.particles().position[b] == fast.particles().position[b]);
    CHECK(fast.concrete().worn_volume() / slow.concrete().worn_volume() ==
          doctest::Approx(50).epsilon(1e-10));
}

TEST_CASE("a run without acceleration tells at which one a collision wears more than a cell") {
    // Head-on on one rigid sphere, where what is lost is known.
    const auto strike = [](Real beta) {
        Scene scene = slab(2, 0.02);
        scene.gravity.setZero();
        scene.add_sphere(0.02, {.position = {0, 0, 0.0201}, .velocity = {0, 0, -2}});
        auto sim = simulate(std::move(scene)).contact(stones).wear(abrasion(beta));
        sim.run({.end_time = 0.02, .time_step = 2e-6});
        return sim;
    };
    const auto slow = strike(1);
    const Real lost = 0.5 * slow.particles().mass.back() * square(2.0) * 0.75;
    const Real safe = slow.largest_safe_acceleration();
    const Real whole = safe / Concrete::safe_collision_share;  // where a collision wears one cell
    CHECK(whole == doctest::Approx(8e-6 / (coefficient * 0.5 * lost)).epsilon(1e-3).scale(0));
    CHECK(strike(0.999 * whole).concrete().overflow_volume() == 0);
    const auto fast = strike(1.5 * whole);
    CHECK(fast.concrete().overflow_volume() == doctest::Approx(4e-6).epsilon(1e-9).scale(0));
    CHECK(fast.largest_safe_acceleration() == doctest::Approx(safe).epsilon(1e-9).scale(0));
    const auto warns = [](const auto& sim) {
        std::ostringstream text;
        text << sim;
        return text.str().find("warning  one collision wore") != std::string::npos;
    };
    CHECK(!warns(strike(0.999 * whole)));
    CHECK(warns(fast));

    // A stone that lands on several bonded spheres.
    const auto land = [](Real beta) { return drop(0.5, beta, bonds, StoneShape::angular, 0.02); };
    const Real once = land(1).largest_safe_acceleration() / Concrete::safe_collision_share;
    CHECK(land(0.999 * once).concrete().overflow_volume() == 0);
    CHECK(land(1.01 * once).concrete().overflow_volume() > 0);
}

TEST_CASE("a heap at rest on concrete does not wear") {
    Scene scene = slab(2, 0.12);
    for (int n = 0; n < 5; ++n)
        scene.add_stone(make_stone(StoneShape::angular, 0.03),
                        {.position = {0.025 * (n % 2) - 0.01, 0.025 * (n / 2 % 2) - 0.01, 0.03 + 0.022 * n}});
    for (int axis = 0; axis < 2; ++axis)
        for (const Real side : {-1.0, 1.0})
            scene.add_wall(0.06 * side * Vec3::Unit(axis), -side * Vec3::Unit(axis));
    auto sim = simulate(std::move(scene))
                   .contact(LinearSpring{{.stiffness = 1e5, .restitution = 0.3, .friction = 0.6}})
                   .bond(MohrCoulomb{{.tensile = 2.7e6, .stiffness = 4e5}})
                   .wear(abrasion(4800));
    sim.run({.end_time = 3});
    const Real worn = sim.concrete().worn_volume(), kinetic = sim.ledger().kinetic;
    CHECK(worn > 0);
    sim.run({.end_time = 4});
    MESSAGE("worn " << worn << " m3 while settling, " << sim.concrete().worn_volume() - worn
                    << " m3 in the last second; kinetic energy " << kinetic << " J");
    // What still trembles decays; its loss in a second is below the round-off of what was worn.
    CHECK(sim.concrete().worn_volume() - worn <= 1e-12 * worn);
    CHECK(sim.ledger().residual_relative() < 1e-12);
}

TEST_CASE("bonded concrete that nothing touches stays whole and still but for its own weight") {
    auto sim = simulate(slab()).contact(stones).bond(bonds).wear(abrasion(4800));
    sim.run({.end_time = 0.3});
    CHECK(sim.bonds_broken() == 0);
    CHECK(sim.concrete().worn_volume() == 0);
    CHECK(sim.ledger().kinetic < 1e-12);  // what the sudden weight set going has been damped away
    for (std::size_t b = 0; b < sim.particles().position.size(); ++b)
        REQUIRE((sim.particles().position[b] - sim.concrete().lattice().sites[b].centre).norm() < 1e-6);
}

TEST_CASE("a block pulled beyond its strength lets go as grains, and the ledger closes") {
    Scene scene = slab(3, 0.06);
    scene.gravity = {
        0, 0,
        5 * 2.7e6 / (2400 * 0.04)};  // upward: the two free layers pull five times what the base's bonds hold
    scene.bounds = {{-10, -10, -10}, {10, 10, 10}};
    auto sim =
        simulate(std::move(scene)).contact(stones).bond(MohrCoulomb{{.tensile = 2.7e6, .stiffness = 4e8}});
    sim.run({.end_time = 2e-4});
    CHECK(sim.bonds_broken() > 0);
    Index grains = 0;
    for (const Kind kind : sim.particles().kind) grains += kind == Kind::grain;
    CHECK(grains == 18);
    CHECK(sim.concrete().detached_volume() == doctest::Approx(18 * 8e-6).scale(0));
    CHECK(sim.ledger().residual_relative() < 1e-12);
    CHECK(sim.ledger().lost_bond > 0);
    CHECK(std::abs(sim.ledger().integration_residue()) < 0.02 * sim.ledger().throughput());
}

TEST_CASE("what a wall passes through stands in that wall") {
    Scene scene = slab(3, 0.1);
    scene.add_wall({0.045, 0, 0}, {-1, 0, 0});
    // Bonds so weak that everything free lets go.
    scene.add_sphere(0.02, {.position = {0, 0, 0.03}, .velocity = {0, 0, -2}});
    auto sim =
        simulate(scene).contact(stones).bond(MohrCoulomb{{.tensile = 1e3, .stiffness = 4e6, .damping = 0.1}});
    sim.run({.end_time = 0.05});
    const Particles& p = sim.particles();
    for (std::size_t b = 0; b < p.position.size(); ++b)
        if (p.position[b].x() > 0.036) CHECK(p.inverse_mass[b] == 0);
    CHECK(sim.bonds_broken() > 0);
}

TEST_CASE("concrete that strays from its place is looked for before it meets other concrete") {
    constexpr Real d = 0.02;
    std::vector<Vec3> centres;
    for (int n = 0; n < 4; ++n) centres.push_back({n * d, 0, 0});
    centres.push_back({3 * d, -1.3 * d, 0});  // beside the free end of the row, bonded to nobody
    Lattice lattice = lattice_of(centres, 0.5 * d, 5 * cube(d));
    for (LatticeSite& site : lattice.sites) site.held = site.centre.x() < 0.5 * d || site.centre.y() < -d;
    Scene scene;
    scene.gravity = {0, -standard_gravity, 0};
    scene.concrete = ConcreteBlock{.lattice = lattice};
    auto sim = simulate(scene)
                   .contact(LinearSpring{{.stiffness = 1e5, .restitution = 0.5}})
                   .bond(MohrCoulomb{{.tensile = 1e12, .stiffness = 1e5}})
                   .wear(SubParticleAbrasion{{.coefficient = 0, .acceleration = 1}});
    Real nearest = 1, lowest = 0;
    sim.run({.end_time = 0.15, .observe_every = 1e-3, .skin = 4 * d}, [&](const auto& now) {
        const auto& x = now.particles().position;
        for (std::size_t n = 0; n + 1 < x.size(); ++n) nearest = std::min(nearest, (x[n] - x.back()).norm());
        lowest = std::min(lowest, x[3].y());
    });
    CHECK(sim.bonds_broken() == 0);
    CHECK(lowest < -0.25 * d);
    CHECK(nearest < 1.01 * d);
    CHECK(nearest > 0.97 * d);
}
