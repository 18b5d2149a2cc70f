#pragma once
// The slots of a simulation as one type.

#include <abrade/bond/bond_law.hpp>
#include <abrade/core/fields.hpp>
#include <abrade/coupling/drag/drag.hpp>
#include <abrade/sim/scene/force_on_bodies.hpp>
#include <abrade/wear/wear_law.hpp>

namespace abrade {

/// What acts on a body beside contacts, bonds and weight where the user gives a force of his own.
template <class OnBody>
struct WithForce : OnBody {
    BodyLoad given;
};
template <class OnBody>
Vec3 force_of(const WithForce<OnBody>& load) noexcept {
    return force_of(static_cast<const OnBody&>(load)) + load.given.force;
}

/// The four policies, the drag law that goes with the fluid, and the user's force on bodies.
template <ContactPolicy C, BondLaw B, WearLaw W, FluidModel F, DragLaw D, ForceOnBodies U = NoForceOnBodies>
struct Policies {
    static constexpr bool has_materials = !std::same_as<PairLaw<C>, C>;
    static constexpr bool has_bonds = !std::same_as<B, NoBond>;
    static constexpr bool has_wear = !std::same_as<W, NoWear>;
    static constexpr bool has_fluid = !std::same_as<F, NoFluid>;
    static constexpr bool fluid_advances = AdvancingFluid<F>;
    static constexpr bool fluid_resolves = ResolvedFluid<F>;
    static constexpr bool has_force = !std::same_as<U, NoForceOnBodies>;
    static constexpr bool looks_ahead = has_fluid || has_force;  ///< whether velocities are brought up to now
    using FromFluid =
        std::conditional_t<fluid_resolves, FlowLoad, FluidLoad>;  ///< what the fluid does to one
    using OnBody = std::conditional_t<has_force, WithForce<FromFluid>, FromFluid>;

    C contact;
    [[no_unique_address]] B bond;
    [[no_unique_address]] W wear;
    [[no_unique_address]] F fluid;
    [[no_unique_address]] D drag;
    [[no_unique_address]] U force{};

    /// Who looks at the contacts of concrete.
    auto observer() const noexcept {
        if constexpr (has_wear)
            return WearObserver<W>(wear);
        else
            return NoObserver{};
    }

    /// Laws are what they are; a fluid that goes on may have much to list.
    static void fields(auto&& field) {
        static_assert(ListsFields<F> || !AdvancingFluid<F>,
                      "a fluid that changes must list its fields to be saved");
        if constexpr (ListsFields<F>) field("fluid", &Policies::fluid);
    }
};

}  // namespace abrade
