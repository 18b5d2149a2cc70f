#pragma once
// The engines that a channel can be run with, by fluid and contact law. One more is a file fluid_NAME.cpp and
// a line here.

#include "config.hpp"
#include "interruption.hpp"
#include "results.hpp"

#include <abrade/sim/snapshot.hpp>

#include <array>
#include <filesystem>

namespace abrade::examples {

/// How a run ended, and what is left of it.
struct ChannelRun {
    ChannelResults results{};
    std::string printed;           ///< what the simulation says of itself
    std::string went_wrong;        ///< empty: nothing
    int code = 0;                  ///< for the shell
    bool owns_checkpoint = false;  ///< it is of this run
    std::filesystem::path left{};  ///< folder of a killed run, of no use once results are in place; or none
    Snapshot last_good{};          ///< where it went wrong
    /// Of the water then: name, unit and one number for each cell.
    struct WaterColumn {
        std::string name, unit;
        std::vector<Real> values;
    };
    std::vector<WaterColumn> last_water{};
    Real last_water_time = 0;  ///< [s]
};

/// Runs to the end, or until a user stops it.
ChannelRun run_without_fluid(const ChannelConfig& config, const ChannelFiles& files);
ChannelRun run_in_uniform_flow(const ChannelConfig& config, const ChannelFiles& files);
ChannelRun run_in_uniform_flow_linear(const ChannelConfig& config, const ChannelFiles& files);
ChannelRun run_in_uniform_flow_elastic_plastic(const ChannelConfig& config, const ChannelFiles& files);
ChannelRun run_in_shallow_water(const ChannelConfig& config, const ChannelFiles& files);
ChannelRun run_in_grid_water(const ChannelConfig& config, const ChannelFiles& files);
ChannelRun run_in_grid_water_below_height(const ChannelConfig& config, const ChannelFiles& files);
ChannelRun run_in_resolved_water(const ChannelConfig& config, const ChannelFiles& files);

struct ChannelEngine {
    std::string_view fluid, contact;  ///< in the TOML file
    ChannelRun (*run)(const ChannelConfig&, const ChannelFiles&);
    std::string_view surface = "";  ///< of a grid's water
};
inline constexpr std::array<ChannelEngine, 9> channel_engines{
    {{"none", "hysteretic", run_without_fluid},
     {"uniform", "hysteretic", run_in_uniform_flow},
     {"uniform", "linear", run_in_uniform_flow_linear},
     {"uniform", "elastic_plastic", run_in_uniform_flow_elastic_plastic},
     {"shallow", "hysteretic", run_in_shallow_water},
     {"grid", "hysteretic", run_in_grid_water, "volume"},
     {"grid", "hysteretic", run_in_grid_water_below_height, "height"},
     {"unresolved", "hysteretic", run_in_resolved_water, "height"},
     {"resolved", "hysteretic", run_in_resolved_water, "height"}}};

/// Throws InputError where none was compiled for these; the surface counts where a fluid has one.
inline const ChannelEngine& find_engine(std::string_view fluid, std::string_view contact,
                                        std::string_view surface) {
    std::string all, last;
    for (const ChannelEngine& one : channel_engines) {
        if (one.fluid == fluid && one.contact == contact && (one.surface.empty() || one.surface == surface))
            return one;
        const std::string pair = std::string(one.fluid) + " with " + std::string(one.contact);
        if (pair != last) all += (all.empty() ? "" : ", ") + pair;  // surfaces of one stand together
        last = pair;
    }
    fail({"fluid.model with contact.law", "a pair that an engine was compiled for: " + all, "",
          "take one of these, or add a line to channel_engines"},
         std::string(fluid) + " with " + std::string(contact));
}

}  // namespace abrade::examples
