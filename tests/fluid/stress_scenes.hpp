#pragma once
// Scenes in which thin water meets cut walls: where solvers of free surfaces fail. Coarse on purpose.

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace stress {
using namespace abrade;

/// One scene; lengths in metres, cells of 0.05 m unless its name says otherwise.
template <int Dim>
struct Scene {
    std::string name;
    GridFluidParams<Dim> params{};
    Real end = 2;         ///< [s]
    Real fall = 1;        ///< height that the water may fall through, dz [m]
    Real inflow = 0;      ///< fastest velocity that is given, u_in [m/s]
    bool fronts = false;  ///< fronts meet and focus: single faces may have three times the speed, not 1.5
    int mirror = -1;      ///< axis along which the scene is its own mirror image
    Real impact = 0;      ///< until when asymmetry is looked at: water meets water then [s]
    std::function<PlaceFunction<Dim>(Real)> moved{};  ///< wall at a time, set before each step
};

constexpr Real cell = 0.05, g = 9.81;

template <int Dim>
Scene<Dim> box(std::string name, CellNumber<Dim> cells, Point<Dim> size = Point<Dim>::Constant(cell)) {
    Scene<Dim> s{.name = std::move(name)};
    s.params.grid.cells = cells;
    s.params.grid.spacing = size;
    s.params.tolerance = 2e-8;  // a cell may hold ten times that too much
    s.params.gravity[Dim - 1] = -g;
    s.params.wall_law.kind = WallLaw::Kind::slip;
    s.fall = cells[Dim - 1] * size[Dim - 1];
    return s;
}

/// Above a plane through `at` that rises at an angle [degrees] along x.
template <int Dim>
PlaceFunction<Dim> slope(Point<Dim> at, Real degrees) {
    const Real a = degrees * pi / 180;
    return [=](const Point<Dim>& x) {
        return (x[Dim - 1] - at[Dim - 1]) * std::cos(a) - (x[0] - at[0]) * std::sin(a);
    };
}
/// Outside of a cylinder along y, or of a ball.
template <int Dim>
PlaceFunction<Dim> ball(Point<Dim> centre, Real radius) {
    return [=](const Point<Dim>& x) { return (x - centre).norm() - radius; };
}
/// Inside a box, > 0.
template <int Dim>
Real inside_box(const Point<Dim>& x, const Point<Dim>& low, const Point<Dim>& high) {
    return std::min((x - low).minCoeff(), (high - x).minCoeff());
}
template <int Dim>
PlaceFunction<Dim> block(Point<Dim> low, Point<Dim> high) {
    return [=](const Point<Dim>& x) { return inside_box<Dim>(x, low, high); };
}
template <int Dim>
PlaceFunction<Dim> outside(PlaceFunction<Dim> solid) {
    return [=](const Point<Dim>& x) { return -solid(x); };
}

inline std::string tenth(int n) { return "0." + std::to_string(n); }

inline std::vector<Scene<2>> plane_scenes() {
    using P = Point<2>;
    std::vector<Scene<2>> all;
    const auto add = [&](Scene<2> s) -> Scene<2>& { return all.emplace_back(std::move(s)); };

    // Films of 0.1 cell that run down slopes, and gather at their foot.
    for (const int degrees : {5, 10, 20, 30, 45}) {
        auto& s = add(box<2>("film of 0.1 cell, " + std::to_string(degrees) + " degrees", {40, 40}));
        const auto bed = slope<2>({0, 0.17 * cell}, degrees);
        s.params.wall = bed;
        s.params.water = [=](const P& x) { return 0.1 * cell - bed(x); };
        s.end = 6;
    }
    for (const int n : {0, 3, 7}) {
        auto& s = add(box<2>("film of 0.3 cell on a cylinder, at " + tenth(n), {40, 40}));
        const auto solid = ball<2>({1 + n * 0.1 * cell, 0.4}, 0.5);
        s.params.wall = solid;
        s.params.water = [=](const P& x) { return 0.3 * cell - solid(x); };
        s.end = 3;
    }
    // A dam that breaks onto a cylinder.
    const auto dam_on_cylinder = [&](std::string name, P size, CellNumber<2> cells, Real shift) {
        auto& s = add(box<2>(std::move(name), cells, size));
        s.params.wall = ball<2>({1.2 + shift, 0.35}, 0.2);
        s.params.water = block<2>({-1, -1}, {0.6, 1});
        s.fall = 1, s.end = 2, s.fronts = true;
    };
    dam_on_cylinder("dam on a cylinder", {cell, cell}, {40, 40}, 0);
    dam_on_cylinder("dam on a cylinder, at 0.5", {cell, cell}, {40, 40}, 0.5 * cell);
    dam_on_cylinder("dam on a cylinder, cells 10:1", {0.1, 0.01}, {20, 160}, 0);
    dam_on_cylinder("dam on a cylinder, cells 1:10", {0.01, 0.1}, {200, 16}, 0);
    // A reservoir that empties through a slot.
    const auto slot = [&](Real width, int n) {
        auto& s = add(box<2>("slot of " + short_text(width) + " cells, at " + tenth(n), {40, 20}));
        const Real low = (6 + 0.1 * n) * cell;
        s.params.wall = [=](const P& x) {
            const Real solid = inside_box<2>(x, {1, -1}, {1 + 4 * cell, 3});
            const Real open = inside_box<2>(x, {-1, low}, {3, low + width * cell});
            return std::max(-solid, open);
        };
        s.params.water = block<2>({-1, -1}, {1, 0.8});
        s.end = 2, s.fall = 0.8, s.fronts = true;
    };
    for (int n = 0; n < 10; ++n) slot(1, n);
    slot(0.5, 2), slot(0.5, 3), slot(0.25, 3), slot(0.25, 4);
    // What lies under water.
    for (const int n : {0, 5}) {
        auto& s = add(box<2>("cylinder under water that sways, at " + tenth(n), {40, 24}));
        s.params.wall = ball<2>({1 + 0.1 * n * cell, 0.4}, 0.2);
        s.params.water = [](const P& x) { return 0.8 + 0.1 * (x[0] - 1) - x[1]; };
        s.end = 4, s.fall = 1;
    }
    // Water that falls onto water, and fronts that meet.
    {
        auto& s = add(box<2>("droplet into a pool", {40, 40}));
        s.params.water = [](const P& x) { return std::max(0.5 - x[1], 0.2 - (x - P(1, 1.2)).norm()); };
        s.end = 2, s.fall = 1, s.fronts = true, s.mirror = 0, s.impact = 0.3;
    }
    {
        auto& s = add(box<2>("two dams that meet", {80, 40}));
        s.params.water = [](const P& x) { return std::min(std::abs(x[0] - 2) - 1.387, 0.993 - x[1]); };
        s.end = 2, s.fall = 1, s.fronts = true, s.mirror = 0, s.impact = 0.4;
    }
    {
        auto& s = add(box<2>("dam against a box", {60, 40}));
        s.params.wall = outside<2>(block<2>({1.83, -1}, {2.17, 0.33}));
        s.params.water = block<2>({-1, -1}, {1, 1});
        s.end = 3, s.fall = 1, s.fronts = true;
    }
    {
        auto& s = add(box<2>("dam against a wall", {60, 50}));
        s.params.water = block<2>({-1, -1}, {1, 1});
        s.end = 3, s.fall = 1, s.fronts = true;
    }
    {
        auto& s = add(box<2>("dam down steps", {60, 40}));
        s.params.wall = [](const P& x) {
            return std::min({std::max(x[1] - 0.73, x[0] - 0.81), std::max(x[1] - 0.37, x[0] - 1.63),
                             std::numeric_limits<Real>::infinity()});
        };
        s.params.water = block<2>({-1, 0.73}, {0.6, 1.5});
        s.end = 3, s.fall = 1.5, s.fronts = true;
    }
    {
        auto& s = add(box<2>("droplet on a cylinder", {40, 40}));
        s.params.wall = ball<2>({1, 0.6}, 0.3);
        s.params.water = [](const P& x) { return 0.15 - (x - P(1.03, 1.5)).norm(); };
        s.end = 2, s.fall = 1.6, s.fronts = true;
    }
    {
        auto& s = add(box<2>("film lands on a roof", {40, 40}));
        s.params.wall = [](const P& x) { return std::abs(x[0] - 1) * 0.6 + (x[1] - 1) * 0.8; };
        s.params.water = [](const P& x) { return 0.04 - std::abs(x[1] - 1.6); };
        s.end = 3, s.fall = 1.7, s.fronts = true;
    }
    {
        auto& s = add(box<2>("water in a groove", {40, 30}));
        s.params.wall = [](const P& x) { return 0.8 * x[1] - 0.6 * std::abs(x[0] - 1.013); };
        s.params.water = [](const P& x) { return 0.5 + 0.3 * (x[0] - 1) - x[1]; };
        s.end = 4, s.fall = 0.8, s.fronts = true;
    }
    {
        auto& s = add(box<2>("wave on a shore", {60, 20}));
        s.params.wall = slope<2>({1, 0.013}, 10);
        s.params.water = [](const P& x) { return 0.3 + (x[0] < 0.5 ? 0.2 : 0) - x[1]; };
        s.end = 4, s.fall = 0.5, s.fronts = true;
    }
    {
        auto& s = add(box<2>("dam into a bed of cylinders", {60, 30}));
        s.params.wall = [](const P& x) {
            Real d = 10;
            for (int i = 0; i < 5; ++i)
                for (int k = 0; k < 2; ++k)
                    d = std::min(d, (x - P(1.1 + 0.31 * i + 0.15 * k, 0.13 + 0.27 * k)).norm() - 0.12);
            return d;
        };
        s.params.water = block<2>({-1, -1}, {0.8, 1});
        s.end = 3, s.fall = 1, s.fronts = true;
    }
    {
        auto& s = add(box<2>("gap of 0.2 cell under a gate", {40, 20}));
        s.params.wall = outside<2>(block<2>({0.97, 0.2 * cell}, {1.13, 2}));
        s.params.water = block<2>({-1, -1}, {0.97, 0.8});
        s.end = 2, s.fall = 0.8, s.fronts = true;
    }
    {
        auto& s = add(box<2>("U-tube of 1.6 cells", {40, 30}));
        s.params.wall = [](const P& x) {
            const auto pipe = [&](const P& low, const P& high) { return inside_box<2>(x, low, high); };
            return std::max({pipe({0.32, 0.11}, {0.4, 2}), pipe({1.61, 0.11}, {1.69, 2}),
                             pipe({0.32, 0.11}, {1.69, 0.19})});
        };
        s.params.water = [](const P& x) { return (x[0] < 1 ? 1.2 : 0.6) - x[1]; };
        s.end = 3, s.fall = 1.2;
    }
    {
        auto& s = add(box<2>("jet on a wedge", {40, 30}));
        s.params.boundaries[0][0] = Boundary::inflow, s.params.boundaries[0][1] = Boundary::outflow;
        s.params.boundary_velocity = [](const P& x, Real) { return P(x[0] < 0.01 ? 2 : 0, 0); };
        s.params.inflow_water = [](const P& x) { return 0.13 - std::abs(x[1] - 0.9); };
        s.params.wall = [](const P& x) { return 0.8 * (x[1] - 0.5) - 0.6 * (x[0] - 1.2); };
        s.end = 3, s.fall = 1.5, s.inflow = 2, s.fronts = true;
    }
    {
        auto& s = add(box<2>("swaying tank, half full", {40, 30}));
        s.params.water = [](const P& x) { return 0.53 - x[1]; };
        s.params.body_force = [](Real t) { return P(1.5 * std::sin(3.4 * t), 0); };
        s.end = 6, s.fall = 1.5, s.fronts = true;
    }
    // A solid that crosses the grid under water.
    for (const Real speed : {0.2, 1.0}) {
        auto& s = add(box<2>("cylinder moved at " + short_text(speed) + " m/s under water", {40, 24}));
        s.params.water = [](const P& x) { return 0.8 - x[1]; };
        s.moved = [speed](Real t) { return ball<2>({0.6 + speed * t, 0.413}, 0.15); };
        s.params.wall = s.moved(0);
        s.end = 0.6 / std::max(speed, Real(0.5)), s.fall = 0.8, s.inflow = 2 * speed;
    }
    // Rest: 2 % of its depth is a fall that nothing should make.
    for (const int n : {0, 3, 5, 8}) {
        auto& s = add(box<2>("rest in an invert, at " + tenth(n), {40, 30}));
        const Real level = 0.6 + 0.1 * n * cell;
        s.params.wall = [](const P& x) { return 1 - (x - P(1.013, 1.21)).norm(); };
        s.params.water = [level](const P& x) { return level - x[1]; };
        s.end = 4, s.fall = 0.02 * level;
    }
    for (const int n : {0, 5}) {
        auto& s = add(box<2>("rest on a slope, gravity tilted, at " + tenth(n), {40, 20}));
        s.params.gravity = P(-0.17, -0.985) * g;
        s.params.wall = [n](const P& x) { return x[1] - 0.1 * n * cell; };
        s.params.water = [](const P& x) { return 0.4 - 0.17 / 0.985 * (x[0] - 1) - x[1]; };
        s.end = 4, s.fall = 0.02 * 0.4;
    }
    return all;
}

inline std::vector<Scene<3>> space_scenes() {
    using P = Point<3>;
    std::vector<Scene<3>> all;
    const auto add = [&](Scene<3> s) -> Scene<3>& { return all.emplace_back(std::move(s)); };
    const P tenth_of_metre = P::Constant(0.1);
    {
        auto& s = add(box<3>("3-D film of 0.1 cell, 20 degrees", {20, 6, 16}, tenth_of_metre));
        const auto bed = slope<3>({0, 0, 0.017}, 20);
        s.params.wall = bed;
        s.params.water = [=](const P& x) { return 0.01 - bed(x); };
        s.end = 3;
    }
    const auto dam = [&](std::string name, P size, CellNumber<3> cells, PlaceFunction<3> wall) {
        auto& s = add(box<3>(std::move(name), cells, size));
        s.params.wall = std::move(wall);
        s.params.water = block<3>({-1, -1, -1}, {0.7, 2, 1});
        s.fall = 1, s.end = 1.5, s.fronts = true;
    };
    const auto cylinder = [](const P& x) { return std::hypot(x[0] - 1.2, x[2] - 0.35) - 0.2; };
    dam("3-D dam on a cylinder", tenth_of_metre, {20, 6, 20}, cylinder);
    dam("3-D dam on a cylinder, cells 10:1", {0.1, 0.1, 0.01}, {20, 2, 160}, cylinder);
    dam("3-D dam against a box", tenth_of_metre, {24, 10, 16},
        outside<3>(block<3>({1.43, 0.33, -1}, {1.77, 0.71, 0.33})));
    {
        auto& s = add(box<3>("3-D reservoir with a hole of a cell", {20, 10, 12}, tenth_of_metre));
        s.params.wall = [](const P& x) {
            const Real solid = inside_box<3>(x, {0.9, -1, -1}, {1.13, 2, 3});
            return std::max(-solid, inside_box<3>(x, {-1, 0.43, 0.27}, {3, 0.53, 0.37}));
        };
        s.params.water = block<3>({-1, -1, -1}, {0.9, 2, 1});
        s.end = 2, s.fall = 1, s.fronts = true;
    }
    {
        auto& s = add(box<3>("3-D droplet on a ball", {16, 16, 18}, tenth_of_metre));
        s.params.wall = ball<3>({0.8, 0.8, 0.5}, 0.3);
        s.params.water = [](const P& x) { return 0.2 - (x - P(0.83, 0.8, 1.4)).norm(); };
        s.end = 1.5, s.fall = 1.6, s.fronts = true;
    }
    {
        auto& s = add(box<3>("3-D ball moved at 0.2 m/s under water", {16, 10, 10}, tenth_of_metre));
        s.params.water = [](const P& x) { return 0.83 - x[2]; };
        s.moved = [](Real t) { return ball<3>({0.6 + 0.2 * t, 0.5, 0.4}, 0.2); };
        s.params.wall = s.moved(0);
        s.end = 0.8, s.fall = 0.8, s.inflow = 0.4;
    }
    {
        auto& s = add(box<3>("3-D rest in a half full bowl", {16, 16, 12}, tenth_of_metre));
        s.params.wall = [](const P& x) { return 0.9 - (x - P(0.81, 0.77, 1.0)).norm(); };
        s.params.water = [](const P& x) { return 0.53 - x[2]; };
        s.end = 3, s.fall = 0.02 * 0.5;
    }
    return all;
}

/// What a run of a scene showed.
struct Outcome {
    Real speed = 0;      ///< fastest face that carries liquid over sqrt(2 g dz + u_in^2) [-]
    Real beyond = 0;     ///< largest share of the momentum on faces above 1.5 of that [-]
    Real gained = 0;     ///< most that mechanical energy grew from an earlier time, over the scene's [-]
    Real overfull = 0;   ///< most that a cell held beyond its volume, in shares of that [-]
    Real lost = 0;       ///< change of volume where nothing flows in or out, over that of the start [-]
    Real asymmetry = 0;  ///< of volume fractions, up to the impact [-]
    Index steps = 0;
    std::string error{};  ///< of a run that ended early
    std::string where{};  ///< the fastest face
};

template <class Flow, int Dim>
void look(const Flow& flow, const Scene<Dim>& scene, Outcome& seen) {
    const auto& grid = flow.grid();
    const auto& f = flow.liquid().fraction();
    const auto& volume_defect = flow.liquid().volume_defect();
    const Real unit = std::sqrt(2 * g * scene.fall + square(scene.inflow));
    const auto open = [&](Offset c) { return flow.walls() ? flow.walls()->open_fraction()[c] : Real(1); };
    constexpr Real carries = 1e-6;  // of a cell
    Real all = 0, fast = 0;
    grid.for_each([&](const CellNumber<Dim>& c, Offset at) {
        seen.overfull = std::max(seen.overfull, f[at] + volume_defect[at] - 1);
        for (int a = 0; a < Dim; ++a) {
            const Offset back = at - grid.layout().stride[a];
            const Real mass = 0.5 * (f[at] * open(at) + f[back] * open(back));
            if (c[a] == 0 || mass < carries) continue;
            const Real ratio = std::abs(flow.velocity()[a][at]) / unit;
            all += mass * ratio;
            if (ratio > 1.5) fast += mass * ratio;
            if (ratio <= seen.speed) continue;
            seen.speed = ratio;
            seen.where = "[";
            for (int b = 0; b < Dim; ++b) seen.where += (b ? "," : "") + std::to_string(c[b]);
            seen.where +=
                "] " + std::to_string(a) + " t " + short_text(flow.time()) + " holds " + short_text(mass);
        }
    });
    if (all > 0) seen.beyond = std::max(seen.beyond, fast / all);
    if (scene.mirror < 0 || flow.time() > scene.impact) return;
    const int n = grid.cells(scene.mirror);
    grid.for_each([&](const CellNumber<Dim>& c, Offset at) {
        CellNumber<Dim> image = c;
        image[scene.mirror] = n - 1 - c[scene.mirror];
        seen.asymmetry = std::max(seen.asymmetry, std::abs(f[at] - f[grid.layout().at(image)]));
    });
}

template <class Flow, int Dim>
Outcome run(const Scene<Dim>& scene) {
    Outcome seen;
    try {
        Flow flow(scene.params);
        Real volume = flow.liquid().volume();
        bool closed = true;
        for (int a = 0; a < Dim; ++a)
            for (const Boundary side : scene.params.boundaries[a]) closed = closed && side == Boundary::wall;
        // What the water can lose: its fall to a heap on the floor, or what came in with it.
        const Real scale = volume * (g * scene.fall + 0.5 * square(scene.inflow));
        const bool driven = !closed || scene.params.body_force || scene.moved;
        flow.open_energy_account();
        const auto energy = [&] {
            return (flow.energy().kinetic + flow.energy().potential) / scene.params.density;
        };
        Real lowest = energy();
        while (flow.time() < scene.end) {
            if (scene.moved) flow.set_wall(scene.moved(flow.time()));
            flow.step(std::min(flow.stable_step().seconds, scene.end / 20));
            ++seen.steps;
            look(flow, scene, seen);
            if (!driven) {
                const Real now = energy();
                seen.gained = std::max(seen.gained, (now - lowest) / scale);
                lowest = std::min(lowest, now);
            }
            if (closed) seen.lost = std::max(seen.lost, std::abs(flow.liquid().volume() / volume - 1));
            if (seen.steps > 20000) {
                seen.error = "20000 steps, t = " + short_text(flow.time());
                break;
            }
        }
    } catch (const std::exception& wrong) {
        seen.error = wrong.what();
    }
    return seen;
}

}  // namespace stress
