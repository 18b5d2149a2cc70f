#pragma once
// How long a step of water on a grid may be.

#include <abrade/fluid/fluid_model.hpp>
#include <abrade/fluid/setup/grid_fluid_params.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace abrade::detail {

/// What a step depends on beside grid and parameters.
template <int Dim>
struct StepCauses {
    Real viscosity = 0;  ///< kinematic, that of eddies included [m2/s]
    Real fastest = 0;    ///< largest sum |u_a| / h_a [1/s]
    /// Largest rate of a cell with speed and eddies together, where it is known: eddies are seldom where
    /// water is fastest [1/s].
    Real combined = std::numeric_limits<Real>::infinity();
    Real push_per_cell = 0;  ///< sum over axes of a user's largest acceleration of the water, over h_a [1/s2]
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
    // One limit for both, or what each of them allows alone would be too much together. Heun's method is
    // stable for real eigenvalues down to -2/dt; those of friction reach -4 nu sum 1/h^2.
    const Real friction = 2 * causes.viscosity * per_h2;
    const Real rate = std::max(causes.fastest, std::min(causes.fastest + friction, causes.combined));
    // At its end gravity and pushes may have made the water faster by their acceleration times dt.
    const Real twice = rate + std::sqrt(square(rate) + 4 * (fall + causes.push_per_cell) * params.courant);
    if (twice > 0) {
        const Real dt = 2 * params.courant / twice;
        step.lower(dt, dt * friction > 0.5 * params.courant ? "viscosity" : "CFL");
    }
    // The shortest wave that the grid knows, of two cells, must not cross a cell.
    if (fall > 0) step.lower(std::sqrt(pi * shortest / causes.gravity->norm()), "gravity wave");
    return step;
}

/// In which neither the fastest solid nor one that falls from rest goes further than water may.
template <int Dim>
FluidStep step_among_solids(FluidStep step, const Grid<Dim>& grid, const GridFluidParams<Dim>& params,
                            Real fastest) {
    const Real way = params.courant * grid.smallest(), falls = std::sqrt(way * params.gravity.norm());
    step.lower(way / std::max(fastest, falls), "solids");
    return step;
}

/// The longest step up to `longest` [s] within which a body force goes on as it does: its path is no longer
/// than its change by more than a tenth of its largest value. A force that is no number shows in the step.
template <int Dim>
Real smooth_step(const BodyForce<Dim>& force, Real time, Real longest) {
    constexpr int parts = 8;
    constexpr Real shortest = 1e-6;  // of the longest: what jumps is taken as it comes
    for (Real dt = longest;; dt *= 0.5) {
        const Point<Dim> first = force(time);
        Point<Dim> last = first;
        Real path = 0, largest = last.norm();
        for (int n = 1; n <= parts; ++n) {
            const Point<Dim> now = force(time + dt * n / parts);
            path += (now - last).norm(), largest = std::max(largest, now.norm());
            last = now;
        }
        if (!(path - (last - first).norm() > 0.1 * largest)) return dt;
        if (dt < shortest * longest) return longest;
    }
}

/// The same, as long as a body force goes on as it does. A given force may not know the time beyond the run:
/// it then fails the step that asks for it.
template <int Dim>
FluidStep step_of_body_force(FluidStep step, const GridFluidParams<Dim>& params, Real time) {
    if (!params.body_force || !std::isfinite(step.seconds)) return step;
    try {
        step.lower(smooth_step<Dim>(params.body_force, time, step.seconds), "body force");
    } catch (...) {
    }
    return step;
}

}  // namespace abrade::detail
