// The usual simulations of bonded bodies, of abrade::compiled.

#include <abrade/sim/compiled.hpp>

namespace abrade {

#define ABRADE_COMPILES(...)                     \
    template class World<Policies<__VA_ARGS__>>; \
    template class Simulation<__VA_ARGS__>;
ABRADE_USUAL_BONDED(ABRADE_COMPILES)
#undef ABRADE_COMPILES

}  // namespace abrade
