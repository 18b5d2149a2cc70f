// The usual simulations of abrade::compiled.

#include <abrade/sim/compiled.hpp>

namespace abrade {

#define ABRADE_COMPILES(...)                     \
    template class World<Policies<__VA_ARGS__>>; \
    template class Simulation<__VA_ARGS__>;
ABRADE_USUAL_SIMULATIONS(ABRADE_COMPILES)
#undef ABRADE_COMPILES

namespace detail {
template <int Lanes>
int CompiledAs<Lanes>::same() {
    return Lanes;
}
template struct CompiledAs<pack_lanes>;
}  // namespace detail

}  // namespace abrade
