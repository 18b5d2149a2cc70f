#include <abrade/abrade.hpp>
#include <abrade/dem/time/collision.hpp>
#include <abrade/dem/time/odeint_steppers.hpp>
#include <iostream>

// A ball in the corner of a steel floor and a rubber wall: a law for each pair of materials.
int main() {
    const abrade::MaterialPairs<abrade::LinearSpring> laws{
        {.materials = {"stone", "steel", "rubber"},
         .pairs = {{"stone", "stone", {.stiffness = 1e6, .restitution = 0.6, .friction = 0.5}},
                   {"stone", "steel", {.stiffness = 2e6, .restitution = 0.8, .friction = 0.3}},
                   {"stone", "rubber", {.stiffness = 1e5, .restitution = 0.3, .friction = 0.9}}}}};

    abrade::Scene scene;
    scene.add_wall({0, 0, 0}, {0, 0, 1}, laws.number("steel"));      // z > 0 is inside
    scene.add_wall({0.5, 0, 0}, {-1, 0, 0}, laws.number("rubber"));  // x < 0.5 m is inside
    scene.add_sphere(0.01,
                     {.position = {0.4, 0, 0.0101}, .velocity = {1, 0, 0}, .material = laws.number("stone")});
    auto sim = abrade::simulate(scene).contact(laws);
    sim.run({.end_time = 0.2});
    std::cout << "back from the wall at " << sim.particles().velocity[0].x() << " m/s\n";

    // The same impact alone. A wall is a sphere of a thousand times the radius that is too heavy to move.
    const double mass = sim.particles().mass[0];
    const auto alone = abrade::collide<abrade::PredictingVerlet>(
        abrade::LinearSpring{{.stiffness = 1e5, .restitution = 0.3, .friction = 0.9}},
        {.radius_i = 0.01, .radius_j = 10, .mass_i = mass, .mass_j = 1e9 * mass, .speed = 1}, 1e-7);
    std::cout << "restitution of a frontal impact " << alone.normal_speed << '\n';
}
