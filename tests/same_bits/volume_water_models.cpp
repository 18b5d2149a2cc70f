// Volume of fluid in two dimensions by other advection schemes, and with eddies.
#include "states.hpp"

#include <abrade/fluid/embedded_boundary/solid_shapes.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

template <class Scheme, class Turbulence>
Numbers dam(const Turbulence& turbulence) {
    GridFluidParams<2> params{.grid = {.cells = {36, 24}, .spacing = {0.05, 0.05}}};
    params.gravity = {0, -9.81};
    params.wall = BallWall<2>({1.0, 0.1}, 0.22);
    params.wall_law = {WallLaw::Kind::logarithmic, 0.01};
    params.water = [](const Point<2>& x) { return std::min(0.6 - x[0], 0.9 - x[1]); };
    GridFluid<2, Turbulent<Turbulence, Advected<Scheme, FreeSurface>>> flow(params, turbulence);
    flow.open_energy_account();
    flow.advance(0.6);
    return state_of_water(flow).with({"fastest water", "water viscous"});
}

const Register upwind{"water2.volume_upwind", [] { return dam<Upwind>(NoTurbulence{}); }};
const Register mixing{"water2.volume_mixing_length", [] {
                          return dam<Koren>(MixingLength{{.depth = 0.5}}).with({"eddies", "water turbulent"});
                      }};

}  // namespace
