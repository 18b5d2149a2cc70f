// Draws the pictures of docs/verification/volume_of_fluid.md and prints its tables: chart_volume_of_fluid
// [FOLDER [FINEST]]. The folder is made where it is not; FINEST cells along the box of the deformation, 128
// if not said.

#include "../../tests/verification/volume_of_fluid.hpp"
#include "../../examples/common/charts.hpp"
#include "../../tests/verification/reference_table.hpp"
#include "panels.hpp"

#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>

using namespace returning_shapes;
using namespace abrade::examples;
using namespace abrade::charts;

namespace {

/// One way to run a test, on grids of several sizes.
struct Series {
    std::string name{};
    std::vector<Real> cells{}, error{}, seconds{};
};

struct Variant {
    std::string name{};
    VolumeOfFluid<2>::Params flat{};
    VolumeOfFluid<3>::Params solid{};
};
const std::vector<Variant> variants{{"planes fitted once a step", {}, {}},
                                    {"planes fitted in every sweep", {true}, {true}}};

Series run(const std::string& test, const std::string& name, const std::vector<int>& sizes, const auto& one) {
    Series series{.name = name};
    for (const int cells : sizes) {
        const Returned r = one(cells);
        const Real error = test == "slotted_disc" ? r.relative : r.error;
        series.cells.push_back(cells);
        series.error.push_back(error);
        series.seconds.push_back(r.seconds);
        std::cout << "| " << test << " | " << name << " | " << cells << " | " << r.steps << " | "
                  << std::scientific << std::setprecision(2) << error << " | " << r.lost << " | " << r.outside
                  << " | " << std::defaultfloat << std::setprecision(3) << r.seconds << " | "
                  << 1e9 * r.seconds / r.wet_steps << " |\n"
                  << std::flush;
    }
    return series;
}

/// The smallest and the largest of what was published, grid by grid.
std::array<Curve, 2> published_range(const std::string& test) {
    std::map<Real, std::array<Real, 2>> range;
    for (const ReferenceRow& row : reference_table("vof01_published_shape_errors.csv")) {
        if (!row.is("test", test)) continue;
        auto& [low, high] = range.try_emplace(row.at("cells"), std::array<Real, 2>{1, 0}).first->second;
        low = std::min(low, row.at("error"));
        high = std::max(high, row.at("error"));
    }
    std::array<Curve, 2> curves;
    for (const auto& [cells, errors] : range)
        for (std::size_t end = 0; end < 2; ++end) {
            curves[end].x.push_back(cells);
            curves[end].y.push_back(errors[end]);
        }
    return curves;
}

/// Fractions of a square box as a map, with an outline over it.
void map_of(const Field<Real>& fraction, int cells, Real size, const Curve& outline, const std::string& title,
            const std::array<Real, 4>& window, const std::filesystem::path& picture) {
    const Grid<2> grid = grid_of<2>(cells, size);
    const auto first = [&](Real x) { return static_cast<int>(std::floor(x / size * cells)); };
    const int x0 = first(window[0]), x1 = first(window[1]), z0 = first(window[2]), z1 = first(window[3]);
    ColourMap map{.title = title,
                  .x = {.label = "x", .unit = "m", .min = x0 * size / cells, .max = x1 * size / cells},
                  .y = {.label = "z", .unit = "m", .min = z0 * size / cells, .max = z1 * size / cells},
                  .colour = {.label = "liquid fraction", .min = 0, .max = 1},
                  .columns = static_cast<std::size_t>(x1 - x0),
                  .equal_aspect = true,
                  .lines = {outline},
                  .width = 900};
    for (int z = z0; z < z1; ++z)
        for (int x = x0; x < x1; ++x) map.values.push_back(fraction[grid.layout().at({x, z})]);
    draw(map, picture);
}

Curve circle(Real x, Real z, Real radius, Real from, Real to) {
    Curve curve{.title = "at the start"};
    for (int k = 0; k <= 200; ++k) {
        const Real angle = from + (to - from) * k / 200;
        curve.x.push_back(x + radius * std::cos(angle));
        curve.y.push_back(z + radius * std::sin(angle));
    }
    return curve;
}

Curve disc_outline() {
    const Real edge = std::asin(0.06 / 0.5);
    Curve curve = circle(2, 2.75, 0.5, -pi / 2 + edge, 1.5 * pi - edge);
    for (const Point<2>& x : {Point<2>(1.94, 2.85), Point<2>(2.06, 2.85)}) {
        curve.x.push_back(x[0]);
        curve.y.push_back(x[1]);
    }
    curve.x.push_back(curve.x.front());
    curve.y.push_back(curve.y.front());
    return curve;
}

void draw_errors(const std::filesystem::path& folder, int finest) {
    std::cout
        << "| test | planes | cells | steps | shape error | volume | beyond [0, 1] | s | ns per wet cell |\n"
           "|---|---|---|---|---|---|---|---|---|\n";
    std::vector<int> sizes{32, 64, 128, 256}, solid_sizes{32};
    while (solid_sizes.back() < finest) solid_sizes.push_back(2 * solid_sizes.back());
    const std::vector<std::string> tests{"slotted_disc", "single_vortex", "deformation"};
    const std::vector<std::string> titles{"Slotted disc, one turn", "Single vortex, 8 s",
                                          "Deformation in 3-D, 3 s"};
    std::vector<std::vector<Series>> all(tests.size());
    for (const Variant& v : variants) {
        all[0].push_back(
            run(tests[0], v.name, {50, 100, 200, 400}, [&](int n) { return zalesak(n, v.flat); }));
        all[1].push_back(
            run(tests[1], v.name, sizes, [&](int n) { return single_vortex(n, 8, 0.5, v.flat); }));
        all[2].push_back(
            run(tests[2], v.name, solid_sizes, [&](int n) { return deformation(n, 0.5, v.solid); }));
    }
    PanelChart errors{.title = "Shapes that a flow brings back: what is wrong with them",
                      .x = {.label = "cells along the box", .min = 25, .max = 500, .logarithmic = true},
                      .y = {.label = "shape error", .min = 1e-4, .max = 1, .logarithmic = true},
                      .names = {variants[0].name, variants[1].name, "the best published, with planes",
                                "the worst published, with planes"},
                      .panels = {},
                      .slopes = {{.x = 40, .y = 4e-3, .slope = -2, .reach = 5, .label = "order 2"}},
                      .columns = 3,
                      .panel_width = 380};
    LineChart cost{.title = "Shape error against time on one core",
                   .x = {.label = "wall time", .unit = "s", .logarithmic = true},
                   .y = {.label = "shape error", .logarithmic = true},
                   .curves = {}};
    for (std::size_t t = 0; t < tests.size(); ++t) {
        Panel panel{.title = titles[t], .curves = {}};
        for (const Series& s : all[t]) {
            panel.curves.push_back({.title = s.name, .x = s.cells, .y = s.error});
            cost.curves.push_back({.title = titles[t] + ": " + s.name, .x = s.seconds, .y = s.error});
        }
        for (Curve& curve : published_range(tests[t])) panel.curves.push_back(std::move(curve));
        errors.panels.push_back(panel);
    }
    draw(errors, folder / "verification_volume_of_fluid_errors.png");
    draw(cost, folder / "verification_volume_of_fluid_cost.png");
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/volume_of_fluid";
        const int finest = argc > 2 ? std::atoi(argv[2]) : 128;
        std::filesystem::create_directories(folder);
        map_of(zalesak(200).end, 200, 4, disc_outline(), "A slotted disc after one turn, 200 x 200 cells",
               {1.4, 2.6, 2.15, 3.35}, folder / "verification_volume_of_fluid_disc.png");
        map_of(single_vortex(128, 8, 0.5, {}, 0.5).end, 128, 1, circle(0.5, 0.75, 0.15, 0, 2 * pi),
               "A circle in a single vortex, stretched for 4 s, 128 x 128 cells", {0, 1, 0, 1},
               folder / "verification_volume_of_fluid_spiral.png");
        map_of(single_vortex(128, 8, 0.5).end, 128, 1, circle(0.5, 0.75, 0.15, 0, 2 * pi),
               "and brought back in 4 s more", {0.3, 0.7, 0.55, 0.95},
               folder / "verification_volume_of_fluid_back.png");
        draw_errors(folder, finest);
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
