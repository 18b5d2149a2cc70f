// Water on a grid below a surface that is a height, which flows around the stones or through them, and feels
// them.

#include "chosen_exchange.hpp"
#include "fluid_grid.hpp"

namespace abrade::examples {

namespace {

ChosenExchange exchange_of(const ChannelConfig& c) {
    if (c.fluid.exchange == "mixture") return MixtureSolids{};
    if (c.fluid.exchange == "direct") return DirectForcing{};
    return MonolithicSolids<>({.resolved_from = c.fluid.resolved_from, .drag = c.drag});
}

}  // namespace

ChannelRun run_in_resolved_water(const ChannelConfig& config, const ChannelFiles& files) {
    return run_below<HeightSurface>(config, files, exchange_of(config));
}

}  // namespace abrade::examples
