#pragma once
// The comments of laws: formula, symbols, validity, what is thrown, source, in this order.

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace house {

/// Where laws and models of physics stand.
inline constexpr std::string_view law_places[] = {"dem/laws",
                                                  "bond",
                                                  "wear",
                                                  "coupling/drag",
                                                  "fluid/momentum/turbulence.hpp",
                                                  "fluid/momentum/advection_schemes.hpp",
                                                  "fluid/uniform_flow.hpp",
                                                  "fluid/shallow_water/shallow_water.hpp"};

/// What the comment above a law misses, the first thing; empty: nothing.
inline std::string missing_in(const std::vector<std::string>& comment) {
    std::size_t at = 0;
    for (const std::string_view part : {"///   ", "/// Validity:", "/// Throws ", "/// Source:"}) {
        while (at < comment.size() && !comment[at].starts_with(part)) ++at;
        if (at == comment.size()) return std::string(part.substr(4) == "  " ? "a formula" : part.substr(4));
    }
    return {};
}

/// Laws of a header, told by their `name`, whose comment misses a part: "NAME misses PART". Null policies
/// ("No...") and tables of laws have no formula.
inline std::vector<std::string> incomplete_laws(const std::filesystem::path& header) {
    std::vector<std::string> found, comment, of_class;
    std::ifstream in(header);
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("///")) {
            comment.push_back(line);
        } else {
            const bool heads_class = line.starts_with("template") || line.starts_with("requires");
            if (line.starts_with("class ") || line.starts_with("struct ") ||
                (heads_class && line.find(" class ") != std::string::npos))
                of_class = comment;
            if (!heads_class) comment.clear();
            constexpr std::string_view names = "    static constexpr std::string_view name = \"";
            if (!line.starts_with(names)) continue;
            const std::string name = line.substr(names.size(), line.rfind('"') - names.size());
            if (name.starts_with("No") || name == "MaterialPairs") continue;
            if (const std::string part = missing_in(of_class); !part.empty())
                found.push_back(name + " misses " + part);
        }
    }
    return found;
}

inline std::vector<std::string> incomplete_laws_below(const std::filesystem::path& include_dir) {
    std::vector<std::string> found;
    const auto look = [&](const std::filesystem::path& file) {
        for (const std::string& one : incomplete_laws(file)) found.push_back(one);
    };
    for (const std::string_view place : law_places) {
        const auto path = include_dir / "abrade" / place;
        if (is_directory(path))
            for (const auto& entry : std::filesystem::directory_iterator(path)) look(entry.path());
        else
            look(path);
    }
    return found;
}

}  // namespace house
