#pragma once
// A force of the user's on bodies, and the null policy.

#include <abrade/dem/store/particles.hpp>

#include <concepts>
#include <string_view>

namespace abrade {

/// A body that moves, as a force sees it: at the present place, with velocities brought up to the present.
struct BodyView {
    Index id = 0;
    Kind kind = Kind::stone;
    Vec3 position = Vec3::Zero();          ///< of the centroid [m]
    Vec3 velocity = Vec3::Zero();          ///< [m/s]
    Vec3 angular_velocity = Vec3::Zero();  ///< [rad/s]
    Real mass = 0;                         ///< [kg]
    Real volume = 0;                       ///< [m3]
};

/// What acts on a body at its centroid; a force alone is enough.
struct BodyLoad {
    Vec3 force = Vec3::Zero();   ///< [N]
    Vec3 torque = Vec3::Zero();  ///< [N m]

    BodyLoad() = default;
    BodyLoad(const Vec3& force_, const Vec3& torque_ = Vec3::Zero()) : force(force_), torque(torque_) {}
};

// clang-format off
/// `force(body, t)` -> BodyLoad or Vec3, const and noexcept; called from many threads, once for each body that moves and
/// each step. A lambda will do: [](const BodyView& body, Real t) noexcept -> Vec3 { ... }.
template <class F>
concept ForceOnBodies = std::copyable<F> && requires(const F& force, const BodyView& body, Real t) {
    { force(body, t) } noexcept -> std::convertible_to<BodyLoad>;
};
// clang-format on

/// No force: nothing is compiled for it.
struct NoForceOnBodies {
    BodyLoad operator()(const BodyView&, Real) const noexcept { return {}; }
};

static_assert(ForceOnBodies<NoForceOnBodies>);
static_assert(!ForceOnBodies<int>);

}  // namespace abrade
