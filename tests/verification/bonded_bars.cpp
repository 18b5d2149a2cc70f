// Bars of bonded spheres drawn apart by their heads: modulus, strength, and the energy that breaking takes.
#include "bonded_bodies.hpp"

#include <doctest/doctest.h>

using namespace bonded_bodies;

namespace {

void check_energy(const Drawn& bar, const std::string& what) {
    const Loaded& seen = bar.seen;
    MESSAGE(what << ": " << bar);
    // What the plates gave is stored, moves, or is booked as lost, up to the residue that is shown.
    const Real given = seen.start.kinetic - seen.end.kinetic;
    CHECK(given - seen.end.stored_bonds - seen.end.stored_contacts - seen.end.lost() ==
          doctest::Approx(seen.end.integration_residue()).scale(seen.start.kinetic).epsilon(1e-11));
    CHECK(std::abs(seen.end.integration_residue()) < 0.02 * seen.end.lost());
    CHECK(seen.end.residual_relative() < 1e-12);
    CHECK(seen.load.size() < 900);  // it came apart
}

}  // namespace

TEST_CASE("a sheet of a triangular lattice, drawn along its rows and across them") {
    const Bar shape{.neck_width = 6,
                    .neck_height = 4,
                    .root_width = 15,
                    .head_width = 20,
                    .head_height = 5,
                    .sheet = true};
    const Real poisson = 0.8 / 3.2, youngs = std::sqrt(0.75) * 1.6 * (1 - square(poisson));
    for (const bool along : {true, false}) {
        const Drawn bar =
            draw_apart(triangular_sheet(shape.head_width * d, shape.height() * d, along), shape, 0.2);
        check_energy(bar, along ? "drawn along rows" : "drawn across rows");
        MESSAGE("without end: E " << youngs);
        CHECK(bar.youngs == doctest::Approx(youngs).epsilon(0.05).scale(0));
    }
}

TEST_CASE("a random packing") {
    const Bar shape{.neck_width = 4, .root_width = 5.5, .head_width = 9, .head_height = 3};
    const Drawn bar =
        draw_apart(random_packing({shape.head_width, shape.head_width, shape.height()}), shape, 0.2);
    check_energy(bar, "random, neck 4 d wide");
    CHECK(bar.youngs > 0.4);
    CHECK(bar.youngs < 0.9);
    CHECK(bar.strength > 0.25);
    CHECK(bar.strength < 0.8);
}
