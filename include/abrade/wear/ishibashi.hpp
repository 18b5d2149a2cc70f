#pragma once
// Wear by impact energy and frictional work, each with a coefficient of its own.

#include <abrade/wear/wear_law.hpp>

#include <limits>

namespace abrade {

/// The form of Ishibashi's law for sediment bypass tunnels.
///   V = beta (C_1 sum(E_n) + C_2 sum(W_f))
/// E_n kinetic energy of impacts along the normal [J], W_f work of friction [J]
/// C_1, C_2 coefficients [m3/J], beta time acceleration [-]
/// Validity: the concrete and gravel that C_1 and C_2 were fitted to: both must be given, none that is
/// published is built in. Volume only: strength stays.
/// Throws InputError for parameters out of their range, and where C_1 or C_2 is not given.
/// Source: T. Ishibashi, Proceedings of JSCE 334 (1983) 103 (in Japanese).
///
/// E_n is booked as the work of the normal force while the two approach (`work_of_approach`), W_f as what the
/// contact law lost across the normal.
class Ishibashi {
public:
    static constexpr std::string_view name = "Ishibashi";

    struct Params {
        Real impact = std::numeric_limits<Real>::quiet_NaN();    ///< C_1 [m3/J]
        Real friction = std::numeric_limits<Real>::quiet_NaN();  ///< C_2 [m3/J]
        Real acceleration = 1;                                   ///< beta [-]

        void validate() const {
            require_not_negative(impact, "Ishibashi.impact", "m3/J",
                                 "there is no default: give a measured one");
            require_not_negative(friction, "Ishibashi.friction", "m3/J",
                                 "there is no default: give a measured one");
            require_positive(acceleration, "Ishibashi.acceleration", "", "1 does not accelerate wear");
        }
        void visit(auto&& f) const {
            f("impact", impact, "m3/J");
            f("friction", friction, "m3/J");
            f("acceleration", acceleration, "-");
        }
    };

    explicit Ishibashi(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    template <class Number>
    WearIncrement<Number> increment(const ContactKinematics<Number>& contact,
                                    const ContactLoad<Number>& load) const noexcept {
        return {Number(params_.acceleration * params_.impact) * work_of_approach(contact, load),
                Number(params_.acceleration * params_.friction) * load.lost_tangential};
    }
    Real strength_left(Real /*fracture*/) const noexcept { return 1; }

private:
    Params params_;
};

static_assert(AcceleratedWear<Ishibashi>);

}  // namespace abrade
