// expect: compiles
// The control of the slots: with laws that have everything, in any order.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/fluid/uniform_flow.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

int main() {
    using namespace abrade;
    simulate({})
        .fluid(UniformFlow{{.discharge = 0.5}})
        .wear(SubParticleAbrasion{{}})
        .contact(LinearSpring{{.stiffness = 1e6}})
        .bond(MohrCoulomb{{.tensile = 1e6, .stiffness = 1e6}})
        .run({.end_time = 1});
}
