#pragma once
// Abrasion below the size of a sphere, from the energy that contacts lose.

#include <abrade/wear/wear_law.hpp>

namespace abrade {

/// The sub-particle abrasion law. A contact that loses mechanical energy leaves half of it in each body, and
/// a constant share of that fractures concrete.
///   dE_nm = 1/2 dE_nm,ij                                             [11]
///   dV_w = C_w beta dE_nm                                            [1]
///   gamma_f = sum(dV_w) / V_omega, at most 1                         [10]
///   what is left of the strength: 1 - gamma_f                        [2]
/// dE_nm,ij energy that the contact lost [J]
/// C_w abrasion coefficient [m3/J], beta time acceleration [-]
/// V_omega volume of the sphere's cell [m3], gamma_f fracture [-]
/// Validity: wear in proportion to the energy lost, for the concrete that C_w was fitted to; beta as long as
/// no collision fills its sphere's cell.
/// Throws InputError for parameters out of their range.
/// Source: equations [1], [2], [10] and [11] of the sub-particle abrasion paper.
///
/// dE_nm,ij is the contact law's dissipation (dashpot and slider; with LinearHysteretic and
/// ElasticPlasticHertz the dent, too), summed as it occurs, and so never negative; elastic energy on loan
/// does not wear. Over a whole collision this is equation [11]'s integral of f . (v_j - v_i) dt up to the
/// integration residue that the ledger shows. A load at rest loses nothing, so a static deposit does not
/// wear.
///
/// `normal_weight` and `tangential_weight` weigh the two kinds of loss; 1 and 1 is the paper. Field evidence
/// finds that sliding over-predicts at equal weight (C. Auel, R. M. Boes, L. S. Sumi, 2017).
class SubParticleAbrasion {
public:
    static constexpr std::string_view name = "SubParticleAbrasion";

    struct Params {
        Real coefficient = 1.1e-7;   ///< C_w [m3/J]
        Real acceleration = 1;       ///< beta [-]
        Real normal_weight = 1;      ///< [-]
        Real tangential_weight = 1;  ///< [-]

        void validate() const {
            require_not_negative(coefficient, "SubParticleAbrasion.coefficient", "m3/J", "0 wears nothing");
            require_positive(acceleration, "SubParticleAbrasion.acceleration", "",
                             "1 does not accelerate wear");
            require_not_negative(normal_weight, "SubParticleAbrasion.normal_weight", "",
                                 "0 leaves impacts out");
            require_not_negative(tangential_weight, "SubParticleAbrasion.tangential_weight", "",
                                 "0 leaves sliding out");
        }
        void visit(auto&& f) const {
            f("coefficient", coefficient, "m3/J");
            f("acceleration", acceleration, "-");
            f("normal_weight", normal_weight, "-");
            f("tangential_weight", tangential_weight, "-");
        }
    };

    explicit SubParticleAbrasion(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    template <class Number>
    WearIncrement<Number> increment(const ContactKinematics<Number>&,
                                    const ContactLoad<Number>& load) const noexcept {
        const Real per_joule = 0.5 * params_.coefficient * params_.acceleration;
        return {Number(per_joule * params_.normal_weight) * load.lost_normal,
                Number(per_joule * params_.tangential_weight) * load.lost_tangential};
    }
    Real strength_left(Real fracture) const noexcept { return 1 - fracture; }

private:
    Params params_;
};

static_assert(AcceleratedWear<SubParticleAbrasion>);

}  // namespace abrade
