// Draws the pictures of docs/verification/viscous_flow.md and prints its tables: chart_viscous_flow [FOLDER
// [CELLS]], which is made where it is not. Takes some minutes; CELLS = 256 adds Taylor-Green vortices with as
// many cells to the period, which take half an hour.

#include "../../tests/verification/viscous_flow.hpp"
#include "../../examples/common/charts.hpp"
#include "../../tests/verification/taylor_green_3d.hpp"

#include <functional>
#include <iostream>

using namespace abrade;
using namespace abrade::examples;

namespace {

namespace fs = std::filesystem;

struct Case {
    std::string name;
    std::function<viscous::Errors(int)> errors;
};

/// Errors of the resistance over cells; prints all.
void draw_orders(const std::string& title, const std::vector<Case>& cases, const fs::path& picture) {
    LineChart chart{
        .title = title,
        .x = {.label = "cells across", .min = 7.0, .max = 40.0, .logarithmic = true},
        .y = {.label = "relative error of the resistance", .min = 3e-4, .max = 1.0, .logarithmic = true},
        .curves = {}};
    std::cout << "case, cells, error of velocity, largest, at centroids of open parts (plates only), of "
                 "resistance; orders of velocity, at centroids (plates only), of resistance\n";
    for (const Case& c : cases) {
        Curve curve{.title = c.name, .x = {}, .y = {}};
        viscous::Errors coarser;
        for (const int cells : {8, 16, 32}) {
            const viscous::Errors e = c.errors(cells);
            const auto print_order = [&](Real coarse, Real fine) {
                if (fine > 0) std::cout << ", " << viscous::order(coarse, fine);
            };
            std::cout << c.name << ", " << cells << ", " << e.profile << ", " << e.largest << ", ";
            if (e.middle > 0) std::cout << e.middle << ", ";
            std::cout << e.resistance;
            if (cells > 8) {
                print_order(coarser.profile, e.profile), print_order(coarser.middle, e.middle);
                print_order(std::abs(coarser.resistance), std::abs(e.resistance));
            }
            std::cout << std::endl;
            curve.x.push_back(cells), curve.y.push_back(std::abs(e.resistance));
            coarser = e;
        }
        chart.curves.push_back(curve);
    }
    for (const int order : {1, 2})
        chart.curves.push_back({.title = order == 1 ? "first order" : "second order",
                                .x = {8, 32},
                                .y = {0.045, 0.045 * std::pow(4, -order)},
                                .style = CurveStyle::dashed});
    draw(chart, picture);
}

void draw_orders(const fs::path& folder) {
    using namespace viscous;
    const auto channel = [](Real share, Real degrees) {
        return
            [=](int n) { return Channel{.cells = n, .angle = degrees * pi / 180, .share = share}.errors(); };
    };
    const auto film = [](Real top, Real share) {
        return [=](int n) { return Film{.cells = n, .top = top, .share = share}.errors(); };
    };
    draw_orders("Between two plates",
                {{"sides of the box", between_sides},
                 {"walls on grid planes", channel(1, 0)},
                 {"cut cells open by 0.75", channel(0.75, 0)},
                 {"by 0.25", channel(0.25, 0)},
                 {"at 10 degrees", channel(0.7, 10)},
                 {"at 30 degrees", channel(0.7, 30)},
                 {"at 45 degrees", channel(0.7, 45)}},
                folder / "verification_viscous_plates.png");
    draw_orders("A film down an incline",
                {{"side, uppermost cell full", film(0, 0)},
                 {"side, full by 0.75", film(0.75, 0)},
                 {"side, full by 0.25", film(0.25, 0)},
                 {"wall on a grid plane", film(0.75, 1)},
                 {"wall, cut cells open by 0.75", film(0.75, 0.75)},
                 {"wall, by 0.25", film(0.75, 0.25)}},
                folder / "verification_viscous_film.png");
}

template <AdvectionScheme Scheme>
void add_decay(LineChart& chart, int cells) {
    using namespace taylor_green_3d;
    auto flow = vortices<Scheme>(cells);
    const std::vector<Sample> samples = decay(flow, 12);
    const Peak most = peak(samples);
    Curve curve{.title = std::string(Scheme::name) + ", " + std::to_string(cells), .x = {}, .y = {}};
    Real resolved = 0, lost = 0;
    for (const Sample& s : samples) {
        curve.x.push_back(s.time), curve.y.push_back(1e3 * s.loss);
        resolved += s.dissipation, lost += s.loss;
    }
    std::cout << Scheme::name << ", " << cells << ", " << most.time << ", " << most.loss << ", "
              << off(samples) << ", " << resolved / lost << ", " << flow.steps() << std::endl;
    chart.curves.push_back(curve);
}

void draw_vortices(const fs::path& folder, int most_cells) {
    LineChart chart{.title = "Taylor-Green vortices at Re 1600: what they lose, and the direct simulation",
                    .x = {.label = "time", .min = 0.0, .max = 12.0},
                    .y = {.label = "1000 x loss of kinetic energy", .min = 0.0, .max = 14.0},
                    .curves = {}};
    std::cout
        << "scheme, cells to the period, peak at, peak, off the direct simulation over its peak (root mean "
           "square), share that friction takes, steps\n";
    for (int cells = 64; cells <= most_cells; cells *= 2) {
        add_decay<Central>(chart, cells);
        add_decay<Koren>(chart, cells);
    }
    Curve exact{.title = "Dairay et al.", .x = {}, .y = {}, .style = CurveStyle::dashed};
    for (const ReferenceRow& row : reference_table("flu05_taylor_green_3D_Re1600_DNS.csv"))
        if (row.at("t") <= 12) exact.x.push_back(row.at("t")), exact.y.push_back(1e3 * row.at("eps_t"));
    chart.curves.push_back(exact);
    draw(chart, folder / "verification_taylor_green_3d.png");
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const fs::path folder = argc > 1 ? argv[1] : "out/charts/viscous_flow";
        fs::create_directories(folder);
        draw_orders(folder);
        draw_vortices(folder, argc > 2 ? std::stoi(argv[2]) : 128);
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
