#pragma once
// Flat rigid boundaries and the box that a simulation lives in.

#include <abrade/core/require.hpp>

#include <cmath>
#include <limits>
#include <string>

namespace abrade {

/// A rigid plane; solids stay on the side that `normal` points to.
struct Plane {
    Vec3 point = Vec3::Zero();    ///< [m]
    Vec3 normal = Vec3::UnitZ();  ///< unit length
    Index material = 0;           ///< number in a table of laws (MaterialPairs)

    /// Of what stands on the plane: the velocity of `point` [m/s], and the spin about it [rad/s].
    struct Motion {
        Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();
    };
    bool moves = false;
    Motion last{}, now{};  ///< over the step that led here, and now

    Real distance(const Vec3& x) const noexcept { return normal.dot(x - point); }

    /// `name` says in messages which plane is meant.
    void validate(const std::string& name = "Plane") const {
        require_finite(point, name + ".point", "m");
        require(std::abs(normal.norm() - 1) < 1e-9, {name + ".normal", "of length 1", "", "normalise it"},
                normal.norm());
    }
};

/// Where a plane is that moves: its place at the start, turned about its point and then displaced.
struct PlanePlace {
    Vec3 displacement = Vec3::Zero();  ///< [m]
    Vec3 rotation = Vec3::Zero();      ///< along the axis, as long as the angle [rad]

    /// The plane at this place.
    Plane of(Plane plane) const {
        plane.point += displacement;
        if (!rotation.isZero(0)) plane.normal = (turn() * plane.normal).normalized();
        return plane;
    }
    Quaternion turn() const {
        const Real angle = rotation.norm();
        if (angle == 0) return Quaternion::Identity();
        const Vec3 half = std::sin(0.5 * angle) / angle * rotation;
        return Quaternion(std::cos(0.5 * angle), half.x(), half.y(), half.z());
    }
    /// How it moved from another place to this one in a time [s].
    Plane::Motion since(const PlanePlace& before, Real time) const {
        const Quaternion turned = (turn() * before.turn().conjugate()).normalized();
        const Real sine = turned.vec().norm(), angle = 2 * std::atan2(sine, turned.w());
        const Vec3 spin = sine > 0 ? Vec3(angle / (sine * time) * turned.vec()) : Vec3(Vec3::Zero());
        return {(displacement - before.displacement) / time, spin};
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

    /// What leads from x into the piece: whole periods [m].
    Vec3 way_back(const Vec3& x) const noexcept {
        Vec3 way = Vec3::Zero();
        for (int a = 0; a < 3; ++a)
            if (period[a] > 0) way[a] = -period[a] * std::floor((x[a] - low[a]) / period[a]);
        return way;
    }
};

}  // namespace abrade
