// Water in two dimensions below a surface that is a height.
#include "states.hpp"

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/setup/inflow.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

using P = Point<2>;
using Flow = GridFluid<2, HeightSurface>;

GridFluidParams<2> tank(int along, int up) {
    GridFluidParams<2> params{.grid = {.cells = {along, up}, .spacing = {0.05, 0.05}},
                              .boundaries = BoundaryConditions<2>::all(Boundary::free_slip)};
    params.gravity = {0, -9.81};
    return params;
}
/// A step of water runs along a pool over a sloping bed.
Numbers dam() {
    auto params = tank(48, 16);
    params.wall = [](const P& x) { return (x[1] - 0.08 * x[0] - 0.013) / 1.01; };
    params.wall_law = {WallLaw::Kind::logarithmic, 0.005};
    params.water = [](const P& x) { return 0.3 + 0.15 / (1 + std::exp(12 * (x[0] - 0.8))) - x[1]; };
    Flow flow(params);
    flow.open_energy_account();
    flow.advance(0.8);
    return state_of_water(flow).with({"fastest water", "water numerical", "water wall_friction"});
}
/// Onto a dry bed.
Numbers onto_dry() {
    auto params = tank(48, 16);
    params.gravity = {0.5, -9.81};
    params.water = [](const P& x) { return 0.3 / (1 + std::exp(6 * (x[0] - 0.8))) - 0.02 - x[1]; };
    Flow flow(params);
    flow.open_energy_account();
    flow.advance(0.5);
    return state_of_water(flow).with({"fastest water"});
}
/// A stream faster than its waves, over a hump.
Numbers stream() {
    auto params = tank(40, 12);
    params.boundaries[0][1] = Boundary::outflow;
    params.wall = [](const P& x) { return (x[1] - 0.05 * std::exp(-20 * (x[0] - 1) * (x[0] - 1))) / 1.03; };
    Inflow<2>({.discharge = 0.6, .depth = 0.22}).give_to(params);
    params.water = [](const P& x) { return 0.22 - x[1]; };
    Flow flow(params);
    flow.open_energy_account();
    flow.advance(0.8);
    return state_of_water(flow).with({"fastest water", "water inflow", "water outflow"});
}

const Register step{"water2.height_dam", dam};
const Register dry{"water2.height_dry_bed", onto_dry};
const Register fast{"water2.height_stream", stream};

}  // namespace
