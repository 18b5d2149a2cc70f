// Stones that are fed, carried down an invert by uniform flow over standing concrete, and leave.
#include "states.hpp"

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/dem/laws/linear_hysteretic.hpp>
#include <abrade/fluid/uniform_flow.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

const Invert invert{.length = 1};

abrade::Scene channel() {
    abrade::Scene scene;
    scene.gravity = invert.gravity();
    scene.concrete = ConcreteBlock{.lattice = invert_lattice(invert, {.sphere_diameter = 0.04, .layers = 2}),
                                   .level = ConcreteLevel::quasi_static,
                                   .worn_out = WornOut::recedes};
    scene.add_wall({0, -0.5, 0}, {0, 1, 0}).add_wall({0, 0.5, 0}, {0, -1, 0});
    scene.feed = FeedParams{.volume_rate = 0.004,
                            .classes = {{0.04, 0.5, StoneShape::sphere}, {0.05, 0.5, StoneShape::angular}},
                            .region = {{0, -0.3, 0.02}, {0.15, 0.3, 0.15}},
                            .bed = [](Real, Real y) { return invert.bed_height(y); },
                            .velocity = {1.5, 0, 0}};
    scene.flow_counter = 0.4, scene.outlet = 0.8;
    return scene;
}
template <class Drag>
Numbers carried(const Drag& drag) {
    auto sim = simulate(channel())
                   .contact(LinearHysteretic{{.stiffness = 5e5, .restitution = 0.6, .friction = 0.5}})
                   .bond(MohrCoulomb{{.tensile = 2.7e6, .stiffness = 4e6}})
                   .wear(SubParticleAbrasion{{.acceleration = 1e4}})
                   .fluid(UniformFlow{{.section = invert, .discharge = 0.5}}, drag);
    sim.run({.end_time = 0.5});
    return state_of(sim).with({"fed", "passed", "left_kinetic", "worn", "drag_input", "lost_sliding"});
}

const Register drag{"flow.uniform", [] { return carried(CliftGauvin{{.shape_factor = 1.2}}); }};
const Register inertia{"flow.uniform_inertia", [] { return carried(WithInertia<>{}); }};

}  // namespace
