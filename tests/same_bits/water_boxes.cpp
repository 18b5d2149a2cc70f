// Water that fills a box of two dimensions: a cavity by each advection scheme, and what flows through.
#include "states.hpp"

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

/// A lid that moves along on top of a square.
template <class Scheme>
Numbers cavity() {
    GridFluid<2, Advected<Scheme, FullBox>> flow(
        {.grid = {.cells = {24, 24}, .spacing = {1.0 / 24, 1.0 / 24}},
         .boundary_velocity = [](const Point<2>& x, Real) { return Point<2>(x[1] >= 1 ? 1 : 0, 0); },
         .density = 1,
         .viscosity = 5e-3});
    flow.open_energy_account();
    flow.advance(1);
    return state_of_water(flow).with({"fastest water", "water viscous", "water boundaries", "water numerical"});
}

/// In at one side, out at the other, with a force that swings.
Numbers through_flow() {
    GridFluidParams<2> params{
        .grid = {.cells = {30, 16}, .spacing = {0.1, 0.1}}, .density = 1000, .viscosity = 5};
    params.boundaries[0] = {Boundary::inflow, Boundary::outflow};
    params.boundary_velocity = [](const Point<2>& x, Real t) {
        return Point<2>(x[0] < 0.05 ? x[1] * (1.6 - x[1]) * (1 + 0.3 * std::sin(8 * t)) : 0, 0);
    };
    params.steady_boundaries = false;
    params.body_force = [](Real t) { return Point<2>(0.1 * std::sin(5 * t), 0.05); };
    GridFluid<2, FullBox> flow(params);
    flow.open_energy_account();
    flow.advance(1.5);
    return state_of_water(flow).with({"fastest water", "water inflow", "water outflow", "water body_force"});
}

const Register upwind{"water2.cavity_upwind", cavity<Upwind>};
const Register central{"water2.cavity_central", cavity<Central>};
const Register limited{"water2.cavity_limited", cavity<Koren>};
const Register through{"water2.through_flow", through_flow};

}  // namespace
