#pragma once
// Number and vector types shared by every room.

#if __cplusplus < 202002L
#error "Abrade needs C++20: compile with -std=c++20 or later"
#endif

#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "Abrade's guards look for NaN and infinity: compile without -ffast-math and -ffinite-math-only"
#endif

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <numbers>

namespace abrade {

using Real = double;
using Index = std::int32_t;

/// A three-component vector over any number type: double, a SIMD pack, a dual number.
template <class Number>
using Vec3Of = Eigen::Matrix<Number, 3, 1>;

using Vec3 = Vec3Of<Real>;
using Mat3 = Eigen::Matrix<Real, 3, 3>;
using Quaternion = Eigen::Quaternion<Real>;

inline constexpr Real pi = std::numbers::pi_v<Real>;

/// Standard gravity [m/s2].
inline constexpr Real standard_gravity = 9.80665;

constexpr Real square(Real x) noexcept { return x * x; }
constexpr Real cube(Real x) noexcept { return x * x * x; }
constexpr Real radians(Real degrees) noexcept { return degrees * pi / 180.0; }

}  // namespace abrade
