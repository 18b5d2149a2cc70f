#pragma once
// What the textbook examples share: an output folder, a summary, and one clear message where something is
// wrong.

#include "charts.hpp"

#include <abrade/io/output_folder.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

namespace abrade::examples {

/// Figures of a summary in the order in which they were put in; units stand in their names.
using Summary = nlohmann::ordered_json;

/// n values from low to high, both included.
inline std::vector<Real> evenly(Real low, Real high, int n) {
    std::vector<Real> values;
    for (int i = 0; i < n; ++i) values.push_back(low + (high - low) * i / (n - 1));
    return values;
}

/// |value - expected| / |expected|.
inline Real relative_error(Real value, Real expected) {
    return std::abs(value - expected) / std::abs(expected);
}

/// y = intercept + slope x by least squares, and the largest distance of a point from that line over the
/// largest |y|. With logarithms of both, the slope is the order of an error.
struct StraightLine {
    Real intercept = 0, slope = 0, departure_relative = 0;
};
inline StraightLine straight_line(const std::vector<Real>& x, const std::vector<Real>& y) {
    const auto n = static_cast<Real>(x.size());
    Real mean_x = 0, mean_y = 0, xx = 0, xy = 0, largest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) mean_x += x[i] / n, mean_y += y[i] / n;
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += square(x[i] - mean_x), xy += (x[i] - mean_x) * (y[i] - mean_y);
        largest = std::max(largest, std::abs(y[i]));
    }
    StraightLine line{mean_y - xy / xx * mean_x, xy / xx, 0};
    for (std::size_t i = 0; i < x.size(); ++i)
        line.departure_relative =
            std::max(line.departure_relative, std::abs(y[i] - line.intercept - line.slope * x[i]) / largest);
    return line;
}

/// Slope of log y over log x: the order of an error y in a step x.
inline Real measured_order(std::vector<Real> x, std::vector<Real> y) {
    for (Real& value : x) value = std::log(value);
    for (Real& value : y) value = std::log(value);
    return straight_line(x, y).slope;
}

/// The main of a textbook example: `example(folder)` runs it, draws into the folder and returns its figures.
/// They are printed, and written to summary.json with wall time and versions. `--out` names the folder.
template <class Example>
int textbook_main(int argc, char** argv, const std::string& name, const std::string& title,
                  const Example& example) {
    std::string out = "out/" + name;
    CLI::App app(title);
    app.add_option("--out", out, "folder of the results")->capture_default_str();
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
        OutputFolder folder(out);
        const auto start = std::chrono::steady_clock::now();
        const Summary figures = example(folder);
        const std::chrono::duration<Real> wall = std::chrono::steady_clock::now() - start;
        Summary summary{{"title", title}};
        summary.update(figures);
        summary["wall_s"] = wall.count();
        summary["version"] = ABRADE_VERSION;
        summary["compiler"] = ABRADE_COMPILER;
        std::ofstream file(folder.path("summary.json"));
        file << summary.dump(2) << "\n";
        file.close();
        if (!file) throw FileError("cannot write summary.json");
        const auto place = folder.publish();

        std::cout << title << "\n";
        for (const auto& [key, value] : summary.items())
            if (value.is_number())
                std::cout << "  " << key << std::string(key.size() < 44 ? 44 - key.size() : 1, ' ')
                          << short_text(value.template get<Real>()) << "\n";
        std::cout << "results in " << place.string() << "\n";
        return 0;
    } catch (const InputError& error) {
        std::cerr << "error: " << error.what() << "\n";
        return 2;
    } catch (const std::exception& error) {
        std::cerr << "error: " << error.what() << "\n";
        return 1;
    }
}

}  // namespace abrade::examples
