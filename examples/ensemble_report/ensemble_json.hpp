#pragma once
// ensemble.json: every figure of an ensemble, for programs.

#include "ensemble.hpp"

#include <abrade/io/file_error.hpp>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace abrade::examples {

/// Seed by seed, a case less the first one. What two runs of one seed share (their stones) cancels out.
inline std::vector<Real> less_first(const Ensemble& e, const EnsembleCase& one, const std::string& metric) {
    std::vector<Real> values = one.by_seed(metric), first = e.cases.front().by_seed(metric);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] -= first[i];
    return values;
}

namespace ensemble_files {

inline nlohmann::ordered_json to_json(const Statistics& s) {
    return {{"count", s.count},
            {"mean", s.mean},
            {"standard_error", s.standard_error},
            {"standard_deviation", s.standard_deviation},
            {"min", s.min},
            {"max", s.max}};
}

inline nlohmann::ordered_json to_json(const EnsembleCase& one, DepthLine EnsembleRun::*line) {
    std::vector<Real> mean, error;
    for (const Statistics& s : statistics_along(one.depths(line)))
        mean.push_back(s.mean), error.push_back(s.standard_error);
    return {{"place_m", one.places(line)}, {"mean", mean}, {"standard_error", error}};
}

inline nlohmann::ordered_json to_json(const Ensemble& e, const EnsembleCase& one) {
    nlohmann::ordered_json json{{"name", one.name}, {"overrides", nlohmann::ordered_json::object()}};
    for (const auto& [key, value] : one.overrides) json["overrides"][key] = value;
    json["seeds"] = e.seeds;
    json["ok"] = one.count(&EnsembleRun::ok), json["failed"] = one.count(&EnsembleRun::failed);
    nlohmann::ordered_json metrics = nlohmann::ordered_json::object();
    for (const std::string& metric : e.metrics) {
        nlohmann::ordered_json of_metric = to_json(one.of(metric));
        const std::vector<Real> values = one.by_seed(metric);
        for (std::size_t i = 0; i < values.size(); ++i) of_metric["by_seed"][e.seeds[i]] = values[i];
        if (e.one_at_a_time() && &one != &e.cases.front())
            of_metric["less_base"] = to_json(statistics(less_first(e, one, metric)));
        metrics[metric] = of_metric;
    }
    json["metrics"] = metrics;
    json["compared_from_m"] = one.reach.compared_from, json["compared_to_m"] = one.reach.compared_to;
    json["profiles"] = {{"centre_depth_mm_per_m3", to_json(one, &EnsembleRun::along)},
                        {"across_depth_mm_per_m3", to_json(one, &EnsembleRun::across)}};
    return json;
}

}  // namespace ensemble_files

/// Writes ensemble.json. What is not a number becomes null. Throws FileError.
inline void write_ensemble_json(const Ensemble& e, const std::filesystem::path& path) {
    nlohmann::ordered_json json{{"title", e.title},
                                {"configuration", e.file},
                                {"fluid", e.fluid.empty() ? "as in the file" : e.fluid},
                                {"set", e.sets},
                                {"swept", e.swept},
                                {"one_at_a_time", e.one_at_a_time()},
                                {"runs", e.runs()},
                                {"ok", e.count(&EnsembleRun::ok)},
                                {"failed", e.count(&EnsembleRun::failed)}};
    json["cases"] = nlohmann::ordered_json::array();
    json["failed_runs"] = nlohmann::ordered_json::array();
    for (const EnsembleCase& one : e.cases) {
        json["cases"].push_back(ensemble_files::to_json(e, one));
        for (const EnsembleRun& run : one.runs)
            if (run.failed())
                json["failed_runs"].push_back({{"case", one.name},
                                               {"seed", run.seed},
                                               {"exit_code", *run.code},
                                               {"error", run.error},
                                               {"folder", run.folder}});
    }
    std::ofstream file(path);
    file << json.dump(1) << "\n";
    if (!file.flush()) throw FileError("cannot write '" + path.string() + "'");
}

}  // namespace abrade::examples
