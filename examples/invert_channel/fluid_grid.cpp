// Water on a grid below a surface of any shape, by volume of fluid.

#include "fluid_grid.hpp"

namespace abrade::examples {

ChannelRun run_in_grid_water(const ChannelConfig& config, const ChannelFiles& files) {
    return run_below<FreeSurface>(config, files);
}

}  // namespace abrade::examples
