#pragma once
#include <abrade/wear/wear_law.hpp>

/// Volume = energy / specific energy (R. Teale, Int. J. Rock Mech. Min. Sci. 2 (1965) 57,
/// doi:10.1016/0148-9062(65)90022-7), half of what a contact loses in each body. Brittle: as strong as ever
/// until a sphere is worn through.
class SpecificEnergy {
public:
    static constexpr std::string_view name = "SpecificEnergy";

    struct Params {
        double impact = 1e7, sliding = 1e7;  ///< [J/m3]
        void validate() const {
            abrade::require_positive(impact, "SpecificEnergy.impact", "J/m3");
            abrade::require_positive(sliding, "SpecificEnergy.sliding", "J/m3");
        }
        void visit(auto&& f) const { f("impact", impact, "J/m3"), f("sliding", sliding, "J/m3"); }
    };

    explicit SpecificEnergy(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    template <class Number>
    abrade::WearIncrement<Number> increment(const abrade::ContactKinematics<Number>&,
                                            const abrade::ContactLoad<Number>& load) const noexcept {
        return {Number(0.5 / params_.impact) * load.lost_normal,
                Number(0.5 / params_.sliding) * load.lost_tangential};
    }
    double strength_left(double fracture) const noexcept { return fracture < 1 ? 1 : 0; }

private:
    Params params_;
};
static_assert(abrade::WearLaw<SpecificEnergy>);
