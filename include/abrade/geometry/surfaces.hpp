#pragma once
// Flat rigid boundaries and the box that a simulation lives in.

#include <abrade/core/require.hpp>

#include <limits>

namespace abrade {

/// A rigid plane; solids stay on the side that `normal` points to.
struct Plane {
    Vec3 point = Vec3::Zero();    ///< [m]
    Vec3 normal = Vec3::UnitZ();  ///< unit length

    Real distance(const Vec3& x) const noexcept { return normal.dot(x - point); }

    void validate() const {
        require(point.allFinite(), {"Plane.point", "finite", "m"}, point.sum());
        require(std::abs(normal.norm() - 1) < 1e-9, {"Plane.normal", "of length 1", "", "normalise it"},
                normal.norm());
    }
};

/// The world's bounds [m]. What leaves them has gone wrong, unless it left through the outlet.
struct Box {
    Vec3 low = Vec3::Constant(-std::numeric_limits<Real>::infinity());
    Vec3 high = Vec3::Constant(std::numeric_limits<Real>::infinity());

    /// False for a point outside, and for one with a NaN.
    bool contains(const Vec3& x) const noexcept {
        return x.x() >= low.x() && x.x() <= high.x() && x.y() >= low.y() && x.y() <= high.y() &&
               x.z() >= low.z() && x.z() <= high.z();
    }
};

/// Space that repeats itself.
struct Periodic {
    Vec3 low = Vec3::Zero();     ///< of the piece that is meant [m]
    Vec3 period = Vec3::Zero();  ///< its size along each axis [m]; 0 where space is open
};

}  // namespace abrade
