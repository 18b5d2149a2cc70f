// Draws the pictures of docs/verification/shallow_water.md and prints its tables: chart_shallow_water
// [FOLDER], which is made where it is not. Takes a minute.

#include "../../tests/verification/shallow_water.hpp"
#include "../../examples/common/charts.hpp"
#include "panels.hpp"

#include <ctime>
#include <functional>
#include <iostream>

using namespace shallow;
using namespace abrade::examples;

namespace {

namespace fs = std::filesystem;

/// Surface of water, nothing where it is dry.
Curve surface_of(const ShallowWater<1>& water, const std::string& title) {
    Curve curve{.title = title, .x = {}, .y = {}};
    for (Index i = 0; i < water.grid().count(0); ++i) {
        curve.x.push_back(water.grid().centre(0, i));
        curve.y.push_back(water.depth(i) > 1e-3 ? water.surface(i) : NAN);
    }
    return curve;
}

/// Of a function of x, in `parts` steps.
Curve curve_of(const std::string& title, Real from, Real to, const std::function<Real(Real)>& y,
               CurveStyle style = CurveStyle::dashed) {
    constexpr int parts = 2000;
    Curve curve{.title = title, .x = {}, .y = {}, .style = style};
    for (int n = 0; n <= parts; ++n) {
        curve.x.push_back(from + (to - from) * n / parts);
        curve.y.push_back(y(curve.x.back()));
    }
    return curve;
}

void draw_dams(const fs::path& folder) {
    LineChart chart{.title = "A dam of 1 m breaks, 1 s later: 200 cells, and the closed solutions",
                    .x = {.label = "distance from the dam", .unit = "m", .min = -5.0, .max = 7.0},
                    .y = {.label = "depth", .unit = "m", .min = 0.0, .max = 1.1},
                    .curves = {}};
    std::cout << "before the dam [m], middle depth, of it exact, middle speed, exact, shock speed, exact\n";
    for (const Real right : {0.0, 0.1, 0.5}) {
        const DamBreak dam{.left = 1, .right = right};
        ShallowWater<1> water = dam.water(200, 10);
        water.advance(1);
        const std::string name = right > 0 ? short_text(right) + " m before it" : "a dry bed before it";
        Curve computed{.title = name, .x = {}, .y = {}};
        for (const Column& p : points_of(water)) computed.x.push_back(p.x), computed.y.push_back(p.depth);
        chart.curves.push_back(computed);
        chart.curves.push_back(
            curve_of(right > 0 ? "Stoker" : "Ritter", -5, 7, [&](Real x) { return dam.at(x, 1).depth; }));
        if (right == 0) continue;
        const DamBreak::Middle exact = dam.middle();
        const Real place = 0.5 * (exact.speed - std::sqrt(9.81 * exact.depth) + exact.shock);
        const FluidSample middle = water.sample({place, 0, 0}, 1);
        Real front = 0;
        for (const Column& p : points_of(water))
            if (p.depth > 0.5 * (exact.depth + right)) front = p.x + 0.5 * water.grid().spacing(0);
        std::cout << right << ", " << middle.depth << ", " << exact.depth << ", " << middle.velocity.x()
                  << ", " << exact.speed << ", " << front << ", " << exact.shock << std::endl;
    }
    draw(chart, folder / "verification_shallow_dam.png");
}

void draw_bowl(const fs::path& folder) {
    const Bowl bowl;
    LineChart chart{.title = "Water swings in a parabolic bowl: 100 cells, and Thacker's planes",
                    .x = {.label = "distance from the middle", .unit = "m", .min = -2.0, .max = 2.0},
                    .y = {.label = "height", .unit = "m", .min = 0.0, .max = 0.3},
                    .curves = {}};
    chart.curves.push_back(curve_of(
        "bed", -2, 2, [&](Real x) { return bowl.bed(x, 0); }, CurveStyle::line));
    ShallowWater<1> water = bowl.line(100);
    std::cout << "periods, mean error of depth over its greatest\n";
    for (const auto& [part, name] :
         {std::pair(0.25, "a quarter of a period"), std::pair(0.5, "half a period"),
          std::pair(1.0, "one period"), std::pair(5.0, "five periods")}) {
        water.advance(part * bowl.period());
        std::cout << part << ", " << bowl.error(water) << std::endl;
        chart.curves.push_back(surface_of(water, std::string("after ") + name));
        if (part > 0.5) continue;  // full periods end where all began
        chart.curves.push_back(curve_of("exact", -2, 2, [&](Real x) {
            const Real z = bowl.surface(x, 0, water.time(), false);
            return z > bowl.bed(x, 0) ? z : NAN;
        }));
    }
    draw(chart, folder / "verification_shallow_bowl.png");
}

void draw_jumps(const fs::path& folder) {
    const Jump jump{3};
    LineChart chart{
        .title = "A jump stands on a rough bed before a weir: Froude number 3 at the inlet, 300 cells",
        .x = {.label = "distance", .unit = "m", .min = 0.0, .max = Jump::length},
        .y = {.label = "height over the inlet's depth", .min = 0.0, .max = 5.0},
        .curves = {}};
    ShallowWater<1> bed = jump.standing(300, 0.9);
    Curve ground{.title = "bed", .x = {}, .y = {}};
    for (Index i = 0; i < 300; ++i)
        ground.x.push_back(bed.grid().centre(0, i)), ground.y.push_back(bed.bed(i));
    chart.curves.push_back(ground);
    std::cout << "weir [m], jump at [m], Froude number, depth over depth, Belanger\n";
    for (const Real weir : {0.85, 0.9, 0.95}) {
        ShallowWater<1> water = jump.standing(300, weir);
        water.advance(3000);
        Index front = 0;
        for (Index i = 1; i < 200; ++i)
            if (water.depth(i) - water.depth(i - 1) > water.depth(front + 1) - water.depth(front))
                front = i - 1;
        const Index before = front - 4, behind = front + 10;
        const Real h = water.depth(before), froude = water.speed(0, before) / std::sqrt(h);
        std::cout << weir << ", " << front * water.grid().spacing(0) << ", " << froude << ", "
                  << water.depth(behind) / h << ", " << Jump{froude}.sequent() << std::endl;
        chart.curves.push_back(surface_of(water, "weir of " + short_text(weir)));
    }
    // What would stand behind the jump, wherever it were.
    ShallowWater<1> smooth = jump.standing(300, 0.85);
    smooth.advance(3000);
    Curve sequent{
        .title = "Belanger's depth for the stream there", .x = {}, .y = {}, .style = CurveStyle::dashed};
    for (Index i = 0; i < 300; ++i) {
        const Real h = smooth.depth(i), froude = smooth.speed(0, i) / std::sqrt(h);
        if (froude < 2.7) break;  // here it jumps
        sequent.x.push_back(smooth.grid().centre(0, i)), sequent.y.push_back(h * Jump{froude}.sequent());
    }
    chart.curves.push_back(sequent);
    draw(chart, folder / "verification_shallow_jump.png");
}

/// Error and processor time of one problem at many resolutions.
struct Work {
    std::string name;
    std::vector<Index> cells;
    std::function<ShallowWater<1>(Index, Real)> make;
    Real time = 0;
    std::function<Real(const ShallowWater<1>&)> error;
};

Curve run(const Work& work, Real courant) {
    Curve curve;
    for (const Index cells : work.cells) {
        ShallowWater<1> water = work.make(cells, courant);
        Real error = 0, seconds = 1e9;
        for (int repeat = 0; repeat < 3; ++repeat) {  // the fastest of three: the machine is not ours alone
            ShallowWater<1> again = water;
            const std::clock_t start = std::clock();
            again.advance(work.time);
            seconds = std::min(seconds, static_cast<Real>(std::clock() - start) / CLOCKS_PER_SEC);
            error = work.error(again);
            if (repeat == 2)
                std::cout << work.name << ", " << courant << ", " << cells << ", " << again.steps() << ", "
                          << error << ", " << seconds << ", " << 1e9 * seconds / again.steps() / cells
                          << std::endl;
        }
        curve.x.push_back(std::max(seconds, 1e-6)), curve.y.push_back(error);
    }
    return curve;
}

void draw_cost(const fs::path& folder) {
    const SimpleWave wave;
    const DamBreak dam{.left = 1, .right = 0.1};
    const Bowl bowl;
    const auto with_courant = [](const ShallowWater<1>& water, Real courant) {
        auto params = water.params();
        params.courant = courant;
        return ShallowWater<1>(params);
    };
    const std::vector<Work> works{{"smooth wave",
                                   {64, 128, 256, 512, 1024, 2048},
                                   [&](Index n, Real c) { return wave.line(n, c); },
                                   0.5 * wave.breaks(),
                                   [&](const ShallowWater<1>& w) { return wave.error(w) / 1; }},
                                  {"dam break",
                                   {50, 100, 200, 400, 800, 1600, 3200},
                                   [&](Index n, Real c) { return with_courant(dam.water(n, 10), c); },
                                   1,
                                   [&](const ShallowWater<1>& w) {
                                       Real sum = 0;
                                       for (const Column& p : points_of(w))
                                           sum += std::abs(p.depth - dam.at(p.x, 1).depth);
                                       return sum / w.grid().count(0);
                                   }},
                                  {"parabolic bowl",
                                   {50, 100, 200, 400, 800, 1600},
                                   [&](Index n, Real c) { return bowl.line(n, c); },
                                   bowl.period(),
                                   [&](const ShallowWater<1>& w) { return bowl.error(w); }}};
    abrade::charts::PanelChart chart{
        .title = "Mean error of depth against the processor time of a run",
        .x = {.label = "processor time", .unit = "s", .min = 1e-5, .max = 2.0, .logarithmic = true},
        .y = {.label = "mean error over the depth", .min = 1e-7, .max = 1e-1, .logarithmic = true},
        .names = {"Courant number 0.25", "0.5", "0.9"},
        .panels = {},
        .slopes = {{1e-3, 3e-2, -0.5, 100, "first order"}, {1e-3, 3e-5, -1, 100, "second"}},
        .columns = 3,
        .panel_width = 420};
    std::cout << "problem, Courant number, cells, steps, error, processor time [s], ns per cell and step\n";
    for (const Work& work : works) {
        abrade::charts::Panel panel{work.name, {}};
        for (const Real courant : {0.25, 0.5, 0.9}) panel.curves.push_back(run(work, courant));
        chart.panels.push_back(panel);
    }
    draw(chart, folder / "verification_shallow_cost.png");
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const fs::path folder = argc > 1 ? argv[1] : "out/charts/shallow_water";
        fs::create_directories(folder);
        draw_dams(folder);
        draw_bowl(folder);
        draw_jumps(folder);
        draw_cost(folder);
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
