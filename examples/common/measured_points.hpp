#pragma once
// A user's own measured points, to be drawn beside a result.

#include <abrade/core/require.hpp>
#include <abrade/core/types.hpp>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace abrade::examples {

/// One measured point.
struct MeasuredPoint {
    Real x = 0;      ///< along the channel [m]
    Real depth = 0;  ///< abrasion depth per volume of sediment passed [mm/m3]
};

/// Reads a CSV file: one header line with two names, then "x [m], depth [mm/m3]" per line. Empty lines and
/// lines that begin with # are skipped. InputError names file, row and column.
inline std::vector<MeasuredPoint> read_measured_points(const std::filesystem::path& path) {
    std::ifstream file{path};
    std::error_code folder;
    if (!file || std::filesystem::is_directory(path, folder))
        fail({"measured points", "a CSV file that can be read", {}, "check its path"},
             "'" + path.string() + "'");
    const auto trimmed = [](std::string_view text) {
        const std::size_t from = text.find_first_not_of(" \t\r");
        return from == text.npos ? std::string_view{}
                                 : text.substr(from, text.find_last_not_of(" \t\r") - from + 1);
    };
    const auto parse = [](std::string_view text, Real& value) {
        if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        return error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
    };
    constexpr std::string_view leave_out = "a # in front leaves the row out";
    std::vector<MeasuredPoint> points;
    bool header = false;
    int row = 0;
    for (std::string whole; std::getline(file, whole);) {
        ++row;
        std::string_view line = trimmed(whole);
        if (row == 1 && line.starts_with("\xEF\xBB\xBF"))
            line.remove_prefix(3);  // what spreadsheets put in front
        if (line.empty() || line.front() == '#') continue;
        std::vector<std::string_view> cells;
        for (std::size_t from = 0; from <= line.size();) {
            const std::size_t end = std::min(line.find(',', from), line.size());
            cells.push_back(trimmed(line.substr(from, end - from)));
            from = end + 1;
        }
        const std::string place = path.string() + ", row " + std::to_string(row);
        if (cells.size() != 2)
            fail({place,
                  "two columns, x [m] and depth [mm/m3], separated by a comma",
                  {},
                  "decimals take a point; a # in front leaves a row out"},
                 "'" + std::string{line} + "'");
        MeasuredPoint point;
        if (!header) {
            header = true;
            Real number = 0;
            if (parse(cells[0], number) || parse(cells[1], number))
                fail({place, "a header line", {}, "put \"x_m,depth_mm_per_m3\" first"},
                     "'" + std::string{line} + "'");
            continue;
        }
        if (!parse(cells[0], point.x))
            fail({place + ", column 1 (x)", "a number in m", {}, leave_out},
                 "'" + std::string{cells[0]} + "'");
        if (!parse(cells[1], point.depth))
            fail({place + ", column 2 (depth)", "a number in mm/m3", {}, leave_out},
                 "'" + std::string{cells[1]} + "'");
        points.push_back(point);
    }
    if (points.empty())
        fail({path.string(),
              "given with at least one point below its header line",
              {},
              "write rows of x [m], depth [mm/m3] under \"x_m,depth_mm_per_m3\""},
             "none");
    return points;
}

}  // namespace abrade::examples
