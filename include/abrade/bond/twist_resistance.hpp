#pragma once
// Resistance to twisting, added to a bond law without moments.

#include <abrade/bond/bond_law.hpp>

namespace abrade {

/// A bond law and a couple about the bond, equal and opposite on its two spheres, while it is sound.
///   M_t = -k_t theta - c_t w,  k_t = a k_s r^2 / 2,  c_t = 2 zeta sqrt(k_t I_eff),  I_eff = 1/(1/I_i +
///   1/I_j)
/// theta twist since the start [rad], w its rate [rad/s]: of i against j, about the normal
/// r the smaller radius [m], k_s the law's spring across the bond [N/m]
/// a ratio, zeta the law's share of critical damping [-], I_eff [kg m2]
/// Validity: as the law's. The couple has no part in the yield, and ends with the bond.
/// Throws InputError for parameters out of their range, those of the law included.
/// Source: torsion of a round bar as thick as the spheres, a = 1: k_t = G J / L where k_s = G A / L, J /
/// A = r^2 / 2.
///
/// What the couple stored counts as lost in the bond when that breaks. With a = 1 the stiffness is that
/// of a ParallelBond of the radius r.
/// Made for lattices whose springs let neighbours turn against each other as gears do: a cubic one of
/// MohrCoulomb bonds (docs/verification/03_heap_at_rest.md).
template <BondLaw Law>
requires(AnswersBondPacks<Law> && !CarriesMoments<Law>) class TwistResistance {
public:
    static constexpr std::string_view name = "TwistResistance";
    static constexpr bool carries_moments = true;

    struct Params {
        typename Law::Params bond{};  ///< of the law that gives the force
        Real stiffness_factor = 1;    ///< a [-]

        void validate() const {
            bond.validate();
            require_positive(stiffness_factor, "TwistResistance.stiffness_factor", "",
                             "1 is a beam as thick as the spheres; use the law alone for none");
        }
        void visit(auto&& f) const {
            bond.visit(f);
            f("twist_stiffness_factor", stiffness_factor, "-");
        }
    };

    template <class Number>
    struct MemoryOf : Law::template MemoryOf<Number> {
        Number twist = Number(0);  ///< theta [rad]
    };
    using Memory = MemoryOf<Real>;

    explicit TwistResistance(Params params) : params_(params), law_(params.bond) { params_.validate(); }
    const Params& params() const noexcept { return params_; }

    template <class Number>
    BondResponseOf<Number, MemoryOf<Number>> respond(const BondKinematicsOf<Number>& bond,
                                                     std::type_identity_t<Number> strength_left,
                                                     const MemoryOf<Number>& memory) const noexcept {
        using Base = typename Law::template MemoryOf<Number>;
        const auto answer = law_.respond(bond, strength_left, static_cast<const Base&>(memory));
        BondResponseOf<Number, MemoryOf<Number>> all;
        all.load = answer.load, all.failure = answer.failure;
        static_cast<Base&>(all.memory) = answer.memory;

        const auto k = rigidity(bond.radius, bond.length);
        const Number zero(0), rate = bond.spin.dot(bond.normal),
                              twist = memory.twist + bond.rotation.dot(bond.normal);
        const Number dashpot = Number(2 * k.damping_ratio) * sqrt(k.twisting * bond.effective_inertia);
        const Number held = Number(0.5) * k.twisting * twist * twist;
        const auto sound = memory.broken == zero, holds = answer.memory.broken == zero;
        const Vec3Of<Number> none = Vec3Of<Number>::Zero(),
                             couple = -(k.twisting * twist + dashpot * rate) * bond.normal;
        all.load.couple = select(holds, couple, none);
        all.load.stored += select(holds, held, zero);
        all.load.lost_bond +=
            select(holds, dashpot * rate * rate * Number(bond.time_step), select(sound, held, zero));
        all.memory.twist = select(holds, twist, zero);
        return all;
    }

    Real strength(Real left_i, Real left_j) const noexcept { return law_.strength(left_i, left_j); }

    template <class Number>
    BondRigidityOf<Number> rigidity(Number radius, Number length) const noexcept {
        auto all = law_.rigidity(radius, length);
        all.twisting = Number(0.5 * params_.stiffness_factor) * all.tangential * radius * radius;
        return all;
    }

    const Law& law() const noexcept { return law_; }  ///< without resistance to twisting

private:
    Params params_;
    Law law_;
};

}  // namespace abrade
