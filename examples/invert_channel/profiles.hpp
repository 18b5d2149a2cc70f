#pragma once
// The worn bed as two lines, for programs that put many runs together: along the centre, and across.

#include "results.hpp"

#include <abrade/io/file_error.hpp>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

namespace abrade::examples {

/// Writes profiles.json. A depth that is not a number (no sediment has passed the gauge) becomes null.
/// Throws FileError.
inline void write_profiles(const ChannelConfig& c, const ChannelResults& r,
                           const std::filesystem::path& path) {
    nlohmann::ordered_json profiles{{"length_m", c.invert.length},
                                    {"width_m", c.invert.width},
                                    {"compared_from_m", c.comparison.from},
                                    {"compared_to_m", c.comparison.to},
                                    {"x_m", r.bed.x_m},
                                    {"centre_depth_mm_per_m3", r.bed.centre_depth_per_m3},
                                    {"y_m", r.bed.y_m},
                                    {"across_depth_mm_per_m3", r.bed.across_depth_per_m3},
                                    {"stones_across_sampled", r.stones_across},
                                    {"impacts_across_sampled", r.impacts_across},
                                    {"sliding_across_sampled", r.sliding_across}};
    for (const Milestone& one : r.milestones)
        profiles["milestones"].push_back({{"converted_m3", one.converted_m3},
                                          {"past_m", one.past_m},
                                          {"centre_depth_mm_per_m3", one.bed.centre_depth_per_m3},
                                          {"across_depth_mm_per_m3", one.bed.across_depth_per_m3}});
    std::ofstream file(path);
    file << profiles.dump() << "\n";
    if (!file.flush()) throw FileError("cannot write '" + path.string() + "'");
}

}  // namespace abrade::examples
