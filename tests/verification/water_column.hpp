#pragma once
// A column of water that collapses: J. Martin and W. Moyce 1952, doi 10.1098/rsta.1952.0006; height twice the
// width.

#include <abrade/fluid/grid_fluid.hpp>

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
         .sides = Sides<2>::all(Side::slip),
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

}  // namespace water_column
