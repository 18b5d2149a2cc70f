#pragma once
// The figures of an invert channel's summary.json that reports show, of one run and of many.

#include <abrade/core/types.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace abrade::examples {

/// A number that an ensemble is judged by.
struct Metric {
    std::string name;   ///< in summary.json
    std::string title;  ///< for a reader
    std::string unit{};
    Real factor = 1;           ///< from the unit of summary.json to this one
    bool logarithmic = false;  ///< where cases stand beside each other: they span powers of ten
};

/// Each summary.json has all of them. Speed over time and the share off the bed are of the compared section.
inline const std::array<Metric, 16> known_metrics{
    {{"centre_depth_mm_per_m3", "depth at the centre per converted sediment", "mm/m3"},
     {"worn_volume_m3", "worn volume", "cm3", 1e6},
     {"worn_band_width_m", "width of the worn band", "m"},
     {"max_depth_mm", "greatest depth", "mm"},
     {"energy_lost_sliding_J", "energy lost in sliding on concrete", "J"},
     {"energy_lost_normal_J", "energy lost in impacts on concrete", "J"},
     {"impact_share", "share of impacts in these losses"},
     {"bonds_broken", "bonds broken"},
     {"largest_collision_share", "largest share of a cell that one collision wore"},
     {"mean_stone_speed_m_per_s", "mean speed of the stones at the end", "m/s"},
     {"sampled_stone_speed_m_per_s", "speed of the stones, mean over time", "m/s"},
     {"stones_off_bed_share", "share of the stones off the bed"},
     {"sediment_passed_m3", "sediment past the gauge", "m3"},
     {"stones_fed", "stones fed"},
     {"ledger_residual_relative", "ledger residual, relative"},
     {"wall_s", "wall time of a run", "s", 1, true}}};

/// What a level of fluid costs, and what it changes: the table of a run, and of an ensemble over levels.
inline constexpr std::array<std::string_view, 6> fluid_metrics{"wall_s",
                                                               "centre_depth_mm_per_m3",
                                                               "energy_lost_normal_J",
                                                               "energy_lost_sliding_J",
                                                               "sampled_stone_speed_m_per_s",
                                                               "stones_off_bed_share"};

inline Metric metric_of(std::string_view name) {
    const auto found = std::find_if(known_metrics.begin(), known_metrics.end(),
                                    [&](const Metric& one) { return one.name == name; });
    return found == known_metrics.end() ? Metric{std::string(name), std::string(name)} : *found;
}

inline std::string with_unit(const Metric& m) {
    return m.unit.empty() ? m.title : m.title + " [" + m.unit + "]";
}

}  // namespace abrade::examples
