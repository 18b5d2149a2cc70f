// Scenes where solvers of free surfaces fail, in the plane; docs/verification/water_stress.md has the table.
#include "stress_checks.hpp"

#include <algorithm>

using namespace abrade;

TEST_CASE("thin water on cut walls, slots, fronts that meet, walls that move: speed, energy, volume") {
    stress::check<2>(stress::plane_scenes());
}

TEST_CASE(
    "a droplet on a cylinder a nanometre aside: no rounding has drops hang in the air and gain energy") {
    const auto scenes = stress::plane_scenes();
    const auto found = std::find_if(scenes.begin(), scenes.end(),
                                    [](const auto& s) { return s.name == "droplet on a cylinder"; });
    REQUIRE(found != scenes.end());
    for (int n = 1; n <= 12; ++n) {
        stress::Scene<2> scene = *found;
        scene.params.water = [n](const Point<2>& x) {
            return 0.15 - (x - Point<2>(1.03 + 1e-9 * n, 1.5)).norm();
        };
        const stress::Outcome seen = stress::run<GridFluid<2>>(scene);
        CAPTURE(n);
        CHECK(seen.error == "");
        CHECK(seen.gained < 4e-3);  // 7 % and 15 % in two of twelve before drops moved evenly
    }
}

TEST_CASE("a brimful box walled off from its outflow is refused before its first step is over") {
    using P = Point<2>;
    GridFluid<2>::Params params{
        .grid = {.cells = {16, 8}, .spacing = P::Constant(stress::cell)},
        .boundaries = BoundaryConditions<2>::all(Boundary::wall),
        .boundary_velocity = [](const P& x, Real) { return P(x[0] < 0.01 ? 1e-4 : 0, 0); },
        .wall = [](const P& x) { return std::abs(x[0] - 0.6) - 0.06; },
        .water = [](const P&) { return 1.0; },
        .inflow_water = [](const P&) { return 1.0; },
        .gravity = {0, -stress::g}};
    params.boundaries[0] = {Boundary::inflow, Boundary::outflow};
    GridFluid<2> flow(params);
    const Real volume = flow.liquid().volume();
    CHECK_THROWS_WITH_AS(flow.step(flow.stable_step().seconds), doctest::Contains("can what flows in reach"),
                         FluidError);
    CHECK(flow.liquid().volume() == doctest::Approx(volume).epsilon(1e-12));
}
