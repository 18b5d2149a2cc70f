#pragma once
// The four slots of a simulation as one type.

#include <abrade/bond/bond_law.hpp>
#include <abrade/core/fields.hpp>
#include <abrade/coupling/drag/drag.hpp>
#include <abrade/wear/wear_law.hpp>

namespace abrade {

/// The four policies, and the drag law that goes with the fluid.
template <ContactPolicy C, BondLaw B, WearLaw W, FluidModel F, DragLaw D>
struct Policies {
    static constexpr bool has_materials = !std::same_as<PairLaw<C>, C>;
    static constexpr bool has_bonds = !std::same_as<B, NoBond>;
    static constexpr bool has_wear = !std::same_as<W, NoWear>;
    static constexpr bool has_fluid = !std::same_as<F, NoFluid>;
    static constexpr bool fluid_advances = AdvancingFluid<F>;
    static constexpr bool fluid_resolves = ResolvedFluid<F>;
    using OnBody = std::conditional_t<fluid_resolves, FlowLoad, FluidLoad>;  ///< what the fluid does to one

    C contact;
    [[no_unique_address]] B bond;
    [[no_unique_address]] W wear;
    [[no_unique_address]] F fluid;
    [[no_unique_address]] D drag;

    /// Laws are what they are; a fluid that goes on may have much to list.
    static void fields(auto&& field) {
        static_assert(ListsFields<F> || !AdvancingFluid<F>,
                      "a fluid that changes must list its fields to be saved");
        if constexpr (ListsFields<F>) field("fluid", &Policies::fluid);
    }
};

}  // namespace abrade
