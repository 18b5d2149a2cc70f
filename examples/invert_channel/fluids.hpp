#pragma once
// The fluids that a channel can be run with. One more is a file fluid_NAME.cpp and a line here.

#include "config.hpp"
#include "results.hpp"

#include <abrade/sim/snapshot.hpp>

#include <array>
#include <filesystem>

namespace abrade::examples {

/// How a run ended, and what is left of it.
struct ChannelRun {
    ChannelResults results{};
    std::string printed;     ///< what the simulation says of itself
    std::string went_wrong;  ///< empty: nothing
    int code = 0;            ///< for the shell
    Snapshot last_good{};    ///< where it went wrong
    /// Of the water then: name, unit and one number for each cell.
    struct WaterColumn {
        std::string name, unit;
        std::vector<Real> values;
    };
    std::vector<WaterColumn> last_water{};
    Real last_water_time = 0;  ///< [s]
};

/// Runs to the end, or until a user stops it; writes series at `stem`.
ChannelRun run_without_fluid(const ChannelConfig& config, const std::filesystem::path& stem);
ChannelRun run_in_uniform_flow(const ChannelConfig& config, const std::filesystem::path& stem);
ChannelRun run_in_shallow_water(const ChannelConfig& config, const std::filesystem::path& stem);
ChannelRun run_in_grid_water(const ChannelConfig& config, const std::filesystem::path& stem);

struct ChannelFluid {
    std::string_view name;  ///< in the TOML file
    ChannelRun (*run)(const ChannelConfig&, const std::filesystem::path&);
};
inline constexpr std::array<ChannelFluid, 4> channel_fluids{{{"none", run_without_fluid},
                                                             {"uniform", run_in_uniform_flow},
                                                             {"shallow", run_in_shallow_water},
                                                             {"grid", run_in_grid_water}}};

}  // namespace abrade::examples
