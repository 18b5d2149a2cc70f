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

void draw_impact(const fs::path& folder) {
    LineChart chart{
        .title = "A column of water against a wall: pressure 3 mm above the floor, 40 cells to its height",
        .x = {.label = "t sqrt(g/H)", .unit = "", .min = 2.0, .max = 5.5},
        .y = {.label = "p / (rho g H)", .unit = "", .min = 0.0, .max = 3.0},
        .curves = {}};
    const auto add = [&](const std::string& title, const std::vector<dam_impact::Pressure>& series,
                         CurveStyle style) {
        Curve curve{.title = title, .x = {}, .y = {}, .style = style};
        for (const auto& [time, value] : series) curve.x.push_back(time), curve.y.push_back(value);
        chart.curves.push_back(curve);
    };
    auto smooth = dam_impact::dam<2>(40);
    add("walls without friction", dam_impact::run(smooth, 5.5), CurveStyle::line);
    auto params = smooth.params();
    params.sides = Sides<2>::all(Side::wall);
    params.wall_law = {WallLaw::Kind::logarithmic, 2e-4};
    GridFluid<2> rough(params);
    add("0.2 mm rough", dam_impact::run(rough, 5.5), CurveStyle::line);
    add("Lobovsky et al.", dam_impact::measured(), CurveStyle::points);
    draw(chart, folder / "verification_free_surface_impact.png");
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
        draw_impact(folder);
        draw_energy(folder);
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
