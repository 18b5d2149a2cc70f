// A surface that is a height in three dimensions: rest, a dam on a dry hill, the same bits for one thread and
// two.
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

#include "height_cells.hpp"

#include <cmath>

using namespace abrade;
using namespace height_cells;

namespace {

using Flow = GridFluid<3, HeightSurface>;
constexpr Real g = 9.81;

GridFluidParams<3> tank(int n, PlaceFunction<3> wall, PlaceFunction<3> water) {
    GridFluidParams<3> params{.grid = {.cells = {2 * n, n, n}, .spacing = Vec3::Constant(1.0 / n)},
                              .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                              .gravity = {0, 0, -g}};
    params.wall = std::move(wall);
    params.water = std::move(water);
    return params;
}

const PlaceFunction<3> hill = [](const Vec3& x) {
    return std::hypot(x[0] - 1, x[1] - 0.5, x[2] + 0.2) - 0.5;
};

}  // namespace

TEST_CASE("rest in a bowl, on a slope, around a pier and a hill") {
    for (const PlaceFunction<3>& wall :
         {PlaceFunction<3>([](const Vec3& x) {
              return 1.1 - std::hypot(x[0] - 1, x[1] - 0.5, std::min(x[2] - 1.2, 0.0));
          }),
          PlaceFunction<3>([](const Vec3& x) { return (x[2] - 0.4 * x[0] - 0.31 * x[1]) / 1.2; }),
          PlaceFunction<3>([](const Vec3& x) { return std::hypot(x[0] - 1, x[1] - 0.5) - 0.2; }), hill})
        for (const Real level : {0.5, 0.513}) {
            auto params = tank(16, wall, [level](const Vec3& x) { return level - x[2]; });
            params.tolerance = 1e-9;
            Flow flow(params);
            Real most = 0;
            while (flow.time() < 0.3) {
                flow.step(std::min(flow.stable_step().seconds, 0.02));
                most = std::max(most, fastest(flow));
            }
            CHECK(most < 1e-6 * std::sqrt(g * level));  // a hundred times what the tolerance leaves
        }
}

TEST_CASE("rest in an invert, its surface tilted with gravity") {
    constexpr Real slope = 0.05, depth = 0.097;
    GridFluidParams<3> params{
        .grid = {.cells = {12, 25, 6}, .low = {0, -0.5, 0}, .spacing = Vec3::Constant(0.04)},
        .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
        .wall = InvertWall({.length = 1, .width = 1, .arc_radius = 1, .slope = 0}),
        .gravity = {g * slope, 0, -g * std::sqrt(1 - slope * slope)},
        .tolerance = 1e-8};
    params.water = [gravity = params.gravity](const Vec3& x) {
        return (-gravity.z() * (depth - x.z()) + gravity.x() * x.x()) / g;
    };
    Flow flow(params);
    Real most = 0;
    while (flow.time() < 1) {
        flow.step(flow.stable_step().seconds);
        most = std::max(most, fastest(flow));
    }
    MESSAGE("tilted in an invert: " << most / std::sqrt(g * depth) << " sqrt(g h)");
    CHECK(most < 1e-6 * std::sqrt(g * depth));  // ten times what the tolerance leaves
}

TEST_CASE(
    "a dam that runs over a dry hill: volume to round-off, bounded speeds, the same bits for two threads") {
    const auto run = [](int threads) {
        const int before = thread_count();
        set_thread_count(threads);
        Flow flow(tank(16, hill, [](const Vec3& x) { return std::min(0.6 - x[2], 0.5 - x[0]); }));
        const Real volume = volume_in_cells(flow);
        Real most = 0, worst = 0;
        while (flow.time() < 0.8) {
            flow.step(flow.stable_step().seconds);
            most = std::max(most, fastest(flow));
            worst = std::max(worst, std::abs(volume_in_cells(flow) / volume - 1));
        }
        CHECK(worst < 1e-12);  // round-off of sums over some thousand cells in some hundred steps
        // Twice what it falls by: a dam runs ahead at 2 sqrt(g h), and splashes no faster.
        CHECK(most < 2 * std::sqrt(g * 0.6));
        set_thread_count(before);
        return flow;
    };
    const Flow one = run(1), two = run(2);
    bool equal = true;
    one.grid().for_each([&](const auto&, Offset c) {
        for (int a = 0; a < 3; ++a) equal = equal && one.velocity()[a][c] == two.velocity()[a][c];
        equal = equal && one.liquid().fraction()[c] == two.liquid().fraction()[c];
    });
    CHECK(equal);
}
