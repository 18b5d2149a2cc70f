// Draws how exact the drag of a fixed sphere is against the time that it takes, ours and OpenFOAM's, from
// what bench/peers/run sphere measured: chart_sphere_drag [FOLDER [CSV]]. CSV:
// out/bench/peers_sphere_errors.csv, best of one hour on one machine; bench/peers/sphere_measured.csv unless
// told otherwise.

#include "../../tests/verification/reference_table.hpp"
#include "panels.hpp"

#include <algorithm>
#include <iostream>

using namespace abrade;

int main(int argc, char** argv) {
    try {
        namespace fs = std::filesystem;
        const fs::path folder = argc > 1 ? argv[1] : "out/charts/sphere_drag";
        fs::create_directories(folder);
        const fs::path measured = argc > 2 ? argv[2] : "bench/peers/sphere_measured.csv";
        charts::PanelChart chart{.title = "Drag of a fixed sphere in a stream, 2 to 6 cells to a diameter",
                                 .x = {.label = "time on one processor",
                                       .unit = "s",
                                       .min = 0.02,
                                       .max = 100.0,
                                       .logarithmic = true},
                                 .y = {.label = "error of the drag, rms over places",
                                       .unit = "",
                                       .min = 0.002,
                                       .max = 2.0,
                                       .logarithmic = true},
                                 .panels = {{.title = "Re 100"}, {.title = "Re 20"}}};
        for (const ReferenceRow& row : reference_table(fs::relative(measured, ABRADE_TEST_DATA).string())) {
            if (row.is("variant", "graded")) continue;  // as exact in long steps, which take less
            const std::string name =
                (row.is("code", "abrade") ? "Abrade: " : "OpenFOAM: ") + row.texts.at("variant");
            const auto found = std::ranges::find(chart.names, name);
            const auto curve = static_cast<std::size_t>(found - chart.names.begin());
            if (found == chart.names.end()) chart.names.push_back(name);
            const std::size_t panel = row.at("reynolds") == 100 ? 0 : 1;
            for (charts::Panel& p : chart.panels) p.curves.resize(chart.names.size());
            chart.panels[panel].curves[curve].x.push_back(row.at("cpu_s"));
            chart.panels[panel].curves[curve].y.push_back(row.at("error"));
        }
        draw(chart, folder / "sphere_drag.png");
        std::cout << "picture in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
