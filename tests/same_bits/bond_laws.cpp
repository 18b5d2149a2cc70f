// The other bond laws, on concrete that a stone strikes.
#include "states.hpp"

#include <abrade/bond/elastic_brittle.hpp>
#include <abrade/bond/parallel_bond.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/sim/simulation.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

template <class Law>
Numbers struck(const Law& law) {
    abrade::Scene scene;
    scene.concrete =
        ConcreteBlock{.lattice = flat_lattice(0.12, 0.12, {.sphere_diameter = 0.02, .layers = 3})};
    scene.add_sphere(0.025, {.position = {0.004, -0.003, 0.027}, .velocity = {2, 0.5, -6}});
    auto sim = simulate(scene)
                   .contact(LinearSpring{{.stiffness = 1e6, .restitution = 0.6, .friction = 0.4}})
                   .bond(law);
    sim.run({.end_time = 0.006});
    return state_of(sim).with({"bonds broken", "lost_bond", "stored_bonds"});
}

const Register brittle{"bonds.elastic_brittle", [] {
                           return struck(ElasticBrittle{{.tensile = 2e5, .shear = 4e5, .stiffness = 4e6}});
                       }};
const Register parallel{"bonds.parallel_bond", [] {
                            return struck(ParallelBond{{.youngs = 3e8, .tensile = 2e5, .cohesion = 3e5}});
                        }};

}  // namespace
