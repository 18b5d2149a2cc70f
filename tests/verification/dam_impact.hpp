#pragma once
// Columns of water fall and run against the far wall of their tank: the pressure that the wall feels, and how
// high the water runs up on it.

#include "reference_table.hpp"

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace dam_impact {

using namespace abrade;

constexpr Real gravity = 9.81;  ///< [m/s2]

/// A column of water in a corner of a tank that has a pressure sensor in its far wall.
struct Tank {
    std::string reference;  ///< what was measured, by file name
    Real height = 0;        ///< of the column, H [m]
    Real column = 0;        ///< its length [m]
    Real length = 0;        ///< of the tank [m]
    Real width = 0;         ///< of the tank, in three dimensions [m]
    int roof = 2;           ///< height of the tank [H]
    Real sensor = 0;        ///< above the floor [m]
    Real arrived = 0;       ///< pressure at which the water has arrived at the sensor [rho g H]
    Real viscosity = 0;     ///< of the water, dynamic [Pa s]

    Real times_per_second() const { return std::sqrt(gravity / height); }  ///< T = t sqrt(g / H) [1/s]
};

/// L. Lobovsky et al. 2014, doi 10.1016/j.jfluidstructs.2014.03.009; water at 25 degrees C.
inline const Tank lobovsky{.reference = "flu07_dambreak_lobovsky2014_pressure.csv",
                           .height = 0.3,
                           .column = 0.6,
                           .length = 1.61,
                           .width = 0.15,
                           .roof = 2,
                           .sensor = 0.003,
                           .arrived = 0.5,
                           .viscosity = 0.89e-3};
/// B. Buchner 2002, Green water on ship-type offshore structures, TU Delft. Height and width of the tank are
/// not in the data: it is two-dimensional here, and no water reaches this roof.
inline const Tank buchner{.reference = "flu08_dambreak_buchner2002_pressure.csv",
                          .height = 0.6,
                          .column = 1.2,
                          .length = 5.366 * 0.6,
                          .width = 0,
                          .roof = 4,
                          .sensor = 0.12,
                          .arrived = 0.3,
                          .viscosity = 1.0e-3};

/// The far wall and the floor at a time.
struct Sample {
    Real time = 0;      ///< T = t sqrt(g / H) [-]
    Real pressure = 0;  ///< P = p / (rho g H) [-]
    Real run_up = 0;    ///< where the water on the wall ends [H]
    Real front = 0;     ///< where the water on the floor ends [H]
};

/// `n` cells to the column's height, walls without friction.
template <int Dim>
GridFluid<Dim> dam(const Tank& tank, int n) {
    const Real h = tank.height / n;
    GridFluidParams<Dim> params;
    params.grid.cells.fill(std::max(static_cast<int>(std::lround(tank.width / h)), 1));
    params.grid.cells[0] = static_cast<int>(std::lround(tank.length / h));
    params.grid.cells[Dim - 1] = tank.roof * n;
    params.grid.spacing = Point<Dim>::Constant(h);
    params.grid.spacing[0] = tank.length / params.grid.cells[0];
    params.boundaries = BoundaryConditions<Dim>::all(Boundary::free_slip);
    params.water = [tank](const Point<Dim>& x) {
        return std::min(tank.column - x[0], tank.height - x[Dim - 1]);
    };
    params.gravity[Dim - 1] = -gravity;
    params.viscosity = tank.viscosity;
    return GridFluid<Dim>(params);
}

/// The same between walls that hold the water: no slip at roughness 0, else a rough wall's logarithmic law.
inline GridFluid<2> dam_between_holding_walls(const Tank& tank, int n, Real roughness) {
    auto params = dam<2>(tank, n).params();
    params.boundaries = BoundaryConditions<2>::all(Boundary::wall);
    if (roughness > 0) params.wall_law = {WallLaw::Kind::logarithmic, roughness};
    return GridFluid<2>(params);
}

/// The wall until T = `end`. The pressure is that of the wall's cells, linear between the two whose centres
/// are next to the sensor; below the lowest centre it is that cell's. The water on the wall ends, from the
/// floor up, where a twentieth of H beside the wall is less than half full for the first time: the same
/// thickness on all grids. On the floor it ends with the last cell that is half full.
template <int Dim>
std::vector<Sample> run(const Tank& tank, GridFluid<Dim>& flow, Real end) {
    const Grid<Dim>& grid = flow.grid();
    const int across = grid.cells(0), up = grid.cells(Dim - 1);
    const Real h = grid.size(Dim - 1, 0);
    CellNumber<Dim> cell;
    cell.fill(grid.cells(1) / 2);
    const auto at = [&](int i, int k) {
        cell[0] = i, cell[Dim - 1] = k;
        return grid.layout().at(cell);
    };
    const Real place = std::max(tank.sensor / h - 0.5, Real(0));
    const int below = static_cast<int>(place);
    const Real share = place - below;
    const int beside = std::max(static_cast<int>(std::lround(tank.height / h)) / 20, 1);
    std::vector<Sample> seen;
    while (flow.time() * tank.times_per_second() < end) {
        flow.step(flow.stable_step().seconds);
        const auto& p = flow.pressure();
        const auto& f = flow.liquid().fraction();
        const auto is_wet = [&](int k) {
            Real sum = 0;
            for (int i = across - beside; i < across; ++i) sum += f[at(i, k)];
            return sum >= 0.5 * beside;
        };
        int wet = 0, front = across;
        while (wet < up && is_wet(wet)) ++wet;
        while (front > 0 && f[at(front - 1, 0)] < 0.5) --front;
        const Real felt = (1 - share) * p[at(across - 1, below)] + share * p[at(across - 1, below + 1)];
        seen.push_back({flow.time() * tank.times_per_second(), felt / (gravity * tank.height),
                        wet * h / tank.height, front * grid.size(0, 0) / tank.height});
    }
    return seen;
}

/// In the order of time: the digitised points are not.
inline std::vector<Sample> measured(const Tank& tank) {
    std::vector<Sample> found;
    for (const ReferenceRow& row : reference_table(tank.reference))
        found.push_back({.time = row.at("T"), .pressure = row.at("P")});
    std::ranges::stable_sort(found, {}, &Sample::time);
    return found;
}

/// When the pressure first reaches that of an arrival.
inline Real arrival(const Tank& tank, const std::vector<Sample>& series) {
    for (const Sample& s : series)
        if (s.pressure >= tank.arrived) return s.time;
    return series.back().time;
}
/// Of the pressure over a while, linear between samples.
inline Real mean(const std::vector<Sample>& series, Real from, Real to) {
    Real sum = 0;
    for (std::size_t k = 1; k < series.size(); ++k) {
        const Sample &a = series[k - 1], &b = series[k];
        const Real low = std::max(a.time, from), high = std::min(b.time, to);
        if (high <= low) continue;
        const Real slope = (b.pressure - a.pressure) / (b.time - a.time);
        sum += (high - low) * (a.pressure + slope * (0.5 * (low + high) - a.time));
    }
    return sum / (to - from);
}
struct Peak {
    Real height = 0;  ///< [rho g H]
    Real time = 0;    ///< the middle of its while, T [-]
};
/// Largest mean over a while, so that no single step and no single point counts.
inline Peak peak(const std::vector<Sample>& series, Real from, Real to, Real window) {
    Peak most{-1e9, 0};
    for (Real start = from; start + window <= to; start += 0.01)
        if (const Real height = mean(series, start, start + window); height > most.height)
            most = {height, start + 0.5 * window};
    return most;
}

/// What is compared with measurements, which are treated alike.
struct Impact {
    Real arrival = 0;  ///< T [-]
    Peak first{};      ///< up to T = 3.5, means over 0.05
    Real plateau = 0;  ///< mean from T = 3.5 to 5 [rho g H]
    Peak second{};     ///< the run-up falls back: T = 5 to 7, means over 0.1
};
constexpr Real last_time = 7;  ///< T [-]
inline Impact impact(const Tank& tank, const std::vector<Sample>& series) {
    const Real end = std::min(series.back().time, last_time);
    return {.arrival = arrival(tank, series),
            .first = peak(series, 2, 3.5, 0.05),
            .plateau = mean(series, 3.5, 5),
            .second = peak(series, 5, end, 0.1)};
}

/// Mean speed of the front from 0.6 to 0.1 H before the wall [sqrt(g H)].
inline Real front_speed(const Tank& tank, const std::vector<Sample>& series) {
    const Real wall = tank.length / tank.height;
    Real from = 0, to = 0;
    for (const Sample& s : series) {
        if (from == 0 && s.front >= wall - 0.6) from = s.time;
        if (to == 0 && s.front >= wall - 0.1) to = s.time;
    }
    return 0.5 / (to - from);
}
/// Height and v^2 / 2g of the water that climbs, at a height of H [H]: where it gets without friction.
inline Real climbing_head(const std::vector<Sample>& series) {
    Real from = 0, to = 0;
    for (const Sample& s : series) {
        if (from == 0 && s.run_up >= 0.75) from = s.time;
        if (to == 0 && s.run_up >= 1.25) to = s.time;
    }
    return 1 + 0.5 * square(0.5 / (to - from));
}
inline Real largest_run_up(const std::vector<Sample>& series) {
    return std::ranges::max(series, {}, &Sample::run_up).run_up;
}

}  // namespace dam_impact
