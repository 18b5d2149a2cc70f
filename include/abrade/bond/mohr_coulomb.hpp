#pragma once
// Bonds that yield on a straight Mohr-Coulomb line whose tensile cut-off degrades with wear.

#include <abrade/bond/bond_springs.hpp>

namespace abrade {

/// The concrete of the abrasion model.
///   f_n = k_n c,  f_s = -k_s s
///   sigma_t(i) = (1 - gamma_f(i)) sigma_t0                           [2]
///   f_b = A sigma_t,  sigma_t joined over i and j                    [3]
///   A = pi r_c^2                                                     [4]
///   breaks in tension where -f_n > f_b, in shear where |f_s| > (f_n + f_b) tan(phi)
/// c compression, s shear [m], k_n, k_s stiffness [N/m]
/// sigma_t0 tensile strength [Pa], gamma_f fracture [-], phi angle of friction
/// r_c radius of the bond, the smaller of the two [m], f_b its strength [N]
/// Validity: small shear angles; bonds bear no moment (TwistResistance adds one).
/// Throws InputError for parameters out of their range.
/// Source: equations [2] to [4] of the sub-particle abrasion paper; MDEM after K. Meguro, M. Hakuno,
/// Structural Engineering / Earthquake Engineering 6 (1989) 283.
///
/// While sound, dashpots c = 2 zeta sqrt(k m_eff) act beside both springs; they are no part of the yield. A
/// broken bond is a frictional contact with the same springs: f_n >= 0, |f_s| <= f_n tan(phi). So breaking
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
            detail::require_friction_angle(friction_angle, "MohrCoulomb.friction_angle");
            require_positive(stiffness, "MohrCoulomb.stiffness", "N/m",
                             "E A / d is about 4e8 N/m for concrete, softer is cheaper");
            require_positive(stiffness_ratio, "MohrCoulomb.stiffness_ratio", "", "the default is 0.2");
            detail::require_damping(damping, "MohrCoulomb.damping");
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

    template <class Number>
    using MemoryOf = SpringMemory<Number>;
    using Memory = MemoryOf<Real>;

    explicit MohrCoulomb(Params params) : params_(params) {  // Params{...} alone tells a wrong name
        params_.validate();
        tan_phi_ = std::tan(radians(params_.friction_angle));
    }
    const Params& params() const noexcept { return params_; }

    template <class Number>
    BondResponseOf<Number, MemoryOf<Number>> respond(const BondKinematicsOf<Number>& bond,
                                                     std::type_identity_t<Number> strength_left,
                                                     const MemoryOf<Number>& memory) const noexcept {
        const auto k = rigidity(bond.radius, bond.length);
        const BondSprings<Number> springs(bond, k, tan_phi_, memory.spring);
        const Number limit = strength_left * capacity(bond.radius), push = springs.push();
        const auto sound = memory.broken == Number(0);
        const auto tension = sound & (-push > limit);
        const auto shear = sound & !tension & (springs.shear_force() > (push + limit) * Number(tan_phi_));
        return springs.template answer<MemoryOf<Number>>(sound, tension, shear);
    }

    Real strength(Real left_i, Real left_j) const noexcept {
        return params_.join == Join::mean ? 0.5 * (left_i + left_j) : std::min(left_i, left_j);
    }

    /// Tensile force that breaks a sound bond between spheres of this radius, A sigma_t0 [N].
    template <class Number>
    Number capacity(Number radius) const noexcept {
        return Number(params_.tensile * (params_.area == Area::circle ? pi : 4.0)) * radius * radius;
    }

    Real stiffness() const noexcept { return params_.stiffness; }
    Real tangential_stiffness() const noexcept { return params_.stiffness * params_.stiffness_ratio; }
    template <class Number>
    BondRigidityOf<Number> rigidity(Number /*radius*/, Number /*length*/) const noexcept {
        return {Number(stiffness()), Number(tangential_stiffness()), params_.damping};
    }

private:
    Params params_;
    Real tan_phi_ = 0;
};

static_assert(BondLaw<MohrCoulomb>);

}  // namespace abrade
