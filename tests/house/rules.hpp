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

/// Folders within rooms, and which folders of the same room each may include beside itself; "fluid" itself
/// means the headers that stand in the room's own folder. Arrows between neighbours have their reason beside
/// them.
inline const std::map<std::string, std::vector<std::string>, std::less<>> inner_rooms{
    {"dem/laws", {}},
    {"dem/store", {}},
    {"dem/contacts", {"dem/laws", "dem/store"}},
    {"dem/time", {"dem/laws"}},  // a collision alone, for those who write laws
    {"fluid", {}},
    {"fluid/shallow_water", {"fluid"}},
    {"fluid/mesh", {"fluid"}},
    {"fluid/setup", {"fluid", "fluid/mesh"}},
    {"fluid/embedded_boundary", {"fluid/mesh"}},
    {"fluid/vof", {"fluid/mesh"}},
    // A height is a surface of the same marks and of planes in cells.
    {"fluid/height", {"fluid/mesh", "fluid/embedded_boundary", "fluid/vof"}},
    {"fluid/pressure", {"fluid", "fluid/mesh"}},
    // Eddies are as large as their distance from walls lets them be.
    {"fluid/momentum", {"fluid/mesh", "fluid/setup", "fluid/embedded_boundary"}},
    // The work of friction is what the kernel of momentum says of it.
    {"fluid/energy",
     {"fluid", "fluid/mesh", "fluid/setup", "fluid/embedded_boundary", "fluid/vof", "fluid/height",
      "fluid/momentum"}},
    {"fluid/navier_stokes",
     {"fluid", "fluid/mesh", "fluid/setup", "fluid/embedded_boundary", "fluid/vof", "fluid/height",
      "fluid/pressure", "fluid/momentum", "fluid/energy"}},
    {"fluid/queries", {"fluid/mesh", "fluid/setup", "fluid/embedded_boundary"}},
    {"coupling/drag", {}},
    {"coupling/mapping", {"coupling/drag"}},  // small bodies are spread over faces with the drag of many
    {"coupling/averaging", {"coupling/drag", "coupling/mapping"}},
    // Of the bodies in a flow the small ones are averaged.
    {"coupling/exchange", {"coupling/mapping", "coupling/averaging"}},
    {"sim/scene", {}},
    {"sim/state", {"sim/scene"}},
    {"sim/motion", {"sim/scene", "sim/state"}},
    {"sim/rest", {"sim/motion"}},
    {"sim/guards", {"sim/state", "sim/motion"}},
    {"sim/engine", {"sim/scene", "sim/state", "sim/motion", "sim/rest", "sim/guards"}},
    {"sim", {"sim/scene", "sim/guards", "sim/engine"}},
};
/// All that dem/time/stepper.hpp, which every simulation includes, may take from odeint.
inline constexpr std::string_view odeint_tag = "boost/numeric/odeint/stepper/stepper_categories.hpp";

struct Header {
    struct Include {
        int line;
        std::string path;  ///< as written between <> or ""
        bool quoted;
        bool of_bodies;  ///< of what this header declares: included unless abrade::compiled holds them
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

/// The folder of a header, without the first: "fluid/vof".
inline std::string folder(std::string_view path) {
    path.remove_prefix(std::string_view("abrade/").size());
    const std::size_t slash = path.rfind('/');
    return std::string(slash == std::string_view::npos ? "" : path.substr(0, slash));
}
inline std::string room(std::string_view folder) { return std::string(folder.substr(0, folder.find('/'))); }

inline Header read(const std::filesystem::path& file, std::string path) {
    static const std::regex include(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
    Header header{std::move(path), {}, 0, {}};
    std::ifstream in(file);
    bool of_bodies = false;
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("#ifndef ABRADE_COMPILED")) of_bodies = true;
        if (line.starts_with("#endif")) of_bodies = false;
        if (++header.lines == 1) header.first_line = line;
        std::smatch match;
        if (std::regex_search(line, match, include))
            header.includes.push_back({header.lines, match[2], match[1] == "\"", of_bodies});
    }
    return header;
}

inline std::map<std::string, Header> all_headers(const std::filesystem::path& include_dir) {
    std::map<std::string, Header> headers;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(include_dir / "abrade")) {
        if (!entry.is_regular_file()) continue;
        const std::string path = entry.path().lexically_relative(include_dir).generic_string();
        headers.emplace(path, read(entry.path(), path));
    }
    return headers;
}

/// What `inner_rooms` allows and no header below `include_dir`/abrade does: "fluid/vof -> fluid/mesh".
inline std::vector<std::string> needless_arrows(const std::filesystem::path& include_dir) {
    std::set<std::string> needless;
    for (const auto& [from, others] : inner_rooms)
        for (const std::string& to : others) needless.insert(from + " -> " + to);
    for (const auto& [path, header] : all_headers(include_dir))
        for (const auto& include : header.includes)
            if (include.path.starts_with("abrade/"))
                needless.erase(folder(path) + " -> " + folder(include.path));
    return {needless.begin(), needless.end()};
}

/// All offences against the rules in the headers below `include_dir`/abrade, in order of path.
inline std::vector<std::string> offences(const std::filesystem::path& include_dir) {
    const std::map<std::string, Header> headers = all_headers(include_dir);

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
        const std::string own_folder = folder(path);
        const auto inner = inner_rooms.find(own_folder);
        if (own_level >= 0 && own_folder.find('/') != std::string::npos && inner == inner_rooms.end())
            offence(header, 1, "stands in no known folder of its room");

        for (const auto& [line, target, quoted, of_bodies] : header.includes) {
            if (target.starts_with("abrade/")) {
                if (!headers.contains(target))
                    offence(header, line, "includes " + target + ", which does not exist");
                if (level(target) > own_level)
                    offence(header, line, "includes " + target + ", which is in a room below its own");
                const std::string other = folder(target);
                if (inner != inner_rooms.end() && other != own_folder && room(other) == room(own_folder) &&
                    std::find(inner->second.begin(), inner->second.end(), other) == inner->second.end())
                    offence(header, line, "includes " + target + ", which " + own_folder + " may not");
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
            if (target.starts_with("boost/numeric/odeint/") &&
                path != "abrade/dem/time/odeint_steppers.hpp" &&
                !(path == "abrade/dem/time/stepper.hpp" && target == odeint_tag))
                offence(header, line, "includes odeint, which only dem/time/odeint_steppers.hpp may");
            if (target == "abrade/dem/time/odeint_steppers.hpp")
                offence(header, line, "includes odeint's steppers, which only users may");
        }
    }

    // A header of bodies includes the one that declares them, which is no cycle.
    const auto holds_bodies_of = [&](const std::string& bodies, const std::string& declares) {
        const auto at = headers.find(declares);
        return at != headers.end() && std::any_of(at->second.includes.begin(), at->second.includes.end(),
                                                  [&](const Header::Include& include) {
                                                      return include.of_bodies && include.path == bodies;
                                                  });
    };

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
        for (const auto& include : headers.at(path).includes)
            if (!holds_bodies_of(path, include.path)) visit(include.path);
        open.pop_back();
        done.insert(path);
    };
    for (const auto& [path, header] : headers) visit(path);
    return found;
}

}  // namespace house
