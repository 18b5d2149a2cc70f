#pragma once
// The state of all bodies at one time, as owned columns that the io room can save.

#include <abrade/core/fields.hpp>
#include <abrade/dem/particles.hpp>
#include <abrade/wear/concrete.hpp>

#include <string>
#include <vector>

namespace abrade {

/// Columns over bodies and over concrete sites.
struct Snapshot {
    Real time = 0;  ///< [s]
    Index step = 0;
    std::vector<Real> id, kind, site;  ///< [body]; kind: 0 stone, 1 concrete, 2 grain, 3 fixed
    std::vector<Real> position, velocity, angular_momentum;  ///< [body x 3] [m], [m/s], [kg m2/s]
    std::vector<Real> orientation;                           ///< [body x 4] w x y z
    std::vector<Real> fracture_rate;                         ///< [site] [-]
    std::vector<std::uint32_t> seen;                         ///< of Concrete::renew_fracture_rates

    static auto fields() {
        return std::tuple(field("time", "s", &Snapshot::time), field("step", &Snapshot::step),
                          field("id", &Snapshot::id), field("kind", &Snapshot::kind),
                          field("site", &Snapshot::site), field("position", "m", &Snapshot::position),
                          field("velocity", "m/s", &Snapshot::velocity),
                          field("angular_momentum", "kg m2/s", &Snapshot::angular_momentum),
                          field("orientation", &Snapshot::orientation),
                          field("fracture_rate", &Snapshot::fracture_rate), field("seen", &Snapshot::seen));
    }

    std::vector<FieldView> body_fields() const {
        return {{"id", "-", 1, id},
                {"kind", "-", 1, kind},
                {"site", "-", 1, site},
                {"position", "m", 3, position},
                {"velocity", "m/s", 3, velocity},
                {"angular_momentum", "kg m2/s", 3, angular_momentum},
                {"orientation", "-", 4, orientation}};
    }
    std::vector<FieldView> site_fields() const { return {{"fracture_rate", "-", 1, fracture_rate}}; }
};

/// Brings a snapshot up to the state as `particles` has it, of the last observation, and the fracture rates.
inline void renew_snapshot(Snapshot& shot, const Particles& particles, const Concrete& concrete, Real time,
                           Index step) {
    shot.time = time;
    shot.step = step;
    for (auto* column : {&shot.id, &shot.kind, &shot.site, &shot.position, &shot.velocity,
                         &shot.angular_momentum, &shot.orientation})
        column->clear();
    const auto append = [](std::vector<Real>& column, const Vec3& v) {
        column.insert(column.end(), v.data(), v.data() + 3);
    };
    for (std::size_t b = 0; b < particles.position.size(); ++b) {
        shot.id.push_back(particles.id[b]);
        shot.kind.push_back(static_cast<Real>(particles.kind[b]));
        shot.site.push_back(particles.site[b]);
        append(shot.position, particles.position[b]);
        append(shot.velocity, particles.velocity[b]);
        append(shot.angular_momentum, particles.angular_momentum[b]);
        const Quaternion& q = particles.orientation[b];
        shot.orientation.insert(shot.orientation.end(), {q.w(), q.x(), q.y(), q.z()});
    }
    concrete.renew_fracture_rates(shot.fracture_rate, shot.seen);
}

}  // namespace abrade
