// Draws what each coupling makes of a ball that is let go in still water, over its density and the step:
// chart_added_mass [FOLDER]. A coupling that cannot bear the added mass runs away, in short steps as in long.

#include "../../tests/coupling/resolved_bodies.hpp"
#include "panels.hpp"

#include <abrade/coupling/exchange/one_fluid.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <string>

using namespace resolved;

namespace {

constexpr Real g = 9.81, h = 1.0 / 32, diameter = 4 * h, runaway = 30;
constexpr std::array ratios{0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.3, 0.5, 0.8, 1.2, 2.0, 2.65, 5.0, 8.0};
/// In sqrt(diameter / g).
constexpr std::array steps{0.003, 0.01, 0.03, 0.1};

/// Velocity of a ball of 4 cells after some steps, over that which added mass allows without friction.
template <class Solids>
Real released(Real ratio, Real step, const typename Solids::Params& params) {
    const Real dt = step * std::sqrt(diameter / g);
    WaterAmong<Solids> water({.grid = {.cells = {24, 24, 24}, .spacing = Vec3::Constant(h)},
                              .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                              .gravity = {0, 0, -g},
                              .density = 1000,
                              .viscosity = 1e-6,
                              .tolerance = 1e-3 * square(step)},
                             {}, Solids(params));
    std::vector<Ball> balls{{Vec3(0.381, 0.37, 0.377), 0.5 * diameter, 1000 * ratio}};
    const Real allowed = -g * (ratio - 1) / (ratio + 0.5);
    try {
        for (int k = 1; k <= 20; ++k) {
            resolved::step(water, balls, dt);
            const Real part = balls[0].body.velocity.z() / (allowed * k * dt);
            if (!(std::abs(part) < runaway)) return runaway;
            if (k == 20) return std::max(std::abs(part), 1 / runaway);
        }
    } catch (const FluidError&) {
    }
    return runaway;
}

template <class Solids>
charts::Panel panel(const std::string& title, const typename Solids::Params& params) {
    charts::Panel found{.title = title};
    std::cout << title << '\n';
    for (const Real step : steps) {
        auto& curve = found.curves.emplace_back();
        for (const Real ratio : ratios) {
            curve.x.push_back(ratio), curve.y.push_back(released<Solids>(ratio, step, params));
            std::cout << "  step " << step << ", ratio " << ratio << ": " << curve.y.back() << '\n';
        }
    }
    return found;
}

}  // namespace

int main(int argc, char** argv) {
    const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/added_mass";
    std::filesystem::create_directories(folder);
    charts::PanelChart chart{
        .title = "A ball let go in still water, after 20 steps; 30: it has run away",
        .x = {.label = "its density over the water's",
              .unit = "",
              .min = 0.008,
              .max = 10.0,
              .logarithmic = true},
        .y = {.label = "velocity over what added mass allows",
              .unit = "",
              .min = 0.1,
              .max = 40.0,
              .logarithmic = true},
        .panels = {
            panel<MonolithicSolids<>>("monolithic", {.resolved_from = 0}),
            panel<MonolithicSolids<>>("averaged", {.resolved_from = std::numeric_limits<Real>::infinity()}),
            panel<MixtureSolids>("one fluid, mixture's density", {}),
            panel<DirectForcing>("direct forcing", {})}};
    for (const Real step : steps) chart.names.push_back("step " + short_text(step) + " sqrt(D/g)");
    draw(chart, folder / "added_mass.png");
    std::cout << "picture in " << folder.string() << '\n';
}
