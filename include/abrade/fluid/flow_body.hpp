#pragma once
// A rigid body as water on a grid sees it, and what the water does to it.

#include <abrade/core/types.hpp>
#include <abrade/geometry/solid_moments.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace abrade {

/// Force and torque about a body's centroid. The force goes with what contacts push: added mass M takes the
/// share M / (m + M) of it at once (m mass of the body), however short a contact is against the water's step.
struct FlowLoad {
    Vec3 force = Vec3::Zero();    ///< while contacts push as `expects` [N]
    Vec3 torque = Vec3::Zero();   ///< [N m]
    Vec3 expects = Vec3::Zero();  ///< force of contacts [N]
    Real share = 0;               ///< of added mass in what contacts move [-]

    static void fields(auto&& field) {
        field("force", "N", &FlowLoad::force), field("torque", "N m", &FlowLoad::torque);
        field("expects", "N", &FlowLoad::expects), field("share", &FlowLoad::share);
    }
    /// While contacts push with a force [N].
    FlowLoad among(const Vec3& contacts) const noexcept {
        FlowLoad now = *this;
        now.force -= share * (contacts - expects);
        return now;
    }
    FlowLoad& operator+=(const FlowLoad& o) noexcept { return force += o.force, torque += o.torque, *this; }
    friend FlowLoad operator-(const FlowLoad& a, const FlowLoad& b) noexcept {
        return {a.force - b.force, a.torque - b.torque};
    }
};

/// A rigid body among water that flows around it. What is in: shape, pose, mass, and the velocity that
/// everything but the water has given it, with the mean `load` that stood for the water meanwhile. What comes
/// out: the velocity that it has together with the water, and the load that stands for the water from here
/// on.
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
struct Struck {
    Vec3 velocity = Vec3::Zero(), blow = Vec3::Zero();  ///< [m/s]

    Struck() = default;
    /// `had`: velocity after the last exchange, of a body that has fallen since then.
    Struck(const FlowBody& body, const Vec3& had, const Vec3& before, const Vec3& falls, Real dt)
        : velocity(body.velocity - had - dt * (falls + body.inverse_mass * body.load.force)), blow(velocity) {
        for (int a = 0; a < 3; ++a)
            if (velocity[a] * before[a] > 0)
                blow[a] -= std::copysign(std::min(std::abs(velocity[a]), std::abs(before[a])), velocity[a]);
    }
    /// What the water does from here on, where it did `found`: of a blow added mass took its part at once,
    /// and does not go on to.
    FlowLoad goes_on(FlowLoad found, Real added, const FlowBody& body, Real dt) const noexcept {
        if (body.inverse_mass == 0) return found;
        found.share = added * body.inverse_mass / (1 + added * body.inverse_mass);
        found.force += found.share / (body.inverse_mass * dt) * blow;
        found.expects = (velocity - blow) / (body.inverse_mass * dt);
        return found;
    }
};

/// Of records in the order of their ids; null: it has none.
template <class Record>
const Record* with_id(const std::vector<Record>& records, Index id) noexcept {
    const auto found = std::ranges::lower_bound(records, id, {}, &Record::id);
    return found != records.end() && found->id == id ? &*found : nullptr;
}

}  // namespace abrade
