// Water on a grid below a surface that is a height.

#include "fluid_grid.hpp"

namespace abrade::examples {

ChannelRun run_in_grid_water_below_height(const ChannelConfig& config, const ChannelFiles& files) {
    return run_below<HeightSurface>(config, files);
}

}  // namespace abrade::examples
