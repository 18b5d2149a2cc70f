#pragma once
// How long a step of water on a grid may be.

#include <abrade/fluid/fluid_model.hpp>
#include <abrade/fluid/grid_fluid_params.hpp>

#include <cmath>
#include <limits>

namespace abrade::detail {

/// What a step depends on beside grid and parameters.
template <int Dim>
struct StepCauses {
    Real viscosity = 0;                   ///< kinematic, that of eddies included [m2/s]
    Real fastest = 0;                     ///< largest sum |u_a| / h_a [1/s]
    const Point<Dim>* gravity = nullptr;  ///< below a surface, body forces included [m/s2]
};

/// Limits by friction, speed and, below a surface, by what gravity does to it.
template <int Dim>
FluidStep limit_of_step(const Grid<Dim>& grid, const GridFluidParams<Dim>& params,
                        const StepCauses<Dim>& causes) {
    FluidStep step;
    if (params.largest_step > 0) step.lower(params.largest_step, "largest_step");
    const bool surface = causes.gravity != nullptr;
    Real per_h2 = 0, fall = 0, shortest = std::numeric_limits<Real>::infinity();
    for (int a = 0; a < Dim; ++a) {
        const Real size = grid.smallest(a);
        per_h2 += 1 / square(size);
        if (surface) fall += std::abs((*causes.gravity)[a]) / size;
        shortest = std::min(shortest, size);
    }
    // Heun's method is stable for real eigenvalues down to -2/dt; those of friction reach -4 nu sum 1/h^2. At
    // the limit itself a pattern of cells would not decay, and a surface feeds it.
    if (causes.viscosity > 0) step.lower((surface ? 0.4 : 0.5) / (causes.viscosity * per_h2), "viscosity");
    // At its end gravity may have made the water faster by g dt.
    const Real twice = causes.fastest + std::sqrt(square(causes.fastest) + 4 * fall * params.courant);
    if (twice > 0) step.lower(2 * params.courant / twice, "CFL");
    // The shortest wave that the grid knows, of two cells, must not cross a cell.
    if (fall > 0) step.lower(std::sqrt(pi * shortest / causes.gravity->norm()), "gravity wave");
    return step;
}

}  // namespace abrade::detail
