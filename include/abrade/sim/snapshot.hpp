#pragma once
// The state of all bodies at one time.

#include <abrade/core/fields.hpp>
#include <abrade/dem/store/particles.hpp>
#include <abrade/wear/concrete.hpp>

#include <vector>

namespace abrade {

/// Columns over bodies and over concrete sites.
struct Snapshot {
    Real time = 0;  ///< [s]
    Index step = 0;
    std::vector<Index> id, site;                             ///< [body] site: of the concrete, -1 for stones
    std::vector<Kind> kind;                                  ///< [body]
    std::vector<Vec3> position, velocity, angular_momentum;  ///< [body] [m], [m/s], [kg m2/s]
    std::vector<Quaternion> orientation;                     ///< [body] x, y, z, w in files
    std::vector<Real> fracture_rate;                         ///< [site] [-]
    std::vector<std::uint32_t> seen;                         ///< of Concrete::renew_fracture_rates

    static void fields(auto&& field) {
        field("time", "s", &Snapshot::time), field("step", &Snapshot::step), field("id", &Snapshot::id),
            field("kind", &Snapshot::kind), field("site", &Snapshot::site),
            field("position", "m", &Snapshot::position), field("velocity", "m/s", &Snapshot::velocity),
            field("angular_momentum", "kg m2/s", &Snapshot::angular_momentum),
            field("orientation", &Snapshot::orientation), field("fracture_rate", &Snapshot::fracture_rate),
            field("seen", &Snapshot::seen);
    }
};

/// Brings a snapshot up to the state as `particles` has it, of the last observation, and the fracture rates.
inline void renew_snapshot(Snapshot& shot, const Particles& particles, const Concrete& concrete, Real time,
                           Index step) {
    shot.time = time, shot.step = step;
    shot.id = particles.id, shot.kind = particles.kind, shot.site = particles.site;
    shot.position = particles.position, shot.velocity = particles.velocity;
    shot.angular_momentum = particles.angular_momentum, shot.orientation = particles.orientation;
    concrete.renew_fracture_rates(shot.fracture_rate, shot.seen);
}

}  // namespace abrade
