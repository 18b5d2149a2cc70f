// Draws what each coupling of bodies and water buys on coarse grids: the error of a sphere's drag, of the
// speed it settles with and of what it loses in impacts, which is what it wears, against processor time; CSV
// beside it: chart_body_levels [FOLDER [FINEST]]. FINEST: most cells to a diameter, 8 unless told otherwise
// (some minutes); 16 takes twenty minutes. One thread.

#include "../../tests/coupling/resolved_bodies.hpp"
#include "../../tests/coupling/still_liquid.hpp"
#include "../../tests/coupling/stone_tank.hpp"
#include "../../tests/verification/settling_sphere.hpp"
#include "panels.hpp"

#include <abrade/coupling/exchange/one_fluid.hpp>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <limits>
#include <numeric>
#include <optional>

using namespace resolved;

namespace {

namespace fs = std::filesystem;

/// Of one level on one grid, in the mean over places on it.
struct Point {
    Real cells = 0;  ///< to a diameter; 0: the water has none
    std::vector<Real> values{};
    Real seconds = 0;  ///< of the processor

    Real mean() const { return std::reduce(values.begin(), values.end()) / static_cast<Real>(values.size()); }
    Real error(Real exact) const {  ///< root mean square [-]
        Real sum = 0;
        for (const Real value : values) sum += square(value / exact - 1);
        return std::sqrt(sum / static_cast<Real>(values.size()));
    }
};
struct Level {
    std::string name;
    std::vector<Point> points{};
};

/// `measure(off)`: off the corners of cells by so much [cell].
Point measured(Real cells, auto&& measure) {
    Point point{.cells = cells};
    const std::clock_t start = std::clock();
    for (const Real off : {0.3, 0.0, 0.6})
        if (off == 0.3 || (cells > 0 && cells <= 4)) point.values.push_back(measure(off));
    point.seconds =
        static_cast<Real>(std::clock() - start) / CLOCKS_PER_SEC / static_cast<Real>(point.values.size());
    std::cout << "  " << cells << " cells: " << point.mean() << ", " << point.seconds << " s" << std::endl;
    return point;
}
/// Of all that live on a grid: `measure(cells, off, solids)`.
std::vector<Level> levels(Real finest, auto&& measure) {
    constexpr Real none = std::numeric_limits<Real>::infinity();
    std::vector<Level> found;
    const auto add = [&](const std::string& name, Real to, auto solids) {
        std::cout << name << '\n';
        Level& level = found.emplace_back(Level{.name = name});
        for (const Real cells : {1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0})
            if (cells <= std::min(to, finest) && (cells > 1 || name == "averaged"))
                level.points.push_back(
                    measured(cells, [&](Real off) { return measure(cells, off, solids); }));
    };
    add("averaged", 4, MonolithicSolids<>({.resolved_from = none}));
    add("monolithic", none, MonolithicSolids<>({.resolved_from = 0}));
    add("mixture", 8, MixtureSolids());
    add("direct forcing", 8, DirectForcing());
    return found;
}

struct Sheet {
    std::ofstream csv;
    charts::PanelChart chart;

