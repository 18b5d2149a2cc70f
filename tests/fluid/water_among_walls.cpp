// Water in cells that walls cut: closed forms, and what lies on both sides of a surface.
#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>
#include <abrade/fluid/vof/liquid_in_cut_cells.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

template <int Dim>
Real share(const auto& wall, const auto& water) {
    typename Grid<Dim>::Params params;
    params.cells.fill(1), params.spacing = Point<Dim>::Ones();
    const Grid<Dim> grid(params);
    const EmbeddedBoundary<Dim> walls(grid, wall, {.closed_below = 0, .bounded_slope = false});
    const Offset cell = grid.layout().at({});
    return detail::WaterAmongWalls<Dim>::share(walls.aperture(), grid.layout().stride, cell,
                                               walls.open_fraction()[cell], water);
}

}  // namespace

TEST_CASE("planes that cross in a cell") {
    const auto slope = [](const auto& x) { return x[0] + x[1] - 0.5; };  // leaves 7/8
    CHECK(share<2>(slope, [](const auto& x) { return 0.5 - x[1]; }) == doctest::Approx(3.0 / 7));
    CHECK(share<2>(slope, [](const auto& x) { return 1.0 + 0 * x[1]; }) == doctest::Approx(1));
    CHECK(share<2>(slope, [](const auto& x) { return -1.0 + 0 * x[1]; }) == 0);
    CHECK(share<2>([](const auto& x) { return x[0] - 0.3; }, [](const auto& x) { return 0.23 - x[1]; }) ==
          doctest::Approx(0.23));
    CHECK(share<3>(slope, [](const auto& x) { return 0.25 - x[2]; }) == doctest::Approx(0.25));
    // Half of the cube, and the sixth at its corner.
    CHECK(share<3>([](const auto& x) { return 1 - x[0] - x[1]; },
                   [](const auto& x) { return 1 - x[0] - x[1] - x[2]; }) == doctest::Approx(1.0 / 3));
}

TEST_CASE("what is above a surface and what is below it are all that is open") {
    std::mt19937 random(3);
    std::normal_distribution<Real> normal;
    for (int trial = 0; trial < 200; ++trial) {
        const Vec3 n(normal(random), normal(random), normal(random)),
            m(normal(random), normal(random), normal(random));
        const Vec3 centre = Vec3::Constant(0.5);
        const auto wall = [&](const Vec3& x) { return n.dot(x - centre) + 0.1; };
        const auto water = [&](const Vec3& x) { return m.dot(x - centre) + 0.2; };
        const auto air = [&](const Vec3& x) { return -water(x); };
        CHECK(share<3>(wall, water) + share<3>(wall, air) == doctest::Approx(1).epsilon(1e-13));
    }
}
