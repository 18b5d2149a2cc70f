#pragma once
// Who looks at contacts beside the law that answers them.

#include <abrade/dem/laws/contact_law.hpp>

namespace abrade {

/// Sees the contacts of which a sphere is watched, once in each evaluation, after the contact law has
/// answered: a pure function. Its answer is added to `SphereLoad::observed` of both spheres; who reads that
/// asks which of them are watched, and clears it. The force is that of surfaces that touch, without a film's
/// between them. Pairs that do not touch may be shown, too: they have no force and no loss then, and the
/// answer must be 0. With a template on the number type an observer sees a pack of contacts at once.
// clang-format off
template <class O>
concept ContactObserver =
    requires(const O& o, const ContactKinematics<Real>& contact, const ContactLoad<Real>& load) {
    { o.observe(contact, load) } noexcept -> std::same_as<Real>;
};
// clang-format on

/// Nobody looks.
struct NoObserver {
    template <class Number>
    Number observe(const ContactKinematics<Number>&, const ContactLoad<Number>&) const noexcept {
        return Number(0);
    }
};
static_assert(ContactObserver<NoObserver>);

}  // namespace abrade
