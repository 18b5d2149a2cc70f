#pragma once
// Where a flow is fastest: what an error says of a run that went wrong.

#include <abrade/fluid/mesh/grid.hpp>

#include <cmath>
#include <string>

namespace abrade::detail {

/// The fastest component on a face; a speed that is no number counts as the fastest.
template <int Dim>
struct FastFace {
    Real speed = -1;  ///< [m/s]
    int axis = 0;
    CellNumber<Dim> cell{};

    template <class State>
    FastFace(const Grid<Dim>& grid, const FaceField<Dim, State>& velocity) {
        grid.for_each([&](const CellNumber<Dim>& at, Offset c) {
            for (int a = 0; a < Dim; ++a) {
                const Real u = std::abs(static_cast<Real>(velocity[a][c]));
                if (!std::isnan(speed) && !(u <= speed)) speed = u, axis = a, cell = at;
            }
        });
    }
    std::string text() const {
        std::string text = "cell [";
        for (int b = 0; b < Dim; ++b) text += (b ? ", " : "") + std::to_string(cell[b]);
        return text + "] has " + short_text(speed) + " m/s along " + Grid<Dim>::axis_name(axis);
    }
};

/// What an error of a step begins with; time and length of the step [s].
inline std::string place_in_time(Index step, Real time, Real dt) {
    return "step " + std::to_string(step) + " (t = " + short_text(time) + " s, dt = " + short_text(dt) +
           " s): ";
}

/// What is wrong with a velocity that came out of a step, where it is, and what helps. `after`: what cells
/// gain of their volume [-], `most`: of what they may.
template <int Dim, class State>
std::string wrong_flow(const Grid<Dim>& grid, const FaceField<Dim, State>& velocity, Real after, Real most,
                       bool enters) {
    std::string cause, remedy;
    if (!std::isfinite(after))
        cause = "the velocity is not a number";
    else if (after > most)
        cause = "no pressure was found, cells gain " + short_text(after) + " of their volume" +
                (enters ? " (can what flows in reach a surface or an outflow?)" : "");
    else
        cause = "beyond GridFluid.velocity_limit", remedy = ", or raise velocity_limit if it is meant";
    return cause + "; " + FastFace<Dim>(grid, velocity).text() +
           "; take a smaller courant or step, or a finer grid there" + remedy;
}

}  // namespace abrade::detail
