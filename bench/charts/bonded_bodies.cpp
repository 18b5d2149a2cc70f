// Draws the pictures of docs/verification/bonds.md: chart_bonded_bodies [FOLDER]. The folder is made where it
// is not.

#include "../../tests/verification/bonded_bodies.hpp"
#include "../../examples/common/charts.hpp"

#include <filesystem>
#include <iostream>

using namespace bonded_bodies;
using namespace abrade::examples;

int main(int argc, char** argv) {
    try {
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/bonded_bodies";
        std::filesystem::create_directories(folder);
        const Real radius = 15 * d;
        const Pressed disc = press(triangular_sheet(2.1 * radius, 2.1 * radius, false), {.radius = radius});
        CircleSet bonds{.title = "bonds, before one breaks", .circles = {}},
            cracks{.title = "broken bonds", .circles = {}, .colour = "#0072b2"};
        for (const Strained& bond : disc.seen.strained)
            bonds.circles.push_back({bond.place.x() / d, bond.place.z() / d, 0.24, bond.needed});
        for (const Crack& crack : disc.seen.cracks)
            cracks.circles.push_back({crack.place.x() / d, crack.place.z() / d, 0.16});
        draw(CirclePicture{.title = "A pressed disc: what its bonds bear, and which break",
                           .x = {.label = "x / d", .min = -16, .max = 16},
                           .y = {.label = "z / d", .min = -16, .max = 16},
                           .colour = {.label = "share of the strength", .min = 0, .max = 1},
                           .sets = {bonds, cracks},
                           .width = 900,
                           .rows = 1},
             folder / "verification_bonds_disc.png");
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
