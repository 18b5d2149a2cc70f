// A static deposit must not wear: stones at rest leave the worn volume as it is, to the last bit, on concrete
// whose spheres move and on concrete that stands. Five hundred for ten seconds: long_deposit.cpp;
// docs/verification/03_heap_at_rest.md.
#include "deposit.hpp"

#include <doctest/doctest.h>

using namespace deposit;

TEST_CASE("stones at rest wear nothing, awake or asleep") {
    for (const Real sleep_speed : {0.0, 2e-3}) {
        const History h = lie({.stones = 16, .per_side = 2, .sleep_speed = sleep_speed}, springs, 3);
        MESSAGE("sleep below " << sleep_speed << " m/s: worn " << h.worn.back() << " m3, unchanged since "
                               << h.unchanged_since() << " s, kinetic energy " << h.kinetic.back() << " J");
        CHECK(h.worn.back() > 1e-6);
        CHECK(h.unchanged_since() <= 2.5);
        CHECK(h.asleep == (sleep_speed > 0 ? 16 : 0));
        CHECK(h.kinetic.back() < (sleep_speed > 0 ? 1e-28 : 1e-18));
        CHECK(h.residual < 1e-12);
        CHECK(h.broken == 0);
    }
}

TEST_CASE("on concrete that stands, stones at rest wear nothing, whatever the lattice") {
    for (const Slab slab : {Slab::cubic, Slab::hexagonal})
        for (const Real sleep_speed : {0.0, 2e-3}) {
            CAPTURE(sleep_speed);
            const History h = lie({.stones = 60,
                                   .per_side = 4,
                                   .slab = slab,
                                   .sleep_speed = sleep_speed,
                                   .level = ConcreteLevel::quasi_static},
                                  springs, 6);
            MESSAGE((slab == Slab::cubic ? "cubic" : "hexagonal")
                    << ": worn " << h.worn.back() << " m3, unchanged since " << h.unchanged_since()
                    << " s, kinetic energy " << h.kinetic.back() << " J");
            CHECK(h.worn.back() > 1e-6);
            // Where one of the sixty happens to rock on two spheres it dies away for seconds.
            CHECK(h.unchanged_since() <= 4.5);
            CHECK(h.asleep == (sleep_speed > 0 ? 60 : 0));
            CHECK(h.kinetic.back() < 1e-15);
            CHECK(h.residual < 1e-12);
            CHECK(h.broken == 0);
        }
}

TEST_CASE("on a cubic lattice whose springs resist twisting it stays with everything awake") {
    const History h =
        lie({.stones = 16, .per_side = 2, .slab = Slab::cubic, .sleep_speed = 0}, twist_springs, 3);
    MESSAGE("worn " << h.worn.back() << " m3, unchanged since " << h.unchanged_since()
                    << " s, kinetic energy " << h.kinetic.back() << " J");
    CHECK(h.worn.back() > 1e-6);
    CHECK(h.unchanged_since() <= 2);
    CHECK(h.kinetic.back() < 1e-18);
    CHECK(h.residual < 1e-12);
    CHECK(h.broken == 0);
}

TEST_CASE("a cubic lattice held by springs alone does not come to rest: its layers turn as one") {
    // Neighbours of a layer that turn against each other roll on each other; bonds to the layers above and
    // below are only twisted, and these bonds do not feel that. Beams do; in a hexagonal lattice three
    // neighbours in a ring block each other.
    auto sim = simulation({.stones = 16, .per_side = 2, .slab = Slab::cubic}, springs);
    sim.run({.end_time = 1.5, .sleep_speed = 2e-3});
    const Ledger before = sim.ledger();
    sim.run({.end_time = 2, .sleep_speed = 2e-3});
    const Particles& p = sim.particles();
    Real together = 0, spin2 = 0, energy_of_spins = 0, concrete = 0;
    int spheres = 0;
    for (std::size_t b = 0; b < p.position.size(); ++b) {
        if (p.kind[b] != Kind::concrete) continue;
        concrete += p.kinetic_energy(static_cast<Index>(b));
        const LatticeSite& site = sim.concrete().lattice().sites[static_cast<std::size_t>(p.site[b])];
        if (site.layer != 1) continue;
        const Real spin = p.angular_momentum[b].z() * p.inverse_inertia[b].z();
        together += (site.along + site.across) % 2 ? spin : -spin, spin2 += square(spin), ++spheres;
        energy_of_spins += 0.5 * p.angular_momentum[b].z() * spin;
    }
    together /= spheres;
    MESSAGE("the middle layer's spheres turn at " << together << " rad/s with " << energy_of_spins
                                                  << " J, all "
                                                  << "of the concrete has " << concrete << " J");
    CHECK(std::abs(together) > 1e-4);
    CHECK(square(together) * spheres == doctest::Approx(spin2).epsilon(1e-3).scale(0));
    CHECK(energy_of_spins > 0.999 * concrete);
    // What they gain the springs of bonds and contacts give; the integrator has no part in it.
    const Ledger& after = sim.ledger();
    const Real gained = after.kinetic - before.kinetic,
               residue = after.integration_residue() - before.integration_residue();
    MESSAGE("gained " << gained << " J, bonds gave " << before.stored_bonds - after.stored_bonds
                      << " J, contacts " << before.stored_contacts - after.stored_contacts
                      << " J; integration residue " << residue << " J");
    CHECK(gained > 0);
    CHECK(std::abs(residue) < 1e-4 * gained);
    CHECK(after.residual_relative() < 1e-12);
}
