#pragma once
// What volume_kept and volume_kept_3d run: dams, jets, walls that cut cells, traces of air beside the bulk.
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

#include <random>

namespace volume_kept {

using namespace abrade;

constexpr Real g = 9.81;

/// What the cells hold, fractions and volume defects; sums of doubles would round to 1e-13 or so.
struct Held {
    long double volume = 0, volume_defect = 0;  ///< [m3]; the defect without its sign
    bool in_bounds = true;
};
template <int Dim>
Held held_by(const VolumeOfFluid<Dim>& water, const Field<Real>* open) {
    Held held;
    const Field<Real>&f = water.fraction(), &s = water.volume_defect();
    water.grid().for_each([&](const CellNumber<Dim>& cell, Offset c) {
        const long double room =
            (open ? (*open)[c] : 1) * static_cast<long double>(water.grid().volume(cell));
        held.volume += room * (static_cast<long double>(f[c]) + static_cast<long double>(s[c]));
        held.volume_defect += room * std::abs(s[c]);
        held.in_bounds = held.in_bounds && f[c] >= 0 && f[c] <= 1;
    });
    return held;
}

/// Steps of its own; in each of them volume is kept to 1e-12 and fractions are within their bounds.
template <int Dim>
void run(const GridFluidParams<Dim>& params, const std::string& name, int steps) {
    GridFluid<Dim> flow(params);
    const Field<Real>* open = flow.walls() ? &flow.walls()->open_fraction() : nullptr;
    const Held before = held_by(flow.liquid(), open);
    REQUIRE(before.volume > 0);
    long double worst = 0, most = 0;
    bool in_bounds = true;
    for (int k = 0; k < steps; ++k) {
        flow.step(flow.stable_step().seconds);
        const Held now = held_by(flow.liquid(), open);
        worst = std::max(worst, std::abs(now.volume / before.volume - 1));
        most = std::max(most, now.volume_defect / before.volume);
        in_bounds = in_bounds && now.in_bounds;
    }
    MESSAGE(name << ": volume off by " << static_cast<Real>(worst) << " at most, beyond the bounds "
                 << static_cast<Real>(most) << ", " << flow.time() << " s");
    CHECK(in_bounds);
    CHECK(worst < 1e-12);
    // What cells hold beyond their volume is asked back by the pressure, to the tolerance of a step.
    CHECK(most < 10 * flow.params().tolerance);
}

template <int Dim>
typename GridFluid<Dim>::Params tank(PlaceFunction<Dim> water) {
    typename GridFluid<Dim>::Params params;
    const int n = Dim == 2 ? 32 : 24;
    params.grid.cells.fill(n);
    if (Dim == 3) params.grid.cells[1] = 16;
    params.grid.spacing = Point<Dim>::Constant(1.0 / n);
    params.boundaries = BoundaryConditions<Dim>::all(Boundary::free_slip);
    params.water = std::move(water);
    params.gravity[Dim - 1] = -g;
    return params;
}

template <int Dim>
void collapse(int steps) {
    run<Dim>(tank<Dim>([](const Point<Dim>& x) { return std::min(0.4 - x[0], 0.6 - x[Dim - 1]); }),
             std::to_string(Dim) + "-D dam", steps);
}

template <int Dim>
void plunge(int steps) {
    auto params = tank<Dim>([](const Point<Dim>& x) {
        const Real off = Dim == 2 ? std::abs(x[0] - 0.5) : std::hypot(x[0] - 0.5, x[1] - 0.33);
        return std::max(0.3 - x[Dim - 1], std::min(0.08 - off, x[Dim - 1] - 0.3));
    });
    params.velocity = [](const Point<Dim>& x) {
        Point<Dim> u = Point<Dim>::Zero();
        u[Dim - 1] = x[Dim - 1] > 0.35 ? -5 : 0;
        return u;
    };
    run<Dim>(params, std::to_string(Dim) + "-D jet", steps);
}

template <int Dim>
void run_in_invert(int steps) {
    typename GridFluid<Dim>::Params params;
    params.grid.cells.fill(25);
    params.grid.cells[Dim - 1] = 14;
    params.grid.spacing = Point<Dim>::Constant(0.04);
    params.grid.low[Dim - 2] = -0.5;
    params.boundaries = BoundaryConditions<Dim>::all(Boundary::free_slip);
    params.wall = InvertWall({.length = 1, .width = 1, .arc_radius = 1, .slope = 0});
    params.water = [](const Point<Dim>& x) { return std::min(0.1 - x[0], 0.4 - x[Dim - 1]); };
    params.gravity[Dim - 1] = -g;
    run<Dim>(params, std::to_string(Dim) + "-D dam in an invert", steps);
}

/// A box full of cells that lack traces, too small to be a surface, and a void; a velocity that converges in
/// some cells and diverges in others.
template <int Dim>
void carry_traces(Boundary side) {
    CellNumber<Dim> cells;
    cells.fill(12);
    const Grid<Dim> grid({.cells = cells, .spacing = Point<Dim>::Constant(1.0 / 12)});
    VolumeOfFluid<Dim> water(grid, BoundaryConditions<Dim>::all(side));
    FaceField<Dim> flux = face_field<Dim>(grid.layout());
    std::mt19937 random(4);
    std::uniform_real_distribution<Real> exponent(-13, -6.1), uniform(-1, 1);
    grid.for_each([&](const CellNumber<Dim>&, Offset c) {
        water.fraction()[c] = uniform(random) < 0.8 ? 1 - std::pow(10, exponent(random)) : 1;
    });
    CellNumber<Dim> hole;
    hole.fill(6);
    water.fraction()[grid.layout().at(hole)] = 0;
    water.prepare();
    auto u = face_field<Dim>(grid.layout());
    grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
        for (int a = 0; a < Dim; ++a)
            if (side == Boundary::periodic || cell[a] > 0) u[a][c] = 0.1 * uniform(random);
    });
    if (side == Boundary::periodic)
        for (int a = 0; a < Dim; ++a) fill_periodic(u[a], grid.layout(), water.boundaries());
    const Held before = held_by<Dim>(water, nullptr);
    long double worst = 0;
    for (int k = 0; k < 20; ++k) {
        water.advance(u, std::min(0.02, water.stable_step(u)), flux);
        worst = std::max(worst, std::abs(held_by<Dim>(water, nullptr).volume / before.volume - 1));
    }
    MESSAGE(Dim << "-D traces: off by " << static_cast<Real>(worst));
    CHECK(worst < 1e-14);
}

}  // namespace volume_kept
