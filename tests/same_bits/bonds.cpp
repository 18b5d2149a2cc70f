// Concrete that moves on its bonds, struck so that they break: by Mohr-Coulomb, and as clumps that come
// loose.
#include "states.hpp"

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/bond/twist_resistance.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/sim/simulation.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

constexpr Real d = 0.02;
const LinearSpring law{{.stiffness = 1e6, .restitution = 0.6, .friction = 0.4}};
constexpr MohrCoulomb::Params weak{.tensile = 2e5, .stiffness = 4e6};

/// A stone that strikes a slab aslant.
abrade::Scene slab(const Lattice& lattice) {
    abrade::Scene scene;
    scene.concrete = ConcreteBlock{.lattice = lattice};
    scene.add_stone(make_stone(StoneShape::angular, 0.05),
                    {.position = {0.004, -0.003, 0.04}, .velocity = {2, 0.5, -6}});
    return scene;
}
/// A beam that a stone strikes off.
Numbers beam() {
    std::vector<Vec3> centres;
    for (int n = 0; n < 5; ++n)
        for (int j = 0; j < 2; ++j)
            for (int k = 0; k < 2; ++k) centres.push_back({n * d, (j - 0.5) * d, -(k + 0.5) * d});
    abrade::Scene scene;
    Lattice lattice = lattice_of(centres, 0.5 * d, 20 * cube(d));
    for (LatticeSite& site : lattice.sites) site.held = site.centre.x() < 0.5 * d;
    scene.concrete = ConcreteBlock{.lattice = lattice, .fragments = Fragments::clumps};
    scene.add_sphere(0.025, {.position = {2 * d, 0.003, 0.026}, .velocity = {0, 0, -6}});
    auto sim = simulate(scene).contact(law).bond(MohrCoulomb{{.tensile = 1e5, .stiffness = 4e6}});
    sim.run({.end_time = 0.02});
    return state_of(sim).with({"bonds broken", "lost_bond", "detached"});
}
Numbers struck(const Lattice& lattice) {
    auto sim = simulate(slab(lattice)).contact(law).bond(MohrCoulomb{weak});
    sim.run({.end_time = 0.01});
    return state_of(sim).with({"bonds broken", "lost_bond", "stored_bonds", "detached"});
}
Numbers twisting() {
    auto sim = simulate(slab(flat_lattice(0.12, 0.12, {.sphere_diameter = d, .layers = 3})))
                   .contact(law)
                   .bond(TwistResistance<MohrCoulomb>{{.bond = weak}});
    sim.run({.end_time = 0.01});
    return state_of(sim).with({"bonds broken", "lost_bond"});
}

const Register cubic{"bonds.mohr_coulomb",
                     [] { return struck(flat_lattice(0.12, 0.12, {.sphere_diameter = d, .layers = 3})); }};
const Register hexagonal{
    "bonds.hexagonal",
    [] { return struck(hexagonal_lattice(0.14, 0.12, {.sphere_diameter = d, .layers = 3})); }};
const Register fragments{"bonds.fragments", beam};
const Register twist{"bonds.twist_resistance", twisting};

}  // namespace
