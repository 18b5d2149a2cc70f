#pragma once
// What many runs of one number came to.

#include <abrade/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace abrade::examples {

/// Of n independent values x_i that are finite:
/// - mean m = sum x_i / n
/// - standard deviation s = sqrt(sum (x_i - m)^2 / (n - 1)), of one run
/// - standard error s / sqrt(n), of the mean
/// A quantity that n does not allow (s of a single value) is not a number.
struct Statistics {
    static constexpr Real unknown = std::numeric_limits<Real>::quiet_NaN();
    std::size_t count = 0;
    Real mean = unknown, standard_deviation = unknown, standard_error = unknown, min = unknown, max = unknown;
};

inline Statistics statistics(std::span<const Real> values) {
    Statistics s;
    Real sum = 0;
    for (const Real x : values) {
        if (!std::isfinite(x)) continue;
        s.min = s.count == 0 ? x : std::min(s.min, x);
        s.max = s.count == 0 ? x : std::max(s.max, x);
        sum += x, ++s.count;
    }
    if (s.count == 0) return s;
    const Real n = static_cast<Real>(s.count);
    s.mean = sum / n;
    if (s.count == 1) return s;
    Real squares = 0;
    for (const Real x : values)
        if (std::isfinite(x)) squares += (x - s.mean) * (x - s.mean);
    s.standard_deviation = std::sqrt(squares / (n - 1));
    s.standard_error = s.standard_deviation / std::sqrt(n);
    return s;
}

/// One `Statistics` for each place on lines of equal length: `lines` are [run][place].
inline std::vector<Statistics> statistics_along(const std::vector<std::vector<Real>>& lines) {
    std::vector<Statistics> along;
    for (std::size_t i = 0; !lines.empty() && i < lines.front().size(); ++i) {
        std::vector<Real> here;
        for (const auto& line : lines) here.push_back(line.at(i));
        along.push_back(statistics(here));
    }
    return along;
}

}  // namespace abrade::examples
