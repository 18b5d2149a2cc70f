#pragma once
// What bond laws share: springs and dashpots along the bond and across it, and what is left when it breaks.

#include <abrade/bond/bond_law.hpp>

namespace abrade {

namespace detail {
inline FailureMode failure_mode_of(bool tension, bool shear) noexcept {
    return tension ? FailureMode::tension : shear ? FailureMode::shear : FailureMode::intact;
}
inline PackFailureMode failure_mode_of(PackMask tension, PackMask shear) noexcept { return {tension, shear}; }

inline void require_friction_angle(Real degrees, std::string_view field) {
    require(degrees >= 0 && degrees < 90, {field, "in [0, 90)", "degrees", "concrete has 30 to 40"}, degrees);
}
inline void require_damping(Real share, std::string_view field) {
    require(share >= 0 && share <= 1,
            {field, "in [0, 1]", "", "it is a share of critical damping, 0 for none"}, share);
}
}  // namespace detail

/// What a bond remembers that has these two springs alone.
template <class Number>
struct SpringMemory {
    Vec3Of<Number> spring = Vec3Of<Number>::Zero();  ///< across the bond [m]
    Number broken = Number(0);                       ///< 1 where it is
};

/// The two springs of one bond at time t_n, f_n = k_n c (c compression) and f_s = -k_s s, with dashpots
/// 2 zeta sqrt(k m_eff) beside them while it is sound. A broken bond is a frictional contact with the same
/// springs, f_n >= 0 and |f_s| <= f_n tan(phi), so breaking under compression changes no normal force.
///
/// Springs tilt with the bond, but do not turn about it: two spheres that spin together about their bond keep
/// the direction of s in space. For loose clusters that are sheared or bent and spin about such an axis this
/// is an error. Nor do springs resist that one end twists against the other: in a cubic lattice, where all
/// neighbours of a layer may turn against each other as gears do, nothing stops that, and the load's own
/// shear drives it slowly (tests/verification/deposit.cpp). Beams (ParallelBond) resist it, and so do springs
/// with TwistResistance; a hexagonal lattice has no such motion.
template <class Number>
class BondSprings {
public:
    using Mask = decltype(Number(0) > Number(0));

    /// `spring` [m] is what the bond remembers of s, `friction` tan(phi).
    BondSprings(const BondKinematicsOf<Number>& bond, const BondRigidityOf<Number>& k, Real friction,
                const Vec3Of<Number>& spring) noexcept
        : bond_(bond), k_(k), friction_(friction), approach_(-bond.velocity.dot(bond.normal)),
          slip_(bond.velocity + approach_ * bond.normal), before_(turn_into_plane(spring, bond.normal)),
          shear_(before_ + bond.displacement - bond.displacement.dot(bond.normal) * bond.normal),
          remembered_(spring) {
        const Number twice(2 * k.damping_ratio);
        normal_dashpot_ = twice * sqrt(k.normal * bond.effective_mass);
        tangential_dashpot_ = twice * sqrt(k.tangential * bond.effective_mass);
    }

    Number push() const noexcept { return k_.normal * bond_.compression; }                    ///< f_n [N]
    Number shear_force() const noexcept { return k_.tangential * sqrt(shear_.dot(shear_)); }  ///< |f_s| [N]
    const Vec3Of<Number>& shear() const noexcept { return shear_; }                           ///< s [m]

    /// The answer where `sound` bonds break in `tension` or `shear` in this step, or hold, and the others are
    /// broken. What the contact that is left of a bond cannot hold is lost in the bond, as are the `also` [J]
    /// that it held beside these springs. Memory's other members are the caller's.
    template <class Memory>
    BondResponseOf<Number, Memory> answer(Mask sound, Mask tension, Mask shear,
                                          Number also = Number(0)) const noexcept {
        BondResponseOf<Number, Memory> all;
        BondLoadOf<Number>& load = all.load;
        const Number held = Number(0.5) * (k_.normal * bond_.compression * bond_.compression +
                                           k_.tangential * shear_.dot(shear_));
        load.force = (push() + normal_dashpot_ * approach_) * bond_.normal - k_.tangential * shear_ -
                     tangential_dashpot_ * slip_;
        load.stored = held;
        load.lost_bond = (normal_dashpot_ * approach_ * approach_ + tangential_dashpot_ * slip_.dot(slip_)) *
                         Number(bond_.time_step);
        all.memory.spring = shear_, all.memory.broken = Number(0);
        const Mask breaks = tension | shear, contact = breaks | !sound;
        if (!any(contact)) return all;

        const Number zero(0), depth = max(bond_.compression, zero);
        const Vec3Of<Number> none = Vec3Of<Number>::Zero();
        const Mask pressed = bond_.compression > zero;
        const auto normal =
            NormalSpring<Number>::pushing(k_.normal * depth, Number(0.5) * k_.normal * depth * depth,
                                          normal_dashpot_, approach_, bond_.time_step);
        const auto tangential =
            SlidingSpring<Number>::at(before_, shear_, slip_, Number(friction_) * normal.force, k_.tangential,
                                      tangential_dashpot_, bond_.time_step);
        const Number stored = select(pressed, normal.stored + tangential.stored, zero);
        const Number gone = Number(0.5) * k_.tangential * remembered_.dot(remembered_);
        const Number lost_normal = select(pressed, normal.lost, zero),
                     lost_tangential = select(pressed, tangential.lost, gone);
        load.force = select(
            contact, select(pressed, Vec3Of<Number>(normal.force * bond_.normal + tangential.force), none),
            load.force);
        load.stored = select(contact, stored, held);
        // Where a bond breaks pressed, the tangential dashpot's work of this step is in no loss: it is part
        // of the integration residue.
        load.lost_bond = select(breaks, max(held + also - stored, zero) + lost_normal,
                                select(contact, zero, load.lost_bond));
        const Mask old = contact & !breaks;
        load.lost_normal = select(old, lost_normal, zero);
        load.lost_tangential = select(old, lost_tangential, zero);
        all.memory.spring = select(contact, select(pressed, tangential.spring, none), shear_);
        all.memory.broken = select(contact, Number(1), zero);
        all.failure = detail::failure_mode_of(tension, shear);
        return all;
    }

private:
    const BondKinematicsOf<Number>& bond_;
    BondRigidityOf<Number> k_;
    Real friction_;
    Number approach_;
    Vec3Of<Number> slip_, before_, shear_, remembered_;
    Number normal_dashpot_, tangential_dashpot_;  ///< [N s/m]
};

}  // namespace abrade
