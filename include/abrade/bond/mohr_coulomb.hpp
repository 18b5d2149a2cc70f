#pragma once
// Bonds that yield on a straight Mohr-Coulomb line whose tensile cut-off degrades with wear.

#include <abrade/bond/bond_law.hpp>

namespace abrade {

/// The concrete of the abrasion model (MDEM, after K. Meguro and M. Hakuno 1989; equations [2] to [4] of the
/// sub-particle abrasion paper):
///   sigma_t(i) = (1 - gamma_f(i)) sigma_t0                           [2]
///   f_b = A sigma_t,  sigma_t joined over i and j                    [3]
///   A = pi r_c^2                                                     [4]
/// Springs f_n = k_n c (c compression), f_s = -k_s s. The bond breaks
///   in tension when -f_n > f_b,
///   in shear when |f_s| > (f_n + f_b) tan(phi).
/// While sound, dashpots c = 2 zeta sqrt(k m_eff) act beside both springs; they are no part of the yield.
/// A broken bond is a frictional contact with the same springs: f_n >= 0, |f_s| <= f_n tan(phi). So breaking
/// under compression changes no normal force; what the springs then give up is booked as lost in the bond.
class MohrCoulomb {
public:
    static constexpr std::string_view name = "MohrCoulomb";

    enum class Join { mean, minimum };   ///< how [3] joins the two strengths; the paper does not say
    enum class Area { circle, square };  ///< [4] pi r^2, or the lattice's (2 r)^2

    struct Params {
        Real tensile = 0;            ///< sigma_t0 [Pa]
        Real friction_angle = 35;    ///< phi [degrees]; assumed, the paper does not give it
        Real stiffness = 0;          ///< k_n [N/m]; E A / d is about 4e8 N/m for concrete, softer is cheaper
        Real stiffness_ratio = 0.2;  ///< k_s / k_n [-]
        Real damping = 0.1;          ///< share of critical damping of one bond [-]; assumed
        Join join = Join::mean;
        Area area = Area::circle;

        void validate() const {
            require_positive(tensile, "MohrCoulomb.tensile", "Pa", "concrete has 2e6 to 5e6 Pa");
            require(friction_angle >= 0 && friction_angle < 90,
                    {"MohrCoulomb.friction_angle", "in [0, 90)", "degrees", "the default is 35"},
                    friction_angle);
            require_positive(stiffness, "MohrCoulomb.stiffness", "N/m",
                             "E A / d is about 4e8 N/m for concrete, softer is cheaper");
            require_positive(stiffness_ratio, "MohrCoulomb.stiffness_ratio", "", "the default is 0.2");
            require(damping >= 0 && damping <= 1,
                    {"MohrCoulomb.damping", "in [0, 1]", "", "it is a share of critical damping, 0 for none"},
                    damping);
        }
        void visit(auto&& f) const {
            f("tensile", tensile, "Pa");
            f("friction_angle", friction_angle, "degrees");
            f("stiffness", stiffness, "N/m");
            f("stiffness_ratio", stiffness_ratio, "-");
            f("damping", damping, "-");
            f("join_minimum", join == Join::minimum ? 1 : 0, "-");
            f("area_square", area == Area::square ? 1 : 0, "-");
        }
    };

    struct Memory {
        Vec3 spring = Vec3::Zero();  ///< shear spring [m]
        bool broken = false;
    };

    explicit MohrCoulomb(Params params) : params_(params) {
        params_.validate();
        tan_phi_ = std::tan(radians(params_.friction_angle));
        dashpot_normal_ = 2 * params_.damping * std::sqrt(stiffness());
        dashpot_shear_ = 2 * params_.damping * std::sqrt(tangential_stiffness());
    }
    const Params& params() const noexcept { return params_; }

