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

/// Drag of a sphere.
///   C_d = 24/Re (1 + 0.15 Re^0.687) + 0.42 / (1 + 42500 Re^-1.16)
/// C_d drag coefficient [-]; `shape_factor` multiplies it: angular stones drag more
/// Re Reynolds number of the slip and the diameter [-]
/// Validity: Re < 3e5; beyond, where the boundary layer may turn turbulent, the value at 3e5 is kept.
/// Throws InputError for parameters out of their range.
/// Source: R. Clift, W. H. Gauvin, Chemeca 70 (1970) 14; as given in Clift, Grace, Weber, Bubbles, Drops and
/// Particles (1978), table 5.1.
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
    Vec3 inertial = Vec3::Zero();        ///< of a law that FeelsInertia [N]
    Real added_mass = 0;                 ///< [kg]
};

inline Vec3 force_of(const FluidLoad& load) noexcept { return load.drag + load.buoyancy + load.inertial; }
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

// clang-format off
/// A drag law that also asks for what an unsteady or sheared fluid does: see WithInertia.
template <class D>
concept FeelsInertia = DragLaw<D> && requires(const D& law) {
    { law.added_mass() } noexcept -> std::same_as<Real>;
    { law.lift() } noexcept -> std::same_as<Real>;
};
// clang-format on

/// A drag law, and beside it what an unsteady or sheared fluid does to the submerged volume.
///   rho V Du/Dt                    the pressure gradient that accelerates the fluid
///   C_m rho V (Du/Dt - dv/dt)      added mass
///   C_L rho V (u - v) x curl u     lift in a shear
/// u the fluid's velocity, v the body's [m/s]; dv/dt is that by all forces, contacts among them [m/s2]
/// V submerged volume [m3], rho the fluid's density [kg/m3]
/// C_m, C_L coefficients [-]: 1/2 for both is exact of a sphere in a fluid without friction
/// Validity: bodies smaller than what the flow varies over; Basset's history force is not among them.
/// Throws InputError for parameters out of their range, those of the law included.
/// Source: T. R. Auton, J. C. R. Hunt, M. Prud'homme, J. Fluid Mech. 197 (1988) 241,
/// doi:10.1017/S0022112088003246.
///
/// What a fluid does not know of its change counts as none. Their work is the ledger's `flow_work`.
template <DragLaw Drag = CliftGauvin>
class WithInertia {
public:
    static constexpr std::string_view name = "WithInertia";

    struct Params {
        typename Drag::Params drag{};
        Real added_mass = 0.5;  ///< C_m [-]
        Real lift = 0.5;        ///< C_L [-]
        void validate() const {
            drag.validate();
            require_not_negative(added_mass, "WithInertia.added_mass", "");
            require_finite(lift, "WithInertia.lift", "");
        }
        void visit(auto&& f) const { drag.visit(f), f("added_mass", added_mass, "-"), f("lift", lift, "-"); }
    };

    WithInertia() = default;
    explicit WithInertia(Params params) : params_(params), drag_(params.drag) { params_.validate(); }
    const Params& params() const noexcept { return params_; }
    Real coefficient(Real reynolds) const noexcept { return drag_.coefficient(reynolds); }
    Real added_mass() const noexcept { return params_.added_mass; }
    Real lift() const noexcept { return params_.lift; }

private:
    Params params_;
    Drag drag_;
};

static_assert(FeelsInertia<WithInertia<>> && !FeelsInertia<CliftGauvin>);

/// Drag 1/2 rho C_d A |u - v| (u - v) and buoyancy -rho g V of the submerged share, `surroundings`
/// sampled at the centroid. Uniform flow pushes with its whole stress, -grad p + div tau = -rho g, so
/// buoyancy opposes gravity, also along the slope. C_d is that of the whole sphere; the submerged share of
/// the volume counts for the cross-section, too.
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
    const Real factor = speed > 0 ? 0.5 * surroundings.density * law.coefficient(reynolds) * area * speed : 0;
    return {.drag = factor * relative,
            .buoyancy = -share * surroundings.density * body.volume * gravity,
            .fluid_velocity = surroundings.velocity};
}

/// The same, of a law that asks for how the fluid changes. What added mass takes is known once all forces
/// are: `share_with_added_mass`.
template <FeelsInertia Drag>
FluidLoad fluid_load(const Drag& law, const FluidSample& surroundings, const FlowChange& change,
                     const Immersed& body, const Vec3& gravity) noexcept {
    FluidLoad load = fluid_load(law, surroundings, body, gravity);
    const Real share = submerged_share(surroundings.depth, std::cbrt(0.75 / pi * body.volume));
    const Real displaced = share * surroundings.density * body.volume;
    const Vec3 relative = surroundings.velocity - body.velocity;
    load.added_mass = law.added_mass() * displaced;
    load.inertial = (displaced + load.added_mass) * change.acceleration +
                    law.lift() * displaced * relative.cross(change.vorticity());
    return load;
}

/// Contacts and all other forces move the water along that a body takes with it: its added mass. `other`: all
/// that acts on the body beside the fluid [N].
inline void share_with_added_mass(FluidLoad& fluid, const Vec3& other, Real mass) noexcept {
    if (fluid.added_mass > 0)
        fluid.inertial -= fluid.added_mass / (mass + fluid.added_mass) * (other + force_of(fluid));
}

}  // namespace abrade
