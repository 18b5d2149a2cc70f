#pragma once
// An ensemble as it lies in its folder: the plan, the log of GNU parallel, and what each run left.

#include "statistics.hpp"

#include "../common/metrics.hpp"

#include <abrade/core/require.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abrade::examples {

/// A depth line of one run, or of many.
struct DepthLine {
    std::vector<Real> place;  ///< x along or y across [m]
    std::vector<Real> depth;  ///< per converted sediment [mm/m3]
};

struct EnsembleRun {
    std::string seed;
    std::string folder;                ///< inside the ensemble's
    std::optional<int> code{};         ///< for the shell; none: the run is not done
    std::string error{};               ///< why it failed; empty where it did not
    std::map<std::string, Real> of{};  ///< metrics of summary.json; a missing number is not a number
    DepthLine along{}, across{};

    bool ok() const { return code && error.empty(); }
    bool failed() const { return code && !error.empty(); }
};

/// A TOML text without its quotes.
inline std::string unquoted(const std::string& value) {
    const bool quoted = value.size() > 1 && (value.front() == '"' || value.front() == '\'');
    return quoted ? value.substr(1, value.size() - 2) : value;
}

/// The part of a channel that its depth lines show.
struct Reach {
    Real length = 0, width = 0;               ///< of the channel [m]
    Real compared_from = 0, compared_to = 0;  ///< section of the centre line [m]
};

struct EnsembleCase {
    std::string name;                                            ///< of its folder
    std::vector<std::pair<std::string, std::string>> overrides;  ///< key, value
    std::vector<EnsembleRun> runs{};                             ///< [seed]
    Reach reach{};

    /// Of runs that are done and did not fail, one for each seed; else not a number.
    std::vector<Real> by_seed(const std::string& metric) const {
        std::vector<Real> values;
        for (const EnsembleRun& run : runs) {
            const auto found = run.of.find(metric);
            values.push_back(run.ok() && found != run.of.end() ? found->second : Statistics::unknown);
        }
        return values;
    }
    Statistics of(const std::string& metric) const { return statistics(by_seed(metric)); }

    /// The lines of all runs that are done, [run][place].
    std::vector<std::vector<Real>> depths(DepthLine EnsembleRun::*line) const {
        std::vector<std::vector<Real>> all;
        for (const EnsembleRun& run : runs)
            if (run.ok() && (all.empty() || (run.*line).depth.size() == all.front().size()))
                all.push_back((run.*line).depth);
        return all;
    }
    /// The places of these lines [m].
    std::vector<Real> places(DepthLine EnsembleRun::*line) const {
        for (const EnsembleRun& run : runs)
            if (run.ok()) return (run.*line).place;
        return {};
    }
    std::size_t count(bool (EnsembleRun::*is)() const) const {
        return static_cast<std::size_t>(
            std::count_if(runs.begin(), runs.end(), [&](const EnsembleRun& run) { return (run.*is)(); }));
    }
    /// "contact.friction = 0.3, wear.acceleration = 25", or "as in the file".
    std::string label() const {
        std::string text;
        for (const auto& [key, value] : overrides)
            text += (text.empty() ? "" : ", ") + key + " = " + unquoted(value);
        return text.empty() ? "as in the file" : text;
    }
};

struct Ensemble {
    std::string file, fluid, mode;
    std::vector<std::string> sets, seeds;
    std::vector<std::string> swept;    ///< keys
    std::vector<std::string> metrics;  ///< names, in the order of summary.json
    std::vector<EnsembleCase> cases;
    std::string title;

    bool one_at_a_time() const { return mode == "one at a time"; }
    bool compares_fluids() const {
        return std::ranges::any_of(
            swept, [](const std::string& key) { return key == "fluid.model" || key == "fluid.exchange"; });
    }
    std::size_t count(bool (EnsembleRun::*is)() const) const {
        std::size_t sum = 0;
        for (const EnsembleCase& one : cases) sum += one.count(is);
        return sum;
    }
    std::size_t runs() const { return cases.size() * seeds.size(); }
};

