#pragma once
// The charts of an ensemble: depth lines of all seeds, a metric against what was swept, a tornado.

#include "ensemble.hpp"

#include "../common/charts.hpp"
#include "../common/metrics.hpp"
#include "../invert_channel/results.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace abrade::examples {

/// Depth along or across the channel with the physical bracket [mm/m3]. `half` columns to each side are
/// averaged first: single spheres are hit by chance.
struct DepthChart {
    std::string title;
    Axis place;
    DepthLine EnsembleRun::*line;
    std::size_t half = 0;
    Bracket bracket{};
    std::string bracket_title;
    Real from = 0, to = 0;  ///< of the bracket [m]
};
/// One case: each seed a thin line, their mean with a band of its standard error.
void draw(const DepthChart& chart, const EnsembleCase& one, const std::filesystem::path& picture);

/// The means of several cases.
void draw_means(const DepthChart& chart, const std::vector<const EnsembleCase*>& cases,
                const std::filesystem::path& picture);

/// Mean and standard error of a metric over the one number that was swept.
void draw_against_value(const Ensemble& e, const Metric& metric, const std::filesystem::path& picture);

/// A panel for each metric, in it a row for each case: each seed a point, their mean with its standard error.
void draw_cases(const Ensemble& e, const std::vector<Metric>& metrics, const std::filesystem::path& picture);

/// How far each value of each sweep moves the metric's mean from the base; the parameter that moves it most
/// on top.
void draw_tornado(const Ensemble& e, const Metric& metric, const std::filesystem::path& picture);

/// The one key that was swept, and all its values are numbers.
bool sweeps_one_number(const Ensemble& e);

}  // namespace abrade::examples
