// Laws around a law: resistance to rolling, and films of liquid between surfaces.
#include "../verification/ledger_scenes.hpp"
#include "states.hpp"

#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/dem/laws/lubrication.hpp>
#include <abrade/dem/laws/rolling_resistance.hpp>

using namespace same_bits;
using namespace ledger_scenes;

namespace {

using Rolling = RollingResistance<LinearSpring>;
using Film = Lubricated<LinearSpring>;
constexpr LinearSpring::Params spring{.stiffness = 5e5, .restitution = 0.7, .friction = 0.4};

/// Spheres that roll down a plane at an angle, over fixed ones.
Numbers roll(Rolling::Model model) {
    abrade::Scene scene;
    scene.gravity = {3, 0.5, -9};
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    for (int n = 0; n < 12; ++n) {
        scene.add_sphere(0.01 + 3e-4 * n, {.position = {0.03 * (n % 4), 0.03 * (n / 4), 0.014}});
        scene.add_fixed(make_clump("bump", {{Vec3::Zero(), 0.004}}),
                        {0.1 + 0.02 * n, 0.013 * (n % 7), 0.001});
    }
    auto sim = simulate(scene).contact(Rolling{{.contact = spring, .friction = 0.1, .model = model}});
    sim.run({.end_time = 0.25});
    return state_of(sim).with({"lost_rolling", "lost_sliding"});
}
Numbers film() {
    auto sim = simulate(gas(4)).contact(
        Film{{.contact = spring, .viscosity = 0.05, .range = 2e-3, .roughness = 5e-5}});
    sim.run({.end_time = 0.05});
    return state_of(sim).with({"lost_film", "lost_normal"});
}

const Register springs{"grains.rolling_resistance", [] { return roll(Rolling::Model::elastic_plastic); }};
const Register constant{"grains.rolling_constant_torque",
                        [] { return roll(Rolling::Model::constant_torque); }};
const Register lubricated{"grains.lubrication", film};

}  // namespace
