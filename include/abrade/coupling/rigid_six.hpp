#pragma once
// Velocity and spin of a rigid body, or a force and a torque on it, in six numbers.

#include <abrade/coupling/solid_shares.hpp>

namespace abrade::detail {

using Six = Eigen::Matrix<Real, 6, 1>;

inline Six coefficient(const SolidFace& f) noexcept {
    Six c = Six::Zero();
    c[f.axis] = 1, c.template tail<3>() = f.lever();
    return c;
}
inline Real along(const SolidFace& f, const Six& q) noexcept {
    return q[f.axis] + q.template tail<3>().dot(f.lever());
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
        sum.template head<3>() += p * c.way, sum.template tail<3>() += p * c.turn;
    }
    return sum;
}

}  // namespace abrade::detail
