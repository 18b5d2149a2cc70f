// A reach of the invert channel: logarithmic inflow, rough walls, a mixing length, outflow.
#include "states.hpp"

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/setup/inflow.hpp>
#include <abrade/fluid/uniform_flow.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

constexpr Real h = 0.05;

GridFluidParams<3> channel(const UniformFlow& uniform) {
    const Invert& invert = uniform.params().section;
    const Real depth = uniform.depth();
    GridFluidParams<3> params{
        .grid = {.cells = {16, 20, 10}, .low = {0, -0.5, 0}, .spacing = Vec3::Constant(h)},
        .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
        .wall = InvertWall(invert),
        .wall_law = {WallLaw::Kind::logarithmic, 3.5e-3},
        .gravity = invert.gravity(),
        .tolerance = 1e-5};
    params.boundaries[0][1] = Boundary::outflow;
    Inflow<3>({.discharge = uniform.params().discharge,
               .depth = depth,
               .section = invert,
               .profile = InflowProfile::logarithmic,
               .roughness = 3.5e-3})
        .give_to(params);
    params.water = [depth](const Vec3& x) { return depth + 0.03 * std::cos(8 * x.x()) - x.z(); };
    params.velocity = [uniform, depth](const Vec3& x) {
        return Vec3(uniform.sample({0, x.y(), std::min(x.z(), depth)}, 0).velocity.x(), 0, 0);
    };
    return params;
}
template <class Surface>
Numbers run() {
    const UniformFlow uniform{{.section = {.length = 0.8}, .discharge = 0.5}};
    GridFluid<3, Turbulent<MixingLength, Surface>> flow(
        channel(uniform),
        MixingLength{{.depth = uniform.depth(), .friction_velocity = uniform.friction_velocity()}});
    flow.open_energy_account();
    flow.advance(0.2);
    return state_of_water(flow).with(
        {"fastest water", "eddies", "water inflow", "water outflow", "water turbulent"});
}

const Register volume{"water3.volume_channel", run<FreeSurface>};

}  // namespace
