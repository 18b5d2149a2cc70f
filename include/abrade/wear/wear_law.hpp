#pragma once
// What a wear law sees and answers, its concept, and the null policy.

#include <abrade/dem/contacts/contact_observer.hpp>

namespace abrade {

/// Concrete worn off one body by one contact in one step.
template <class Number>
struct WearIncrement {
    Number normal;      ///< by impact, along the normal [m3]
    Number tangential;  ///< by sliding and cutting, across it [m3]
};

/// A wear law is a pure function of a contact in one step: how it stands, and what the contact law answered.
/// - `increment` gives the volume worn off *one* of the two bodies; it is never negative; a template on the
///   number type, as contact laws are. Each side that is concrete wears that volume: concrete against
///   concrete wears twice a law's formula, but for SubParticleAbrasion, which halves the loss;
/// - `strength_left(fracture)` says what a sphere that is worn to `fracture` in [0, 1] still holds.
// clang-format off
template <class W>
concept WearLaw = Law<W> &&
    requires(const W& law, const ContactKinematics<Real>& contact, const ContactLoad<Real>& load) {
    { law.increment(contact, load) } noexcept -> std::same_as<WearIncrement<Real>>;
    { law.strength_left(Real{}) } noexcept -> std::same_as<Real>;
};
// clang-format on

/// A wear law as it looks at contacts: the volume of either kind that one side wears in a step [m3].
template <WearLaw W>
class WearObserver {
public:
    explicit WearObserver(const W& law) noexcept : law_(&law) {}

    template <class Number>
    Number observe(const ContactKinematics<Number>& contact,
                   const ContactLoad<Number>& load) const noexcept requires requires(const W& law) {
        law.increment(contact, load);
    }
    {
        const auto increment = law_->increment(contact, load);
        return increment.normal + increment.tangential;
    }

private:
    const W* law_;
};

/// A wear law with a time acceleration beta [-]: what it wears is proportional to it.
// clang-format off
template <class W>
concept AcceleratedWear = WearLaw<W> && requires(const W& law) {
    { law.params().acceleration } -> std::convertible_to<Real>;
};
// clang-format on

/// Work of the normal force in one step while the two approach [J], never negative. Over an impact it is the
/// kinetic energy along the normal, 1/2 m_eff w^2, to O(dt^2), whatever the restitution: until the approach
/// ends, that is what the normal force takes. Bodies that touch at several points share it among them.
template <class Number>
Number work_of_approach(const ContactKinematics<Number>& contact, const ContactLoad<Number>& load) noexcept {
    const Number push = max(load.force.dot(contact.normal), Number(0));
    const Number approach = max(-contact.velocity.dot(contact.normal), Number(0));
    return push * approach * Number(contact.time_step);
}

/// Nothing wears.
struct NoWear {
    static constexpr std::string_view name = "NoWear";
    using Params = NoParams;

    NoWear() = default;
    explicit NoWear(Params) {}
    const Params& params() const noexcept {
        static constexpr Params none{};
        return none;
    }
    template <class Number>
    WearIncrement<Number> increment(const ContactKinematics<Number>&,
                                    const ContactLoad<Number>&) const noexcept {
        return {Number(0), Number(0)};
    }
    Real strength_left(Real) const noexcept { return 1; }
};

static_assert(WearLaw<NoWear> && !AcceleratedWear<NoWear> && ContactObserver<WearObserver<NoWear>>);
static_assert(!WearLaw<NoParams>);

}  // namespace abrade
