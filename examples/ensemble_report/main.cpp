// Means, standard errors and charts of many runs of the invert channel. examples/ensemble makes the runs and
// calls this at their end; alone it shows what there is so far.
//
//   examples/run ensemble_report [FOLDER] [--metric NAME]
//
// ensemble       the folder: the plan, the log of GNU parallel, what each run left
// statistics     mean, standard deviation, standard error
// ensemble_json  every figure, for programs
// drawings       the charts
// one_run        a run, as GNU parallel starts it

#include "drawings.hpp"
#include "ensemble.hpp"
#include "ensemble_json.hpp"

#include "../common/nearest_name.hpp"
#include "../common/report.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>

using namespace abrade;
using namespace abrade::examples;

namespace {

namespace fs = std::filesystem;

constexpr std::size_t metrics_beside = 4;  ///< columns of the table of cases
constexpr std::size_t most_means = 7;      ///< curves that one chart can tell apart
constexpr auto ledger_residual = "ledger_residual_relative";
constexpr Real closed_ledger = 1e-9;  ///< round-off of millions of steps is far below

/// The metric itself first, then those that stand beside it.
std::vector<Metric> shown_metrics(const Ensemble& e, const Metric& metric) {
    std::vector<Metric> shown{metric};
    const auto add = [&](const Metric& one) {
        if (one.name != metric.name) shown.push_back(one);
    };
    if (e.compares_fluids())
        for (const std::string_view name : fluid_metrics) add(metric_of(name));
    else
        for (std::size_t i = 0; shown.size() <= metrics_beside; ++i) add(known_metrics[i]);
    return shown;
}

/// "0.27 ± 0.04": the error with two digits, the mean to the same place.
std::string with_error(const Statistics& s, Real factor) {
    if (s.count == 0) return "none";
    const Real mean = factor * s.mean, error = factor * s.standard_error;
    if (!std::isfinite(error)) return short_number(mean) + " (one value)";
    if (error == 0) return short_number(mean) + " ± 0";
    const int place = 1 - static_cast<int>(std::floor(std::log10(error)));  // digits after the point
    if (place > 6 || place < -3) return short_number(mean) + " ± " + short_number(error, 2);
    std::array<char, 80> text{};
    std::snprintf(text.data(), text.size(), "%.*f ± %.*f", std::max(place, 0), mean, std::max(place, 0),
                  error);
    return text.data();
}

ReportTable table_of_one_case(const Ensemble& e) {
    ReportTable table{.title = "Figures",
                      .columns = {"quantity", "mean ± standard error", "standard deviation of a run", "least",
                                  "most", "runs"}};
    for (const Metric& m : known_metrics) {
        const Statistics s = e.cases.front().of(m.name);
        if (s.count == 0) continue;
        table.rows.push_back(
            {with_unit(m), with_error(s, m.factor),
             std::isfinite(s.standard_deviation) ? short_number(m.factor * s.standard_deviation, 2) : "",
             short_number(m.factor * s.min, 3), short_number(m.factor * s.max, 3), std::to_string(s.count)});
    }
    return table;
}

ReportTable table_of_cases(const Ensemble& e, const Metric& metric) {
    const std::vector<Metric> shown = shown_metrics(e, metric);
    ReportTable table{.title = "Mean ± standard error of each case", .columns = {"case", "runs"}};
    for (const Metric& m : shown) table.columns.push_back(with_unit(m));
    if (e.one_at_a_time())
        table.columns.insert(table.columns.begin() + 3, "the same less the base, seed by seed");
    for (const EnsembleCase& one : e.cases) {
        std::vector<std::string> row{one.label(), std::to_string(one.count(&EnsembleRun::ok)) + " of " +
                                                      std::to_string(one.runs.size())};
        for (const Metric& m : shown) {
            row.push_back(with_error(one.of(m.name), m.factor));
            if (&m == &shown.front() && e.one_at_a_time())
                row.push_back(&one == &e.cases.front()
                                  ? ""
                                  : with_error(statistics(less_first(e, one, m.name)), m.factor));
        }
        table.rows.push_back(row);
    }
    return table;
}

ReportTable table_of_failures(const Ensemble& e) {
    ReportTable table{.title = "Runs that failed",
                      .columns = {"case", "seed", "exit code", "error", "folder"},
                      .numbers = false};
    for (const EnsembleCase& one : e.cases)
        for (const EnsembleRun& run : one.runs)
            if (run.failed())
                table.rows.push_back(
                    {one.label(), run.seed, std::to_string(*run.code), run.error, run.folder});
    return table;
}

/// A chart of depth for these cases: along the centre line, or across. The bracket is for the mean width that
/// wears.
DepthChart depth_chart(const std::vector<const EnsembleCase*>& cases, bool along) {
    std::vector<Real> widths;
    Reach reach = cases.front()->reach;
    for (const EnsembleCase* one : cases) {
        for (const Real width : one->by_seed("worn_band_width_m")) widths.push_back(width);
        reach.length = std::max(reach.length, one->reach.length);
        reach.width = std::max(reach.width, one->reach.width);
    }
    const Real mean = statistics(widths).mean, worn = mean > 0 ? mean : 1;
    const Bracket bracket = Bracket{}.per_width(worn);
    const std::string on_width = ", " + short_number(worn, 2) + " m wide";
    if (along)
        return {
            .title = "Abrasion depth along the centre line",
            .place = {.label = "distance along the channel", .unit = "m", .min = 0.0, .max = reach.length},
            .line = &EnsembleRun::along,
            .half = std::max<std::size_t>(2, cases.front()->places(&EnsembleRun::along).size() / 200),
            .bracket = bracket,
            .bracket_title = "physical bracket" + on_width,
            .from = reach.compared_from,
            .to = reach.compared_to};
    return {.title = "Abrasion depth across the channel, mean of the compared section",
            .place = {.label = "across", .unit = "m", .min = -0.5 * reach.width, .max = 0.5 * reach.width},
            .line = &EnsembleRun::across,
            .half = 1,
            .bracket = bracket,
            .bracket_title = "physical bracket" + on_width,
            .from = -0.5 * worn,
            .to = 0.5 * worn};
}

void add_depth_charts(const Ensemble& e, const fs::path& charts_folder, Report& report) {
    std::vector<const EnsembleCase*> drawn;
    for (const EnsembleCase& one : e.cases)
        if (one.of("centre_depth_mm_per_m3").count > 0) drawn.push_back(&one);
    if (drawn.size() > 1 && drawn.size() <= most_means)
        for (const bool along : {true, false}) {
            const DepthChart chart = depth_chart(drawn, along);
            const fs::path picture = charts_folder / (along ? "centre_lines.png" : "across.png");
            draw_means(chart, drawn, picture);
            report.figures.push_back({picture, chart.title + ": the mean of each case."});
        }
    for (const EnsembleCase* one : drawn)
        for (const bool along : {true, false}) {
            const DepthChart chart = depth_chart({one}, along);
            const fs::path picture =
                charts_folder / ((along ? "centre_line_" : "across_") + one->name + ".png");
            draw(chart, *one, picture);
            report.figures.push_back(
                {picture, chart.title + (e.cases.size() == 1 ? "" : "; " + one->label()) +
                              ". Running mean of " + std::to_string(2 * chart.half + 1) + " columns, " +
                              std::to_string(one->depths(chart.line).size()) +
                              " seeds. The bracket is what physics allows on the width that wears."});
        }
}

void add_metric_chart(const Ensemble& e, const Metric& metric, const fs::path& charts_folder,
                      Report& report) {
    if (e.cases.size() == 1) return;
    if (e.one_at_a_time() && e.cases.front().of(metric.name).count > 0) {
        draw_tornado(e, metric, charts_folder / "tornado.png");
        report.figures.push_back(
            {charts_folder / "tornado.png",
             "How far each value, taken by itself, moves the mean from the base. A bar shorter "
             "than its error bar and the grey band tells of chance, not of the parameter."});
    } else if (sweeps_one_number(e)) {
        draw_against_value(e, metric, charts_folder / "metric.png");
        report.figures.push_back({charts_folder / "metric.png", "Against " + e.swept.front() + "."});
    } else if (e.compares_fluids()) {
        draw_cases(e, shown_metrics(e, metric), charts_folder / "metric.png");
        report.figures.push_back({charts_folder / "metric.png",
                                  "What each level of fluid changes, and the wall time that it costs."});
    } else {
        draw_cases(e, {metric}, charts_folder / "metric.png");
        report.figures.push_back({charts_folder / "metric.png", "All cases."});
    }
}

std::string explanation(const Ensemble& e) {
    std::string text = std::to_string(e.cases.size()) + (e.cases.size() == 1 ? " case" : " cases") + " of " +
                       e.file + " under " + std::to_string(e.seeds.size()) +
                       (e.seeds.size() == 1 ? " seed" : " seeds") + ": " + std::to_string(e.runs()) +
                       " runs.";
    if (!e.fluid.empty()) text += " Fluid: " + e.fluid + ".";
    for (const std::string& set : e.sets) text += (&set == &e.sets.front() ? " Set: " : ", ") + set;
    return text + (e.sets.empty() ? "" : ".") +
           " Stones meet as chance has it, and single runs scatter: read means with their standard errors, "
           "and take "
           "two for different where they are apart by more than twice the standard error of their "
           "difference.";
}

/// Whether every run closed its energy ledger.
std::string ledger_note(const Ensemble& e) {
    Real largest = 0;
    std::string where;
    for (const EnsembleCase& one : e.cases)
        for (const EnsembleRun& run : one.runs)
            if (run.ok() && !std::isnan(largest) && !(run.of.at(ledger_residual) <= largest))
                largest = run.of.at(ledger_residual), where = one.label() + ", seed " + run.seed;
    const std::string residual = "the largest relative residual is " + short_number(largest, 2) +
                                 (where.empty() ? "" : " (" + where + ")");
    return largest <= closed_ledger ? "The energy ledger closes in every run: " + residual + "."
                                    : "Warning: the energy ledger does not close: " + residual +
                                          ", more than round-off (" + short_number(closed_ledger) + ").";
}

int evaluate(const fs::path& folder, const std::string& wanted) {
    const Ensemble e = read_ensemble(folder);
    const std::size_t failed = e.count(&EnsembleRun::failed), ok = e.count(&EnsembleRun::ok);
    const std::size_t left = e.runs() - ok - failed;

    // Runs take hours: an unknown metric is told, and does not cost the report.
    const bool known =
        e.metrics.empty() || std::find(e.metrics.begin(), e.metrics.end(), wanted) != e.metrics.end();
    const Metric metric = metric_of(known ? wanted : known_metrics.front().name);

    write_ensemble_json(e, folder / "ensemble.json");
    Report report;
    report.title = (e.title.empty() ? e.file : e.title) + ": ensemble";
    report.explanation = explanation(e);
    if (failed > 0)
        report.notes.push_back(std::to_string(failed) + " of " + std::to_string(e.runs()) +
                               " runs failed. They are left out of every mean and chart, and listed below.");
    if (left > 0)
        report.notes.push_back(std::to_string(left) + " of " + std::to_string(e.runs()) +
                               " runs are not done yet.");
    if (ok > 0)
        report.tables.push_back(e.cases.size() == 1 ? table_of_one_case(e) : table_of_cases(e, metric));
    if (failed > 0) report.tables.push_back(table_of_failures(e));
    if (ok > 0) {
        const fs::path charts_folder = folder / "charts";
        fs::create_directories(charts_folder);
        add_metric_chart(e, metric, charts_folder, report);
        add_depth_charts(e, charts_folder, report);
    }
    if (ok > 0) report.notes.push_back(ledger_note(e));
    report.notes.push_back(
        "Each run has a report of its own, with all parameters, in runs/CASE/seed_N/results.");
    report.versions = build_versions();
    report.versions.push_back({"configuration", e.file, ""});
    write_report(report, folder / "report.html");

    for (const EnsembleCase& one : e.cases) {
        std::cout << one.name << ": " << one.count(&EnsembleRun::ok) << " of " << one.runs.size() << " runs, "
                  << metric.title << " " << with_error(one.of(metric.name), metric.factor)
                  << (metric.unit.empty() || one.of(metric.name).count == 0 ? "" : " " + metric.unit) << "\n";
    }
    for (const EnsembleCase& one : e.cases)
        for (const EnsembleRun& run : one.runs)
            if (run.failed())
                std::cerr << "failed: " << one.name << ", seed " << run.seed << ", exit code " << *run.code
                          << ": " << run.error << " (" << run.folder << ")\n";
    if (left > 0) std::cerr << "note: " << left << " of " << e.runs() << " runs are not done yet\n";
    std::cout << "means in " << folder.string() << ", start with report.html\n";
    if (!known)
        fail({"--metric",
              "a number of summary.json",
              {},
              "the report shows " + metric.name +
                  (nearest_name(wanted, e.metrics).empty()
                       ? ""
                       : "; did you mean " + nearest_name(wanted, e.metrics) + "?")},
             wanted);
    return failed > 0 ? 3 : 0;
}

}  // namespace

int main(int argc, char** argv) {
    fs::path folder = "out/ensemble";
    std::string metric = known_metrics.front().name;
    CLI::App app(
        "Means, standard errors and charts of many runs of the invert channel; examples/ensemble makes "
        "them.");
    app.add_option("folder", folder, "of examples/ensemble")->capture_default_str();
    app.add_option("--metric", metric, "of summary.json, for the charts")->capture_default_str();
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        std::cerr << "error: " << error.what() << "; see --help\n";
        return 2;
    }
    try {
        require_gnuplot();
        return evaluate(folder, metric);
    } catch (const InputError& error) {
        std::cerr << "error: " << error.what() << "\n";
        return 2;
    } catch (const std::exception& error) {
        std::cerr << "error: " << error.what() << "\n";
        return 1;
    }
}
