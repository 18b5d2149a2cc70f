#pragma once
// A stone that stands in a stream faster than its waves, half out of it: the force that the exchange hands
// out against the balance of momentum of the water around it.

#include <abrade/coupling/exchange/monolithic.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace stone_in_stream {

using namespace abrade;

using Flow = GridFluid<3, Among<MonolithicSolids<>, HeightSurface>>;

constexpr Real diameter = 0.2, length = 1.6, g = 9.81, density = 1000;  // [m], [m/s2], [kg/m3]

/// Bed and sides let water glide: no friction takes part in the balance.
struct Stream {
    Real cells = 6;   ///< to the stone's diameter
    Real froude = 2;  ///< of the stream as it comes
    Real slope = 0;   ///< of the bed: weight takes part along the stream [-]
    Vec3 off{0.3, 0.1,
             0};        ///< of the stone's centre from a corner of cells, and of its foot from the bed [cell]
    Real depth = 0.1;   ///< of the stream [m]
    Real centre = 0.1;  ///< height of the stone's centre, beside `off` [m]
    Real width = 0.8;   ///< of the channel [m]
};

/// What goes through a section across the stream, in the middles of the cells of a number: its momentum, and
/// the water's pressure on it [N].
inline Real thrust(const Flow& flow, int i) {
    const Grid<3>& grid = flow.grid();
    const Layout<3>& l = grid.layout();
    Real sum = 0;
    for (int j = 0; j < grid.cells(1); ++j) {
        Real height = 0;
        for (int k = 0; k < grid.cells(2); ++k)
            height += flow.liquid().fraction()[l.at({i, j, k})] * grid.size(2, k);
        // The pressure is linear between the bed, the middles of cells and the surface.
        const Offset bed = l.at({i, j, 0});
        const Real low = flow.pressure()[bed], next = flow.pressure()[bed + l.stride[2]];
        Real z = 0, pressure = grid.size(2, 0) < height ? low + 0.5 * (low - next) : 2 * low, pressed = 0;
        for (int k = 0; k < grid.cells(2) && grid.face(2, k) < height; ++k) {
            const Offset c = l.at({i, j, k});
            const Real u = 0.5 * (flow.velocity()[0][c] + flow.velocity()[0][c + l.stride[0]]);
            sum += grid.size(1, j) * flow.liquid().fraction()[c] * grid.size(2, k) * square(u);
            if (grid.centre(2, k) > height) break;
            pressed += 0.5 * (pressure + flow.pressure()[c]) * (grid.centre(2, k) - z);
            z = grid.centre(2, k), pressure = flow.pressure()[c];
        }
        sum += grid.size(1, j) * (pressed + 0.5 * pressure * (height - z));
    }
    return density * sum;
}

/// Momentum along the stream [kg m/s] and mass [kg] between the middles of two columns of cells.
struct Held {
    Real momentum = 0, mass = 0;
};
inline Held held(const Flow& flow, int from, int to) {
    const Grid<3>& grid = flow.grid();
    const Layout<3>& l = grid.layout();
    std::vector<Real> solid(static_cast<std::size_t>(l.total), 0);
    for (const SolidPart& p : flow.solids().parts()) solid[static_cast<std::size_t>(p.cell)] += p.volume;
    Held found;
    for (int i = from; i <= to; ++i)
        for (int j = 0; j < grid.cells(1); ++j)
            for (int k = 0; k < grid.cells(2); ++k) {
                const Offset c = l.at({i, j, k});
                const Real room = grid.volume({i, j, k}) - solid[static_cast<std::size_t>(c)];
                const Real water = density * flow.liquid().fraction()[c] * std::max(room, 0.0);
                const Real low = i == from ? 0 : 0.5, high = i == to ? 0 : 0.5;  // halves of the column
                found.mass += (low + high) * water;
                found.momentum +=
                    water * (low * flow.velocity()[0][c] + high * flow.velocity()[0][c + l.stride[0]]);
            }
    return found;
}

/// Means over time, along the stream [N].
struct Force {
    Real handed_out = 0;         ///< on the stone, by the exchange
    Real balance = 0, near = 0;  ///< by the water's momentum up to two sections behind it
    Real across = 0;             ///< by the exchange, away from the bed
};
inline Force force_on_stone(const Stream& s, Real from, Real to) {
    const Real h = diameter / s.cells, cosine = 1 / std::sqrt(1 + square(s.slope));
    const Vec3 speed(s.froude * std::sqrt(g * cosine * s.depth), 0, 0);
    const auto count = [h](Real x) { return static_cast<int>(std::round(x / h)); };
    GridFluidParams<3> p{.grid = {.cells = {count(length), count(s.width), count(s.depth + 0.35)},
                                  .spacing = Vec3::Constant(h)},
                         .boundaries = BoundaryConditions<3>::all(Boundary::free_slip)};
    p.boundaries[0] = {Boundary::inflow, Boundary::outflow};
    p.boundary_velocity = [speed](const Vec3&, Real) { return speed; };
    p.velocity = [speed](const Vec3&) { return speed; };
    p.water = p.inflow_water = [depth = s.depth](const Vec3& x) { return depth - x.z(); };
    p.gravity = g * cosine * Vec3(s.slope, 0, -1);
    p.density = density, p.viscosity = 1e-3, p.tolerance = 1e-7;
    Flow flow(p, {}, MonolithicSolids<>({.resolved_from = 0}));
    const Vec3 place = Vec3(0.6, 0.5 * s.width, s.centre) + h * s.off;
    const Sphere sphere{place, 0.5 * diameter};
    FlowBody body{.position = place, .volume = pi / 6 * cube(diameter), .spheres = {&sphere, 1}};
    const int first = count(0.2), ends[] = {count(length - 0.2), count(length - 0.5)};
    Real stored[2]{}, balance[2]{}, time = 0;
    Force found;
    while (flow.time() < to) {
        const bool counts = flow.time() >= from;
        const Real dt = flow.stable_step().seconds;
        if (counts && time == 0)
            for (const int e : {0, 1}) stored[e] = held(flow, first, ends[e]).momentum;
        flow.advance(flow.time() + dt, {&body, 1});
        if (!counts) continue;
        time += dt, found.handed_out += dt * body.load.force.x(), found.across += dt * body.load.force.z();
        for (const int e : {0, 1})
            balance[e] += dt * (thrust(flow, first) - thrust(flow, ends[e]) +
                                held(flow, first, ends[e]).mass * p.gravity.x());
    }
    for (const int e : {0, 1}) balance[e] -= held(flow, first, ends[e]).momentum - stored[e];
    found.handed_out /= time, found.across /= time;
    found.balance = balance[0] / time, found.near = balance[1] / time;
    return found;
}

}  // namespace stone_in_stream
