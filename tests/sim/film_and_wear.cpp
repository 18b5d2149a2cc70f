// A wear law that goes by impacts sees them through the film of a law that acts before surfaces touch.

#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/dem/laws/lubrication.hpp>
#include <abrade/geometry/lattice.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/finnie.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

/// Volume that a ball wears off rigid concrete that it strikes at 45 degrees [m3].
template <class Law>
Real worn_by(const Law& law) {
    Scene scene;
    scene.gravity.setZero();
    scene.concrete = ConcreteBlock{.lattice = flat_lattice(0.3, 0.1, {.sphere_diameter = 0.02, .layers = 1}),
                                   .level = ConcreteLevel::rigid};
    scene.add_sphere(0.02, {.position = {-0.05, 0, 0.06}, .velocity = {1, 0, -1}});
    auto sim = simulate(scene).contact(law).wear(Finnie{{.flow_stress = 1e7, .acceleration = 100}});
    sim.run({.end_time = 0.1});
    CHECK(sim.particles().velocity[0].z() > 0);  // it has been there
    return sim.concrete().worn_volume();
}

}  // namespace

TEST_CASE("a film that hardly slows a ball changes nothing of what its impact cuts") {
    const LinearSpring dry{{.stiffness = 1e6, .restitution = 0.5, .friction = 0.4}};
    const Lubricated<LinearSpring> wet{
        {.contact = dry.params(), .viscosity = 1e-6, .range = 0.002, .roughness = 1e-5}};
    const Real without = worn_by(dry), with = worn_by(wet);
    CHECK(without > 0);
    CHECK(with == doctest::Approx(without).epsilon(0.02).scale(0));
}
