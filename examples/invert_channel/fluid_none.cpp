// A dry channel: stones slide down it by their weight alone.

#include "run_channel.hpp"

namespace abrade::examples {

ChannelRun run_without_fluid(const ChannelConfig& config, const std::filesystem::path& stem) {
    return run_channel<LinearHysteretic>(config, stem, NoFluid{}, [](const NoFluid&, bool) {});
}

}  // namespace abrade::examples
