// Steady uniform flow and contacts that yield.

#include "uniform.hpp"

namespace abrade::examples {

ChannelRun run_in_uniform_flow_elastic_plastic(const ChannelConfig& config, const ChannelFiles& files) {
    return run_uniform<ElasticPlasticHertz>(config, files);
}

}  // namespace abrade::examples
