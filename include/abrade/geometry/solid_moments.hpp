#pragma once
// Volume, centroid and inertia of a solid: what every way of integrating one hands over.

#include <abrade/core/types.hpp>

#include <cmath>

namespace abrade {

struct Sphere {
    Vec3 centre = Vec3::Zero();  ///< [m]
    Real radius = 0;             ///< [m]
};

/// Volume integrals of a solid of unit density.
struct SolidMoments {
    Real volume = 0;               ///< [m3]
    Vec3 centroid = Vec3::Zero();  ///< [m]
    Mat3 inertia = Mat3::Zero();   ///< about the centroid, [m5]; times density [kg/m3] gives [kg m2]
};

/// How far `found` is from `expected`.
struct MomentsError {
    Real volume = 0;    ///< (found - expected) / expected [-]
    Real centroid = 0;  ///< distance over the radius of the sphere of the expected volume [-]
    Real inertia = 0;   ///< largest component of the difference over the largest of the expected [-]
};

inline MomentsError moments_error(const SolidMoments& found, const SolidMoments& expected) {
    const Real radius = std::cbrt(0.75 * expected.volume / pi);
    return {
        found.volume / expected.volume - 1, (found.centroid - expected.centroid).norm() / radius,
        (found.inertia - expected.inertia).cwiseAbs().maxCoeff() / expected.inertia.cwiseAbs().maxCoeff()};
}

namespace detail {

/// Integrals of 1, x and x x^T over the solid, from which every other moment follows.
struct RawMoments {
    Real volume = 0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero();

    SolidMoments about_centroid() const {
        const Vec3 c = first / volume;
        const Mat3 covariance = second - volume * c * c.transpose();
        return {volume, c, covariance.trace() * Mat3::Identity() - covariance};
    }
};

}  // namespace detail

}  // namespace abrade
