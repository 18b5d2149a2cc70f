// Spheres that collide: springs, and springs that yield.
#include "../verification/ledger_scenes.hpp"
#include "states.hpp"

#include <abrade/dem/laws/linear_hysteretic.hpp>
#include <abrade/dem/laws/linear_spring.hpp>

using namespace same_bits;
using namespace ledger_scenes;

namespace {

/// A gas in periodic space, under a weight that pulls it sideways.
template <class Law>
Numbers gas_of(const Law& law, Real end, int side = 5) {
    abrade::Scene scene = gas(side);
    scene.gravity = {0.3, 0.1, -9.81};
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = end});
    return state_of(sim).with({"lost_normal", "lost_sliding", "stored_contacts"});
}

/// A heap that comes to rest and goes to sleep, and a stone that wakes some of it.
Numbers sleeping_heap() {
    abrade::Scene scene;
    scene.periodic_along = {true, true, false};
    scene.bounds = {{0, 0, -1}, {0.1, 0.1, 2}};
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    Random random(5);
    for (int n = 0; n < 48; ++n) {
        const Vec3 aside = 1e-3 * random.in_cube();
        scene.add_sphere(0.01,
                         {.position = 0.0212 * Vec3(n % 4 + 0.5, n / 4 % 4 + 0.5, n / 16 + 0.5) + aside});
    }
    scene.add_sphere(0.01, {.position = {0.03, 0.02, 0.9}});
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 5e4, .restitution = 0.3, .friction = 0.5}});
    sim.run({.end_time = 0.45, .time_step = 2e-5, .sleep_speed = 0.02, .sleep_after = 0.02});
    return state_of(sim).with({"lost_asleep", "lost_sliding"});
}

const Register spring{
    "grains.linear_spring",
    [] { return gas_of(LinearSpring{{.stiffness = 5e5, .restitution = 0.8, .friction = 0.3}}, 0.04); }};
/// So many that threads share them.
const Register many{
    "grains.many",
    [] { return gas_of(LinearSpring{{.stiffness = 5e5, .restitution = 0.8, .friction = 0.3}}, 0.02, 11); }};
const Register hysteretic{
    "grains.linear_hysteretic",
    [] { return gas_of(LinearHysteretic{{.stiffness = 5e5, .restitution = 0.6, .friction = 0.4}}, 0.04); }};
const Register asleep{"grains.sleeping_heap", sleeping_heap};

}  // namespace
