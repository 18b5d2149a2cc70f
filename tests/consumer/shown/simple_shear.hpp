#pragma once
#include <abrade/fluid/fluid_model.hpp>

/// Water sheared between the plane z = 0 and its surface: u_x = rate z.
class SimpleShear {
public:
    static constexpr std::string_view name = "SimpleShear";

    struct Params {
        double rate = 0;   ///< [1/s]
        double level = 1;  ///< of the surface [m]
        void validate() const {
            abrade::require(std::isfinite(rate), {"SimpleShear.rate", "finite", "1/s"}, rate);
            abrade::require_positive(level, "SimpleShear.level", "m");
        }
        void visit(auto&& f) const { f("rate", rate, "1/s"), f("level", level, "m"); }
    };

    explicit SimpleShear(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    abrade::FluidSample sample(const abrade::Vec3& x, double /*time*/) const noexcept {
        return {.velocity = {params_.rate * x.z(), 0, 0},
                .depth = params_.level - x.z(),
                .density = 1000,
                .viscosity = 1.31e-3};
    }

private:
    Params params_;
};
static_assert(abrade::FluidModel<SimpleShear>);
