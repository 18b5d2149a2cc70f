// Taylor-Green vortices in three dimensions at Re 1600 on coarse grids; finer ones in
// long_taylor_green_3d.cpp.
#include "taylor_green_3d.hpp"

#include <doctest/doctest.h>

using namespace taylor_green_3d;

TEST_CASE("an eighth between walls that glide is the whole") {
    auto whole = vortices<Central>(24, Part::whole), eighth = vortices<Central>(24);
    whole.advance(4), eighth.advance(4);
    MESSAGE("energy " << energy(whole) << " and " << energy(eighth));
    CHECK(energy(eighth) == doctest::Approx(energy(whole)).epsilon(1e-5).scale(0));  // tolerance: 1e-6 a step
    CHECK(dissipation(eighth) == doctest::Approx(dissipation(whole)).epsilon(1e-4).scale(0));
}

TEST_CASE("64 cells to the period: central fluxes make no energy and lose none") {
    auto flow = vortices<Central>(64);
    const std::vector<Sample> samples = decay(flow, 10);
    const Peak most = peak(samples);
    MESSAGE("most is lost at " << most.time << ": " << most.loss << "; off the direct simulation by "
                               << 100 * off(samples) << " % of its peak, root mean square");
    Real apart = 0;
    for (const Sample& s : samples)
        if (s.time > 0.15)  // the first step knows no pressure yet
            apart = std::max(apart, std::abs(s.loss / s.dissipation - 1));
    MESSAGE("loss and friction differ by " << 100 * apart << " % at most");
    CHECK(apart < 0.012);
    CHECK(off(samples) < 0.09);  // 8.5 % measured; the gates are those of 128 and 256 cells
}
