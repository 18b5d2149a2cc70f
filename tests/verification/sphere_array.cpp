// Stokes drag of a periodic simple cubic array of fixed spheres against A. Sangani & A. Acrivos 1982. The
// reference's gate is 2 % below a solid fraction of 0.2. It is not met on grids that a test affords: bounds
// are what was measured and some more. docs/verification/resolved_bodies.md has the table.
#include "sphere_array.hpp"

#include <doctest/doctest.h>

using namespace sphere_array;

TEST_CASE("drag of a cubic array: too low by what a thinner sphere's would be, and less so on finer grids") {
    const auto rows = reference_table("cpl06_simple_cubic_array_stokes_drag.csv");
    for (const ReferenceRow& row : rows)
        CHECK(exact_factor(row.at("solid_fraction")) == doctest::Approx(row.at("Fstar")).epsilon(1e-5));
    for (const Real c : {0.064, 0.125}) {
        const Deviation four = deviation_of(c, 4), eight = deviation_of(c, 8);
        CAPTURE(c);
        for (const Deviation& d : {four, eight}) {
            MESSAGE(d.cells << " cells: " << 100 * d.mean << " %, the radius lacks " << d.lacks << " cells");
            CHECK(std::abs(d.lacks) < 0.3);
            CHECK(d.most - d.least < 0.08);
        }
        CHECK(std::abs(four.mean) < 0.35);
        CHECK(std::abs(eight.mean) < 0.17);
        CHECK(std::abs(eight.mean) < 0.55 * std::abs(four.mean));  // first order
    }
}

TEST_CASE("cubic array: the force that drives the water is the one that the sphere gets") {
    const ArrayDrag drag = drag_in({.solid_fraction = 0.125, .cells = 6});
    CHECK(std::abs(drag.lost) < 1e-6);
    CHECK(std::abs(drag.unsteady) < 1e-5);
}
