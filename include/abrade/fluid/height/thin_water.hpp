#pragma once
// Friction of water that is too thin for the grid to know its layers.

#include <abrade/fluid/height/height_of_fluid.hpp>

namespace abrade::detail {

/// Faces between columns whose mean depth d [m] is below a tenth of a cell lose
///   du/dt = -max(c_f |u| / d, 3 nu / d^2) u,   c_f = 0.005,
/// turbulent friction over a depth (R. Dressler, doi:10.6028/jres.049.021) or that of a laminar film (W.
/// Nusselt 1916); implicit, so it only ever slows. Films on slopes and behind a water's edge have bounded
/// speeds by it.
template <int Dim>
void slow_thin_water(FaceField<Dim>& u, const HeightOfFluid<Dim>& liquid, Real dt, Real viscosity) {
    constexpr Real thin = 0.1, friction = 0.005;
    const HeightColumns<Dim>& columns = liquid.columns();
    const Grid<Dim>& grid = liquid.grid();
    const BoundaryConditions<Dim>& boundaries = liquid.boundaries();
    columns.parallel_for_each([&](int plane, int j, Index n) {
        for (int a = 0; a < Dim - 1; ++a) {
            const Index other = n - columns.step(a);
            if ((a == 0 ? plane : j) == 0 && !boundaries.periodic(a)) continue;
            const Real depth = 0.5 * (liquid.column_volume(n) + liquid.column_volume(other)) / columns.plan();
            const int low = std::min(columns.first(n), columns.first(other));
            if (low >= columns.levels() || !(depth > 0) ||
                depth >= thin * grid.size(Grid<Dim>::vertical, low))
                continue;
            const int high = std::max(liquid.top(n), liquid.top(other));
            for (int k = low; k <= std::min(high, columns.levels() - 1); ++k) {
                Real& speed = u[a][columns.cell(plane, j, k)];
                const Real rate = std::max(friction * std::abs(speed) / depth, 3 * viscosity / square(depth));
                speed /= 1 + dt * rate;
            }
        }
    });
}

}  // namespace abrade::detail
