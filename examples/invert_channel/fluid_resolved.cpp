// Water on a grid below a surface that is a height, which flows around the stones or through them, and feels
// them.

#include "fluid_grid.hpp"

#include <abrade/coupling/monolithic.hpp>

namespace abrade::examples {

ChannelRun run_in_resolved_water(const ChannelConfig& config, const ChannelFiles& files) {
    using Solids = MonolithicSolids<>;
    return run_below<HeightSurface>(
        config, files, Solids({.resolved_from = config.fluid.resolved_from, .drag = config.drag}));
}

}  // namespace abrade::examples
