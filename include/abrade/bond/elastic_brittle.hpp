#pragma once
// Bonds that are elastic until they are not: no yield line, no friction while they hold.

#include <abrade/bond/bond_springs.hpp>

namespace abrade {

/// Springs that break at a quadratic criterion of both forces.
///   f_n = k_n c,  f_s = -k_s s
///   breaks where (max(-f_n, 0) / (A sigma_t))^2 + (|f_s| / (A tau))^2 > 1,  A = pi r^2
/// c compression, s shear [m], k_n, k_s stiffness [N/m]
/// r the smaller radius [m]
/// sigma_t tensile, tau shear strength [Pa]; wear takes its share off both
/// Validity: small shear angles; what is left of a broken bond is a frictional contact.
/// Throws InputError for parameters out of their range.
/// Source: P. P. Camanho, C. G. Davila, M. F. de Moura, J. Compos. Mater. 37 (2003) 1415,
/// doi:10.1177/0021998303034505.
///
/// The bond counts as broken in tension where that part is the larger. Pulled alone it breaks at a stretch of
/// A sigma_t / k_n and gives up (A sigma_t)^2 / (2 k_n).
class ElasticBrittle {
public:
    static constexpr std::string_view name = "ElasticBrittle";

    struct Params {
        Real tensile = 0;            ///< sigma_t [Pa]
        Real shear = 0;              ///< tau [Pa]
        Real stiffness = 0;          ///< k_n [N/m]
        Real stiffness_ratio = 0.2;  ///< k_s / k_n [-]
        Real friction = 0.5;         ///< of what is left once broken [-]
        Real damping = 0.1;          ///< share of critical damping of one bond [-]

        void validate() const {
            require_positive(tensile, "ElasticBrittle.tensile", "Pa", "concrete has 1e6 to 5e6");
            require_positive(shear, "ElasticBrittle.shear", "Pa", "a few times the tensile strength");
            require_positive(stiffness, "ElasticBrittle.stiffness", "N/m",
                             "E A / d is about 4e8 N/m for concrete, softer is cheaper");
            require_positive(stiffness_ratio, "ElasticBrittle.stiffness_ratio", "", "the default is 0.2");
            require_not_negative(friction, "ElasticBrittle.friction", "",
                                 "tan of 30 to 40 degrees for concrete, 0 for none");
            detail::require_damping(damping, "ElasticBrittle.damping");
        }
        void visit(auto&& f) const {
            f("tensile", tensile, "Pa");
            f("shear", shear, "Pa");
            f("stiffness", stiffness, "N/m");
            f("stiffness_ratio", stiffness_ratio, "-");
            f("friction", friction, "-");
            f("damping", damping, "-");
        }
    };

    template <class Number>
    using MemoryOf = SpringMemory<Number>;
    using Memory = MemoryOf<Real>;

    explicit ElasticBrittle(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    template <class Number>
    BondResponseOf<Number, MemoryOf<Number>> respond(const BondKinematicsOf<Number>& bond,
                                                     std::type_identity_t<Number> strength_left,
                                                     const MemoryOf<Number>& memory) const noexcept {
        const auto k = rigidity(bond.radius, bond.length);
        const BondSprings<Number> springs(bond, k, params_.friction, memory.spring);
        const Number area = strength_left * Number(pi) * bond.radius * bond.radius;
        const Number pulled = max(-springs.push(), Number(0)) * Number(1 / params_.tensile),
                     sheared = springs.shear_force() * Number(1 / params_.shear);
        const auto sound = memory.broken == Number(0);
        const auto breaks = sound & (pulled * pulled + sheared * sheared > area * area);
        return springs.template answer<MemoryOf<Number>>(sound, breaks & (pulled > sheared),
                                                         breaks & (pulled <= sheared));
    }

    Real strength(Real left_i, Real left_j) const noexcept { return 0.5 * (left_i + left_j); }
    template <class Number>
    BondRigidityOf<Number> rigidity(Number /*radius*/, Number /*length*/) const noexcept {
        return {Number(params_.stiffness), Number(params_.stiffness * params_.stiffness_ratio),
                params_.damping};
    }

private:
    Params params_;
};

static_assert(BondLaw<ElasticBrittle>);

}  // namespace abrade
