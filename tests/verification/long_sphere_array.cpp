// Stokes drag of a periodic simple cubic array of fixed spheres on finer grids and at more solid fractions:
// the table of docs/verification/resolved_bodies.md.
#include "sphere_array.hpp"

#include <doctest/doctest.h>

using namespace sphere_array;

TEST_CASE("drag of a cubic array over solid fraction and cells to a diameter") {
    for (const ReferenceRow& row : reference_table("cpl06_simple_cubic_array_stokes_drag.csv"))
        for (const Real cells : {4.0, 6.0, 8.0, 12.0, 16.0}) {
            const Real c = row.at("solid_fraction");
            // Nearly touching spheres, and periods of 40 cells and more, are left out.
            if (c < 0.01 || c > 0.4 || cells > 9 * std::cbrt(c / 0.01)) continue;
            const Deviation d = deviation_of(c, cells);
            MESSAGE("solid fraction " << c << ", " << d.cells << " cells: " << 100 * d.mean << " % ("
                                      << 100 * d.least << " to " << 100 * d.most << "), the radius lacks "
                                      << d.lacks << " cells");
            CHECK(d.lacks > -0.05);
            CHECK(d.lacks < 0.15);
            if (c < 0.2 && cells > 11) CHECK(std::abs(d.mean) < 0.021);
            if (c < 0.03 && cells > 7) CHECK(std::abs(d.mean) < 0.02);
        }
}
