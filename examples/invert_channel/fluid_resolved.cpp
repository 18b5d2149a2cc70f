// Water on a grid below a surface that is a height, which flows around the stones and feels them.

#include "fluid_grid.hpp"

#include <abrade/coupling/monolithic.hpp>

namespace abrade::examples {

ChannelRun run_in_resolved_water(const ChannelConfig& config, const ChannelFiles& files) {
    return run_below<HeightSurface, MonolithicSolids<>>(config, files);
}

}  // namespace abrade::examples