    BondResponse<Memory> respond(const BondKinematics& bond, Real strength_left,
                                 const Memory& memory) const noexcept {
        const Real kn = stiffness(), ks = tangential_stiffness(), dt = bond.time_step;
        const Real approach = -bond.velocity.dot(bond.normal);
        const Vec3 slip = bond.velocity + approach * bond.normal;
        const Vec3 way = bond.travel - bond.travel.dot(bond.normal) * bond.normal;
        const Vec3 before = turn_into_plane(memory.spring, bond.normal), shear = before + way;
        const Real root_mass = std::sqrt(bond.effective_mass);
        const Real cn = root_mass * dashpot_normal_, cs = root_mass * dashpot_shear_;

        if (!memory.broken) {
            const Real fn = kn * bond.compression, limit = strength_left * capacity(bond.radius);
            const Real shear2 = shear.squaredNorm();
            const Real elastic = 0.5 * kn * square(bond.compression) + 0.5 * ks * shear2;
            if (-fn > limit) return {{Vec3::Zero(), 0, elastic, 0, 0}, {Vec3::Zero(), true}, Fate::tension};
            if (square(ks) * shear2 <= square((fn + limit) * tan_phi_)) {
                const Vec3 force = (fn + cn * approach) * bond.normal - ks * shear - cs * slip;
                const Real damped = (cn * square(approach) + cs * slip.squaredNorm()) * dt;
                return {{force, elastic, damped, 0, 0}, {shear, false}, Fate::intact};
            }
            if (bond.compression <= 0)
                return {{Vec3::Zero(), 0, elastic, 0, 0}, {Vec3::Zero(), true}, Fate::shear};
            BondResponse<Memory> broken = slide(bond, before, shear, cn, cs);
            broken.load.lost_bond = std::max(0.0, elastic - broken.load.stored) + broken.load.lost_normal;
            broken.load.lost_normal = broken.load.lost_tangential = 0;
            broken.fate = Fate::shear;
            return broken;
        }
        if (bond.compression > 0) return slide(bond, before, shear, cn, cs);
        return {{Vec3::Zero(), 0, 0, 0, 0.5 * ks * memory.spring.squaredNorm()},
                {Vec3::Zero(), true},
                Fate::intact};
    }

    Real strength(Real left_i, Real left_j) const noexcept {
        return params_.join == Join::mean ? 0.5 * (left_i + left_j) : std::min(left_i, left_j);
    }

    /// Tensile force that breaks a sound bond between spheres of this radius, A sigma_t0 [N].
    Real capacity(Real radius) const noexcept {
        return params_.tensile * square(radius) * (params_.area == Area::circle ? pi : 4.0);
    }

    Real stiffness() const noexcept { return params_.stiffness; }
    Real tangential_stiffness() const noexcept { return params_.stiffness * params_.stiffness_ratio; }
    Real damping_ratio() const noexcept { return params_.damping; }

private:
    /// A broken bond: spring, dashpot and slider without tension.
    BondResponse<Memory> slide(const BondKinematics& bond, const Vec3& before, const Vec3& shear, Real cn,
                               Real cs) const noexcept {
        const Real dt = bond.time_step, approach = -bond.velocity.dot(bond.normal);
        const Vec3 slip = bond.velocity + approach * bond.normal;
        const Real depth = std::max(bond.compression, 0.0), push = stiffness() * depth;
        const auto normal = NormalSpring<Real>::pushing(push, 0.5 * push * depth, cn, approach, dt);
        const auto tangential = SlidingSpring<Real>::at(before, shear, slip, tan_phi_ * normal.force,
                                                        tangential_stiffness(), cs, dt);
        const Vec3 force = normal.force * bond.normal + tangential.force;
        return {{force, normal.stored + tangential.stored, 0, normal.lost, tangential.lost},
                {tangential.spring, true},
                Fate::intact};
    }

    Params params_;
    Real tan_phi_ = 0;
    Real dashpot_normal_ = 0, dashpot_shear_ = 0;  ///< 2 zeta sqrt(k); times sqrt(m_eff) [N s/m]
};

static_assert(BondLaw<MohrCoulomb>);

}  // namespace abrade
