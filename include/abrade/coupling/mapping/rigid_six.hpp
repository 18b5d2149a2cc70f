#pragma once
// Velocity and spin of a rigid body, or a force and a torque on it, in six numbers.

#include <abrade/coupling/mapping/solid_cover.hpp>

namespace abrade::detail {

using Six = Eigen::Matrix<Real, 6, 1>;

/// What the velocity of a face across `axis` owes to a body's spin: component `axis` of spin x arm.
inline Vec3 lever(int axis, const Vec3& arm) noexcept { return arm.cross(Vec3::Unit(axis)); }
inline Six coefficient(int axis, const Vec3& arm) noexcept {
    Six c = Six::Zero();
    c[axis] = 1, c.template tail<3>() = lever(axis, arm);
    return c;
}
inline Real along(int axis, const Vec3& arm, const Six& q) noexcept {
    return q[axis] + q.template tail<3>().dot(lever(axis, arm));
}
inline Six velocity_of(const FlowBody& body) noexcept {
    return (Six() << body.velocity, body.angular_velocity).finished();
}
inline Six accelerated(const FlowBody& body, const Six& impulse) noexcept {
    Six q;
    q.template head<3>() = body.inverse_mass * impulse.template head<3>();
    q.template tail<3>() = body.inverse_inertia * impulse.template tail<3>();
    return q;
}
/// Mass and inertia of one that is free.
inline Eigen::Matrix<Real, 6, 6> inertia_of(const FlowBody& body) noexcept {
    Eigen::Matrix<Real, 6, 6> m = Eigen::Matrix<Real, 6, 6>::Zero();
    m.template topLeftCorner<3, 3>() = Mat3::Identity() / body.inverse_mass;
    m.template bottomRightCorner<3, 3>() = body.inverse_inertia.inverse();
    return m;
}
/// J^T of a pressure.
template <class Number>
Six pressed(const SolidCover& cover, const Field<Number>& of) noexcept {
    Six sum = Six::Zero();
    for (const SolidCell& c : cover.cells) {
        const auto p = static_cast<Real>(of[c.cell]);
        sum.template head<3>() += p * c.area, sum.template tail<3>() += p * c.area_moment;
    }
    return sum;
}

}  // namespace abrade::detail
