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

/// Abrasion depth across the channel [mm per m3 of converted sediment]: the mean over the compared section,
/// at each column of the lattice. Not a number before any sediment has passed.
inline std::vector<Real> cross_profile(const ChannelConfig& c, const ChannelResults& r) {
    const Real per_m3 =
        r.converted_sediment_m3 > 0 ? 1e3 / r.converted_sediment_m3 : std::numeric_limits<Real>::quiet_NaN();
    std::vector<Real> profile;
    for (Index j = 0; j < r.across; ++j) {
        Real depth = 0;
        Index compared = 0;
        for (Index i = 0; i < r.along; ++i) {
            const Real x = r.x_m[static_cast<std::size_t>(i)];
            if (x < c.comparison.from || x > c.comparison.to) continue;
            depth += r.depth_m[static_cast<std::size_t>(i * r.across + j)], ++compared;
        }
        profile.push_back(compared > 0 ? depth / compared * per_m3 : 0);
    }
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
                                          {"x_m", r.x_m},
                                          {"centre_depth_mm_per_m3", r.centre_depth_per_m3},
                                          {"y_m", r.y_m},
                                          {"across_depth_mm_per_m3", cross_profile(c, r)}};
    std::ofstream file(path);
    file << profiles.dump() << "\n";
    if (!file.flush()) throw FileError("cannot write '" + path.string() + "'");
}

}  // namespace abrade::examples
