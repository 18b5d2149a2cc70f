#pragma once
// The usual simulations of bodies that water flows around, and that water, which abrade::compiled has
// compiled. Without that library this declares nothing. Not part of sim/compiled.hpp, for it includes all of
// the water on a grid, which few programs need.

#include <abrade/core/compiled_as.hpp>
#include <abrade/coupling/exchange/monolithic.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/sim/simulation.hpp>

/// Calls one(surface) for each of them.
#define ABRADE_USUAL_IN_WATER(one) one(FullBox) one(FreeSurface) one(HeightSurface)

namespace abrade {

/// Water that resolves the bodies in it.
template <class Surface>
using WaterAmongBodies = GridFluid<3, Among<MonolithicSolids<>, Surface>>;

#ifdef ABRADE_COMPILED
#define ABRADE_IS_COMPILED(Surface)                                                                   \
    extern template class GridFluid<3, Among<MonolithicSolids<>, Surface>>;                           \
    extern template class World<                                                                      \
        Policies<LinearSpring, NoBond, NoWear, WaterAmongBodies<Surface>, NoDrag, NoForceOnBodies>>;  \
    extern template class Simulation<LinearSpring, NoBond, NoWear, WaterAmongBodies<Surface>, NoDrag, \
                                     NoForceOnBodies>;
ABRADE_USUAL_IN_WATER(ABRADE_IS_COMPILED)
#undef ABRADE_IS_COMPILED
#endif

}  // namespace abrade
