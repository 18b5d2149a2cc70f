#pragma once
// What a projection asks of who solves for the pressure.

#include <abrade/fluid/mesh/plane_runs.hpp>
#include <abrade/fluid/pressure/poisson.hpp>

#include <concepts>
#include <string_view>

namespace abrade {

/// Solves A e = b for a Poisson operator that is filled anew in each step: `matrix()`, then `build()`, which
/// closes its periodic sides and completes it (`detail::close_periodic`, `Poisson::complete`);
/// `right_side()`, then `solve(target, limit)` until the norm of what is left (the root of the sum of
/// squares) is at most `target`, or `limit` iterations are done. It may overwrite the right side. `runs()`
/// are its planes, shared out to threads; `floating()` says that e is known but for a constant. Solids that
/// move in the flow add to the operator within the search (SolidsInFlow): who can do that takes them as a
/// third argument.
// clang-format off
template <class S, int Dim>
concept PressureSolver = std::copyable<S> &&
    std::constructible_from<S, const Layout<Dim>&, const Point<Dim>&, const PerAxis<bool, Dim>&> &&
    requires(S& s, const S& still) {
    { s.matrix() } -> std::same_as<Poisson<Dim>&>;
    { S::name } -> std::convertible_to<std::string_view>;
    s.build();
    { s.right_side() } -> std::same_as<Field<float>&>;
    { s.solve(Real{}, int{}).iterations } -> std::convertible_to<int>;
    { still.solution() } -> std::same_as<const Field<float>&>;
    { still.runs() } -> std::same_as<const detail::PlaneRuns&>;
    { still.floating() } -> std::same_as<bool>;
};
// clang-format on

}  // namespace abrade
