#pragma once
// Free rotation of a rigid body that conserves its energy and its angular momentum.

#include <abrade/core/types.hpp>

namespace abrade {

/// Angular velocity [rad/s] halfway through a free turn over dt, for an angular momentum [kg m2/s], both
/// along the principal axes of the body, which turn with it.
///
/// Implicit midpoint rule for Euler's equations, dPi/dt = Pi x I^-1 Pi. With the Cayley transform for the
/// attitude (`turned`) the angular momentum in the world frame stays what it is and the rotational energy
/// 1/2 Pi . I^-1 Pi is conserved to round-off, at any dt. So rotation adds nothing to the energy ledger.
/// M. A. Austin, P. S. Krishnaprasad, L.-S. Wang, J. Comput. Phys. 107 (1993) 105,
/// doi:10.1006/jcph.1993.1128. Second order; converges while |omega| dt < 1.
inline Vec3 midpoint_spin(const Vec3& angular_momentum, const Vec3& inverse_inertia, Real dt) noexcept {
    const Vec3& start = angular_momentum;
    Vec3 end = start, spin;
    for (int iteration = 0; iteration < 30; ++iteration) {
        const Vec3 middle = 0.5 * (start + end);
        spin = inverse_inertia.cwiseProduct(middle);
        const Vec3 next = start + dt * middle.cross(spin);
        const Real change = (next - end).squaredNorm();
        end = next;
        if (change <= 1e-32 * start.squaredNorm()) break;
    }
    return spin;
}

/// `orientation` (principal frame to world) after a turn over dt at `spin` along the principal axes [rad/s].
inline Quaternion turned(const Quaternion& orientation, const Vec3& spin, Real dt) noexcept {
    const Vec3 half = 0.5 * dt * spin;
    return (orientation * Quaternion(1, half.x(), half.y(), half.z())).normalized();
}

}  // namespace abrade
