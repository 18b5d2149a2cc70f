// Depth-averaged water: dams that break over beds with dry ground, streams, and stones that it feels or not.
#include "states.hpp"

#include <abrade/coupling/averaging/two_way_shallow.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/sim/simulation.hpp>

using namespace same_bits;
using namespace abrade;

namespace {

Real hump(Real x, Real y) { return 0.25 * std::exp(-8 * ((x - 2.2) * (x - 2.2) + 0.5 * y * y)); }

Numbers dam_1d() {
    ShallowWater<1> water({.low = {0},
                           .high = {4},
                           .cells = {160},
                           .boundaries = {{{ShallowBoundary::wall(), ShallowBoundary::outflow()}}},
                           .bed = hump,
                           .surface = [](Real x, Real) { return x < 1.5   ? 0.5
                                                                : x > 3.2 ? 0.02
                                                                          : -1.0; },
                           .manning = 0.015});
    water.advance(1);
    return state_of_water(water).with({"fastest water"});
}
Numbers stream_1d() {
    ShallowWater<1> water({.low = {0},
                           .high = {4},
                           .cells = {120},
                           .boundaries = {{{ShallowBoundary::inflow(0.4, 0.15), ShallowBoundary::outflow()}}},
                           .bed = [](Real x, Real) { return 0.4 * hump(x, 0); },
                           .gravity = {0.3, 0, -9.8},
                           .manning = 0.02});
    water.advance(2);
    return state_of_water(water).with({"fastest water"});
}

ShallowWaterParams<2> basin() {
    return {.low = {0, -0.6},
            .high = {4, 0.6},
            .cells = {160, 48},  // threads share it
            .boundaries = {{{ShallowBoundary::wall(), ShallowBoundary::outflow()},
                            {ShallowBoundary::wall(), ShallowBoundary::wall()}}},
            .bed = [](Real x, Real y) { return hump(x, y) + 0.1 * y * y; },
            .surface = [](Real x, Real y) { return x < 1.2 + 0.3 * y ? 0.5 : -1; },
            .gravity = {0, 0, -9.81},
            .manning = 0.015};
}
Numbers dam_2d() {
    ShallowWater<2> water(basin());
    water.advance(0.8);
    return state_of_water(water).with({"fastest water", "dry cells"});
}

/// Stones on the bed that the wave meets.
template <class Water>
Numbers stones() {
    abrade::Scene scene;
    scene.gravity = {0, 0, -9.81};
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    for (int n = 0; n < 8; ++n)
        scene.add_sphere(0.03, {.position = {0.9 + 0.1 * (n % 4), -0.2 + 0.3 * (n / 4), 0.04 + 0.01 * n}});
    scene.add_stone(make_stone(StoneShape::angular, 0.08), {.position = {1.4, 0, 0.08}});
    auto params = basin();
    params.bed = {};
    auto sim = simulate(scene)
                   .contact(LinearSpring{{.stiffness = 2e5, .restitution = 0.5, .friction = 0.4}})
                   .fluid(Water(params));
    sim.run({.end_time = 0.5});
    return state_of(sim).with({"fastest water", "lost_sliding", "kinetic"});
}

const Register line{"shallow.dam_1d", dam_1d};
const Register stream{"shallow.stream_1d", stream_1d};
const Register plane{"shallow.dam_2d", dam_2d};
const Register one_way{"shallow.stones_one_way", stones<ShallowWater<2>>};
const Register two_way{"shallow.stones_two_way", stones<TwoWayShallow<>>};

}  // namespace
