// The other wear laws, on a rigid floor that stones bounce and slide on.
#include "states.hpp"

#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/archard.hpp>
#include <abrade/wear/finnie.hpp>
#include <abrade/wear/ishibashi.hpp>
#include <abrade/wear/sklar_dietrich.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

template <class Law>
Numbers worn_by(const Law& law) {
    abrade::Scene scene;
    scene.concrete = ConcreteBlock{.lattice = flat_lattice(0.2, 0.1, {.sphere_diameter = 0.02, .layers = 2}),
                                   .level = ConcreteLevel::rigid};
    scene.add_stone(make_stone(StoneShape::ellipsoid, 0.04),
                    {.position = {-0.06, 0, 0.03}, .velocity = {2, 0, -1}});
    scene.add_sphere(0.02, {.position = {0.01, 0.01, 0.03}, .velocity = {1, 0.3, -2}});
    auto sim =
        simulate(scene).contact(HertzMindlin{{.youngs = 2e8, .restitution = 0.6, .friction = 0.4}}).wear(law);
    sim.run({.end_time = 0.05});
    return state_of(sim).with({"worn"});
}

const Register archard{
    "wear.archard",
    [] { return worn_by(Archard{{.coefficient = 1e-4, .hardness = 1e9, .acceleration = 1e3}}); }};
const Register finnie{"wear.finnie",
                      [] { return worn_by(Finnie{{.flow_stress = 1e8, .acceleration = 10}}); }};
const Register sklar_dietrich{
    "wear.sklar_dietrich",
    [] { return worn_by(SklarDietrich{{.tensile = 2.7e6, .youngs = 2.7e10, .acceleration = 1e3}}); }};
const Register ishibashi{
    "wear.ishibashi",
    [] { return worn_by(Ishibashi{{.impact = 1e-10, .friction = 3e-11, .acceleration = 1e3}}); }};

}  // namespace
