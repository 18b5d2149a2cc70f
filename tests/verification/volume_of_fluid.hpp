#pragma once
// Flows that carry a shape somewhere and back again: what is left of it, for volume of fluid.

#include <abrade/fluid/vof/fill_below.hpp>
#include <abrade/fluid/vof/volume_of_fluid.hpp>

#include <chrono>

namespace returning_shapes {

using namespace abrade;

/// What came back. `error` [m2 or m3] = sum |f - f_start| V; `relative` to the shape's volume.
struct Returned {
    Real error = 0, relative = 0;
    Real lost = 0;           ///< largest |volume / volume at the start - 1| on the way
    Real outside = 0;        ///< largest excursion of f beyond 0 and 1
    Real redistributed = 0;  ///< of the volume, all steps together
    int steps = 0;
    Real seconds = 0;    ///< wall time of the steps alone
    Real wet_steps = 0;  ///< cells that were wet, all steps together
    Field<Real> start{}, end{};
};

struct Duration {
    Real duration = 1;  ///< [s]
    int steps = 0;
    Real until = 1;  ///< share of the duration that is run
};

template <int Dim>
Grid<Dim> grid_of(int cells, Real size) {
    CellNumber<Dim> count;
    count.fill(cells);
    return Grid<Dim>({.cells = count, .spacing = Point<Dim>::Constant(size / cells)});
}

/// Carries `water` with velocity times factor(t), taken in the middle of each step.
template <int Dim>
Returned carry(const Duration& problem, VolumeOfFluid<Dim>& water, const FaceField<Dim>& velocity,
               const auto& factor) {
    using Clock = std::chrono::steady_clock;
    Returned result{.steps = problem.steps, .start = water.fraction()};
    const Grid<Dim>& grid = water.grid();
    FaceField<Dim> flux = face_field<Dim>(grid.layout());
    const Real before = water.volume(), dt = problem.duration / problem.steps;
    auto u = velocity;
    const int last = static_cast<int>(std::lround(problem.until * problem.steps)) - 1;
    for (int k = 0; k <= last; ++k) {
        const Real now = factor((k + 0.5) * dt);
        for (std::size_t a = 0; a < Dim; ++a)
            for (Offset i = 0; i < u[a].size(); ++i) u[a][i] = now * velocity[a][i];
        const auto begun = Clock::now();
        const VolumeStep step = water.advance(u, dt, flux);
        result.seconds += std::chrono::duration<Real>(Clock::now() - begun).count();
        result.redistributed += step.redistributed / before;
        result.wet_steps += static_cast<Real>(water.wet().cells());
        if (k % 16 != 0 && k != last) continue;
        result.lost = std::max(result.lost, std::abs(water.volume() / before - 1));
        grid.for_each([&](const CellNumber<Dim>&, Offset c) {
            result.outside = std::max({result.outside, -water.fraction()[c], water.fraction()[c] - 1});
        });
    }
    grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
        result.error += std::abs(water.fraction()[c] - result.start[c]) * grid.volume(cell);
    });
    result.relative = result.error / before;
    result.end = water.fraction();
    return result;
}

/// Velocity on faces from a stream function: (dpsi/dz, -dpsi/dx), exactly what flows through each face.
inline FaceField<2> from_stream(const Grid<2>& grid, const auto& stream) {
    auto u = face_field<2>(grid.layout());
    grid.for_each(
        [&](const CellNumber<2>& cell, Offset c) {
            const Real x = grid.face(0, cell[0]), z = grid.face(1, cell[1]);
            const Real dx = grid.size(0, cell[0]), dz = grid.size(1, cell[1]);
            u[0][c] = (stream(x, z + dz) - stream(x, z)) / dz;
            u[1][c] = -(stream(x + dx, z) - stream(x, z)) / dx;
        },
        1);
    return u;
}

