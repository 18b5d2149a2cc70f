#pragma once
// The slots of a simulation: scene and laws, and what is said of a law that cannot be used.

#include <abrade/bond/bond_law.hpp>
#include <abrade/coupling/drag/drag.hpp>
#include <abrade/dem/laws/contact_law.hpp>
#include <abrade/dem/laws/material_pairs.hpp>
#include <abrade/fluid/fluid_model.hpp>
#include <abrade/sim/run_options.hpp>
#include <abrade/sim/scene/policies.hpp>
#include <abrade/sim/scene/scene.hpp>

#include <stdexcept>
#include <type_traits>
#include <utility>

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

template <class C = ContactLawIsMissing, BondLaw B = NoBond, WearLaw W = NoWear, FluidModel F = NoFluid,
          DragLaw D = NoDrag, ForceOnBodies U = NoForceOnBodies>
class Simulation;

/// A scene and its laws. Each slot gives back a simulation of another type with its slot filled, and throws
/// std::logic_error once the simulation has run.
template <class C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U>
class Slots {
public:
    // Not `force`: g++ warns where a function by its address hides the member of that name.
    Slots(Scene scene, C contact, B bond, W wear, F fluid, D drag, U on_bodies)
        : scene_(std::move(scene)), contact_(std::move(contact)), bond_(std::move(bond)),
          wear_(std::move(wear)), fluid_(std::move(fluid)), drag_(std::move(drag)),
          force_(std::move(on_bodies)) {}

    template <class L, class One = PairLaw<L>>
    auto contact(L law) && {
        check_not_run();
        if constexpr (ParamSet<L>)
            static_assert(detail::never<L>,
                          "contact(law): these are a law's parameters; write contact(Law{...})");
        else
            static_assert(ContactLaw<One>,
                          "Simulation::contact(law): the law misses what the notes below name");
        if constexpr (ContactPolicy<L>)
            return Simulation<L, B, W, F, D, U>{std::move(scene_), std::move(law),    std::move(bond_),
                                                std::move(wear_),  std::move(fluid_), std::move(drag_),
                                                std::move(force_)};
        else
            return detail::AfterRejectedLaw{};
    }
    template <class L>
    auto bond(L law) && {
        check_not_run();
        if constexpr (ParamSet<L>)
            static_assert(detail::never<L>, "bond(law): these are a law's parameters; write bond(Law{...})");
        else
            static_assert(BondLaw<L>, "Simulation::bond(law): the law misses what the notes below name");
        if constexpr (BondLaw<L>)
            return Simulation<C, L, W, F, D, U>{std::move(scene_), std::move(contact_), std::move(law),
                                                std::move(wear_),  std::move(fluid_),   std::move(drag_),
                                                std::move(force_)};
        else
            return detail::AfterRejectedLaw{};
    }
    template <class L>
    auto wear(L law) && {
        check_not_run();
        if constexpr (ParamSet<L>)
            static_assert(detail::never<L>, "wear(law): these are a law's parameters; write wear(Law{...})");
        else
            static_assert(WearLaw<L>, "Simulation::wear(law): the law misses what the notes below name");
        if constexpr (WearLaw<L>)
            return Simulation<C, B, L, F, D, U>{std::move(scene_), std::move(contact_), std::move(bond_),
                                                std::move(law),    std::move(fluid_),   std::move(drag_),
                                                std::move(force_)};
        else
            return detail::AfterRejectedLaw{};
    }
    template <class L, class Drag = UsualDrag<L>>
    auto fluid(L law, Drag drag = Drag{}) && {
        check_not_run();
        static_assert(FluidModel<L>, "Simulation::fluid(law): the fluid misses what the notes below name");
        static_assert(!advances_in_time<L> || AdvancingFluid<L>,
                      "fluid(law): advance() needs a stable_step()");
        static_assert(DragLaw<Drag>,
                      "Simulation::fluid(law, drag): the drag law misses what the notes below name");
        if constexpr (FluidModel<L> && DragLaw<Drag>)
            return Simulation<C, B, W, L, Drag, U>{std::move(scene_), std::move(contact_), std::move(bond_),
                                                   std::move(wear_),  std::move(law),      std::move(drag),
                                                   std::move(force_)};
        else
            return detail::AfterRejectedLaw{};
    }
    /// A force on each body that moves, beside all others: see ForceOnBodies. Its work is
    /// `Ledger::force_work`. Bodies under it take each step: none flies freely or sleeps.
    template <class L>
    auto force(L law) && {
        check_not_run();
        static_assert(ForceOnBodies<L>,
                      "Simulation::force(law): needs law(const BodyView&, Real t) const "
                      "noexcept, which gives a BodyLoad or a Vec3 [N]");
        if constexpr (ForceOnBodies<L>)
            return Simulation<C, B, W, F, D, L>{std::move(scene_), std::move(contact_), std::move(bond_),
                                                std::move(wear_),  std::move(fluid_),   std::move(drag_),
                                                std::move(law)};
        else
            return detail::AfterRejectedLaw{};
    }

    // A filled slot makes a simulation of another type, so none is filled of one that has a name.
    template <class L>
    auto contact(L&&) & {
        return detail::no_slot_of_a_name<L>();
    }
    template <class L>
    auto bond(L&&) & {
        return detail::no_slot_of_a_name<L>();
    }
    template <class L>
    auto wear(L&&) & {
        return detail::no_slot_of_a_name<L>();
    }
    template <class L>
    auto fluid(L&&, auto&&...) & {
        return detail::no_slot_of_a_name<L>();
    }
    template <class L>
    auto force(L&&) & {
        return detail::no_slot_of_a_name<L>();
    }

    const C& contact_law() const noexcept { return contact_; }
    const B& bond_law() const noexcept { return bond_; }
    const W& wear_law() const noexcept { return wear_; }
    const D& drag_law() const noexcept { return drag_; }

protected:
    Scene scene_;
    [[no_unique_address]] C contact_;
    [[no_unique_address]] B bond_;
    [[no_unique_address]] W wear_;
    [[no_unique_address]] F fluid_;
    [[no_unique_address]] D drag_;
    [[no_unique_address]] U force_;
    bool in_use_ = false;  ///< a world has been made of them

private:
    void check_not_run() const {
        if (in_use_) throw std::logic_error("Simulation: fill the slots before the first run");
    }
};

}  // namespace abrade
