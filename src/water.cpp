// The usual grid water of abrade::compiled.

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

namespace abrade {

#define ABRADE_COMPILES(...) template class GridFluid<__VA_ARGS__>;
ABRADE_USUAL_WATER(ABRADE_COMPILES)
#undef ABRADE_COMPILES

}  // namespace abrade
