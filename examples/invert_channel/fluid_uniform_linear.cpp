// Steady uniform flow and contacts that lose by a dashpot.

#include "uniform.hpp"

namespace abrade::examples {

ChannelRun run_in_uniform_flow_linear(const ChannelConfig& config, const ChannelFiles& files) {
    return run_uniform<LinearSpring>(config, files);
}

}  // namespace abrade::examples
