// Water at rest in an invert, its surface on the curved bed: level and tilted, in a section and in space.
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

constexpr Real g = 9.81;

/// Fastest in a second, over sqrt(g h); gravity leans by `slope` (a sine) along x, across in two dimensions.
template <int Dim>
Real unrest(Real spacing, Real depth, Real slope) {
    GridFluidParams<Dim> params;
    params.grid.spacing = Point<Dim>::Constant(spacing);
    params.grid.cells.fill(static_cast<int>(std::lround(1 / spacing)));
    params.grid.cells[Dim - 1] = static_cast<int>(std::lround(0.24 / spacing));
    if constexpr (Dim == 3) params.grid.cells[0] = 12;
    params.grid.low[Dim - 2] = -0.5;
    params.boundaries = BoundaryConditions<Dim>::all(Boundary::free_slip);
    params.wall = InvertWall({.length = 1, .width = 1, .arc_radius = 1, .slope = 0});
    params.gravity[0] = g * slope, params.gravity[Dim - 1] = -g * std::sqrt(1 - square(slope));
    params.water = [across = params.gravity, depth](const Point<Dim>& x) {
        return (-across[Dim - 1] * (depth - x[Dim - 1]) + across[0] * x[0]) / g;
    };
    params.tolerance = 1e-8;
    GridFluid<Dim> flow(params);
    Real most = 0;
    while (flow.time() < 1) {
        flow.step(flow.stable_step().seconds);
        flow.grid().for_each([&](const auto&, Offset c) {
            if (flow.liquid().fraction()[c] > 0)
                for (const auto& u : flow.velocity()) most = std::max(most, std::abs(u[c]));
        });
    }
    return most / std::sqrt(g * depth);
}

}  // namespace

TEST_CASE("water that ends on a curved bed rests") {
    for (const Real depth : {0.073, 0.097})
        for (const Real slope : {0.0, 0.05}) {
            const Real section = unrest<2>(0.02, depth, slope);
            MESSAGE(depth << " m deep, tilted by " << slope << ": " << section << " sqrt(g h)");
            CHECK(section < 1e-6);
        }
    const Real space = unrest<3>(0.04, 0.097, 0.05);
    MESSAGE("in space: " << space << " sqrt(g h)");
    CHECK(space < 1e-6);
}
