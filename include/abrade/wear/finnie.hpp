#pragma once
// Cutting wear by impacts that come in at an angle.

#include <abrade/wear/wear_law.hpp>

namespace abrade {

/// Finnie's law of cutting by impacts.
///   V = c beta m v^2 / (p psi K) f(alpha)
///   f = sin(2 alpha) - (6 / K) sin^2(alpha)   for tan(alpha) <= K / 6: still cutting when it leaves
///   f = (K / 6) cos^2(alpha)                  above: the cut ends before
/// m mass of what impacts [kg], v its speed [m/s], alpha the angle between v and the surface
/// p flow stress of what is cut [Pa], K ratio of the force along the normal to the force across it [-]
/// psi length of the contact over depth of the cut [-]
/// c share of impacts that cut [-], beta time acceleration [-]
/// Validity: ductile metals. Nothing is cut head-on, so for brittle concrete it tells of the oblique part
/// alone. Volume only: strength stays.
/// Throws InputError for parameters out of their range.
/// Source: I. Finnie, Wear 3 (1960) 87, doi:10.1016/0043-1648(60)90055-7.
///
/// Both branches meet with one slope. An impact is booked in the step in which its contact begins, with that
/// step's velocity at the contact point (spin counts) and the effective mass: of a stone against rigid
/// concrete its own mass, against one bonded sphere less than that sphere's. A clump that lands on several
/// spheres at once is booked as often. Broken bonds that close again are not told to begin, and wear nothing.
class Finnie {
public:
    static constexpr std::string_view name = "Finnie";

    struct Params {
        Real flow_stress = 0;    ///< p [Pa]
        Real force_ratio = 2;    ///< K [-]; customary for metals, not measured for concrete
        Real depth_ratio = 2;    ///< psi [-]; likewise
        Real cutting_share = 1;  ///< c, in (0, 1] [-]
        Real acceleration = 1;   ///< beta [-]

        void validate() const {
            require_positive(flow_stress, "Finnie.flow_stress", "Pa", "that of what is cut");
            require_positive(force_ratio, "Finnie.force_ratio", "", "2 is customary");
            require_positive(depth_ratio, "Finnie.depth_ratio", "", "2 is customary");
            require(cutting_share > 0 && cutting_share <= 1,
                    {"Finnie.cutting_share", "in (0, 1]", "", "1 where each impact cuts"}, cutting_share);
            require_positive(acceleration, "Finnie.acceleration", "", "1 does not accelerate wear");
        }
        void visit(auto&& f) const {
            f("flow_stress", flow_stress, "Pa");
            f("force_ratio", force_ratio, "-");
            f("depth_ratio", depth_ratio, "-");
            f("cutting_share", cutting_share, "-");
            f("acceleration", acceleration, "-");
        }
    };

    explicit Finnie(Params params) : params_(params) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    /// Of one impact of mass m [kg] at v_n along the normal and v_t across it, both >= 0 [m/s]. With v_n held
    /// at (K / 6) v_t the first branch is the second.
    template <class Number>
    Number volume(Number mass, Number along, Number across) const noexcept {
        const Real turning = params_.force_ratio / 6;
        const Number cutting = min(along, Number(turning) * across);
        return Number(per_energy()) * mass * cutting * (across + across - Number(1 / turning) * cutting);
    }

    template <class Number>
    WearIncrement<Number> increment(const ContactKinematics<Number>& contact,
                                    const ContactLoad<Number>& /*load*/) const noexcept {
        const auto begins = (contact.overlap > Number(0)) & (contact.touched == Number(0));
        if (!any(begins)) return {Number(0), Number(0)};
        const Number along = -contact.velocity.dot(contact.normal);
        const Vec3Of<Number> across = contact.velocity + along * contact.normal;
        const Number cut =
            volume(Number(1) / contact.inverse_mass, max(along, Number(0)), sqrt(across.dot(across)));
        return {Number(0), select(begins, cut, Number(0))};
    }
    Real strength_left(Real /*fracture*/) const noexcept { return 1; }

private:
    Real per_energy() const noexcept {  ///< [1/Pa]
        return params_.cutting_share * params_.acceleration /
               (params_.flow_stress * params_.depth_ratio * params_.force_ratio);
    }

    Params params_;
};

static_assert(AcceleratedWear<Finnie>);

}  // namespace abrade
