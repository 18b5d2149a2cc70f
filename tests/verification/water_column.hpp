#pragma once
// A column of water that collapses: J. Martin and W. Moyce 1952, doi 10.1098/rsta.1952.0006; height twice the
// width.

#include "reference_table.hpp"

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

#include <string>
#include <vector>

namespace water_column {

using namespace abrade;

struct Front {
    Real time = 0, place = 0;  ///< T = t sqrt(2 g / a), Z = x / a [-]
};

/// How the front goes, with `n` cells across the column, until Z = `end`; `flow` is left as it was then.
template <class Flow>
std::vector<Front> run(Flow& flow, Real width, Real end) {
    const Real h = flow.grid().size(0, 0), unit = std::sqrt(2 * 9.81 / width);
    std::vector<Front> fronts{{0, 1}};
    while (fronts.back().place < end) {
        flow.step(flow.stable_step().seconds);
        Real place = 0;
        // Half full cells count; where the tip is, along the cell.
        for (int i = 0; i < flow.grid().cells(0); ++i) {
            Real share = 0;
            for (int k = 0; k < flow.grid().cells(1) / 8; ++k)
                share = std::max(share, flow.liquid().fraction()[flow.grid().layout().at({i, k})]);
            if (share >= 0.5) place = (i + share) * h;
        }
        fronts.push_back({flow.time() * unit, place / width});
    }
    return fronts;
}

inline GridFluid<2> column(int n, Real width, Real length) {
    const Real h = width / n;
    return GridFluid<2>(
        {.grid = {.cells = {static_cast<int>(length * n), 5 * n / 2}, .spacing = {h, h}},
         .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
         .water = [width](const Point<2>& x) { return std::min(width - x[0], 2 * width - x[1]); },
         .gravity = {0, -9.81},
         .viscosity = 1e-3});
}

/// Place at a time, or time at a place.
inline Real at(const std::vector<Front>& fronts, Real Front::*from, Real Front::*wanted, Real value) {
    for (std::size_t k = 1; k < fronts.size(); ++k)
        if (fronts[k].*from >= value) {
            const Real share = (value - fronts[k - 1].*from) / (fronts[k].*from - fronts[k - 1].*from);
            return fronts[k - 1].*wanted + share * (fronts[k].*wanted - fronts[k - 1].*wanted);
        }
    return fronts.back().*wanted;
}

/// Largest relative error of the front to Z = 4.9. The diaphragm of the experiment takes its time: aligned at
/// Z = 1.44 (1.443 and 1.474 in the tables).
inline Real worst_of_series(const std::vector<Front>& fronts, const std::string& series) {
    Real offset = 0, most = 0;
    for (const ReferenceRow& row : reference_table("flu06_dambreak_front_martin_moyce.csv")) {
        if (!row.is("series", series) || row.at("Z") < 1.4 || row.at("Z") > 4.9) continue;
        if (offset == 0) offset = row.at("T") - at(fronts, &Front::place, &Front::time, row.at("Z"));
        const Real place = at(fronts, &Front::time, &Front::place, row.at("T") - offset);
        MESSAGE(series << ": T = " << row.at("T") << ", Z = " << row.at("Z") << ", here " << place);
        most = std::max(most, std::abs(place / row.at("Z") - 1));
    }
    MESSAGE("largest error of the front " << 100 * most << " %");
    return most;
}

}  // namespace water_column
