// One bonded chain in tension against the closed form (bpm02).
#include "reference_table.hpp"

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

TEST_CASE(
    "a chain of bonds breaks at sigma_t A, at the strain sigma_t / E, with the energy sigma_t^2 A l / (2 E) "
    "in each bond") {
    std::vector<Real> value;
    for (const auto& row : reference_table("bpm02_tension_strength_analytic.csv"))
        value.push_back(row.at("value"));
    REQUIRE(value.size() == 4);
    const Real force = value[0], strain = value[1], energy = value[2], elongation_of_100 = value[3];
    const Real area = 1e-4, youngs = 30e9, tensile = 3e6, length = 0.01;  // the table's example
    const Real radius = std::sqrt(area / pi);                             // the bond's area is pi r^2
    const MohrCoulomb law{{.tensile = tensile, .stiffness = youngs * area / length, .damping = 0}};
    CHECK(law.capacity(radius) == doctest::Approx(force).epsilon(1e-12));

    // A chain of 100 bonds drawn out evenly, bond by bond the same stretch.
    constexpr int count = 100;
    const Clump ball = make_clump("ball", {{Vec3::Zero(), radius}});
    Particles p;
    for (int n = 0; n <= count; ++n)
        p.add(ball, 2400, {.position = {n * length, 0, 0}}, n == 0 ? Kind::fixed : Kind::concrete);
    Network<MohrCoulomb> network;
    std::vector<BondedPair> pairs;
    for (Index n = 0; n < count; ++n) pairs.push_back({n, n + 1});
    network.build(p, pairs);
    SphereStore store;
    store.arrange(p, {}, 0, {});
    network.arrange(store);
    network.pack(store.phantom(), [&](const auto& bond, Index) {
        return SlotPair{store.slot_of(bond.spheres.first), store.slot_of(bond.spheres.second)};
    });
    Real last_force = 0, last_energy = 0, at = 0;
    for (Real stretch = 0;; stretch += 2e-4 * strain) {  // a fifth of the 0.1 % asked for
        for (Index n = 0; n <= count; ++n)
            store.lines.place[static_cast<std::size_t>(store.slot_of(n))].centre.x() =
                n * length * (1 + stretch);
        for (SphereLoad& load : store.lines.load) load.force.setZero();
        BondSums sums;
        for (Index slab = 0; slab < store.slabs.count(); ++slab)
            sums += network.respond(slab, law, NoObserver{}, store.lines, [](Index) { return 1.0; }, {1e-7, 0});
        if (sums.broken_tension > 0) {
            CHECK(sums.lost_bond / sums.broken_tension == doctest::Approx(energy).epsilon(0.001).scale(0));
            at = stretch;
            break;
        }
        last_force = store.lines.load[static_cast<std::size_t>(store.slot_of(0))].force.norm();
        last_energy = sums.stored / count;
        REQUIRE(stretch < 2 * strain);
    }
    CHECK(last_force == doctest::Approx(force).epsilon(0.001));
    CHECK(last_energy == doctest::Approx(energy).epsilon(0.001).scale(0));
    CHECK(at == doctest::Approx(strain).epsilon(0.001).scale(0));
    CHECK(at * count * length == doctest::Approx(elongation_of_100).epsilon(0.001).scale(0));
}

TEST_CASE(
    "a column pulled at by its weight, through the engine: it holds below its strength and breaks above") {
    // Two free spheres above a fixed one, pulled upward by gravity turned around.
    const Real d = 0.02, k = 4e6, sphere = 2400 * pi / 6 * cube(d);
    const MohrCoulomb law{{.tensile = 2.7e6, .stiffness = k, .damping = 0.5}};
    const Real capacity = law.capacity(0.5 * d);
    const auto broken_at = [&](Real share) {
        Scene scene;
        scene.concrete = ConcreteBlock{flat_lattice(d, d, {.layers = 3})};
        scene.gravity = {0, 0, share * capacity / (2 * sphere)};
        auto sim = simulate(scene).contact(LinearSpring{{.stiffness = k}}).bond(law);
        sim.run({.end_time = 0.02});
        return sim.bonds_broken();
    };
    // A load put on at once swings to nearly twice itself, less what damping takes: it holds under half and
    // breaks above the whole.
    CHECK(broken_at(0.49) == 0);
    CHECK(broken_at(1.01) == 1);
}
