// Steady uniform flow and contacts that lose by a dent.

#include "uniform.hpp"

namespace abrade::examples {

ChannelRun run_in_uniform_flow(const ChannelConfig& config, const std::filesystem::path& stem) {
    return run_uniform<LinearHysteretic>(config, stem);
}

}  // namespace abrade::examples
