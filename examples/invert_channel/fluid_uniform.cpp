// Steady uniform flow and contacts that lose by a dent.

#include "uniform.hpp"

namespace abrade::examples {

ChannelRun run_in_uniform_flow(const ChannelConfig& config, const ChannelFiles& files) {
    return run_uniform<LinearHysteretic>(config, files);
}

}  // namespace abrade::examples
