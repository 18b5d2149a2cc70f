#pragma once
// "Did you mean ...?"

#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abrade::examples {

/// Levenshtein's distance: how many letters to insert, delete or replace to make one text of the other.
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i);
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, replaced}));
        }
    }
    return row.back();
}

/// The known name closest to `name`; empty where none has more than half of its letters in common.
inline std::string nearest_name(std::string_view name, const auto& known) {
    std::string best;
    std::size_t least = std::string_view::npos;
    for (const std::string_view candidate : known) {
        const std::size_t distance = edit_distance(name, candidate);
        if (distance < least && distance <= std::max(name.size(), candidate.size()) / 2) {
            least = distance;
            best = candidate;
        }
    }
    return best;
}

}  // namespace abrade::examples
