// Water in two dimensions below a surface by volume of fluid: dams, walls that cut cells and their friction,
// waves in a tank that moves, levels of uneven height, what leaves and what flows in.
#include "states.hpp"

#include <abrade/fluid/embedded_boundary/solid_shapes.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/queries/flow_queries.hpp>
#include <abrade/fluid/queries/wall_loads.hpp>
#include <abrade/fluid/setup/inflow.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

using P = Point<2>;
constexpr Real h = 0.05;

GridFluidParams<2> tank(int along, int up) {
    GridFluidParams<2> params{.grid = {.cells = {along, up}, .spacing = {h, h}},
                              .boundaries = BoundaryConditions<2>::all(Boundary::free_slip)};
    params.gravity = {0, -9.81};
    return params;
}

/// A dam that breaks onto a disc and a step, held by walls as the law says; then what walls and gauges feel.
Numbers dam_on_walls(const WallLaw& law) {
    auto params = tank(40, 24);
    params.boundaries = BoundaryConditions<2>::all(Boundary::wall);
    params.wall = WallUnion(BallWall<2>({1.1, 0.2}, 0.22), BoxWall<2>({1.53, -1}, {1.9, 0.17}));
    params.wall_law = law;
    params.water = [](const P& x) { return std::min(0.6 - x[0], 0.9 - x[1]); };
    GridFluid<2> flow(params);
    flow.open_energy_account();
    flow.advance(0.7);
    Numbers numbers = state_of_water(flow);
    numbers.kind("asked");
    for (const Real x : {0.3, 0.9, 1.4, 1.95}) {
        numbers.add(section(flow, 0, x).discharge), numbers.add(section(flow, 0, x).energy);
        numbers.add(gauge(flow, x));
        numbers.add(pressure_at(flow, {x, 0.43})), numbers.add(pressure_on_wall(flow, {x, 0.0}));
    }
    const auto load = wall_load(flow, {1, 0});
    numbers.add_vector(load.pressure.force), numbers.add_vector(load.shear.force),
        numbers.add_vector(load.total().moment);
    numbers.add(load.wetted), numbers.figure("wall load", load.pressure.force.norm());
    return std::move(numbers).with({"fastest water", "water numerical", "wall load"});
}
/// A wave on a beach, in a tank that is shaken, in cells that grow upwards.
Numbers shaken() {
    auto params = tank(40, 16);
    params.grid.levels = {0};
    for (int k = 0; k < 16; ++k) params.grid.levels.push_back(params.grid.levels.back() + 0.03 + 0.003 * k);
    params.wall = [](const P& x) { return (x[1] - 0.3 * (x[0] - 1.2)) / 1.05; };
    params.water = [](const P& x) { return 0.4 + 0.05 * std::cos(3 * x[0]) - x[1]; };
    params.body_force = [](Real t) { return P(0.8 * std::sin(6 * t), 0); };
    GridFluid<2> flow(params);
    flow.open_energy_account();
    flow.advance(0.8);
    return state_of_water(flow).with({"fastest water", "water body_force"});
}
/// A stream over a hump, faster than its waves.
Numbers stream() {
    auto params = tank(40, 16);
    params.boundaries[0][1] = Boundary::outflow;
    params.wall = BallWall<2>({1.0, -0.5}, 0.58);
    Inflow<2>({.discharge = 0.6, .depth = 0.22, .profile = InflowProfile::logarithmic, .roughness = 0.01})
        .give_to(params);
    params.water = [](const P& x) { return 0.22 - x[1]; };
    GridFluid<2> flow(params);
    flow.open_energy_account();
    flow.advance(0.8);
    return state_of_water(flow).with({"fastest water", "water inflow", "water outflow"});
}
/// A slower one that leaves at a level, by periodic weight along the bed.
Numbers level_beyond() {
    auto params = tank(30, 16);
    params.boundaries[0][1] = Boundary::outflow;
    Inflow<2>({.discharge = 0.2, .depth = 0.5}).give_to(params);
    params.water = params.outflow_water = [](const P& x) { return 0.48 - x[1]; };
    GridFluid<2> flow(params);
    flow.advance(0.8);
    return state_of_water(flow).with({"fastest water"});
}
/// A drop falls into a pool that goes on beyond its sides.
Numbers drop() {
    auto params = tank(28, 28);
    params.boundaries[0] = {Boundary::periodic, Boundary::periodic};
    params.gravity = {0.5, -9.81};
    params.water = [](const P& x) { return std::max(0.4 - x[1], 0.15 - (x - P(0.7, 0.9)).norm()); };
    GridFluid<2> flow(params);
    flow.open_energy_account();
    flow.advance(0.45);
    return state_of_water(flow).with({"fastest water", "water body_force"});
}
/// A bed that sinks below a swaying pool.
Numbers sinking_bed() {
    auto params = tank(24, 20);
    const auto bed_at = [](Real z) { return [z](const P& x) { return x[1] - z - 0.1 * x[0]; }; };
    params.wall = bed_at(0.23);
    params.water = [](const P& x) { return 0.6 + 0.05 * x[0] - x[1]; };
    GridFluid<2> flow(params);
    flow.open_energy_account();
    for (int n = 1; n <= 10; ++n) {
        flow.set_wall(bed_at(0.23 - 0.006 * n));
        flow.advance(0.03 * n);
    }
    return state_of_water(flow).with({"fastest water", "water reshaped"});
}

using Kind = WallLaw::Kind;
const Register no_slip{"water2.volume_dam_no_slip", [] { return dam_on_walls({Kind::no_slip}); }};
const Register slip{"water2.volume_dam_slip", [] { return dam_on_walls({Kind::slip}); }};
const Register rough{"water2.volume_dam_rough", [] { return dam_on_walls({Kind::logarithmic, 0.01}); }};
const Register shake{"water2.volume_shaken", shaken};
const Register fast{"water2.volume_stream", stream};
const Register slow{"water2.volume_level", level_beyond};
const Register droplet{"water2.volume_drop", drop};
const Register worn{"water2.volume_sinking_bed", sinking_bed};

}  // namespace
