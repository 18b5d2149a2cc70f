#pragma once
// Forces of a sampled fluid on a body that the fluid does not feel: drag by a published law, and buoyancy.

#include <abrade/fluid/fluid_model.hpp>

#include <algorithm>
#include <cmath>

namespace abrade {

/// A drag law gives the drag coefficient of a body at particle Reynolds number Re = rho |u| d / mu.
// clang-format off
template <class D>
concept DragLaw = Law<D> && requires(const D& law) {
    { law.coefficient(Real{}) } noexcept -> std::same_as<Real>;
};
// clang-format on

/// Drag of a sphere for Re < 3e5; beyond, where the boundary layer may turn turbulent, the value at 3e5 is
/// kept:
///   C_d = 24/Re (1 + 0.15 Re^0.687) + 0.42 / (1 + 42500 Re^-1.16)
/// R. Clift, W. H. Gauvin, Chemeca 70 (1970) 14; as given in Clift, Grace, Weber, Bubbles, Drops and
/// Particles (1978), table 5.1. Angular stones drag more; `shape_factor` multiplies C_d.
class CliftGauvin {
public:
    static constexpr std::string_view name = "CliftGauvin";

    struct Params {
        Real shape_factor = 1;  ///< [-]
        void validate() const {
            require_positive(shape_factor, "CliftGauvin.shape_factor", "",
                             "1 for spheres, more for angular stones");
        }
        void visit(auto&& f) const { f("shape_factor", shape_factor, "-"); }
    };

    CliftGauvin() = default;
    explicit CliftGauvin(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    Real coefficient(Real reynolds) const noexcept {
        const Real re = std::clamp(reynolds, 1e-12, 3e5), log_re = std::log(re);
        return params_.shape_factor * (24 / re * (1 + 0.15 * std::exp(0.687 * log_re)) +
                                       0.42 / (1 + 42500 * std::exp(-1.16 * log_re)));
    }

private:
    Params params_;
};

/// For no fluid, or one that does not push.
class NoDrag {
public:
    static constexpr std::string_view name = "NoDrag";
    using Params = NoParams;

    NoDrag() = default;
    explicit NoDrag(Params) {}
    const Params& params() const noexcept {
        static constexpr Params none{};
        return none;
    }
    Real coefficient(Real) const noexcept { return 0; }
};

static_assert(DragLaw<CliftGauvin>);
static_assert(DragLaw<NoDrag>);
static_assert(!DragLaw<NoParams>);

/// What the fluid does to one body.
struct FluidLoad {
    Vec3 drag = Vec3::Zero();            ///< [N]
    Vec3 buoyancy = Vec3::Zero();        ///< [N]
    Vec3 fluid_velocity = Vec3::Zero();  ///< that the drag was reckoned with [m/s]
};

inline Vec3 force_of(const FluidLoad& load) noexcept { return load.drag + load.buoyancy; }
inline Vec3 force_of(const FlowLoad& load) noexcept { return load.force; }

/// The share of a sphere's volume below the surface when its centre is `depth` below it: a spherical cap.
inline Real submerged_share(Real depth, Real radius) noexcept {
    const Real s = std::clamp((depth + radius) / (2 * radius), 0.0, 1.0);
    return s * s * (3 - 2 * s);
}

/// A body as the fluid sees it: a sphere of the same volume.
struct Immersed {
    Vec3 position = Vec3::Zero();  ///< [m]
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
    Real volume = 0;               ///< [m3]
};

/// Drag 1/2 rho C_d A |u - v| (u - v) and buoyancy -rho g V of the submerged share, `surroundings`
/// sampled at the centroid. Uniform flow pushes with its whole stress, -grad p + div tau = -rho g, so
/// buoyancy opposes gravity, also along the slope. C_d is that of the whole sphere; area and volume are those
/// submerged.
template <DragLaw Drag>
FluidLoad fluid_load(const Drag& law, const FluidSample& surroundings, const Immersed& body,
                     const Vec3& gravity) noexcept {
    const Real radius = std::cbrt(0.75 / pi * body.volume);
    const Real share = submerged_share(surroundings.depth, radius);
    if (share <= 0) return {};
    const Vec3 relative = surroundings.velocity - body.velocity;
    const Real speed = relative.norm();
    const Real reynolds = surroundings.density * speed * 2 * radius / surroundings.viscosity;
    const Real area = share * pi * square(radius);
    // Written with Re C_d so that it stays finite at rest.
    const Real factor = speed > 0 ? 0.5 * surroundings.density * law.coefficient(reynolds) * area * speed : 0;
    return {.drag = factor * relative,
            .buoyancy = -share * surroundings.density * body.volume * gravity,
            .fluid_velocity = surroundings.velocity};
}

}  // namespace abrade