/// A circle of radius 0.15 at (0.5, 0.75) in the unit box, stretched into a spiral and back:
/// psi = sin^2(pi x) sin^2(pi z) cos(pi t / T) / pi (Rider & Kothe 1998, doi 10.1006/jcph.1998.5906).
inline Returned single_vortex(int cells, Real period, Real courant,
                              const VolumeOfFluid<2>::Params& params = {}, Real until = 1) {
    const Grid<2> grid = grid_of<2>(cells, 1);
    VolumeOfFluid<2> water(grid, BoundaryConditions<2>::all(Boundary::wall), params);
    fill_below<2>(
        water.fraction(), grid, [](const Point<2>& x) { return (x - Point<2>(0.5, 0.75)).norm() - 0.15; }, 5);
    water.prepare();
    const auto u =
        from_stream(grid, [](Real x, Real z) { return square(std::sin(pi * x) * std::sin(pi * z)) / pi; });
    // The largest speed is 1 m/s.
    const int steps = static_cast<int>(std::ceil(period * cells / courant));
    return carry<2>({.duration = period, .steps = steps, .until = until}, water, u,
                    [&](Real t) { return std::cos(pi * t / period); });
}

/// Zalesak's slotted disc as Rudman set it up (1997, doi 10.1002/(SICI)1097-0363(19970415)24:7<671::AID-
/// FLD508>3.0.CO;2-9): radius 0.5 at (2, 2.75) in a box of 4, a slot 0.12 wide that leaves a bridge of 0.4;
/// turned once about (2, 2), with 2524 steps on 200 x 200 cells.
inline Real slotted_disc(const Point<2>& x) {
    const Real disc = (x - Point<2>(2, 2.75)).norm() - 0.5;
    const Real slot = std::max(std::abs(x[0] - 2) - 0.06, x[1] - 2.85);
    return std::max(disc, -slot);
}
inline Returned zalesak(int cells, const VolumeOfFluid<2>::Params& params = {}, Real until = 1) {
    const Grid<2> grid = grid_of<2>(cells, 4);
    VolumeOfFluid<2> water(grid, BoundaryConditions<2>::all(Boundary::outflow), params);
    fill_below<2>(water.fraction(), grid, slotted_disc, 5);
    water.prepare();
    const auto u = from_stream(grid, [](Real x, Real z) { return -0.25 * (square(x - 2) + square(z - 2)); });
    return carry<2>({.duration = 4 * pi, .steps = 2524 * cells / 200, .until = until}, water, u,
                    [](Real) { return 1; });
}

/// A sphere of radius 0.15 at (0.35, 0.35, 0.35) in the unit box, LeVeque's deformation (1996, doi
/// 10.1137/0733033) for a period of 3 s. Faces carry the exact flow through them: the vector potential
/// A = (0, Ay, Az) below, by its circulation around the face with the midpoint of each edge, is free of
/// divergence to round-off.
inline Returned deformation(int cells, Real courant, const VolumeOfFluid<3>::Params& params = {}) {
    const Grid<3> grid = grid_of<3>(cells, 1);
    VolumeOfFluid<3> water(grid, BoundaryConditions<3>::all(Boundary::wall), params);
    fill_below<3>(
        water.fraction(), grid,
        [](const Point<3>& x) { return (x - Point<3>::Constant(0.35)).norm() - 0.15; }, 3);
    water.prepare();
    auto u = face_field<3>(grid.layout());
    const auto bump = [](Real s) { return square(std::sin(pi * s)); };
    const auto wave = [](Real s) { return std::sin(2 * pi * s); };
    const Real h = 1.0 / cells;
    // Two fluxes in planes: with P = sin^2 sin^2 / pi, (u, v) = w_z (dP/dy, -dP/dx) and (u, w) = w_y (dP/dz,
    // -dP/dx) give (2 sin^2(x) w_y w_z, -w_x sin^2(y) w_z, -w_x w_y sin^2(z)).
    const auto stream = [&](Real s, Real t) { return bump(s) * bump(t) / pi; };
    grid.for_each(
        [&](const CellNumber<3>& cell, Offset c) {
            const Real x = grid.face(0, cell[0]), y = grid.face(1, cell[1]), z = grid.face(2, cell[2]);
            const Real my = wave(y + 0.5 * h), mz = wave(z + 0.5 * h);
            u[0][c] = (mz * (stream(x, y + h) - stream(x, y)) + my * (stream(x, z + h) - stream(x, z))) / h;
            u[1][c] = -mz * (stream(x + h, y) - stream(x, y)) / h;
            u[2][c] = -my * (stream(x + h, z) - stream(x, z)) / h;
        },
        1);
    // The largest speed is 2 m/s.
    const int steps = static_cast<int>(std::ceil(3.0 * 2 * cells / courant));
    return carry<3>({.duration = 3, .steps = steps}, water, u, [](Real t) { return std::cos(pi * t / 3); });
}

}  // namespace returning_shapes
