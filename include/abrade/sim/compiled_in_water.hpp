#pragma once
// The usual simulations of bodies that water flows around, and that water, which abrade::compiled has
// compiled: as sim/compiled.hpp.

#include <abrade/core/compiled_as.hpp>
#include <abrade/coupling/exchange/monolithic.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/sim/simulation.hpp>

namespace abrade::detail {

template <class Surface>
using WaterAmongBodies = GridFluid<3, Among<MonolithicSolids<>, Surface>>;

}  // namespace abrade::detail

// clang-format off
/// Calls one(dimensions, options) for each of these waters.
#define ABRADE_USUAL_WATER_AMONG_BODIES(one) \
    one(3, Among<MonolithicSolids<>, FullBox>) \
    one(3, Among<MonolithicSolids<>, FreeSurface>) \
    one(3, Among<MonolithicSolids<>, HeightSurface>)
/// Calls one(contact, bond, wear, fluid, drag, force) for each of these simulations.
#define ABRADE_USUAL_IN_WATER(one) \
    one(LinearSpring, NoBond, NoWear, detail::WaterAmongBodies<FullBox>, NoDrag, NoForceOnBodies) \
    one(LinearSpring, NoBond, NoWear, detail::WaterAmongBodies<FreeSurface>, NoDrag, NoForceOnBodies) \
    one(LinearSpring, NoBond, NoWear, detail::WaterAmongBodies<HeightSurface>, NoDrag, NoForceOnBodies)
// clang-format on

#ifdef ABRADE_COMPILED
namespace abrade {

#define ABRADE_IS_COMPILED(...) extern template class GridFluid<__VA_ARGS__>;
ABRADE_USUAL_WATER_AMONG_BODIES(ABRADE_IS_COMPILED)
#undef ABRADE_IS_COMPILED
#define ABRADE_IS_COMPILED(...)                         \
    extern template class World<Policies<__VA_ARGS__>>; \
    extern template class Simulation<__VA_ARGS__>;
ABRADE_USUAL_IN_WATER(ABRADE_IS_COMPILED)
#undef ABRADE_IS_COMPILED

}  // namespace abrade
#endif
