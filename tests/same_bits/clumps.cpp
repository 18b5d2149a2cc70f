// Clumps: pebbles, crushed stone and gravel, and how they are made.
#include "../verification/ledger_scenes.hpp"
#include "states.hpp"

#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/geometry/gravel.hpp>
#include <abrade/geometry/sphere_filling.hpp>

using namespace same_bits;
using namespace ledger_scenes;

namespace {

const HertzMindlin law{{.youngs = 2e8, .restitution = 0.6, .friction = 0.4}};

/// Let go above the floor of a box, on fixed stones.
Numbers in_box() {
    abrade::Scene scene = bed(3, 2);
    const Clump gravel =
        make_gravel({.size = 0.035, .elongation = 0.7, .flatness = 0.6, .max_spheres = 16, .seed = 4});
    for (std::size_t n = 0; n < scene.stones.size(); n += 4) scene.stones[n].clump = gravel;
    scene.add_fixed(make_stone(StoneShape::angular, 0.04), {0.064, 0.066, -0.01});
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0.12});
    return state_of(sim).with({"lost_normal", "lost_sliding"});
}
/// Through periodic space, each turning on its own.
Numbers across_periods() {
    abrade::Scene scene = bed(3, 2);
    scene.walls.resize(1);
    scene.gravity = {2, 0, -9.81};
    scene.periodic_along = {true, true, false};
    scene.bounds = {{0, 0, -1}, {0.192, 0.192, 2}};
    Random random(3);
    for (auto& stone : scene.stones) stone.state.angular_velocity = 20 * random.in_cube();
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0.12});
    return state_of(sim).with({"lost_normal", "lost_sliding"});
}

/// What clumps are made of, and what they weigh.
void add_clump(Numbers& numbers, const Clump& clump) {
    numbers.kind("members");
    for (const auto& member : clump.members) numbers.add_vector(member.centre), numbers.add(member.radius);
    numbers.kind("volume").add(clump.volume);
    numbers.kind("moments").add_vector(clump.principal_moments);
    numbers.kind("reach").add(clump.bounding_radius);
    numbers.figure("clump volume", clump.volume);
}
Numbers shapes() {
    Numbers numbers;
    for (const auto shape : {StoneShape::sphere, StoneShape::ellipsoid, StoneShape::angular})
        add_clump(numbers, make_stone(shape, 0.05));
    for (const std::uint64_t seed : {1u, 2u})
        add_clump(numbers, make_gravel({.size = 0.04,
                                        .elongation = 0.6,
                                        .flatness = 0.8,
                                        .roundness = 0.3,
                                        .max_spheres = 25,
                                        .seed = seed}));
    const std::vector<Vec3> corners{{0, 0, 0}, {0.05, 0, 0}, {0, 0.04, 0}, {0, 0, 0.06}};
    const std::array<std::array<Vec3, 3>, 4> faces{{{corners[0], corners[2], corners[1]},
                                                    {corners[0], corners[1], corners[3]},
                                                    {corners[0], corners[3], corners[2]},
                                                    {corners[1], corners[2], corners[3]}}};
    const auto filled = fill_with_spheres(mesh_of_triangles(faces), {.max_spheres = 20, .samples = 1000});
    add_clump(numbers, make_clump("filled", filled.spheres));
    numbers.kind("gap").add(filled.largest_gap);
    return std::move(numbers).with({"clump volume"});
}

const Register box{"clumps.in_box", in_box};
const Register periods{"clumps.across_periods", across_periods};
const Register made{"clumps.shapes", shapes};

}  // namespace
