#pragma once
// The cube whose lid slides, at Re 1000: S. Albensoeder and H. Kuhlmann 2005, doi 10.1016/j.jcp.2004.12.024,
// tables 5 and 6.

#include "reference_table.hpp"

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

namespace cavity_3d {

using namespace abrade;

constexpr Real reynolds = 1000;

/// The lid is the upper side and slides along x. The flow is its own mirror across the plane y = 1/2: half
/// the cube, before a side that glides, is all of it.
template <AdvectionScheme Scheme>
GridFluid<3, Advected<Scheme, FullBox>> half_cube(int n) {
    BoundaryConditions<3> boundaries;
    boundaries[1][1] = Boundary::free_slip;
    return GridFluid<3, Advected<Scheme, FullBox>>(
        {.grid = {.cells = {n, n / 2, n}, .spacing = Point<3>::Constant(1.0 / n)},
         .boundaries = boundaries,
         .boundary_velocity = [](const Point<3>& x, Real) { return Point<3>(x[2] > 1 - 1e-9 ? 1 : 0, 0, 0); },
         .density = 1,
         .viscosity = 1 / reynolds});
}

/// Differences to the tables along a line, as shares of the lid's speed.
struct LineErrors {
    Real root_mean_square = 0, largest = 0;
    Real extremum = 0;  ///< of the smallest and the largest value, the larger relative error [-]
};
struct Errors {
    LineErrors u;  ///< along the lid's motion, on the upright centre line
    LineErrors w;  ///< upright, on the level centre line
};

Errors errors(const auto& flow) {
    // The tables' lid stands at x = -1/2 and moves along y.
    Errors e;
    for (const bool upright : {true, false}) {
        LineErrors& line = upright ? e.u : e.w;
        Real sum = 0, least = 0, most = 0, least_there = 0, most_there = 0;
        int count = 0;
        const auto value = [&](Real place) {  // w: the tables' u is downward
            return upright ? flow.sample({0.5, 0.5, 0.5 - place}, 0).velocity.x()
                           : -flow.sample({place + 0.5, 0.5, 0.5}, 0).velocity.z();
        };
        for (const ReferenceRow& row : reference_table("flu03_albensoeder3D_cavity_Re1000_cube.csv")) {
            const Real place = row.at("coordinate"), wanted = row.at("value");
            if (row.is("profile", upright ? "v_of_x" : "u_of_y") == false || std::abs(place) > 0.499)
                continue;
            const Real off = value(place) - wanted;
            sum += off * off, ++count;
            line.largest = std::max(line.largest, std::abs(off));
            // Beside the lid the largest value is the lid's, so the extrema are those of the return flow.
            if (upright && place < -0.4) continue;
            if (wanted < least) least = wanted, least_there = value(place);
            if (wanted > most) most = wanted, most_there = value(place);
        }
        line.root_mean_square = std::sqrt(sum / count);
        line.extremum = std::abs(least_there / least - 1);
        if (!upright) line.extremum = std::max(line.extremum, std::abs(most_there / most - 1));
    }
    return e;
}

}  // namespace cavity_3d
