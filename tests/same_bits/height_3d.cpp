// Water in three dimensions below a height: pools that sway, over beds and against walls; with eddies.
#include "states.hpp"

#include <abrade/fluid/embedded_boundary/solid_shapes.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

GridFluidParams<3> tank(int along = 24) {
    GridFluidParams<3> params{.grid = {.cells = {along, 14, 12}, .spacing = Vec3::Constant(0.05)},
                              .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                              .gravity = {0, 0, -9.81}};
    params.water = [](const Vec3& x) {
        return 0.22 + 0.18 / (1 + std::exp(10 * (x.x() - 0.5 + 0.2 * x.y()))) - x.z();
    };
    return params;
}
template <class Turbulence>
Numbers run(const GridFluidParams<3>& params, const Turbulence& turbulence) {
    GridFluid<3, Turbulent<Turbulence, HeightSurface>> flow(params, turbulence);
    flow.open_energy_account();
    flow.advance(0.5);
    return state_of_water(flow).with({"fastest water", "water numerical"});
}

const Register dam{"water3.height_dam", [] { return run(tank(), NoTurbulence{}); }};
/// So long that threads share it.
const Register longer{"water3.height_long", [] { return run(tank(100), NoTurbulence{}); }};
const Register bed{"water3.height_bed", [] {
                       auto params = tank();
                       params.wall = BallWall<3>({0.75, 0.33, -0.4}, 0.51);
                       params.wall_law = {WallLaw::Kind::logarithmic, 0.004};
                       return run(params, Smagorinsky{}).with({"eddies", "water wall_friction"});
                   }};

}  // namespace
