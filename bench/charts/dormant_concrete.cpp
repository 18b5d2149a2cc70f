// Draws the pictures of docs/dormant_concrete.md and prints its tables: chart_dormant_concrete [FOLDER]. The
// folder is made where it is not.

#include "../../examples/common/charts.hpp"
#include "../../tests/verification/struck_concrete.hpp"
#include "panels.hpp"

#include <fstream>
#include <iomanip>
#include <iostream>

using namespace abrade;
using namespace abrade::examples;

namespace {

constexpr Real forces[] = {0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30, 100};  ///< [N]
constexpr Index radii[] = {0, 2, 4, 8, 16};                           ///< [bonds]

/// A scene's runs and the same with everything awake.
struct Case {
    std::vector<StruckConcrete> scenes;
    std::vector<Outcome> awake{};
};

/// One stone each, somewhere on the middle cell.
Case impacts(std::initializer_list<std::pair<Real, Real>> velocities, Real tensile) {
    Case all;
    for (const auto& [along, down] : velocities)
        all.scenes.push_back({.side = 0.7,
                              .patch = 0.02,
                              .stones = 1,
                              .seed = static_cast<std::uint32_t>(all.scenes.size() + 1),
                              .interval = 8e-3,
                              .along = along,
                              .down = down,
                              .tensile = tensile});
    return all;
}
Case train() { return {{StruckConcrete{.stones = 40}}}; }

/// What sleep changed, mean over a case's scenes.
struct Change {
    Real worn = 0, largest = 0;  ///< |difference| over the worn volume awake, and the largest [-]
    Real awake = 0;              ///< share of the spheres that could move [-]
    Index others = 0;            ///< bonds broken in one run only
    Real residual = 0;           ///< the largest of the ledger [-]
};

Change change(const Case& all, Real wake_force, Index wake_radius) {
    Change c;
    const auto count = static_cast<Real>(all.scenes.size());
    for (std::size_t n = 0; n < all.scenes.size(); ++n) {
        StruckConcrete scene = all.scenes[n];
        scene.wake_force = wake_force, scene.wake_radius = wake_radius;
        const Outcome near = run(scene);
        const Outcome& awake = all.awake[n];
        const Real off = std::abs(near.worn / awake.worn - 1);
        std::vector<Index> others;
        std::set_symmetric_difference(near.which.begin(), near.which.end(), awake.which.begin(),
                                      awake.which.end(), std::back_inserter(others));
        c.worn += off / count, c.largest = std::max(c.largest, off), c.awake += near.awake / count;
        c.others += static_cast<Index>(others.size()), c.residual = std::max(c.residual, near.residual);
    }
    return c;
}

struct Panels {
    abrade::charts::Panel error, awake;
};

Panels measure(Case all, const std::string& title, std::ostream& csv) {
    std::cout << "\n"
              << title << "\n\n| impact, along and down, m/s | worn, mm3 | bonds broken |\n|---|---|---|\n";
    for (const StruckConcrete& scene : all.scenes) {
        all.awake.push_back(run(scene));
        std::cout << "| " << scene.along << ", " << scene.down << " | " << 1e9 * all.awake.back().worn
                  << " | " << all.awake.back().broken << " |" << std::endl;
    }
    std::cout
        << "\n| wake_force, N | wake_radius, bonds | worn, off by | at most | bonds broken in one only | "
           "awake, % | residual |\n|---|---|---|---|---|---|---|\n";
    Panels panels{{.title = title}, {.title = title}};
    for (const Index radius : radii) {
        Curve error, awake;
        for (const Real force : forces) {
            const Change c = change(all, force, radius);
            error.x.push_back(force), error.y.push_back(std::max(c.worn, 1e-16));
            awake.x.push_back(force), awake.y.push_back(100 * c.awake);
            csv << title << ',' << force << ',' << radius << ',' << c.worn << ',' << c.largest << ','
                << c.others << ',' << c.awake << ',' << c.residual << '\n';
            std::cout << std::setprecision(2) << "| " << force << " | " << radius << " | " << c.worn << " | "
                      << c.largest << " | " << c.others << " | " << std::setprecision(3) << 100 * c.awake
                      << " | " << std::setprecision(1) << c.residual << std::setprecision(6) << " |"
                      << std::endl;
        }
        panels.error.curves.push_back(error), panels.awake.curves.push_back(awake);
    }
    return panels;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        set_thread_count(1);
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/dormant_concrete";
        std::filesystem::create_directories(folder);
        std::ofstream csv(folder / "dormant_concrete.csv");
        csv << "case,wake_force_N,wake_radius,worn_difference,largest,bonds_broken_in_one_only,awake,"
               "residual\n";
        const Panels sound = measure(impacts({{0, 1}, {2, 1}, {5, 3}, {1, 4}}, 2.7e6),
                                     "4 single impacts, nothing breaks", csv);
        const Panels broken =
            measure(impacts({{3, 6}, {0, 3}, {5, 3}}, 2e5), "3 single impacts on weak bonds", csv);
        const Panels many = measure(train(), "40 stones, one after the other", csv);
        std::vector<std::string> names;
        for (const Index radius : radii) names.push_back("wake radius " + std::to_string(radius));
        const Axis force{.label = "wake force", .unit = "N", .min = 0.007, .max = 140, .logarithmic = true};
        draw(
            abrade::charts::PanelChart{
                .title = "Concrete that sleeps: worn volume against all awake",
                .x = force,
                .y = {.label = "|difference| / worn volume", .min = 1e-9, .max = 1, .logarithmic = true},
                .names = names,
                .panels = {sound.error, broken.error, many.error},
                .columns = 3,
                .panel_width = 400},
            folder / "dormant_error.png");
        draw(abrade::charts::PanelChart{.title = "What that costs: mean share of the concrete that is awake",
                                        .x = force,
                                        .y = {.label = "awake", .unit = "%", .min = 0, .max = 105},
                                        .names = names,
                                        .panels = {sound.awake, broken.awake, many.awake},
                                        .columns = 3,
                                        .panel_width = 400},
             folder / "dormant_awake.png");
        std::cout << "\npictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