    /// `exact`: none: the finest of the monolithic exchange.
    void add(const std::string& title, const std::vector<Level>& all, std::optional<Real> exact) {
        for (const Level& level : all)
            if (!exact && level.name == "monolithic") exact = level.points.back().mean();
        charts::Panel& panel = chart.panels.emplace_back(charts::Panel{.title = title});
        panel.curves.resize(chart.names.size());
        for (const Level& level : all) {
            const auto at = std::ranges::find(chart.names, level.name) - chart.names.begin();
            examples::Curve& curve = panel.curves.at(static_cast<std::size_t>(at));
            for (const Point& p : level.points) {
                const Real error = p.error(*exact);
                csv << title << ',' << level.name << ',' << p.cells << ',' << p.mean() << ',' << *exact << ','
                    << error << ',' << p.seconds << std::endl;
                if (error > 0) curve.x.push_back(p.seconds), curve.y.push_back(error);
            }
        }
    }
};

std::vector<Level> drag(Real reynolds, Real finest) {
    std::cout << "drag, Re " << reynolds << '\n';
    return levels(finest, [&](Real cells, Real off, const auto& solids) {
        return drag_in({.cells = cells, .reynolds = reynolds, .off = off}, 12, solids).mean;
    });
}

std::vector<Level> settling(const ReferenceRow& row, Real finest) {
    std::cout << "settling\n";
    constexpr Real end = 0.9;
    const auto nothing = [](const auto&) {};
    std::vector<Level> all = levels(finest, [&](Real cells, Real off, const auto& solids) {
        const Vec3 place =
            settling_sphere::middle + off * settling_sphere::diameter / cells * Vec3(1, 0.37, -0.71);
        return settling_sphere::settle_from(place, end, nothing, settling_sphere::oil(row, cells, solids))
            .speed;
    });
    std::cout << "one way\n";
    const Point one_way = measured(0, [&](Real) {
        const Still still({.viscosity = row.at("mu_f"), .density = row.at("rho_f")});
        return settling_sphere::settle(end, nothing, still, WithInertia<>{}).speed;
    });
    all.push_back({"one way", {one_way}});
    return all;
}

/// What a stone that sinks six diameters onto a floor loses there within a second [J].
std::vector<Level> impacts(Real finest) {
    std::cout << "impacts\n";
    constexpr Real diameter = 0.05;
    const auto lost = [](const Vec3& aside, auto... fluid) {
        using namespace stone_tank;
        Scene scene;
        scene.gravity = {0, 0, -stone_tank::g};
        scene.add_wall({0, 0, 0}, {0, 0, 1});
        scene.add_sphere(0.5 * diameter, {.position = Vec3(0, 0, 6.5 * diameter) + aside}, stone_density);
        auto sim = simulate(scene)
                       .contact(LinearSpring{{.stiffness = 1e5, .restitution = 0.5, .friction = 0.3}})
                       .fluid(std::move(fluid)...);
        sim.run({.end_time = 1});
        return sim.ledger().lost_normal + sim.ledger().lost_sliding;
    };
    std::vector<Level> all = levels(std::min(finest, 12.0), [&](Real cells, Real off, auto solids) {
        const int across = static_cast<int>(6 * cells), up = static_cast<int>(9 * cells);
        const stone_tank::Tank tank{.cells = {across, across, up}, .h = diameter / cells};
        return lost(off * tank.h * Vec3(1, 0.37, 0.71),
                    stone_tank::water_in<FullBox>(tank, std::move(solids)));
    });
    std::cout << "one way\n";
    all.push_back(
        {"one way", {measured(0, [&](Real) { return lost(Vec3::Zero(), Still({}), WithInertia<>{}); })}});
    return all;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const fs::path folder = argc > 1 ? argv[1] : "out/charts/body_levels";
        const Real finest = argc > 2 ? std::atof(argv[2]) : 8;
        if (!(finest >= 2)) throw std::invalid_argument("FINEST: give at least 2 cells to a diameter");
        fs::create_directories(folder);
        Sheet sheet{
            .csv = std::ofstream(folder / "body_levels.csv"),
            .chart = {.title = "A sphere in water, from a few cells to a diameter on",
                      .x = {.label = "time on one processor",
                            .unit = "s",
                            .min = 0.001,
                            .max = 1e3,
                            .logarithmic = true},
                      .y = {.label = "error", .unit = "", .min = 5e-4, .max = 2.0, .logarithmic = true},
                      .names = {"one way", "averaged", "monolithic", "mixture", "direct forcing"}}};
        sheet.csv << "what,level,cells_to_a_diameter,mean,exact,error,cpu_s\n";
        sheet.add("drag at Re 20", drag(20, std::min(finest, 12.0)), fitted_drag_at_20);
        sheet.add("drag at Re 100", drag(100, finest), fitted_drag_at_100);
        const auto rows = reference_table("cpl01_tencate2002_parameters_peaks.csv");
        const auto e4 = std::ranges::find_if(rows, [](const ReferenceRow& r) { return r.is("case", "E4"); });
        sheet.add("speed of settling at Re 32", settling(*e4, finest), e4->at("umax_exp_mps"));
        sheet.add("lost in impacts by a stone that sinks", impacts(finest), std::nullopt);
        draw(sheet.chart, folder / "body_levels.png");
        std::cout << "picture and CSV in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
