// All of it together: stones that are fed into an invert channel, which water flows around or over, with a
// mixing length below a height; concrete that stands and wears; what passes and what leaves.
#include "states.hpp"

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/coupling/exchange/monolithic.hpp>
#include <abrade/dem/laws/linear_hysteretic.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/setup/inflow.hpp>
#include <abrade/fluid/uniform_flow.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

using Flow = GridFluid<3, Among<MonolithicSolids<>, Turbulent<MixingLength, HeightSurface>>>;

const Invert invert{.length = 1};

Flow water() {
    const UniformFlow uniform{{.section = invert, .discharge = 0.5}};
    const Real depth = uniform.depth();
    GridFluidParams<3> params{
        .grid = {.cells = {20, 20, 12}, .low = {0, -0.5, 0}, .spacing = {0.05, 0.05, 0.04}},
        .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
        .wall = InvertWall(invert),
        .wall_law = {WallLaw::Kind::logarithmic, 3.5e-3},
        .gravity = invert.gravity(),
        .tolerance = 1e-5};
    params.boundaries[0][1] = Boundary::outflow;
    Inflow<3>({.discharge = 0.5,
               .depth = depth,
               .section = invert,
               .profile = InflowProfile::logarithmic,
               .roughness = 3.5e-3})
        .give_to(params);
    params.water = [depth](const Vec3& x) { return depth - x.z(); };
    params.velocity = [speed = uniform.mean_velocity()](const Vec3&) { return Vec3(speed, 0, 0); };
    params.start_time = -0.02;
    return Flow(params, MixingLength{{.depth = depth, .friction_velocity = uniform.friction_velocity()}},
                MonolithicSolids<>({.resolved_from = 2.5}));
}

Numbers run() {
    abrade::Scene scene;
    scene.gravity = invert.gravity();
    scene.concrete = ConcreteBlock{.lattice = invert_lattice(invert, {.sphere_diameter = 0.04, .layers = 2}),
                                   .level = ConcreteLevel::quasi_static,
                                   .worn_out = WornOut::recedes};
    scene.add_wall({0, -0.5, 0}, {0, 1, 0}).add_wall({0, 0.5, 0}, {0, -1, 0});
    scene.feed = FeedParams{.volume_rate = 0.02,
                            .classes = {{0.06, 0.6, StoneShape::angular}, {0.14, 0.4, StoneShape::ellipsoid}},
                            .region = {{0.1, -0.3, 0.01}, {0.35, 0.3, 0.2}},
                            .bed = [](Real, Real y) { return invert.bed_height(y); },
                            .velocity = {2, 0, -1}};
    scene.flow_counter = 0.45, scene.outlet = 0.65;
    Flow flow = water();
    flow.open_energy_account();
    auto sim = simulate(scene)
                   .contact(LinearHysteretic{{.stiffness = 3e5, .restitution = 0.6, .friction = 0.5}})
                   .bond(MohrCoulomb{{.tensile = 2.7e6, .stiffness = 4e6}})
                   .wear(SubParticleAbrasion{{.acceleration = 1e3}})
                   .fluid(std::move(flow));
    sim.run({.end_time = 0.5});
    return state_of(sim).with({"fed", "passed", "left_kinetic", "worn", "flow_work", "eddies", "averaged"});
}

const Register channel{"whole.channel", run};

}  // namespace
