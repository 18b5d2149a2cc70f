#pragma once
// What the engine asks of a fluid, and the null policy.

#include <abrade/core/law.hpp>

namespace abrade {

/// The fluid at one point.
struct FluidSample {
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
    Real depth = 0;                ///< of the point below the free surface [m]; negative above it
    Real density = 0;              ///< [kg/m3]
    Real viscosity = 0;            ///< dynamic [Pa s]
};

/// A fluid that can be sampled: `sample(x, t)`, const, noexcept, callable from many threads.
/// One-way fluids stop here. Fluids that feel the solids will refine this concept: solids in, loads out.
// clang-format off
template <class F>
concept FluidModel = Law<F> && requires(const F& fluid, const Vec3& x) {
    { fluid.sample(x, Real{}) } noexcept -> std::same_as<FluidSample>;
};
// clang-format on

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

}  // namespace abrade
