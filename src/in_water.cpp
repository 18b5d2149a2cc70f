// The usual simulations of bodies that water flows around, and that water, of abrade::compiled.

#include <abrade/sim/compiled_in_water.hpp>

namespace abrade {

#define ABRADE_COMPILES(...) template class GridFluid<__VA_ARGS__>;
ABRADE_USUAL_WATER_AMONG_BODIES(ABRADE_COMPILES)
#undef ABRADE_COMPILES
#define ABRADE_COMPILES(...)                     \
    template class World<Policies<__VA_ARGS__>>; \
    template class Simulation<__VA_ARGS__>;
ABRADE_USUAL_IN_WATER(ABRADE_COMPILES)
#undef ABRADE_COMPILES

}  // namespace abrade
