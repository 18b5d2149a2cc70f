#include <abrade/abrade.hpp>
#include <iostream>

// 64 marbles rain on a floor, in a box that repeats itself along x and y.
int main() {
    abrade::Scene scene;
    scene.bounds = {{0, 0, -0.01}, {0.1, 0.1, 1}};  // [m]
    scene.periodic_along = {true, true, false};     // what leaves at x = 0.1 m comes in at x = 0
    scene.add_wall({0, 0, 0}, {0, 0, 1});           // a floor: a point of it, and its normal
    for (int n = 0; n < 64; ++n)
        scene.add_sphere(0.008, {.position = {0.025 * (n % 4), 0.025 * (n / 4 % 4), 0.02 + 0.025 * (n / 16)},
                                 .velocity = {0.2 * (n % 3 - 1), 0, -0.5},
                                 .angular_velocity = {0, 30, 0}});

    auto sim = abrade::simulate(scene).contact(
        abrade::HertzMindlin{{.youngs = 5e7, .restitution = 0.7, .friction = 0.4}});

    sim.run({.end_time = 0.6, .observe_every = 0.2}, [](const auto& now) {
        int touching = 0;
        double pressed = 0;  // [N]
        now.world().each_contact([&](auto /*body*/, auto other, const auto& contact, const auto& load) {
            ++touching;
            if (other < 0) pressed += load.force.dot(contact.normal);  // the floor is no body
        });
        std::cout << now.time() << " s: " << touching << " contacts, the floor bears " << pressed << " N\n";
    });
    std::cout << "the marbles weigh " << sim.particles().mass[0] * 64 * 9.80665 << " N\n" << sim;
}
