// Concrete that moves and comes to touch others than those it is bonded to.
#include "../../bench/charts/struck_patch.hpp"

#include <doctest/doctest.h>

using namespace abrade;
using namespace abrade::charts;

TEST_CASE("a sphere that rolls about the one it is bonded to meets the next") {
    // Nothing but a bond to a held sphere carries it, and bonds without moments let it roll down that one.
    const Real d = 0.02;
    Scene scene;
    scene.concrete =
        ConcreteBlock{.lattice = lattice_of({{0, 0, 0}, {d, 0, 0}, {0, 0, -d}}, 0.5 * d, cube(d)),
                      .level = ConcreteLevel::dynamic};
    scene.concrete->lattice.sites[0].held = scene.concrete->lattice.sites[2].held = true;
    const MohrCoulomb bond{{.tensile = 2.7e6, .stiffness = 2e6}};
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 2e6, .restitution = 0.5}}).bond(bond);
    Real way = 0, deepest = 0;
    sim.run({.end_time = 0.3, .observe_every = 1e-3}, [&](const auto& now) {
        way = std::max(way, d - now.concrete_place(1).x());
        deepest = std::max(deepest, d - (now.concrete_place(1) - now.concrete_place(2)).norm());
    });
    CHECK(sim.bonds_broken() == 0);
    CHECK(way > 0.1 * d);  // it has come to the next one, which is at 60 degrees
    CHECK(deepest > 0);
    CHECK(deepest < 0.01 * d);
    CHECK(sim.ledger().residual_relative() < 1e-11);
}

TEST_CASE("what hangs by a few bonds does not pass into its neighbours") {
    // Looked for as contacts only once loose, or only once a bond had broken, spheres came to overlap by
    // half a radius unseen, and the run ended in an error when they were seen. Which seeds ended so depended
    // on the compiler: 2 for any processor, 3 for the one at hand, of 1 to 6.
    for (const std::uint32_t seed : {2u, 3u}) {
        CAPTURE(seed);
        Patch patch{.seed = seed, .stones = 160};
        patch.bond.join = MohrCoulomb::Join::minimum;
        patch.wear.acceleration = 2000;
        Scene scene = patch.scene();
        scene.concrete->worn_out = WornOut::grain;
        scene.concrete->overflow = DropOverflow{};
        auto sim = simulate(scene)
                       .contact(LinearSpring{patch.contact})
                       .bond(MohrCoulomb{patch.bond})
                       .wear(SubParticleAbrasion{patch.wear});
        sim.run({.end_time = patch.end_time(), .safety = patch.safety});
        Index grains = 0;
        for (Index s = 0; s < sim.concrete().sites(); ++s) grains += sim.concrete().gone(s);
        MESSAGE(sim.bonds_broken() << " bonds broken, " << grains << " grains");
        CHECK(sim.bonds_broken() > 30);
        CHECK(grains > 5);
        CHECK(sim.ledger().residual_relative() < 1e-11);
    }
}
