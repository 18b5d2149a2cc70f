#pragma once
// Stones in a tank of water through the whole engine: the scenes in which methods fail.

#include <abrade/coupling/exchange/monolithic.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/sim/simulation.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace stone_tank {

using namespace abrade;

constexpr Real g = 9.81, water_density = 1000, stone_density = 2650;

/// Its floor is at z = 0, its middle at x = y = 0; it lets water glide.
struct Tank {
    PerAxis<int, 3> cells{12, 12, 16};
    Real h = 0.0125;         ///< cell [m]
    Real level = 0;          ///< of the water; 0: the box is full [m]
    Real largest_step = 0;   ///< of the water's; 0: what is stable [s]
    Real resolved_from = 3;  ///< cells to a diameter
    Real tolerance = 1e-6;

    Real size(int axis) const { return cells[axis] * h; }
};

template <class Surface, class Solids>
auto water_in(const Tank& tank, Solids solids) {
    using Flow = GridFluid<3, Among<Solids, Surface>>;
    typename Flow::Params params{.grid = {.cells = tank.cells,
                                          .low = Vec3(-0.5 * tank.size(0), -0.5 * tank.size(1), 0),
                                          .spacing = Vec3::Constant(tank.h)},
                                 .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                                 .gravity = {0, 0, -g},
                                 .density = water_density,
                                 .viscosity = 1e-3,
                                 .largest_step = tank.largest_step,
                                 .tolerance = tank.tolerance};
    if (tank.level > 0) params.water = [level = tank.level](const Vec3& x) { return level - x.z(); };
    return Flow(params, {}, std::move(solids));
}
template <class Surface, class Solids = MonolithicSolids<>>
auto water_in(const Tank& tank) {
    Solids solids;
    if constexpr (requires { solids.params().resolved_from; })
        solids = Solids({.resolved_from = tank.resolved_from});
    return water_in<Surface>(tank, std::move(solids));
}

/// With a floor, or without where concrete is one.
inline Scene walls_of(const Tank& tank, bool floor = true) {
    Scene scene;
    scene.gravity = {0, 0, -g};
    if (floor) scene.add_wall({0, 0, 0}, {0, 0, 1});
    for (int a = 0; a < 2; ++a)
        for (const Real side : {-1.0, 1.0})
            scene.add_wall(0.5 * side * tank.size(a) * Vec3::Unit(a), -side * Vec3::Unit(a));
    return scene;
}

/// Layers of stones that do not touch, from 0.8 to 1 of a diameter [m], the lowest `lift` above the floor.
inline void add_stones(Scene& scene, const Tank& tank, int count, Real diameter, Real lift) {
    std::uint32_t state = 12345;
    const auto random = [&] {
        state = 1664525u * state + 1013904223u;
        return (state >> 8) / 16777216.0;
    };
    const Real room = 1.05 * diameter;
    const int along = static_cast<int>(tank.size(0) / room), across = static_cast<int>(tank.size(1) / room);
    for (int n = 0; n < count; ++n) {
        const Vec3 place(n % along + 0.5, n / along % across + 0.5, n / (along * across) + 0.5);
        const Real radius = 0.5 * diameter * (0.8 + 0.2 * random());
        const Vec3 aside(random(), random(), 0);  // lest columns stand
        scene.add_sphere(radius,
                         {.position = room * (place - 0.5 * Vec3(along, across, 0)) + Vec3(0, 0, lift) +
                                      0.02 * diameter * aside},
                         stone_density);
    }
}

Real fastest_stone(const auto& sim) {
    Real most = 0;
    for (const Vec3& v : sim.particles().velocity) most = std::max(most, v.norm());
    return most;
}
inline Real buoyancy(Real diameter) { return water_density * g * pi / 6 * cube(diameter); }

}  // namespace stone_tank
