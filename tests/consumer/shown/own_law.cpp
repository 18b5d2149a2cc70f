#include <abrade/abrade.hpp>
#include <iostream>
#include "hysteretic_spring.hpp"

int main() {
    abrade::Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(0.02, {.velocity = {1, 0, 0}}).add_sphere(0.02, {.position = {0.0401, 0, 0}});
    auto sim = abrade::simulate(scene).contact(HystereticSpring{{.stiffness = 1e6, .restitution = 0.6}});
    sim.run({.end_time = 0.002, .safety = 0.1});
    const auto& v = sim.particles().velocity;
    std::cout << sim << "restitution " << v[1].x() - v[0].x() << '\n';
}
