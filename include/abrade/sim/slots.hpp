#pragma once
// What stands in the slots of a simulation while they are empty, or filled by what cannot be used.

#include <abrade/coupling/drag/drag.hpp>
#include <abrade/sim/run_options.hpp>

#include <type_traits>

namespace abrade {

/// What goes with a fluid where nothing is said; one that resolves bodies knows its forces.
template <class F>
using UsualDrag = std::conditional_t<std::same_as<F, NoFluid> || ResolvedFluid<F>, NoDrag, CliftGauvin>;

/// Stands in the contact slot until `.contact(law)` fills it.
struct ContactLawIsMissing {};

namespace detail {

/// What a slot gives back when its law cannot be used: takes any further call, so that one error is printed.
struct AfterRejectedLaw {
    AfterRejectedLaw contact(auto&&...) { return {}; }
    AfterRejectedLaw bond(auto&&...) { return {}; }
    AfterRejectedLaw wear(auto&&...) { return {}; }
    AfterRejectedLaw fluid(auto&&...) { return {}; }
    AfterRejectedLaw force(auto&&...) { return {}; }
    void run(const RunOptions&, auto&&...) {}
    void build() {}
};

template <class L>
inline constexpr bool never = false;

template <class L>
AfterRejectedLaw no_slot_of_a_name() {
    static_assert(never<L>,
                  "fill the slots in one go, auto sim = simulate(scene).contact(law).bond(law), or "
                  "of what has a name: auto next = std::move(sim).contact(law)");
    return {};
}

}  // namespace detail

}  // namespace abrade
