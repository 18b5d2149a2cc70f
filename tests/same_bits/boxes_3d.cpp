// Water that fills a box of three dimensions: in double and in single precision, with eddies.
#include "states.hpp"

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

template <class Scheme, class State, class Turbulence>
Numbers cavity(const Turbulence& turbulence, int along = 14) {
    GridFluidParams<3> params{.grid = {.cells = {along, 12, 16}, .spacing = {1.0 / 14, 1.0 / 12, 1.0 / 16}},
                              .density = 1,
                              .viscosity = 2e-3};
    params.boundary_velocity = [](const Vec3& x, Real) {
        return Vec3(x.z() >= 1 ? 1 : 0, x.z() >= 1 ? 0.3 : 0, 0);
    };
    GridFluid<3, Turbulent<Turbulence, InPrecision<State, Advected<Scheme, FullBox>>>> flow(params,
                                                                                            turbulence);
    flow.open_energy_account();
    flow.advance(1.5);
    return state_of_water(flow).with({"fastest water", "water viscous", "water numerical"});
}

const Register box{"water3.cavity", [] { return cavity<Koren, Real>(NoTurbulence{}); }};
/// So long that threads share it.
const Register longer{"water3.cavity_long", [] { return cavity<Koren, Real>(NoTurbulence{}, 80); }};
/// Between programs of other instruction sets single precision keeps six digits.
const Register single{"water3.cavity_float", [] { return cavity<Central, float>(NoTurbulence{}); }, 1e-4};
const Register eddies{"water3.cavity_smagorinsky",
                      [] { return cavity<Koren, Real>(Smagorinsky{{.constant = 0.17}}).with({"eddies"}); }};

}  // namespace
