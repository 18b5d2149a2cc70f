// Scenes where solvers of free surfaces fail, in the plane; docs/water_stress.md has the table.
#include "stress_checks.hpp"

using namespace abrade;

TEST_CASE("thin water on cut walls, slots, fronts that meet, walls that move: speed, energy, volume") {
    stress::check<2>(stress::plane_scenes());
}

TEST_CASE("a brimful box walled off from its outflow is refused before its first step is over") {
    using P = Point<2>;
    GridFluid<2>::Params params{
        .grid = {.cells = {16, 8}, .spacing = P::Constant(stress::cell)},
        .sides = Sides<2>::all(Side::wall),
        .side_velocity = [](const P& x, Real) { return P(x[0] < 0.01 ? 1e-4 : 0, 0); },
        .wall = [](const P& x) { return std::abs(x[0] - 0.6) - 0.06; },
        .water = [](const P&) { return 1.0; },
        .inflow_water = [](const P&) { return 1.0; },
        .gravity = {0, -stress::g}};
    params.sides[0] = {Side::inflow, Side::outflow};
    GridFluid<2> flow(params);
    const Real volume = flow.liquid().volume();
    CHECK_THROWS_WITH_AS(flow.step(flow.stable_step().seconds), doctest::Contains("can what flows in reach"),
                         FluidError);
    CHECK(flow.liquid().volume() == doctest::Approx(volume).epsilon(1e-12));
}
