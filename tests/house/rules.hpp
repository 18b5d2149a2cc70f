#pragma once
// The rules of the house, read from the text of the headers. Each offence is one line: file:line: what.

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace house {

/// A room may include itself and the rooms before it.
inline constexpr std::array<std::string_view, 9> rooms{"core",  "geometry", "dem", "bond", "wear",
                                                       "fluid", "coupling", "sim", "io"};
inline constexpr int longest_header = 400;
/// All that dem/stepper.hpp, which every simulation includes, may take from odeint.
inline constexpr std::string_view odeint_tag = "boost/numeric/odeint/stepper/stepper_categories.hpp";

struct Header {
    struct Include {
        int line;
        std::string path;  ///< as written between <> or ""
        bool quoted;
    };
    std::string path;  ///< from the include folder: "abrade/dem/linear.hpp"
    std::string first_line;
    int lines = 0;
    std::vector<Include> includes;
};

/// Place of a header's room in the order; the root of the house stands after all rooms; -1: no such room.
inline int level(std::string_view path) {
    path.remove_prefix(std::string_view("abrade/").size());
    const std::size_t slash = path.find('/');
    if (slash == std::string_view::npos) return static_cast<int>(rooms.size());
    const auto room = std::find(rooms.begin(), rooms.end(), path.substr(0, slash));
    return room == rooms.end() ? -1 : static_cast<int>(room - rooms.begin());
}

inline Header read(const std::filesystem::path& file, std::string path) {
    static const std::regex include(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
    Header header{std::move(path), {}, 0, {}};
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (++header.lines == 1) header.first_line = line;
        std::smatch match;
        if (std::regex_search(line, match, include))
            header.includes.push_back({header.lines, match[2], match[1] == "\""});
    }
    return header;
}

/// All offences against the rules in the headers below `include_dir`/abrade, in order of path.
inline std::vector<std::string> offences(const std::filesystem::path& include_dir) {
    std::map<std::string, Header> headers;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(include_dir / "abrade")) {
        if (!entry.is_regular_file()) continue;
        const std::string path = entry.path().lexically_relative(include_dir).generic_string();
        headers.emplace(path, read(entry.path(), path));
    }

    std::vector<std::string> found;
    const auto offence = [&](const Header& header, int line, const std::string& what) {
        found.push_back(header.path + ":" + std::to_string(line) + ": " + what);
    };
    for (const auto& [path, header] : headers) {
        const int own_level = level(path);
        if (own_level < 0) offence(header, 1, "stands in no known room");
        if (own_level == static_cast<int>(rooms.size()) && path != "abrade/abrade.hpp")
            offence(header, 1, "only abrade.hpp stands outside the rooms");
        if (!path.ends_with(".hpp")) offence(header, 1, "is not a .hpp");
        if (header.first_line != "#pragma once") offence(header, 1, "must begin with #pragma once");
        if (header.lines > longest_header)
            offence(header, header.lines, "is longer than " + std::to_string(longest_header) + " lines");

        for (const auto& [line, target, quoted] : header.includes) {
            if (target.starts_with("abrade/")) {
                if (!headers.contains(target))
                    offence(header, line, "includes " + target + ", which does not exist");
                if (level(target) > own_level)
                    offence(header, line, "includes " + target + ", which is in a room below its own");
                if (target == "abrade/abrade.hpp") offence(header, line, "includes the whole house");
            } else if (quoted) {
                offence(header, line, "includes \"" + target + "\", must be <abrade/ROOM/HEADER.hpp>");
            }
            if (target == "Eigen/Dense" || target == "Eigen/Eigen")
                offence(header, line, "includes all of Eigen, must be the parts that it uses");
            if (target == "iostream")
                offence(header, line, "includes <iostream>, must be <ostream> or <iosfwd>");
            if (target == "boost/numeric/odeint.hpp") offence(header, line, "includes all of odeint");
            // One of its steppers takes as long to compile as a room of ours: only where a user asks for it.
            if (target.starts_with("boost/numeric/odeint/") && path != "abrade/dem/odeint_steppers.hpp" &&
                !(path == "abrade/dem/stepper.hpp" && target == odeint_tag))
                offence(header, line, "includes odeint, which only dem/odeint_steppers.hpp may");
            if (target == "abrade/dem/odeint_steppers.hpp")
                offence(header, line, "includes odeint's steppers, which only users may");
        }
    }

    // Cycles: the path from the root of the search back to a header that is still open.
    std::set<std::string> done;
    std::vector<std::string> open;
    const std::function<void(const std::string&)> visit = [&](const std::string& path) {
        const auto again = std::find(open.begin(), open.end(), path);
        if (again != open.end()) {
            std::string chain;
            for (auto step = again; step != open.end(); ++step) chain += *step + " -> ";
            found.push_back("cycle: " + chain + path);
            return;
        }
        if (!headers.contains(path) || done.contains(path)) return;
        open.push_back(path);
        for (const auto& include : headers.at(path).includes) visit(include.path);
        open.pop_back();
        done.insert(path);
    };
    for (const auto& [path, header] : headers) visit(path);
    return found;
}

}  // namespace house
