// What a user asks a flow: pressures, sections and levels are those of closed forms.
#include <abrade/fluid/flow_queries.hpp>
#include <abrade/fluid/grid_fluid.hpp>
#include <abrade/fluid/wall_loads.hpp>
#include <abrade/fluid/wall_solids.hpp>

#include <doctest/doctest.h>

#include <cmath>

#include "../message_of.hpp"

using namespace abrade;
TEST_CASE("x") {
    GridFluidParams<3> p{.grid = {.cells = {16, 16, 16}, .spacing = Vec3::Constant(1.0 / 16)},
                         .sides = Sides<3>::all(Side::slip), .wall = BallWall<3>({0.51, 0.49, 0.43}, 0.25),
                         .water = [](const Point<3>& x) { return 0.87 - x[2]; }, .gravity = {0, 0, -9.81}};
    GridFluid<3> flow(p);
    std::printf("%g %g\n", pressure_at(flow, {0.1, 0.1, 0.2}), 9810*0.67);
    auto l = wall_load(flow, {0.51, 0.49, 0.43});
    const Real displaced = 9810 * (1 - flow.walls()->total_volume());
    std::printf("%.12g %g %g displaced %.12g exact %g\n", l.pressure.force[2], l.pressure.force[0], l.pressure.force[1], displaced, 9810*4./3*pi*pow(.25,3));
    std::printf("moment %g %g %g area %g %g\n", l.pressure.moment[0], l.pressure.moment[1], l.pressure.moment[2], l.area, 4*pi*.0625);
    Load<3> sum = l.pressure;
    for (int a = 0; a < 3; ++a) for (bool h : {false,true}) sum += side_load(flow, {a,h}, {0,0,0}).pressure;
    std::printf("sum %g %g %g weight %g\n", sum.force[0], sum.force[1], sum.force[2], 9810*flow.liquid().volume());
    std::printf("gauge %g\n", gauge(flow, 0.3, 0.3));
}
