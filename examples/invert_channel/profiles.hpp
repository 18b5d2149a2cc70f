#pragma once
// The worn bed as two lines, for programs that put many runs together: along the centre, and across.

#include "results.hpp"

#include <abrade/io/file_error.hpp>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <limits>
#include <vector>

namespace abrade::examples {

/// Abrasion depth across the channel per volume past the gauge [mm/m3]: the mean over the compared section.
/// Not a number before any sediment has passed.
inline std::vector<Real> cross_profile(const ChannelResults& r) {
    const Real per_m3 =
        r.converted_sediment_m3 > 0 ? 1e3 / r.converted_sediment_m3 : std::numeric_limits<Real>::quiet_NaN();
    std::vector<Real> profile;
    for (const Real depth : r.bed.across_depth_m) profile.push_back(depth * per_m3);
    return profile;
}

/// Writes profiles.json. A depth that is not a number (no sediment has passed the gauge) becomes null.
/// Throws FileError.
inline void write_profiles(const ChannelConfig& c, const ChannelResults& r,
                           const std::filesystem::path& path) {
    const nlohmann::ordered_json profiles{{"length_m", c.invert.length},
                                          {"width_m", c.invert.width},
                                          {"compared_from_m", c.comparison.from},
                                          {"compared_to_m", c.comparison.to},
                                          {"x_m", r.bed.x_m},
                                          {"centre_depth_mm_per_m3", r.bed.centre_depth_per_m3},
                                          {"y_m", r.bed.y_m},
                                          {"across_depth_mm_per_m3", cross_profile(r)},
                                          {"stones_across", r.stones_across}};
    std::ofstream file(path);
    file << profiles.dump() << "\n";
    if (!file.flush()) throw FileError("cannot write '" + path.string() + "'");
}

}  // namespace abrade::examples
