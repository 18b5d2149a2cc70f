#pragma once
// Steady uniform flow down a channel: one depth, a logarithmic velocity profile, no feedback.

#include <abrade/fluid/fluid_model.hpp>
#include <abrade/geometry/invert.hpp>

namespace abrade {

/// Depth of uniform flow by Manning's formula, Q = A R_h^(2/3) S^(1/2) / n, at the centre line [m].
/// Q discharge [m3/s], A flow area [m2], R_h = A / wetted perimeter [m], S slope [-].
/// Throws InputError when Q or n is not > 0, or the channel does not slope.
inline Real normal_depth(const Invert& section, Real discharge, Real manning) {
    require_positive(discharge, "normal_depth.discharge", "m3/s");
    require_positive(manning, "normal_depth.manning", "s/m^(1/3)", "concrete has 0.012 to 0.020");
    require_positive(section.slope, "Invert.slope", "m/m", "uniform flow needs a slope");
    const auto carried = [&](Real depth) {
        const Real area = section.flow_area(depth);
        return area * std::pow(area / section.wetted_perimeter(depth), 2.0 / 3) * std::sqrt(section.slope) /
               manning;
    };
    Real low = 0, high = 0.01;
    while (carried(high) < discharge) high *= 2;
    for (int i = 0; i < 100; ++i) {
        const Real middle = 0.5 * (low + high);
        (carried(middle) < discharge ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/// Uniform flow over an invert, its depth from Manning; the velocity is along x.
///   u(y, z) = C ln(1 + (z - z_bed(y)) / z_0),  z_0 = k_s / 30,  k_s = (26 n)^6
/// u [m/s], z height, z_bed that of the bed [m]; C such that the discharge is met [m/s]
/// n Manning's [s/m^(1/3)], k_s Strickler's roughness height, z_0 the fully rough one [m]
/// Validity: steady, fully rough flow of a wide section. Water at 10 degrees C unless given otherwise.
/// Throws InputError for parameters out of their range.
/// Source: H. Schlichting, Boundary-Layer Theory; A. Strickler 1923.
///
/// Bed shear stress of the section: rho g R_h S [Pa]; shear velocity at the centre line: sqrt(g h S) [m/s];
/// R_h hydraulic radius, h depth [m], S slope [-].
class UniformFlow {
public:
    static constexpr std::string_view name = "UniformFlow";

    struct Params {
        Invert section{};
        Real discharge = 0;        ///< Q [m3/s]
        Real manning = 0.015;      ///< n [s/m^(1/3)]; assumed, for worn concrete
        Real density = 1000;       ///< [kg/m3]
        Real viscosity = 1.31e-3;  ///< dynamic [Pa s]

        void validate() const {
            section.validate();
            require_positive(discharge, "UniformFlow.discharge", "m3/s", "a dry channel needs no fluid");
            require_positive(manning, "UniformFlow.manning", "s/m^(1/3)", "concrete has 0.012 to 0.020");
            require_positive(density, "UniformFlow.density", "kg/m3", "water has 1000 kg/m3");
            require_positive(viscosity, "UniformFlow.viscosity", "Pa s",
                             "water has 1.31e-3 Pa s at 10 degrees C");
        }
        void visit(auto&& f) const {
            f("discharge", discharge, "m3/s");
            f("manning", manning, "s/m^(1/3)");
            f("density", density, "kg/m3");
            f("viscosity", viscosity, "Pa s");
        }
    };

    explicit UniformFlow(Params params) : params_(params) {  // Params{...} alone tells a wrong name
        params_.validate();
        depth_ = normal_depth(params_.section, params_.discharge, params_.manning);
        roughness_length_ = std::pow(26 * params_.manning, 6) / 30;
        scale_ = params_.discharge / integral_of_unit_profile();
    }
    const Params& params() const noexcept { return params_; }

    FluidSample sample(const Vec3& x, Real /*t*/) const noexcept {
        const Real height = std::max(0.0, x.z() - params_.section.bed_height(x.y()));
        return {{scale_ * std::log1p(height / roughness_length_), 0, 0},
                depth_ - x.z(),
                params_.density,
                params_.viscosity};
    }

    /// Sheared across the bed; nothing is accelerated.
    FlowChange change(const Vec3& x, Real /*t*/) const noexcept {
        const Invert& section = params_.section;
        const Real height = x.z() - section.bed_height(x.y());
        FlowChange change;
        if (height < 0) return change;
        const Real slope = scale_ / (height + roughness_length_), dy = 1e-6 * section.width;
        const Real bed_rises = (section.bed_height(x.y() + dy) - section.bed_height(x.y() - dy)) / (2 * dy);
        change.gradient(0, 1) = -slope * bed_rises, change.gradient(0, 2) = slope;
        return change;
    }

    Real depth() const noexcept { return depth_; }  ///< at the centre line [m]
    Real mean_velocity() const noexcept {
        return params_.discharge / params_.section.flow_area(depth_);
    }                                         ///< [m/s]
    Real hydraulic_radius() const noexcept {  ///< [m]
        return params_.section.flow_area(depth_) / params_.section.wetted_perimeter(depth_);
    }
    Real bed_shear() const noexcept {  ///< rho g R_h S [Pa]
        return params_.density * standard_gravity * hydraulic_radius() * params_.section.slope;
    }
    Real friction_velocity() const noexcept {  ///< u* = sqrt(g h S) at the centre line [m/s]
        return std::sqrt(standard_gravity * depth_ * params_.section.slope);
    }
    Real froude() const noexcept {  ///< with the hydraulic depth A / surface width [-]
        const Invert& s = params_.section;
        const Real half = depth_ > s.bed_height(0.5 * s.width)
                              ? 0.5 * s.width
                              : std::sqrt(square(s.arc_radius) - square(s.arc_radius - depth_));
        return mean_velocity() / std::sqrt(standard_gravity * s.flow_area(depth_) / (2 * half));
    }

private:
    /// Integral over the flow area of ln(1 + height / z_0): in closed form along each vertical, midpoints
    /// across.
    Real integral_of_unit_profile() const {
        constexpr int strips = 2000;
        const Real dy = params_.section.width / strips, z0 = roughness_length_;
        Real sum = 0;
        for (int i = 0; i < strips; ++i) {
            const Real h = depth_ - params_.section.bed_height((i + 0.5) * dy - 0.5 * params_.section.width);
            if (h > 0) sum += dy * ((h + z0) * std::log1p(h / z0) - h);
        }
        return sum;
    }

    Params params_;
    Real depth_ = 0, roughness_length_ = 0, scale_ = 0;
};

static_assert(FluidModel<UniformFlow>);

}  // namespace abrade
