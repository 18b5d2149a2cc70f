#pragma once
// The cross-section of an open channel with a concave invert: an arc, then vertical walls.

#include <abrade/core/require.hpp>

#include <algorithm>
#include <cmath>

namespace abrade {

/// Channel coordinates: x along the invert (downstream), y across, z normal to the invert at the centre
/// line. The bed is the arc z(y) = R - sqrt(R^2 - y^2) for |y| <= width/2; vertical walls stand at its edges.
struct Invert {
    Real length = 45;     ///< [m]
    Real width = 1;       ///< between the walls [m]
    Real arc_radius = 1;  ///< R [m]
    Real slope = 0.05;    ///< fall per length along the invert, sin of the bed's angle [-]

    void validate() const {
        require_positive(length, "Invert.length", "m");
        require_positive(width, "Invert.width", "m");
        require(arc_radius >= 0.5 * width && std::isfinite(arc_radius),
                {"Invert.arc_radius", "at least half the width (" + to_text(0.5 * width) + " m)", "m",
                 "widen the arc or narrow the channel"},
                arc_radius);
        require(slope >= 0 && slope < 1,
                {"Invert.slope", "at least 0 and below 1", "m/m", "it is the sine of the bed's angle"},
                slope);
    }

    Real bed_height(Real y) const noexcept {
        const Real inside = std::min(std::abs(y), 0.5 * width);
        return arc_radius - std::sqrt(square(arc_radius) - square(inside));
    }

    /// Half the angle that the arc spans [rad].
    Real half_angle() const noexcept { return std::asin(0.5 * width / arc_radius); }

    /// Area of water that stands `depth` [m] deep at the centre [m2].
    Real flow_area(Real depth) const noexcept {
        const Real edge = bed_height(0.5 * width);
        if (depth > edge) return flow_area(edge) + width * (depth - edge);
        const Real angle = std::acos(std::clamp(1 - depth / arc_radius, -1.0, 1.0));
        return square(arc_radius) * (angle - std::sin(angle) * std::cos(angle));
    }

    /// Length of bed and wall that the water touches [m].
    Real wetted_perimeter(Real depth) const noexcept {
        const Real edge = bed_height(0.5 * width);
        if (depth > edge) return 2 * arc_radius * half_angle() + 2 * (depth - edge);
        return 2 * arc_radius * std::acos(std::clamp(1 - depth / arc_radius, -1.0, 1.0));
    }

    /// Gravity in channel coordinates [m/s2].
    Vec3 gravity() const noexcept { return standard_gravity * Vec3(slope, 0, -std::sqrt(1 - square(slope))); }
};

}  // namespace abrade
