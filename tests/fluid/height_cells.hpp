#pragma once
// What the cells below a height say, in two and three dimensions: not what the class says of itself.

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <algorithm>
#include <cmath>

namespace height_cells {

using namespace abrade;

/// Of the fractions [m3].
Real volume_in_cells(const auto& flow) {
    long double sum = 0;
    flow.grid().for_each([&](const auto& cell, Offset c) {
        const Real open = flow.walls() ? flow.walls()->open_fraction()[c] : 1;
        sum += static_cast<long double>(open * flow.grid().volume(cell)) *
               static_cast<long double>(flow.liquid().fraction()[c] + flow.liquid().volume_defect()[c]);
    });
    return static_cast<Real>(sum);
}

/// Largest speed on a lower face of a cell that holds liquid [m/s].
Real fastest(const auto& flow) {
    Real most = 0;
    flow.grid().for_each([&](const auto&, Offset c) {
        if (!(flow.liquid().fraction()[c] > 0)) return;
        for (const auto& u : flow.velocity()) most = std::max(most, std::abs(u[c]));
    });
    return most;
}

}  // namespace height_cells
