// Clear water runs down the dry channel of the validation: prints how long that takes and what comes of it,
// and draws the surface along the channel: chart_water_channel [FOLDER [LENGTH [SECONDS [SURFACE]]]], 4.5 m,
// 3 s and "volume" (of fluid; or "height") unless told otherwise, which take a minute of one processor; the
// whole channel is 45 and 25. As many threads as OMP_NUM_THREADS says. Steps are those of the validation.

#include "../../examples/common/charts.hpp"
#include "../../tests/verification/channel_water.hpp"

#include <chrono>
#include <cstdlib>
#include <iostream>

using namespace channel_water;
using namespace abrade::examples;

namespace {

template <class Surface>
void run(const std::filesystem::path& folder, Real length, Real end) {
    const Means uniform = wanted();
    LineChart chart{.title = "Water runs down " + short_text(length) + " m of the dry invert",
                    .x = {.label = "distance along the channel", .unit = "m", .min = 0.0, .max = length},
                    .y = {.label = "depth at the centre line", .unit = "m", .min = 0.0, .max = 0.3},
                    .curves = {}};

    const auto begun = std::chrono::steady_clock::now();
    const auto wall = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    };
    auto params = channel(length);
    params.courant = 0.9;
    GridFluid<3, Turbulent<MixingLength, Surface>> flow(params, MixingLength{{.depth = uniform.depth}});
    std::cout << "cells " << flow.grid().layout().cell_count() << ", begun after " << wall()
              << " s\ntime [s], wall time [s], steps, wet cells, water [m3], "
                 "discharge at the outlet [m3/s]\n";
    const int parts = 25, drawn = 5;
    for (int part = 1; part <= parts; ++part) {
        const Real until = end * part / parts;
        flow.advance(until);
        std::cout << flow.time() << ", " << wall() << ", " << flow.steps() << ", " << flow.wet_cells() << ", "
                  << flow.liquid().volume() << ", " << section(flow, flow.grid().cells(0) - 1).discharge
                  << std::endl;
        if (part % drawn != 0 && part != 2) continue;
        Curve curve{.title = short_text(until) + " s", .x = {}, .y = {}};
        for (int i = 0; i < flow.grid().cells(0); ++i) {
            const Real x = flow.grid().centre(0, i), depth = flow.surface_at({x, 0, 0});
            if (depth > 0.001) curve.x.push_back(x), curve.y.push_back(depth);
        }
        chart.curves.push_back(curve);
    }
    chart.curves.push_back({.title = "Manning",
                            .x = {0, length},
                            .y = {uniform.depth, uniform.depth},
                            .style = CurveStyle::dashed});
    draw(chart, folder / "water_channel.png");

    std::cout << "means from, to [m]: depth [m], speed [m/s], 0.03 and 0.16 m above the centre line [m/s]\n";
    const auto print = [](const std::string& where, const Means& m) {
        std::cout << where << ": " << m.depth << ", " << m.speed << "; " << m.low << ", " << m.high << '\n';
    };
    for (const Real at : {0.25, 0.5, 0.75, 1.0}) {
        const Real to = std::min(at * length + 0.3, length);
        print(short_text(to - 0.6) + ", " + short_text(to), means(flow, to - 0.6, to));
    }
    print("wanted", uniform);
    std::cout << "pictures in " << folder.string() << '\n';
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/water_channel";
        const Real length = argc > 2 ? std::atof(argv[2]) : 4.5, end = argc > 3 ? std::atof(argv[3]) : 3;
        const std::string surface = argc > 4 ? argv[4] : "volume";
        require_positive(length, "LENGTH", "m"), require_positive(end, "SECONDS", "s");
        if (surface != "volume" && surface != "height")
            fail({"SURFACE", "volume or height", "", "leave it out for volume"}, surface);
        std::filesystem::create_directories(folder);
        surface == "height" ? run<HeightSurface>(folder, length, end) : run<FreeSurface>(folder, length, end);
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
