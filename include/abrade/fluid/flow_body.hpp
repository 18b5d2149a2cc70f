#pragma once
// A rigid body as water on a grid sees it, and what the water does to it.

#include <abrade/core/types.hpp>
#include <abrade/geometry/solid_moments.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace abrade {

/// Force and torque about a body's centroid.
struct FlowLoad {
    Vec3 force = Vec3::Zero();   ///< [N]
    Vec3 torque = Vec3::Zero();  ///< [N m]
    Real added_mass = 0;         ///< water that moves with the body as contacts push it [kg]
    Vec3 shared = Vec3::Zero();  ///< its part of the contacts' force, as `force` counts it already [N]

    static void fields(auto&& field) {
        field("force", "N", &FlowLoad::force), field("torque", "N m", &FlowLoad::torque);
        field("added_mass", "kg", &FlowLoad::added_mass), field("shared", "N", &FlowLoad::shared);
    }
    /// What acts on a body of that mass beside its contacts' whole force [N].
    Vec3 force_among(const Vec3& contacts, Real mass) const noexcept {
        return force + shared - added_mass / (mass + added_mass) * contacts;
    }
    FlowLoad& operator+=(const FlowLoad& o) noexcept { return force += o.force, torque += o.torque, *this; }
    friend FlowLoad operator-(const FlowLoad& a, const FlowLoad& b) noexcept {
        return {a.force - b.force, a.torque - b.torque};
    }
};

/// A rigid body among water that flows around it. What is in: shape, pose, mass, and the velocity that
/// everything but the water has given it, with the `load` that stood for the water meanwhile. What comes out:
/// the velocity that it has together with the water, and the load that stands for the water from here on.
struct FlowBody {
    Index id = 0;                          ///< the same at each exchange, and no other body's
    Vec3 position = Vec3::Zero();          ///< of the centroid [m]
    Vec3 velocity = Vec3::Zero();          ///< of the centroid [m/s]
    Vec3 angular_velocity = Vec3::Zero();  ///< [rad/s]
    Real volume = 0;                       ///< [m3]
    Real inverse_mass = 0;                 ///< 0: it moves as it is told [1/kg]
    Mat3 inverse_inertia = Mat3::Zero();   ///< about the centroid, along the axes of the box [1/(kg m2)]
    std::span<const Sphere> spheres{};     ///< whose union it is [m]
    FlowLoad load{};                       ///< mean over the water's step

    Real diameter() const noexcept { return std::cbrt(6 / pi * volume); }  ///< of a sphere as large [m]
};

/// Velocity that contacts gave a body since the last exchange, and what is left of it if it was a blow:
/// what the last time had of it as well is a force that lasts.
struct ContactVelocity {
    Vec3 velocity = Vec3::Zero(), blow = Vec3::Zero();  ///< [m/s]

    ContactVelocity() = default;
    /// `had`: velocity after the last exchange, of a body that has fallen since then.
    ContactVelocity(const FlowBody& body, const Vec3& had, const Vec3& before, const Vec3& falls, Real dt)
        : velocity(body.velocity - had -
                   dt * (falls + body.inverse_mass * (body.load.force + body.load.shared))),
          blow(velocity) {
        for (int a = 0; a < 3; ++a)
            if (velocity[a] * before[a] > 0)
                blow[a] -= std::copysign(std::min(std::abs(velocity[a]), std::abs(before[a])), velocity[a]);
    }
    /// The part of added mass in it [N]: the water took it at once, and does not go on to.
    Vec3 taken_by(Real added, const FlowBody& body, Real dt) const noexcept {
        if (body.load.added_mass > 0) return Vec3::Zero();  // it went along
        return added / ((1 + added * body.inverse_mass) * dt) * blow;
    }
    /// Water that goes along in a contact, over the added mass far from anything: between 1 and the 1.38 of a
    /// sphere that touches a plane (H. Lamb, Hydrodynamics, 1932, art. 99). With 1.2 a stone's rebound
    /// depends least on whether a contact lasts longer than a step of the water's.
    static constexpr Real near = 1.2;
    /// Hands out how much water goes along from here on, and its part of the contacts' force.
    void hand_out(FlowBody& body, Real added, Real dt) const noexcept {
        if (body.inverse_mass == 0) return;
        const Real mass = 1 / body.inverse_mass, moved = mass + body.load.added_mass;  // over `velocity`
        body.load.added_mass = near * added;
        body.load.shared = body.load.added_mass / (mass + body.load.added_mass) * moved / dt * velocity;
    }
};

/// Of records in the order of their ids; null: it has none.
template <class Record>
const Record* with_id(const std::vector<Record>& records, Index id) noexcept {
    const auto found = std::ranges::lower_bound(records, id, {}, &Record::id);
    return found != records.end() && found->id == id ? &*found : nullptr;
}

}  // namespace abrade
