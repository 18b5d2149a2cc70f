#pragma once
// Bonds that are short beams of cement: they carry bending and twisting, too.

#include <abrade/bond/bond_springs.hpp>

namespace abrade {

/// A round beam between two spheres.
///   f_n = E A/L c,   f_s = -kappa E A/L s,   M_b = -E I/L theta_b,   M_t = -kappa E J/L theta_t
///   sigma = -f_n/A + |M_b| R/I,  tau = |f_s|/A + |M_t| R/J
///   A = pi R^2,  I = pi R^4 / 4,  J = 2 I
///   breaks in tension where sigma > sigma_t, in shear where tau > cohesion + f_n/A tan(phi)
/// f_n, f_s forces [N], M_b, M_t couples [N m], sigma, tau stresses [Pa]
/// A area [m2], I, J its second moments [m4]
/// c compression, s shear [m], theta_b bending and theta_t twist [rad]
/// R = `radius_factor` times the smaller radius, L length [m]
/// E Young's modulus [Pa], kappa = `stiffness_ratio`, G over E times the shear factor for a beam that shears
/// like a solid [-]
/// sigma_t tensile strength, cohesion [Pa], of which wear takes its share; phi angle of friction
/// Validity: small angles; a beam about as long as it is thick. tan(phi) counts where f_n presses.
/// Throws InputError for parameters out of their range.
/// Source: D. O. Potyondy, P. A. Cundall, Int. J. Rock Mech. Min. Sci. 41 (2004) 1329,
/// doi:10.1016/j.ijrmms.2004.09.011.
///
/// While sound, dashpots 2 zeta sqrt(k m_eff), 2 zeta sqrt(k I_eff) act beside all four. What is left of a
/// broken bond is a frictional contact; moments end with the bond.
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
            require_positive(stiffness_ratio, "ParallelBond.stiffness_ratio", "", "the default is 0.4");
            require_positive(tensile, "ParallelBond.tensile", "Pa", "concrete has 1e6 to 5e6");
            require_positive(cohesion, "ParallelBond.cohesion", "Pa", "a few times the tensile strength");
            detail::require_friction_angle(friction_angle, "ParallelBond.friction_angle");
            require_positive(radius_factor, "ParallelBond.radius_factor", "",
                             "1 is a beam as thick as the spheres, its area goes with the square");
            detail::require_damping(damping, "ParallelBond.damping");
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

    template <class Number>
    struct MemoryOf {
        Vec3Of<Number> spring = Vec3Of<Number>::Zero();  ///< shear spring [m]
        Vec3Of<Number> bend = Vec3Of<Number>::Zero();    ///< theta_b, across the normal [rad]
        Number twist = Number(0);                        ///< theta_t, about the normal [rad]
        Number broken = Number(0);                       ///< 1 where it is
    };
    using Memory = MemoryOf<Real>;

    explicit ParallelBond(Params params) : params_(params) {  // Params{...} alone tells a wrong name
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
        const Vec3Of<Number>& n = bond.normal;
        const Number twisted = bond.rotation.dot(n), twist = memory.twist + twisted;
        const Vec3Of<Number> bend = turn_into_plane(memory.bend, n) + (bond.rotation - twisted * n);
        const Number bend2 = bend.dot(bend), half(0.5), zero(0);
        const Number held = half * (k.bending * bend2 + k.twisting * twist * twist);

        const Number r = Number(params_.radius_factor) * bond.radius, per_area = Number(1 / pi) / (r * r);
        const Number moment_share = Number(4) * per_area / r;  // R/I; R/J is half of it
        const Number pull = -springs.push() * per_area;
        const Number pulled = pull + moment_share * k.bending * sqrt(bend2);
        const Number sheared =
            springs.shear_force() * per_area + half * moment_share * k.twisting * max(twist, -twist);
        const auto sound = memory.broken == zero;
        const auto tension = sound & (pulled > strength_left * Number(params_.tensile));
        const auto shear =
            sound & !tension &
            (sheared > strength_left * Number(params_.cohesion) + max(-pull, zero) * Number(tan_phi_));
        auto answer = springs.template answer<MemoryOf<Number>>(sound, tension, shear, held);

        const auto holds = answer.memory.broken == zero;
        const Number twist_rate = bond.spin.dot(n), twice(2 * k.damping_ratio);
        const Vec3Of<Number> bend_rate = bond.spin - twist_rate * n, none = Vec3Of<Number>::Zero();
        const Number bend_dashpot = twice * sqrt(k.bending * bond.effective_inertia),
                     twist_dashpot = twice * sqrt(k.twisting * bond.effective_inertia);
        const Vec3Of<Number> couple = -k.bending * bend - bend_dashpot * bend_rate -
                                      (k.twisting * twist + twist_dashpot * twist_rate) * n;
        const Number damped =
            (bend_dashpot * bend_rate.dot(bend_rate) + twist_dashpot * twist_rate * twist_rate) *
            Number(bond.time_step);
        answer.load.couple = select(holds, couple, none);
        answer.load.stored = answer.load.stored + select(holds, held, zero);
        answer.load.lost_bond = answer.load.lost_bond + select(holds, damped, zero);
        answer.memory.bend = select(holds, bend, none), answer.memory.twist = select(holds, twist, zero);
        return answer;
    }

    Real strength(Real left_i, Real left_j) const noexcept { return 0.5 * (left_i + left_j); }

    template <class Number>
    BondRigidityOf<Number> rigidity(Number radius, Number length) const noexcept {
        const Number r = Number(params_.radius_factor) * radius;
        const Number along = Number(params_.youngs * pi) * r * r / length,
                     bending = Number(0.25) * along * r * r;
        const Real kappa = params_.stiffness_ratio;
        return {along, Number(kappa) * along, params_.damping, bending, Number(2 * kappa) * bending};
    }

private:
    Params params_;
    Real tan_phi_ = 0;
};

static_assert(BondLaw<ParallelBond> && CarriesMoments<ParallelBond>);

}  // namespace abrade
