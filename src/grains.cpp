// The usual simulations of grains, of abrade::compiled.

#include <abrade/sim/compiled.hpp>

namespace abrade {

#define ABRADE_COMPILES(...)                     \
    template class World<Policies<__VA_ARGS__>>; \
    template class Simulation<__VA_ARGS__>;
ABRADE_USUAL_GRAINS(ABRADE_COMPILES)
#undef ABRADE_COMPILES

}  // namespace abrade
