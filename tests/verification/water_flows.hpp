#pragma once
// Flows that are measured against other codes and against references: the lid-driven cavity, decaying
// vortices, a column that collapses, a channel over a bump. Each runs to its end and gives what errors are
// computed from.

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/setup/inflow.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>
#include <vector>

namespace water_flows {

using namespace abrade;

/// What a user may choose beside grid, scheme, state and surface.
struct Choice {
    Real tolerance = 1e-6, courant = 0.5;
    Boundary walls = Boundary::wall;  ///< of the column that collapses
};

struct Cost {
    Index cells = 0, steps = 0;
};

/// Seconds of the processor that a run takes, with all that it builds: the median of three where it is short.
template <class Flow>
struct Timed {
    Real seconds = 0;
    Flow flow{};
};
auto timed(const auto& once) {
    std::vector<Timed<decltype(once())>> runs;
    do {
        const std::clock_t start = std::clock();
        auto flow = once();
        runs.push_back({static_cast<Real>(std::clock() - start) / CLOCKS_PER_SEC, std::move(flow)});
    } while (runs.size() < 3 && runs.back().seconds < 2);
    std::sort(runs.begin(), runs.end(), [](const auto& a, const auto& b) { return a.seconds < b.seconds; });
    return runs[runs.size() / 2];
}

/// Speeds along the two centre lines, ends included [lid's speed].
struct CentreLines {
    Cost cost{};
    std::vector<Real> at{};      ///< place along the line [side]
    std::vector<Real> u{}, v{};  ///< u along x = 1/2, v along y = 1/2
};

/// The lid-driven cavity at Re 1000 after 40 s: a square of side 1, its lid moves along x at speed 1.
template <AdvectionScheme Scheme, class State = Real>
CentreLines cavity(int n, const Choice& choice) {
    GridFluid<2, InPrecision<State, Advected<Scheme, FullBox>>> flow(
        {.grid = {.cells = {n, n}, .spacing = Point<2>::Constant(1.0 / n)},
         .boundary_velocity = [](const Point<2>& x, Real) { return Point<2>(x[1] > 1 - 1e-9 ? 1 : 0, 0); },
         .density = 1,
         .viscosity = 1e-3,
         .courant = choice.courant,
         .tolerance = choice.tolerance});
    flow.advance(40);
    CentreLines lines{.cost = {n * n, flow.steps()}, .at = {0}, .u = {0}, .v = {0}};
    for (int k = 0; k < n; ++k) {
        lines.at.push_back((k + 0.5) / n);
        lines.u.push_back(static_cast<Real>(flow.velocity()[0][flow.grid().layout().at({n / 2, k})]));
        lines.v.push_back(static_cast<Real>(flow.velocity()[1][flow.grid().layout().at({k, n / 2})]));
    }
    lines.at.push_back(1), lines.u.push_back(1), lines.v.push_back(0);
    return lines;
}

/// G. Taylor and A. Green's vortices in a periodic square of 2 pi, viscosity 0.01, to 10 s.
struct Vortices {
    static constexpr Real viscosity = 0.01, end = 10;
    static Point<2> exact(const Point<2>& x, Real t) {
        return std::exp(-2 * viscosity * t) *
               Point<2>(std::sin(x[0]) * std::cos(x[1]), -std::cos(x[0]) * std::sin(x[1]));
    }

    Cost cost{};
    std::vector<Real> u{},
        v{};  ///< [cell, x first] on the faces that keep them, at (i, j + 1/2), (i + 1/2, j)
};
template <AdvectionScheme Scheme, class State = Real>
Vortices taylor_green(int n, const Choice& choice) {
    GridFluid<2, InPrecision<State, Advected<Scheme, FullBox>>> flow(
        {.grid = {.cells = {n, n}, .spacing = Point<2>::Constant(2 * pi / n)},
         .boundaries = BoundaryConditions<2>::all(Boundary::periodic),
         .velocity = [](const Point<2>& x) { return Vortices::exact(x, 0); },
         .density = 1,
         .viscosity = Vortices::viscosity,
         .courant = choice.courant,
         .tolerance = choice.tolerance});
    flow.advance(Vortices::end);
    Vortices found{.cost = {n * n, flow.steps()}};
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const Offset c = flow.grid().layout().at({i, j});
            found.u.push_back(static_cast<Real>(flow.velocity()[0][c]));
            found.v.push_back(static_cast<Real>(flow.velocity()[1][c]));
        }
    return found;
}

/// The column of J. Martin and W. Moyce 1952 (doi:10.1098/rsta.1952.0006), twice as high as wide, in a box of
/// 8 by 3 widths, every 0.01 s to 0.24 s.
struct Collapse {
    static constexpr Real width = 0.05715;  ///< a [m]
    Cost cost{};
    std::vector<Real> time{};                ///< [s]
    std::vector<std::vector<Real>> floor{};  ///< [time][column] liquid fraction of the lowest cell

