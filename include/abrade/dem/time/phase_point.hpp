#pragma once
// A small mechanical state, and what a system with memory must offer so that any stepper may move it.

#include <abrade/core/types.hpp>

#include <array>
#include <concepts>
#include <cstddef>

namespace abrade {

/// Positions and velocities of a system with N degrees of freedom. The library's engine has a state of its
/// own (sim/state/state.hpp); this one is for a contact alone, an oscillator, a law under study.
template <std::size_t N>
struct PhasePoint {
    using Vector = std::array<Real, N>;
    static constexpr std::size_t degrees = N;
    Vector position{}, velocity{};
};

/// A system whose forces may depend on a memory (contact laws do). An evaluation answers from the memory
/// committed last and keeps what it makes of it as a *trial*, which the next evaluation throws away; `commit`
/// makes the last trial the memory. A multistage stepper evaluates as often as it likes and commits once,
/// after an accepted step, an evaluation at the positions where that step ended.
template <class S, std::size_t N>
concept TrialSystem = requires(S& system, const std::array<Real, N>& vector, Real dt) {
    { system.acceleration(vector, vector) } -> std::same_as<std::array<Real, N>>;
    // Along a step of length dt whose forces are taken once, at its end: laws may then correct, by dt, for
    // what began within the step.
    { system.acceleration_after(dt, vector, vector) } -> std::same_as<std::array<Real, N>>;
    system.commit();
};

/// What names a stepper: `M::Stepper<System, N> s(system, point); s.step(dt)` moves `point`, which it refers
/// to, and commits once. See dem/time/odeint_steppers.hpp.
// clang-format off
template <class M>
concept Method = requires(const M& method) {
    { M::name } -> std::convertible_to<const char*>;
    { M::order } -> std::convertible_to<int>;  // on smooth forces that depend on positions only
};
// clang-format on

}  // namespace abrade
