#pragma once
// Who looks at contacts beside the law that answers them.

#include <abrade/dem/laws/contact_law.hpp>

namespace abrade {

/// Sees the contacts of spheres that are watched, once in each step, after the contact law has answered: a
/// pure function, whose answer is added up in `SphereLoad::observed` of each watched side. With a template on
/// the number type it sees a pack of contacts at once.
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
