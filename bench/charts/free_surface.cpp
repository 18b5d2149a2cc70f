// Draws the pictures of docs/verification/free_surface.md: chart_free_surface [FOLDER], which is made where
// it is not. Takes less than a minute.

#include "../../examples/common/charts.hpp"
#include "../../tests/verification/dam_impact.hpp"
#include "../../tests/verification/waves.hpp"

#include <iostream>

using namespace abrade;
using namespace abrade::examples;

namespace {

namespace fs = std::filesystem;

struct ImpactChart {
    dam_impact::Tank tank;
    std::string title, measured, file;
    Real most = 0;  ///< [rho g H]
};

void draw_impact(const ImpactChart& what, const fs::path& folder) {
    constexpr int cells = 40;
    LineChart chart{.title = what.title + ", " + std::to_string(cells) + " cells to the column's height",
                    .x = {.label = "t sqrt(g/H)", .unit = "", .min = 2.0, .max = dam_impact::last_time},
                    .y = {.label = "p / (rho g H)", .unit = "", .min = 0.0, .max = what.most},
                    .curves = {}};
    const auto add = [&](const std::string& title, const std::vector<dam_impact::Sample>& series,
                         CurveStyle style) {
        Curve curve{.title = title, .x = {}, .y = {}, .style = style};
        for (const auto& s : series) curve.x.push_back(s.time), curve.y.push_back(s.pressure);
        chart.curves.push_back(curve);
    };
    auto smooth = dam_impact::dam<2>(what.tank, cells);
    add("walls without friction", dam_impact::run(what.tank, smooth, dam_impact::last_time),
        CurveStyle::line);
    for (const Real roughness : {2e-5, 2e-4}) {
        auto rough = dam_impact::dam_between_holding_walls(what.tank, cells, roughness);
        add(roughness < 1e-4 ? "0.02 mm rough" : "0.2 mm rough",
            dam_impact::run(what.tank, rough, dam_impact::last_time), CurveStyle::line);
    }
    add(what.measured, dam_impact::measured(what.tank), CurveStyle::points);
    draw(chart, folder / what.file);
}

void draw_energy(const fs::path& folder) {
    LineChart chart{.title = "Energy of a standing wave of 1 m on 32 cells, without viscosity",
                    .x = {.label = "periods", .unit = "", .min = 0.0, .max = 15.0},
                    .y = {.label = "energy over that of the start", .unit = "", .min = 0.9, .max = 1.6},
                    .curves = {}};
    for (const int steps : {0, 60, 240}) {
        waves::StandingWave wave;
        const Real period = 2 * pi / wave.frequency(), dt = period / std::max(steps, 1);
        auto flow = wave.tank<2>(32);
        const Real start = waves::wave_energy(flow);
        Curve curve{.title = steps > 0 ? std::to_string(steps) + " equal steps a period" : "steps of its own",
                    .x = {},
                    .y = {}};
        while (flow.time() < 15 * period) {
            flow.step(steps > 0 ? dt : flow.stable_step().seconds);
            curve.x.push_back(flow.time() / period), curve.y.push_back(waves::wave_energy(flow) / start);
        }
        chart.curves.push_back(curve);
    }
    draw(chart, folder / "verification_free_surface_energy.png");
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const fs::path folder = argc > 1 ? argv[1] : "out/charts/free_surface";
        fs::create_directories(folder);
        draw_impact({dam_impact::lobovsky, "Pressure 0.01 H above the floor", "Lobovsky et al.",
                     "verification_free_surface_impact.png", 3},
                    folder);
        draw_impact({dam_impact::buchner, "Pressure 0.2 H above the floor", "Buchner",
                     "verification_free_surface_run_up.png", 1.5},
                    folder);
        draw_energy(folder);
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
