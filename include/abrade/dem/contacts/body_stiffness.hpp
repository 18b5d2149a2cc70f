#pragma once
// What springs and dashpots do to one body, and the time step that this allows.

#include <abrade/core/types.hpp>

#include <array>
#include <cmath>
#include <limits>

namespace abrade {

/// Springs and dashpots of one contact or bond, along its normal and across it, and those against turning.
struct LinkRigidity {
    Real normal = 0, tangential = 0;                  ///< [N/m]
    Real normal_dashpot = 0, tangential_dashpot = 0;  ///< [N s/m]
    Real turning = 0, turning_dashpot = 0;            ///< [N m], [N m s]

    /// Dashpots of a share zeta of critical damping, c = 2 zeta sqrt(k m), m the effective mass [kg].
    static LinkRigidity damped(Real normal, Real tangential, Real zeta, Real mass) noexcept {
        return {normal, tangential, 2 * zeta * std::sqrt(normal * mass),
                2 * zeta * std::sqrt(tangential * mass)};
    }
};

/// Largest stable step [s] of one mode, omega^2 = k/m [1/s2] and c/m [1/s], when dashpots see the velocity
/// taken ahead from the last two half steps:
///   dt = 2 / (sqrt(omega^2 + (c/m)^2) + c/m) = 2/omega (sqrt(1 + 4 zeta^2) - 2 zeta),  c/m = 2 zeta omega.
/// With w = omega dt the positions follow
///   x_{n+1} - 2 x_n + x_{n-1} = -w^2 x_n - 2 zeta w (3/2 x_n - 2 x_{n-1} + 1/2 x_{n-2}),
/// and the roots of lambda^3 + (w^2 - 2 + 3 zeta w) lambda^2 + (1 - 4 zeta w) lambda + zeta w lie within the
/// unit circle (E. I. Jury, 1964) while w^2 + 8 zeta w < 4; there one passes through -1.
inline Real damped_step(Real omega2, Real c) noexcept { return 2 / (std::sqrt(omega2 + c * c) + c); }

/// Stiffness K and damping C that act on one body, over displacement and rotation, each scaled by the root of
/// its mass or inertia. The whole system is stable where every body satisfies
///   largest eigenvalue of dt^2 K + 4 dt C  <=  4,
/// when each link between two free bodies counts twice, and once where the partner is fixed:
/// - a mode z of the whole system obeys the recursion of `damped_step` with its own quotients k = z'Kz/z'Mz
///   and c = z'Cz/z'Mz, so it is stable if dt^2 k + 4 dt c <= 4;
/// - a link stores 1/2 k (a_i - a_j)^2 <= k (a_i^2 + a_j^2), so no quotient exceeds the largest among bodies.
/// The other way round, a body that moves alone has the quotient of its links counted once. So the true limit
/// is never below the step found here, and never above twice that; without damping never above sqrt(2) times.
/// For two equal bodies, for a long row of them and for a body among fixed ones the step is exact.
class BodyStiffness {
public:
    using Matrix6 = Eigen::Matrix<Real, 6, 6>;

    struct Body {
        Real inverse_mass = 0;                            ///< [1/kg]
        Vec3 inverse_inertia = Vec3::Zero();              ///< about the principal axes [1/(kg m2)]
        Quaternion orientation = Quaternion::Identity();  ///< principal frame to world
    };

    /// A link that acts at `arm` [m] from the centre, along the unit vector n.
    void add(const Body& body, const Vec3& n, const Vec3& arm, const LinkRigidity& link, bool partner_moves) {
        const Real times = partner_moves ? 2 : 1;
        const Vec3 across = n.unitOrthogonal();
        add(direction(body, n, arm), times * link.normal, times * link.normal_dashpot);
        for (const Vec3& t : {across, Vec3(n.cross(across))})
            add(direction(body, t, arm), times * link.tangential, times * link.tangential_dashpot);
        stiffness_.diagonal().tail<3>() += times * link.turning * body.inverse_inertia;
        damping_.diagonal().tail<3>() += times * link.turning_dashpot * body.inverse_inertia;
    }
    /// `count` links of a solid sphere from anywhere. One alone: its normal spring has k_n/m, its tangential
    /// one, which also turns the sphere of inertia 2/5 m r^2, 7/2 k_t/m.
    void add_anywhere(const Body& body, int count, const LinkRigidity& link) {
        const Real per_mass = 2 * count * body.inverse_mass;
        stiffness_.diagonal().array() += per_mass * std::max(link.normal, 3.5 * link.tangential);
        damping_.diagonal().array() +=
            per_mass * std::max(link.normal_dashpot, 3.5 * link.tangential_dashpot);
        stiffness_.diagonal().tail<3>() += 2 * count * link.turning * body.inverse_inertia;
        damping_.diagonal().tail<3>() += 2 * count * link.turning_dashpot * body.inverse_inertia;
    }

    /// The largest step [s] up to `most` that this body allows, to 1e-4 from below; 0 where anything is not
    /// finite.
    Real step(Real most) const noexcept {
        if (!stiffness_.allFinite() || !damping_.allFinite()) return 0;
        Real low = damped_step(row_sum(stiffness_), row_sum(damping_)), high = most;
        if (low >= most || allows(most)) return most;
        while (high - low > 1e-4 * low) {
            const Real middle = std::isfinite(high) ? 0.5 * (low + high) : 2 * low;
            (allows(middle) ? low : high) = middle;
        }
        return low;
    }

private:
    using Vector6 = Eigen::Matrix<Real, 6, 1>;

    /// How far a unit of each scaled coordinate moves the point along e.
    static Vector6 direction(const Body& body, const Vec3& e, const Vec3& arm) {
        Vector6 g;
        g.head<3>() = std::sqrt(body.inverse_mass) * e;
        g.tail<3>() =
            body.inverse_inertia.cwiseSqrt().cwiseProduct(Vec3(body.orientation.conjugate() * arm.cross(e)));
        return g;
    }
    void add(const Vector6& g, Real stiffness, Real damping) {
        const Matrix6 outer = g * g.transpose();
        stiffness_ += stiffness * outer, damping_ += damping * outer;
    }

    Matrix6 at_step(Real dt) const noexcept { return square(dt) * stiffness_ + 4 * dt * damping_; }
    static Real row_sum(const Matrix6& a) noexcept { return a.cwiseAbs().rowwise().sum().maxCoeff(); }

    /// Whether 4 - dt^2 K - 4 dt C is positive definite: whether all pivots of its elimination are positive.
    bool allows(Real dt) const noexcept {
        Matrix6 rest = 4 * Matrix6::Identity() - at_step(dt);
        for (int pivot = 0; pivot < 6; ++pivot) {
            if (!(rest(pivot, pivot) > 0)) return false;
            for (int row = pivot + 1; row < 6; ++row) {
                const Real share = rest(row, pivot) / rest(pivot, pivot);
                for (int column = pivot + 1; column < 6; ++column)
                    rest(row, column) -= share * rest(pivot, column);
            }
        }
        return true;
    }

    Matrix6 stiffness_ = Matrix6::Zero(), damping_ = Matrix6::Zero();
};

}  // namespace abrade