namespace ensemble_files {

inline std::vector<std::string> split(const std::string& line, char at = '\t') {
    std::vector<std::string> parts;
    std::istringstream in(line);
    for (std::string part; std::getline(in, part, at);) parts.push_back(part);
    return parts;
}

/// "key=value" as a pair.
inline std::pair<std::string, std::string> assignment(const std::string& text) {
    const std::size_t sign = std::min(text.find('='), text.size());
    return {text.substr(0, sign), sign < text.size() ? text.substr(sign + 1) : ""};
}

inline int to_int(std::string_view text) {
    int value = -1;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

/// The last line of a log that begins with "error: ", else its last line.
inline std::string last_error(const std::filesystem::path& log) {
    std::ifstream in(log);
    std::string last, error;
    for (std::string line; std::getline(in, line);) {
        if (line.empty()) continue;
        last = line;
        if (line.starts_with("error: ")) error = line.substr(7);
    }
    return !error.empty() ? error : !last.empty() ? last : "it left no log";
}

/// Numbers and what lies in tables as "table.name"; null is not a number.
inline void flatten(const nlohmann::ordered_json& json, const std::string& prefix, EnsembleRun& run,
                    std::vector<std::string>& names) {
    for (const auto& [key, value] : json.items()) {
        if (prefix + key == "level") continue;  // figures that stand by themselves as well
        if (value.is_object()) flatten(value, prefix + key + ".", run, names);
        if (!value.is_number() && !value.is_null()) continue;
        if (key == "seed" || key == "threads") continue;
        const std::string name = prefix + key;
        run.of[name] = value.is_number() ? value.get<Real>() : Statistics::unknown;
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
}

inline std::vector<Real> numbers(const nlohmann::ordered_json& json) {
    std::vector<Real> values;
    for (const auto& one : json) values.push_back(one.is_number() ? one.get<Real>() : Statistics::unknown);
    return values;
}

/// Throws InputError where a summary is not that of the run, or lacks a figure that the report shows.
inline void check_summary(const nlohmann::ordered_json& summary, const EnsembleRun& run,
                          const Ensemble& ensemble) {
    constexpr auto remedy = "delete the folder of this run, and the same command makes it again";
    const auto scene = [](const std::string& file, const std::string& seed) {
        return "of " + file + " under seed " + seed;
    };
    const std::string expected = scene(ensemble.file, run.seed),
                      got = scene(summary.value("configuration", "no file"),
                                  summary.contains("seed") ? summary["seed"].dump() : "none");
    if (got != expected) fail({"summary.json", expected, {}, remedy}, got);
    for (const Metric& one : known_metrics)
        if (const auto found = summary.find(one.name);
            found == summary.end() || !(found->is_number() || found->is_null()))
            fail({"summary.json: " + one.name,
                  "a number, or null where there was nothing to measure",
                  {},
                  remedy},
                 found == summary.end() ? "nothing" : found->dump());
}

/// What the run left: its figures and depth lines, or why there are none.
inline void read_run(const std::filesystem::path& folder, EnsembleRun& run, Reach& reach,
                     Ensemble& ensemble) {
    if (!std::filesystem::exists(folder)) {
        run.error = "no folder came back from its host";
        return;
    }
    if (*run.code != 0) {
        run.error = last_error(folder / "log.txt");
        return;
    }
    try {
        const auto parse = [&](const char* name) {
            std::ifstream in(folder / "results" / name);
            return nlohmann::ordered_json::parse(in);
        };
        const auto summary = parse("summary.json"), profiles = parse("profiles.json");
        check_summary(summary, run, ensemble);
        flatten(summary, "", run, ensemble.metrics);
        ensemble.title = summary.at("title").get<std::string>();
        run.along = {numbers(profiles.at("x_m")), numbers(profiles.at("centre_depth_mm_per_m3"))};
        run.across = {numbers(profiles.at("y_m")), numbers(profiles.at("across_depth_mm_per_m3"))};
        reach = {profiles.at("length_m").get<Real>(), profiles.at("width_m").get<Real>(),
                 profiles.at("compared_from_m").get<Real>(), profiles.at("compared_to_m").get<Real>()};
    } catch (const nlohmann::json::exception& error) {
        run.error = std::string("its results cannot be read: ") + error.what();
    } catch (const InputError& error) {
        run.error = error.what();
    }
}

}  // namespace ensemble_files

/// Reads the folder of examples/ensemble. Throws InputError where there is no plan.
inline Ensemble read_ensemble(const std::filesystem::path& folder) {
    namespace files = ensemble_files;
    std::ifstream plan(folder / "plan");
    if (!plan)
        fail({"folder", "one that examples/ensemble made", {}, "run examples/ensemble first"},
             "'" + folder.string() + "'");
    Ensemble e;
    for (std::string line; std::getline(plan, line);) {
        const std::vector<std::string> parts = files::split(line);
        if (parts.size() < 2) continue;
        const std::string &field = parts[0], &value = parts[1];
        if (field == "file") e.file = std::filesystem::path(value).filename().string();
        if (field == "fluid") e.fluid = value;
        if (field == "mode") e.mode = value;
        if (field == "set") e.sets.push_back(value);
        if (field == "sweep") e.swept.push_back(files::assignment(value).first);
        if (field == "seed") e.seeds.push_back(value);
        if (field == "case") {
            e.cases.push_back({value, {}});
            for (std::size_t i = 2; i < parts.size(); ++i)
                e.cases.back().overrides.push_back(files::assignment(parts[i]));
        }
    }
    // Runs are numbered seed by seed; the last line of a number counts.
    std::map<std::size_t, int> codes;
    std::ifstream log(folder / "jobs.log");
    for (std::string line; std::getline(log, line);) {
        const auto parts = files::split(line);
        if (parts.size() < 8 || parts[0] == "Seq") continue;
        const int code = files::to_int(parts[6]), signal = files::to_int(parts[7]);
        codes[static_cast<std::size_t>(files::to_int(parts[0]))] = signal > 0 ? 128 + signal : code;
    }
    for (std::size_t c = 0; c < e.cases.size(); ++c)
        for (std::size_t s = 0; s < e.seeds.size(); ++s) {
            EnsembleCase& one = e.cases[c];
            one.runs.push_back({e.seeds[s], "runs/" + one.name + "/seed_" + e.seeds[s]});
            EnsembleRun& run = one.runs.back();
            const auto found = codes.find(s * e.cases.size() + c + 1);
            if (found == codes.end() || found->second == 130) continue;  // ended by a signal, and not done
            run.code = found->second;
            files::read_run(folder / run.folder, run, one.reach, e);
        }
    return e;
}

}  // namespace abrade::examples
