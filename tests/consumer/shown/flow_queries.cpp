#include <abrade/fluid/embedded_boundary/solid_shapes.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/queries/flow_queries.hpp>
#include <abrade/fluid/queries/wall_loads.hpp>
#include <iostream>

using namespace abrade;

int main() {
    // A stream of 4 m/s, 0.5 m deep, meets a round pier.
    GridFluidParams<3> params{.grid = {.cells = {20, 10, 14}, .spacing = {0.1, 0.1, 0.1}},
                              .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                              .gravity = {0, 0, -9.81}};
    params.wall =
        CylinderWall({1.2, 0.5, -1}, {1.2, 0.5, 2}, 0.15);  // BoxWall, BallWall, MeshWall, PlaneWall
    params.boundaries[0] = {Boundary::inflow, Boundary::outflow};
    params.boundary_velocity = [](const Point<3>&, Real) { return Point<3>(4, 0, 0); };
    params.water = params.inflow_water = [](const Point<3>& x) { return 0.5 - x.z(); };
    params.velocity = [](const Point<3>&) { return Point<3>(4, 0, 0); };
    GridFluid<3> flow(params);
    flow.advance(0.5);

    const Real in_the_water = pressure_at(flow, {0.3, 0.5, 0.1});       // [Pa]
    const Real at_the_nose = pressure_on_wall(flow, {1.05, 0.5, 0.1});  // [Pa]

    const Point<3> foot(1.2, 0.5, 0);
    const WallLoad<3> pier = wall_load(flow, foot);  // about its foot
    const WallLoad<3> lower_half = wall_load(flow, foot, WithinBox<3>{{1, 0, 0}, {1.4, 1, 0.3}});
    const WallLoad<3> floor = side_load(flow, {.axis = 2, .high = false}, foot);

    const FlowSection through = section(flow, 0, 0.4);  // across x, at x = 0.4 m
    const Real level = gauge(flow, 1.0, 0.5);           // [m]

    std::cout << "pressure " << in_the_water << " and, on the pier, " << at_the_nose << " Pa\n"
              << "force " << pier.total().force.transpose() << " N, of that on its lower part "
              << lower_half.total().force.x() << " N; moment " << pier.total().moment.transpose() << " N m\n"
              << "weight on the floor " << -floor.pressure.force.z() << " N\n"
              << "discharge " << through.discharge << " m3/s, power " << through.energy << " W, area "
              << through.area << " m2, speed " << through.mean_velocity() << " m/s, depth "
              << through.mean_depth() << " m, head " << through.energy_head() << " m\n"
              << "level before the pier " << level << " m\n";
}
