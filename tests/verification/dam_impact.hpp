#pragma once
// A column of water runs against a wall: L. Lobovsky et al. 2014, doi 10.1016/j.jfluidstructs.2014.03.009.
// Column 0.3 m high and 0.6 m long, tank 1.61 m, pressure 3 mm above the floor.

#include "reference_table.hpp"

#include <abrade/fluid/grid_fluid.hpp>

#include <algorithm>
#include <vector>

namespace dam_impact {

using namespace abrade;

constexpr Real height = 0.3, length = 0.6, tank = 1.61, sensor = 0.003, gravity = 9.81;  ///< [m], [m/s2]

struct Pressure {
    Real time = 0, value = 0;  ///< T = t sqrt(g / H), P = p / (rho g H) [-]
};

/// `n` cells to the column's height, walls without friction.
template <int Dim>
GridFluid<Dim> dam(int n) {
    const Real h = height / n;
    GridFluidParams<Dim> params;
    params.grid.cells.fill(std::max(static_cast<int>(std::lround(0.15 / h)), 1));  // the tank is 0.15 m wide
    params.grid.cells[0] = static_cast<int>(std::lround(tank / h));
    params.grid.cells[Dim - 1] = 2 * n;
    params.grid.spacing = Point<Dim>::Constant(h);
    params.grid.spacing[0] = tank / params.grid.cells[0];
    params.sides = Sides<Dim>::all(Side::slip);
    params.water = [](const Point<Dim>& x) { return std::min(length - x[0], height - x[Dim - 1]); };
    params.gravity[Dim - 1] = -gravity;
    params.viscosity = 0.89e-3;
    return GridFluid<Dim>(params);
}

/// What the sensor sees until T = `end`: pressure at the wall, from the cells at its height.
template <int Dim>
std::vector<Pressure> run(GridFluid<Dim>& flow, Real end) {
    const Grid<Dim>& grid = flow.grid();
    const Real unit = std::sqrt(gravity / height);
    CellNumber<Dim> cell;
    cell.fill(grid.cells(1) / 2);
    cell[0] = grid.cells(0) - 1;
    cell[Dim - 1] = static_cast<int>(sensor / grid.size(Dim - 1, 0));
    const Offset at = grid.layout().at(cell);
    std::vector<Pressure> seen;
    while (flow.time() * unit < end) {
        flow.step(flow.stable_step().seconds);
        seen.push_back({flow.time() * unit, flow.pressure()[at] / (gravity * height)});
    }
    return seen;
}

inline std::vector<Pressure> measured() {
    std::vector<Pressure> found;
    for (const ReferenceRow& row : reference_table("flu07_dambreak_lobovsky2014_pressure.csv"))
        found.push_back({row.at("T"), row.at("P")});
    return found;
}

/// When the pressure first reaches half of what rests there would weigh.
inline Real arrival(const std::vector<Pressure>& series) {
    for (const Pressure& p : series)
        if (p.value >= 0.5) return p.time;
    return series.back().time;
}
/// Mean over a while, by the trapezium rule.
inline Real mean(const std::vector<Pressure>& series, Real from, Real to) {
    Real sum = 0, time = 0;
    for (std::size_t k = 1; k < series.size(); ++k) {
        if (series[k - 1].time < from || series[k].time > to) continue;
        const Real step = series[k].time - series[k - 1].time;
        sum += 0.5 * step * (series[k - 1].value + series[k].value), time += step;
    }
    return sum / time;
}
/// Largest mean over a while, so that no single step counts.
inline Real peak(const std::vector<Pressure>& series, Real window = 0.05) {
    Real most = 0;
    for (const Pressure& p : series)
        if (p.time + window <= series.back().time)
            most = std::max(most, mean(series, p.time, p.time + window));
    return most;
}

}  // namespace dam_impact
