#pragma once
// A liquid at rest that feels nothing, written as a user would.

#include <abrade/fluid/fluid_model.hpp>

namespace abrade {

struct StillParams {
    Real viscosity = 1e-3, surface = 1e9, density = 1000;
    void validate() const { require_positive(viscosity, "Still.viscosity", "Pa s"); }
    void visit(auto&& f) const {
        f("viscosity", viscosity, "Pa s"), f("surface", surface, "m"), f("density", density, "kg/m3");
    }
};

/// A lake.
struct Still {
    static constexpr std::string_view name = "Still";
    using Params = StillParams;
    explicit Still(Params p) : params_(p) { params_.validate(); }
    const Params& params() const noexcept { return params_; }
    FluidSample sample(const Vec3& x, Real) const noexcept {
        return {Vec3::Zero(), params_.surface - x.z(), params_.density, params_.viscosity};
    }

private:
    Params params_;
};
static_assert(FluidModel<Still>);

}  // namespace abrade
