#pragma once
// Brittle wear by the energy of impacts.

#include <abrade/wear/wear_law.hpp>

namespace abrade {

/// The impact wear of Sklar and Dietrich.
///   V = beta KE_n / eps_v,  KE_n = 1/2 m w^2,  eps_v = k_v sigma_T^2 / (2 Y)
/// m effective mass [kg], w speed of the impact along the normal [m/s]
/// eps_v energy that it takes to detach a unit volume [J/m3]
/// k_v strength coefficient [-], sigma_T tensile strength [Pa], Y Young's modulus of what wears [Pa]
/// beta time acceleration [-]
/// Validity: brittle rock; sliding wears nothing. Volume only: strength stays.
/// Throws InputError for parameters out of their range.
/// Source: L. S. Sklar, W. E. Dietrich, Water Resources Research 40 (2004) W06301, doi:10.1029/2003WR002496.
///
/// KE_n is booked as the work of the normal force while the two approach (`work_of_approach`), which needs no
/// mass and no first instant.
class SklarDietrich {
public:
    static constexpr std::string_view name = "SklarDietrich";

    struct Params {
        Real tensile = 0;                 ///< sigma_T [Pa]
        Real youngs = 0;                  ///< Y [Pa]
        Real strength_coefficient = 1e6;  ///< k_v [-]; calibrated on rock, concrete is said to have less
        Real acceleration = 1;            ///< beta [-]

        void validate() const {
            require_positive(tensile, "SklarDietrich.tensile", "Pa", "concrete has 1e6 to 5e6 Pa");
            require_positive(youngs, "SklarDietrich.youngs", "Pa", "concrete has 2e10 to 4e10 Pa");
            require_positive(strength_coefficient, "SklarDietrich.strength_coefficient", "",
                             "1e6 was calibrated on rock");
            require_positive(acceleration, "SklarDietrich.acceleration", "", "1 does not accelerate wear");
        }
        void visit(auto&& f) const {
            f("tensile", tensile, "Pa");
            f("youngs", youngs, "Pa");
            f("strength_coefficient", strength_coefficient, "-");
            f("acceleration", acceleration, "-");
        }
    };

    explicit SklarDietrich(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    /// eps_v [J/m3].
    Real energy_of_detachment() const noexcept {
        return params_.strength_coefficient * square(params_.tensile) / (2 * params_.youngs);
    }
    /// Of an impact that brings `energy` along the normal [J].
    template <class Number>
    Number volume(Number energy) const noexcept {
        return Number(params_.acceleration / energy_of_detachment()) * energy;
    }

    template <class Number>
    WearIncrement<Number> increment(const ContactKinematics<Number>& contact,
                                    const ContactLoad<Number>& load) const noexcept {
        return {volume(work_of_approach(contact, load)), Number(0)};
    }
    Real strength_left(Real /*fracture*/) const noexcept { return 1; }

private:
    Params params_;
};

static_assert(AcceleratedWear<SklarDietrich>);

}  // namespace abrade