    /// Where the lowest row is half full, Z [a].
    Real front(std::size_t k) const {
        const std::vector<Real>& share = floor[k];
        std::size_t wet = 0;
        for (std::size_t i = 0; i + 1 < share.size(); ++i)
            if (share[i] > 0.5) wet = i;
        const Real beyond = (share[wet] - 0.5) / (share[wet] - share[wet + 1]);
        return (static_cast<Real>(wet) + 0.5 + beyond) * 8 / static_cast<Real>(share.size());
    }
};
/// `n`: cells across the column.
template <AdvectionScheme Scheme>
Collapse dam_break(int n, const Choice& choice) {
    constexpr Real width = Collapse::width;
    GridFluid<2, Advected<Scheme>> flow(
        {.grid = {.cells = {8 * n, 3 * n}, .spacing = Point<2>::Constant(width / n)},
         .boundaries = BoundaryConditions<2>::all(choice.walls),
         .water = [](const Point<2>& x) { return std::min(width - x[0], 2 * width - x[1]); },
         .gravity = {0, -9.81},
         .viscosity = 1e-3,
         .courant = choice.courant,
         .tolerance = choice.tolerance});
    Collapse found;
    for (int k = 0; k <= 24; ++k) {
        flow.advance(0.01 * k);
        found.time.push_back(0.01 * k);
        auto& floor = found.floor.emplace_back();
        for (int i = 0; i < 8 * n; ++i)
            floor.push_back(flow.liquid().fraction()[flow.grid().layout().at({i, 0})]);
    }
    found.cost = {24 * n * n, flow.steps()};
    return found;
}

/// A channel over a smooth bump, slow before it and fast behind, frictionless, from the hydrostatic stream to
/// 4 s. The discharge and the height are those of N. Sivakumaran, T. Tingsanchali and R. Hosking 1983
/// (doi:10.1017/S0022112083000567); the bump ends at 0.6 m.
struct Bump {
    static constexpr Real discharge = 0.11197;  ///< [m2/s]
    static constexpr Real gravity = 9.81, height = 0.2, half_length = 0.6, end = 4;
    static constexpr Real low = -1.2, high = 1.2, top = 0.48;  ///< of the box [m]
    static constexpr Real level = 0.346;                       ///< of the water that flows in [m]

    static Real bed(Real x) { return height * square(std::max(0.0, 1 - square(x / half_length))); }
    /// Of a stream that is critical on the crest: roots of h + q^2 / (2 g h^2) = E [m].
    static Real hydrostatic_depth(Real x) {
        const Real energy = height + 1.5 * std::cbrt(square(discharge) / gravity) - bed(x);
        const Real angle =
            std::acos(std::max(-1.0, 1 - 27 * square(discharge) / (4 * gravity * energy * square(energy))));
        return energy / 3 * (1 + 2 * std::cos((angle - (x < 0 ? 0 : 2 * pi)) / 3));
    }

    Cost cost{};
    std::vector<Real> x{}, surface{};  ///< [column] middle, level [m]: its water stands on its bed
};
/// `n`: cells along the channel.
template <class Surface, AdvectionScheme Scheme>
Bump bump(int n, const Choice& choice) {
    const Real spacing = (Bump::high - Bump::low) / n;
    GridFluidParams<2> params{
        .grid = {.cells = {n, static_cast<int>(std::lround(Bump::top / spacing))},
                 .low = {Bump::low, 0},
                 .spacing = Point<2>::Constant(spacing)},
        .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
        .wall = [](const Point<2>& x) { return x[1] - Bump::bed(x[0]); },
        .wall_law = {WallLaw::Kind::slip},
        .water = [](const Point<2>& x) { return Bump::bed(x[0]) + Bump::hydrostatic_depth(x[0]) - x[1]; },
        .velocity =
            [](const Point<2>& x) { return Point<2>(Bump::discharge / Bump::hydrostatic_depth(x[0]), 0); },
        .gravity = {0, -Bump::gravity},
        .viscosity = 1e-3,
        .courant = choice.courant,
        .tolerance = choice.tolerance};
    params.boundaries[0][1] = Boundary::outflow;
    Inflow<2>({.discharge = Bump::discharge, .depth = Bump::level}).give_to(params);
    GridFluid<2, Advected<Scheme, Surface>> flow(std::move(params));
    flow.advance(Bump::end);
    Bump found{.cost = {flow.grid().layout().cell_count(), flow.steps()}};
    for (int i = 0; i < flow.grid().cells(0); ++i) {
        Real air = 0;
        for (int k = 0; k < flow.grid().cells(1); ++k) {
            const Offset c = flow.grid().layout().at({i, k});
            air += (1 - flow.liquid().fraction()[c]) * flow.walls()->open_fraction()[c] * spacing;
        }
        found.x.push_back(flow.grid().centre(0, i)), found.surface.push_back(Bump::top - air);
    }
    return found;
}

}  // namespace water_flows
