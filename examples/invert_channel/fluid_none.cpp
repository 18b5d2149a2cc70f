// A dry channel: stones slide down it by their weight alone.

#include "run_channel.hpp"

namespace abrade::examples {

ChannelRun run_without_fluid(const ChannelConfig& config, const ChannelFiles& files) {
    ChannelWater none;
    return run_channel<LinearHysteretic>(config, files, NoFluid{}, none, [](const NoFluid&, bool) {});
}

}  // namespace abrade::examples
