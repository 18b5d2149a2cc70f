// The usual simulations of bodies that water flows around, and that water, of abrade::compiled.

#include <abrade/sim/compiled_in_water.hpp>

namespace abrade {

#define ABRADE_COMPILES(Surface)                                                                     \
    template class GridFluid<3, Among<MonolithicSolids<>, Surface>>;                                 \
    template class World<                                                                            \
        Policies<LinearSpring, NoBond, NoWear, WaterAmongBodies<Surface>, NoDrag, NoForceOnBodies>>; \
    template class Simulation<LinearSpring, NoBond, NoWear, WaterAmongBodies<Surface>, NoDrag,       \
                              NoForceOnBodies>;
ABRADE_USUAL_IN_WATER(ABRADE_COMPILES)
#undef ABRADE_COMPILES

}  // namespace abrade
