#pragma once
// What the engine asks of a fluid: that it can be sampled, and of one that changes, that it goes on in time.
// The null policy.

#include <abrade/core/law.hpp>
#include <abrade/fluid/flow_body.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace abrade {

/// The fluid at one point; where there is none, nothing of it is submerged.
struct FluidSample {
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
    /// Of the point below the free surface [m]; negative above it, without end where no fluid is.
    Real depth = -std::numeric_limits<Real>::infinity();
    Real density = 0;    ///< [kg/m3]
    Real viscosity = 0;  ///< dynamic [Pa s]
};

/// How the fluid changes around one point. A fluid that knows it offers `change(x, t)`, const, noexcept.
struct FlowChange {
    Vec3 acceleration = Vec3::Zero();  ///< Du/Dt [m/s2]
    Mat3 gradient = Mat3::Zero();      ///< du_i/dx_j [1/s]

    /// Curl of the velocity [1/s].
    Vec3 vorticity() const noexcept {
        return {gradient(2, 1) - gradient(1, 2), gradient(0, 2) - gradient(2, 0),
                gradient(1, 0) - gradient(0, 1)};
    }
};

/// The longest step that is stable for a fluid as it stands [s], and what sets it.
struct FluidStep {
    Real seconds = std::numeric_limits<Real>::infinity();
    std::string_view limit = "nothing flows";  ///< "CFL"
    Index cell = -1;                           ///< that sets it, in the fluid's own count; -1: none

    void lower(Real candidate, std::string_view reason, Index whose = -1) noexcept {
        if (candidate < seconds) seconds = candidate, limit = reason, cell = whose;
    }
};

/// Throws InputError for a fluid's time that its steps would be lost in.
inline void require_start_time(Real time, std::string field) {
    require(std::abs(time) <= 1e9,
            {std::move(field), "from -1e9 to 1e9", "s", "beyond that steps are lost in its round-off"}, time);
}

/// A step of a fluid that went wrong. What throws it leaves the fluid as it was before that step, and says in
/// its text where, how fast and why; a simulation raises it as RunError.
struct FluidError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A fluid that can be sampled: `sample(x, t)`, const, noexcept, callable from many threads.
///
/// What stays as it is stops here. `AdvancingFluid` refines it, `ResolvedFluid` that: bodies in, loads out.
// clang-format off
template <class F>
concept FluidModel = Law<F> && requires(const F& fluid, const Vec3& x) {
    { fluid.sample(x, Real{}) } noexcept -> std::same_as<FluidSample>;
};

/// A fluid that changes in time, in steps of its own:
/// - `time()`: where it is [s]. It may begin before 0, to be settled when the solids begin;
/// - `stable_step()`: the longest step that it could take from here; infinite where nothing flows;
/// - `advance(to_time)`: goes on to exactly that time, in as many steps as that takes; at once where it is there
///   or beyond. Throws FluidError.
/// Before solids take a step from t to t + dt the simulation brings the fluid to t + dt, or by a whole step of the
/// fluid's where that leads beyond. `sample(x, t)` is then asked for times up to `time()`, no more than a step
/// (the fluid's or the solids', whichever is longer) before it; answering with the state of `time()` is allowed: in
/// that while no wave crosses a cell.
template <class F>
concept AdvancingFluid = FluidModel<F> && requires(F& fluid, const F& still) {
    fluid.advance(Real{});
    { still.time() } noexcept -> std::same_as<Real>;
    { still.stable_step() } -> std::same_as<FluidStep>;
};
// clang-format on

// clang-format off
/// A fluid that flows around bodies and finds what it does to them, together with its own pressure.
/// `advance(to_time, bodies)`: bodies as they stand at `to_time`, moved there by all that acts on them, the load
/// that they had from the last exchange included; gives them the velocity that they have together with the fluid,
/// and the load that stands for the fluid until the next exchange. Solids lead: they take their steps up to the end
/// of the fluid's next one, then the fluid follows. `sample` is not asked.
template <class F>
concept ResolvedFluid = AdvancingFluid<F> && requires(F& fluid, std::span<FlowBody> bodies) {
    fluid.advance(Real{}, bodies);
};
// clang-format on

/// Of a fluid that does not know: it is taken for one that is uniform and steady.
template <class F>
FlowChange change_of([[maybe_unused]] const F& fluid, [[maybe_unused]] const Vec3& x,
                     [[maybe_unused]] Real t) noexcept {
    if constexpr (requires { fluid.change(x, t); })
        return fluid.change(x, t);
    else
        return {};
}

/// Whether a fluid means to change: one that does so in part only would be taken for one that stays as it is.
template <class F>
inline constexpr bool advances_in_time = requires(F& fluid) {
    fluid.advance(Real{});
};

/// Brings a fluid that changes to `t`, or one whole step of its own further where that leads beyond `t`: a
/// step of solids is often much shorter than the fluid's.
template <AdvancingFluid F>
void bring_fluid_to(F& fluid, Real t) {
    const Real now = fluid.time();
    if (now >= t) return;
    const Real own = fluid.stable_step().seconds;
    fluid.advance(own < std::numeric_limits<Real>::infinity() ? std::max(t, now + own) : t);
}

/// A vacuum.
struct NoFluid {
    static constexpr std::string_view name = "NoFluid";
    using Params = NoParams;

    NoFluid() = default;
    explicit NoFluid(Params) {}
    const Params& params() const noexcept {
        static constexpr Params none{};
        return none;
    }
    FluidSample sample(const Vec3&, Real) const noexcept { return {}; }
};

static_assert(FluidModel<NoFluid>);
static_assert(!FluidModel<NoParams>);
static_assert(!AdvancingFluid<NoFluid>);

}  // namespace abrade
