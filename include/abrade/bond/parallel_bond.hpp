#pragma once
// Bonds that are short beams of cement: they carry bending and twisting, too.

#include <abrade/bond/bond_springs.hpp>

namespace abrade {

/// A round beam of radius R and length L between two spheres (D. O. Potyondy, P. A. Cundall, Int. J. Rock
/// Mech. Min. Sci. 41 (2004) 1329, doi:10.1016/j.ijrmms.2004.09.011). With A = pi R^2, I = pi R^4 / 4, J = 2
/// I:
///   f_n = E A/L c,   f_s = -kappa E A/L s,   M_b = -E I/L theta_b,   M_t = -kappa E J/L theta_t
/// c compression, s shear [m], theta_b bending and theta_t twist [rad]; R = `radius_factor` times the smaller
/// radius, kappa = `stiffness_ratio` (G over E times the shear factor for a beam that shears like a solid).
///   sigma = -f_n/A + |M_b| R/I,  tau = |f_s|/A + |M_t| R/J
/// It breaks in tension when sigma > sigma_t, in shear when tau > cohesion + f_n/A tan(phi); the second term
/// counts where f_n presses. Wear takes its share off sigma_t and the cohesion. While sound, dashpots
/// 2 zeta sqrt(k m_eff), 2 zeta sqrt(k I_eff) act beside all four. What is left of a broken bond is a
/// frictional contact; moments end with the bond.
class ParallelBond {
public:
    static constexpr std::string_view name = "ParallelBond";
    static constexpr bool carries_moments = true;

    struct Params {
        Real youngs = 0;             ///< E [Pa]
        Real stiffness_ratio = 0.4;  ///< kappa, across over along [-]
        Real tensile = 0;            ///< sigma_t [Pa]
        Real cohesion = 0;           ///< [Pa]
        Real friction_angle = 35;    ///< phi [degrees]
        Real radius_factor = 1;      ///< R over the smaller radius [-]
        Real damping = 0.1;          ///< share of critical damping of one bond [-]

        void validate() const {
            require_positive(youngs, "ParallelBond.youngs", "Pa", "concrete has 2e10 to 4e10");
            require_positive(stiffness_ratio, "ParallelBond.stiffness_ratio");
            require_positive(tensile, "ParallelBond.tensile", "Pa", "concrete has 1e6 to 5e6");
            require_positive(cohesion, "ParallelBond.cohesion", "Pa", "a few times the tensile strength");
            require(friction_angle >= 0 && friction_angle < 90,
                    {"ParallelBond.friction_angle", "in [0, 90)", "degrees", "concrete has 30 to 40"},
                    friction_angle);
            require_positive(radius_factor, "ParallelBond.radius_factor");
            require(damping >= 0 && damping <= 1,
                    {"ParallelBond.damping", "in [0, 1]", "", "0 takes nothing, 1 is critical"}, damping);
        }
        void visit(auto&& f) const {
            f("youngs", youngs, "Pa");
            f("stiffness_ratio", stiffness_ratio, "-");
            f("tensile", tensile, "Pa");
            f("cohesion", cohesion, "Pa");
            f("friction_angle", friction_angle, "degrees");
            f("radius_factor", radius_factor, "-");
            f("damping", damping, "-");
        }
    };

    struct Memory {
        Vec3 spring = Vec3::Zero();  ///< shear spring [m]
        Vec3 bend = Vec3::Zero();    ///< theta_b, across the normal [rad]
        Real twist = 0;              ///< theta_t, about the normal [rad]
        bool broken = false;
    };

    explicit ParallelBond(Params params) : params_(params) {
        params_.validate();
        tan_phi_ = std::tan(radians(params_.friction_angle));
    }
    const Params& params() const noexcept { return params_; }

    BondResponse<Memory> respond(const BondKinematics& bond, Real strength_left,
                                 const Memory& memory) const noexcept {
        const BondRigidity k = rigidity(bond.radius, bond.length);
        const BondSprings springs(bond, k, tan_phi_, memory.spring);
        if (memory.broken) return springs.broken<Memory>();

        const Vec3& n = bond.normal;
        const Real twisted = bond.turn.dot(n), twist = memory.twist + twisted;
        const Vec3 bend = turn_into_plane(memory.bend, n) + (bond.turn - twisted * n);
        const Real held = 0.5 * k.bending * bend.squaredNorm() + 0.5 * k.twisting * square(twist);
        const Real r = params_.radius_factor * bond.radius, area = pi * square(r);
        const Real moment_share = 4 / (area * r);  // R/I; R/J is half of it
        const Real pull = -springs.push() / area;
        const Real tension = pull + moment_share * k.bending * bend.norm();
        const Real shear = springs.shear_force() / area + 0.5 * moment_share * k.twisting * std::abs(twist);
        if (tension > strength_left * params_.tensile) return springs.breaks<Memory>(Fate::tension, held);
        if (shear > strength_left * params_.cohesion + std::max(-pull, 0.0) * tan_phi_)
            return springs.breaks<Memory>(Fate::shear, held);

        const Real twist_rate = bond.spin.dot(n);
        const Vec3 bend_rate = bond.spin - twist_rate * n;
        const Real root = 2 * k.damping_ratio * std::sqrt(bond.effective_inertia);
        const Real bend_dashpot = root * std::sqrt(k.bending), twist_dashpot = root * std::sqrt(k.twisting);
        BondLoad load = springs.sound();
        load.couple = -k.bending * bend - bend_dashpot * bend_rate -
                      (k.twisting * twist + twist_dashpot * twist_rate) * n;
        load.stored += held;
        load.lost_bond +=
            (bend_dashpot * bend_rate.squaredNorm() + twist_dashpot * square(twist_rate)) * bond.time_step;
        return {load, {springs.shear(), bend, twist, false}, Fate::intact};
    }

    Real strength(Real left_i, Real left_j) const noexcept { return 0.5 * (left_i + left_j); }

    BondRigidity rigidity(Real radius, Real length) const noexcept {
        const Real r = params_.radius_factor * radius, area = pi * square(r);
        const Real along = params_.youngs * area / length, bending = 0.25 * along * square(r);
        return {along, params_.stiffness_ratio * along, params_.damping, bending,
                2 * params_.stiffness_ratio * bending};
    }

private:
    Params params_;
    Real tan_phi_ = 0;
};

static_assert(BondLaw<ParallelBond> && CarriesMoments<ParallelBond>);

}  // namespace abrade
