// Concrete that stands and wears: what becomes of spheres that are worn out, and of wear without a sphere
// left.
#include "states.hpp"

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/geometry/surface_lattice.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

const LinearSpring law{{.stiffness = 1e6, .restitution = 0.5, .friction = 0.4}};
constexpr Real d = 0.02;

/// In space that repeats itself: stones come back to what they have worn.
abrade::Scene under_stones(ConcreteBlock concrete) {
    abrade::Scene scene;
    scene.periodic_along = {true, true, false};
    scene.bounds.low.head<2>().setConstant(-0.1), scene.bounds.high.head<2>().setConstant(0.1);
    scene.concrete = std::move(concrete);
    scene.add_stone(make_stone(StoneShape::angular, 0.05),
                    {.position = {-0.05, 0.01, 0.04}, .velocity = {1, 0, -2}});
    scene.add_sphere(0.02, {.position = {0.04, -0.02, 0.03}, .velocity = {-1, 0.4, -3}});
    scene.add_sphere(0.02, {.position = {0.05, 0.04, 0.05}, .velocity = {-2, 0.4, -2}});
    return scene;
}
Numbers wear_down(ConcreteBlock concrete, Real acceleration, std::initializer_list<std::string_view> shown,
                  Real end = 0.4) {
    auto sim = simulate(under_stones(std::move(concrete)))
                   .contact(law)
                   .bond(MohrCoulomb{{.tensile = 2.7e6, .stiffness = 4e6}})
                   .wear(SubParticleAbrasion{{.acceleration = acceleration}});
    sim.run({.end_time = end});
    return state_of(sim).with({"worn", "lost_sliding"}).with(shown);
}
Lattice slab() { return flat_lattice(0.2, 0.2, {.sphere_diameter = d, .layers = 4}); }
Lattice dune() {
    return lattice_under([](Real x, Real y) { return 0.02 * std::sin(20 * x) * std::cos(10 * y) - 0.02; },
                         0.2, 0.2, {.sphere_diameter = d, .layers = 3});
}
ConcreteBlock standing(WornOut worn_out, Overflow overflow = FillCrater{}) {
    return {
        .lattice = slab(), .level = ConcreteLevel::quasi_static, .worn_out = worn_out, .overflow = overflow};
}

const Register fines{"wear.fines", [] { return wear_down(standing(WornOut::fines), 3e3, {"gone"}); }};
const Register grain{"wear.grain", [] { return wear_down(standing(WornOut::grain), 3e3, {"gone"}); }};
const Register recedes{"wear.recedes", [] { return wear_down(standing(WornOut::recedes), 3e3, {"gone"}); }};
const Register recorded{"wear.recorded", [] { return wear_down(standing(WornOut::recorded), 3e3, {}); }};
const Register patch{"wear.patch", [] {
                         return wear_down(standing(WornOut::fines, SpreadOverPatch{0.06, 0.06}), 3e3, {});
                     }};
const Register epoch{"wear.epoch", [] {
                         return wear_down(standing(WornOut::recedes, SpreadByEpoch{0.06, 0.02}), 3e3, {});
                     }};
const Register dropped{"wear.dropped_overflow",
                       [] { return wear_down(standing(WornOut::fines, DropOverflow{}), 3e3, {"overflow"}); }};
const Register rigid{
    "wear.rigid_dune", [] {
        return wear_down(
            {.lattice = dune(), .fracture_volume = FractureVolume::sphere, .level = ConcreteLevel::rigid},
            2e3, {});
    }};
const Register dynamic{"wear.dynamic", [] {
                           return wear_down(
                               {.lattice = flat_lattice(0.2, 0.2, {.sphere_diameter = d, .layers = 3})}, 6e3,
                               {"gone"}, 0.1);
                       }};

/// A row that sticks out of a wall: equilibrium lets spheres go, together with their neighbours.
Numbers row() {
    std::vector<Vec3> centres;
    for (int n = 0; n < 10; ++n) centres.push_back({d * (n % 5), d * (n / 5), 0});
    abrade::Scene scene;
    scene.concrete = ConcreteBlock{.lattice = lattice_of(centres, 0.5 * d, 10 * cube(d)),
                                   .level = ConcreteLevel::quasi_static,
                                   .cluster = 1};
    for (const std::size_t n : {0u, 5u}) scene.concrete->lattice.sites[n].held = true;
    scene.add_sphere(0.015, {.position = {2 * d, 0.4 * d, 0.03}, .velocity = {0, 0, -1}});
    auto sim = simulate(scene)
                   .contact(law)
                   .bond(MohrCoulomb{{.tensile = 2e4, .stiffness = 4e6}})
                   .wear(SubParticleAbrasion{{.acceleration = 100}});
    sim.run({.end_time = 0.03});
    return state_of(sim).with({"let go", "bonds broken", "worn"});
}
const Register let_go{"wear.let_go", row};

}  // namespace
