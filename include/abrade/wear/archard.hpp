#pragma once
// Sliding wear by load and distance.

#include <abrade/wear/wear_law.hpp>

namespace abrade {

/// Archard's law of sliding wear.
///   dV = (k / H) beta F_n |v_t| dt
/// k wear coefficient of the body that wears [-], H its hardness [Pa]
/// F_n normal force, what pushes [N]
/// v_t velocity of the two against each other across the normal at the contact point [m/s]
/// beta time acceleration [-]
/// Validity: steady sliding. Volume only: strength stays.
/// Throws InputError for parameters out of their range.
/// Source: J. F. Archard, Journal of Applied Physics 24 (1953) 981, doi:10.1063/1.1721448.
///
/// A block that slides a distance s under N wears k N s / H; an impact that slides throughout, k / (H mu)
/// times its frictional work. The distance is that of the bodies, elastic or not: an impact that sticks wears
/// several times what its friction spends. `Ishibashi` with C_1 = 0 and C_2 = k / (H mu) counts that alone.
class Archard {
public:
    static constexpr std::string_view name = "Archard";

    struct Params {
        Real coefficient = 0;   ///< k [-]
        Real hardness = 0;      ///< H [Pa]
        Real acceleration = 1;  ///< beta [-]

        void validate() const {
            require_positive(coefficient, "Archard.coefficient", "-", "1e-8 to 1e-2 are usual");
            require_positive(hardness, "Archard.hardness", "Pa", "that of the body that wears");
            require_positive(acceleration, "Archard.acceleration", "", "1 does not accelerate wear");
        }
        void visit(auto&& f) const {
            f("coefficient", coefficient, "-");
            f("hardness", hardness, "Pa");
            f("acceleration", acceleration, "-");
        }
    };

    explicit Archard(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    template <class Number>
    WearIncrement<Number> increment(const ContactKinematics<Number>& contact,
                                    const ContactLoad<Number>& load) const noexcept {
        const Number push = max(load.force.dot(contact.normal), Number(0));
        const Vec3Of<Number> slip = contact.velocity - contact.velocity.dot(contact.normal) * contact.normal;
        const auto per_work =
            Number(params_.coefficient / params_.hardness * params_.acceleration * contact.time_step);
        return {Number(0), per_work * push * sqrt(slip.dot(slip))};
    }
    Real strength_left(Real /*fracture*/) const noexcept { return 1; }

private:
    Params params_;
};

static_assert(AcceleratedWear<Archard>);

}  // namespace abrade
