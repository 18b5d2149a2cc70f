#include <abrade/abrade.hpp>
#include <iostream>

// A stone falls on a slab of concrete; each impact wears what a hundred of them would.
int main() {
    abrade::Scene scene;
    const abrade::Lattice slab = abrade::flat_lattice(0.3, 0.3, {.sphere_diameter = 0.02, .layers = 3});
    scene.concrete = abrade::ConcreteBlock{.lattice = slab, .level = abrade::ConcreteLevel::quasi_static};
    scene.add_stone(abrade::make_stone(abrade::StoneShape::angular, 0.05), {.position = {0, 0, 0.2}});

    auto sim = abrade::simulate(scene)
                   .contact(abrade::LinearHysteretic{{.stiffness = 5e6, .restitution = 0.6, .friction = 0.5}})
                   .bond(abrade::MohrCoulomb{{.tensile = 2.7e6, .stiffness = 5e6}})
                   .wear(abrade::SubParticleAbrasion{{.coefficient = 1.1e-7, .acceleration = 100}});
    sim.run({.end_time = 0.4});

    const abrade::Ledger& ledger = sim.ledger();
    std::cout << "lost in contact with concrete: " << ledger.concrete_lost_normal << " J by impacts, "
              << ledger.concrete_lost_sliding << " J by sliding\nworn: " << 1e9 * sim.concrete().worn_volume()
              << " mm3\n"
              << sim;
}
