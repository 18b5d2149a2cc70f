// Draws the pictures of docs/verification/convergence.md on the time acceleration of wear and prints its tables:
// chart_wear_acceleration [FOLDER]. The folder is made where it is not.
//
// Its runs take some minutes. What they gave is kept in FOLDER as wear_acceleration.csv, and taken from there
// the next time.

#include "../../examples/common/charts.hpp"
#include "patch_runs.hpp"

#include <iomanip>
#include <iostream>

using namespace abrade;
using namespace abrade::charts;
using namespace abrade::examples;

namespace {

constexpr int seeds = 3;

struct Setting {
    std::string title;
    Patch patch{};
};

/// Few stones: hardly a sphere is worn out by many collisions.
std::vector<Setting> few_stones() {
    const auto with = [](const std::string& title, auto&& set) {
        Setting one{title, {.stones = 30, .interval = 0.016}};
        set(one.patch);
        return one;
    };
    return {with("0.03 m, 2 m/s", [](Patch& p) { p.stone_size = 0.03; }),
            with("0.05 m, 2 m/s", [](Patch&) {}),
            with("0.08 m, 2 m/s", [](Patch& p) { p.stone_size = 0.08; }),
            with("0.05 m, 1 m/s", [](Patch& p) { p.along = 0.5, p.down = 1; }),
            with("0.05 m, 4 m/s", [](Patch& p) { p.along = 2, p.down = 4; })};
}

/// Beta at which a cell is worn by a collision that leaves there half of all the energy of a stone that was
/// fed at the greatest height.
Real beta_of_theory(const Patch& p) {
    const Real mass = 2650 * pi / 6 * cube(p.stone_size), fall = 0.2;
    const Real energy = 0.5 * mass * (square(p.along) + square(p.down)) + mass * standard_gravity * fall;
    return cube(p.lattice.sphere_diameter) / (p.wear.coefficient * 0.5 * energy);
}

std::string label_of(const Setting& s, Real beta) { return s.title + ", beta " + to_text(beta); }

struct Map {
    Curve over_beta, over_share;  ///< worn over what the energy would wear
};

/// Runs at beta 1 say where a collision wears a cell; the others are at multiples of that.
Map map_of(const Setting& setting, PatchRuns& runs) {
    Map map{{.title = setting.title}, {.title = setting.title}};
    const auto run_at = [&](Real beta) {
        Patch patch = setting.patch;
        patch.wear.acceleration = beta;
        runs.make(label_of(setting, beta), patch, seeds);
        return runs.of(label_of(setting, beta)).mean;
    };
    const PatchAnswers slow = run_at(1);
    Real largest = 0;
    for (const PatchAnswers& a : runs.all(label_of(setting, 1))) largest = std::max(largest, a.share);
    const Real safe = 1 / largest;
    std::cout << "| " << setting.title << " | " << std::setprecision(3) << beta_of_theory(setting.patch)
              << " | " << safe;
    for (const Real times : {0.3, 0.6, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 30.0}) {
        const PatchAnswers a = run_at(times * safe);
        for (Curve* curve : {&map.over_beta, &map.over_share})
            curve->y.push_back(a.worn / (slow.worn * times * safe));
        map.over_beta.x.push_back(times * safe), map.over_share.x.push_back(times);
        std::cout << " | " << map.over_beta.y.back() << ", " << a.bonds_broken;
    }
    std::cout << " |\n";
    return map;
}

void draw_against(const Axis& what, const std::vector<Curve>& curves, const std::filesystem::path& picture) {
    draw(LineChart{.title = "30 stones on bonded concrete: worn volume over beta, over the same at beta 1",
                   .x = what,
                   .y = {.label = "worn / (beta x worn at beta 1)", .min = 0, .max = 1.1},
                   .curves = curves},
         picture);
}

void draw_map(const std::filesystem::path& folder, PatchRuns& runs) {
    std::cout
        << "| stones | theory, beta | one collision wears a cell at beta | worn / (beta worn at 1), bonds "
           "broken at 0.3 | 0.6 | 1 | 1.5 | 2 | 3 | 5 | 10 | 30 times that |\n"
           "|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    std::vector<Curve> over_beta, over_share;
    for (const Setting& setting : few_stones()) {
        const Map one = map_of(setting, runs);
        over_beta.push_back(one.over_beta), over_share.push_back(one.over_share);
    }
    over_share.push_back({.title = "a whole cell", .x = {1, 1}, .y = {0, 1.05}, .style = CurveStyle::dashed});
    draw_against({.label = "time acceleration beta", .min = 20, .max = 90'000, .logarithmic = true},
                 over_beta, folder / "convergence_beta.png");
    draw_against({.label = "beta over that at which one collision wears a cell",
                  .min = 0.2,
                  .max = 50,
                  .logarithmic = true},
                 over_share, folder / "convergence_beta_share.png");
}

/// As many stones, at one rate, as beta makes of the same hours and the same sediment.
void same_hours(PatchRuns& runs) {
    std::cout << "\n| beta | stones | largest share | worn, cm3 | overflow, % | largest depth, mm | bonds "
                 "broken | spheres gone |\n|---|---|---|---|---|---|---|---|\n";
    for (const Real beta : {125.0, 250.0, 500.0, 1000.0, 2000.0}) {
        Patch patch;
        patch.wear.acceleration = beta;
        patch.stones = static_cast<int>(std::lround(80'000 / beta));
        patch.interval = 0.012;
        const std::string label = "the same hours, beta " + to_text(beta);
        runs.make(label, patch, seeds);
        const Statistics s = runs.of(label);
        // Now and then a stone finds no room in time: per stone, times those that were due.
        std::cout << std::setprecision(3) << "| " << beta << " | " << patch.stones << " | " << s.mean.share
                  << " | " << 1e6 * s.mean.worn * patch.stones << " +- "
                  << 1e6 * s.standard_error(&PatchAnswers::worn) * patch.stones << " | "
                  << 100 * s.mean.overflow / (s.mean.overflow + s.mean.worn) << " | "
                  << 1e3 * s.mean.max_depth << " +- " << 1e3 * s.standard_error(&PatchAnswers::max_depth)
                  << " | " << s.mean.bonds_broken << " +- " << s.standard_error(&PatchAnswers::bonds_broken)
                  << " | " << s.mean.grains << " |\n";
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        set_thread_count(1);
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/wear_acceleration";
        std::filesystem::create_directories(folder);
        PatchRuns runs(folder / "wear_acceleration.csv");
        draw_map(folder, runs);
        same_hours(runs);
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
