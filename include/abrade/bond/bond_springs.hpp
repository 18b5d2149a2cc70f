#pragma once
// What bond laws share: springs and dashpots along the bond and across it, and what is left when it breaks.

#include <abrade/bond/bond_law.hpp>

namespace abrade {

/// The two springs of one bond at time t_n, f_n = k_n c (c compression) and f_s = -k_s s, with dashpots
/// 2 zeta sqrt(k m_eff) beside them while it is sound. A broken bond is a frictional contact with the same
/// springs, f_n >= 0 and |f_s| <= f_n tan(phi), so breaking under compression changes no normal force.
class BondSprings {
public:
    /// `spring` [m] is what the bond remembers of s, `friction` tan(phi).
    BondSprings(const BondKinematics& bond, const BondRigidity& k, Real friction, const Vec3& spring) noexcept
        : bond_(bond), k_(k), friction_(friction), approach_(-bond.velocity.dot(bond.normal)),
          slip_(bond.velocity + approach_ * bond.normal), before_(turn_into_plane(spring, bond.normal)),
          shear_(before_ + bond.travel - bond.travel.dot(bond.normal) * bond.normal), remembered_(spring) {
        normal_dashpot_ = 2 * k.damping_ratio * std::sqrt(k.normal * bond.effective_mass);
        tangential_dashpot_ = 2 * k.damping_ratio * std::sqrt(k.tangential * bond.effective_mass);
    }

    Real push() const noexcept { return k_.normal * bond_.compression; }         ///< f_n [N]
    Real shear_force() const noexcept { return k_.tangential * shear_.norm(); }  ///< |f_s| [N]
    const Vec3& shear() const noexcept { return shear_; }                        ///< s [m]
    Real stored() const noexcept {                                               ///< [J]
        return 0.5 * k_.normal * square(bond_.compression) + 0.5 * k_.tangential * shear_.squaredNorm();
    }

    /// Of a sound bond.
    BondLoad sound() const noexcept {
        BondLoad load;
        load.force = (push() + normal_dashpot_ * approach_) * bond_.normal - k_.tangential * shear_ -
                     tangential_dashpot_ * slip_;
        load.stored = stored();
        load.lost_bond = (normal_dashpot_ * square(approach_) + tangential_dashpot_ * slip_.squaredNorm()) *
                         bond_.time_step;
        return load;
    }

    /// Of one that breaks in this step and held `also` [J] beside its springs: what the contact that is left
    /// cannot hold is lost in the bond.
    template <class Memory>
    BondResponse<Memory> breaks(Fate fate, Real also = 0) const noexcept {
        BondResponse<Memory> answer = bond_.compression > 0 ? slide<Memory>() : open<Memory>();
        const Real held = stored() + also;
        answer.load.lost_bond = std::max(0.0, held - answer.load.stored) + answer.load.lost_normal;
        answer.load.lost_normal = answer.load.lost_tangential = 0;
        answer.fate = fate;
        return answer;
    }

    /// Of one that is broken: a contact, or nothing where it is open.
    template <class Memory>
    BondResponse<Memory> broken() const noexcept {
        return bond_.compression > 0 ? slide<Memory>() : open<Memory>();
    }

private:
    template <class Memory>
    BondResponse<Memory> slide() const noexcept {
        const Real depth = bond_.compression, dt = bond_.time_step;
        const auto normal =
            NormalSpring<Real>::pushing(push(), 0.5 * push() * depth, normal_dashpot_, approach_, dt);
        const auto tangential = SlidingSpring<Real>::at(before_, shear_, slip_, friction_ * normal.force,
                                                        k_.tangential, tangential_dashpot_, dt);
        BondResponse<Memory> answer;
        answer.load.force = normal.force * bond_.normal + tangential.force;
        answer.load.stored = normal.stored + tangential.stored;
        answer.load.lost_normal = normal.lost, answer.load.lost_tangential = tangential.lost;
        answer.memory.spring = tangential.spring, answer.memory.broken = true;
        return answer;
    }
    template <class Memory>
    BondResponse<Memory> open() const noexcept {
        BondResponse<Memory> answer;
        answer.load.lost_tangential = 0.5 * k_.tangential * remembered_.squaredNorm();
        answer.memory.broken = true;
        return answer;
    }

    const BondKinematics& bond_;
    const BondRigidity& k_;
    Real friction_, approach_;
    Vec3 slip_, before_, shear_, remembered_;
    Real normal_dashpot_ = 0, tangential_dashpot_ = 0;  ///< [N s/m]
};

}  // namespace abrade
