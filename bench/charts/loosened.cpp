// Whether concrete that stands lets as many spheres go as concrete that moves; draws the picture of
// docs/howto/standing_concrete.md on that, prints its tables and writes summary.json: chart_loosened [FOLDER].
//
// What its runs gave is kept in FOLDER as loosened.csv, and taken from there the next time.

#include "../../examples/common/charts.hpp"
#include "patch_runs.hpp"

#include <nlohmann/json.hpp>

#include <iomanip>
#include <iostream>

using namespace abrade;
using namespace abrade::charts;
using namespace abrade::examples;

namespace {

struct Level {
    std::string title;
    ConcreteLevel level = ConcreteLevel::quasi_static;
    Index cluster = 0;
    int most_seeds = 1000;  ///< that it is worth the time of
};
const Level moves{"dynamic", ConcreteLevel::dynamic};

/// Bonds of 64 times the contacts' stiffness: the contact alone decides how a stone rebounds. At `beta` 1000
/// all stones together wear the top layer through.
Patch struck(const Level& how, Real tensile, int stones, Real beta) {
    Patch patch{.stones = stones,
                .dashpot = false,
                .level = how.level,
                .cluster = how.cluster,
                .worn_out = WornOut::fines,
                .overflow = FillCrater{}};
    patch.lattice.layers = 4;
    patch.bond.tensile = tensile, patch.bond.stiffness = 64 * patch.contact.stiffness;
    patch.wear.acceleration = beta;
    return patch;
}

/// "mean +- deviation of a run"
std::string spread(const Statistics& s, Real PatchAnswers::*of, Real unit = 1) {
    std::ostringstream text;
    text << std::setprecision(3) << s.mean.*of / unit << " +- " << s.deviation.*of / unit;
    return text.str();
}

/// Prints one row for each level; returns their statistics.
std::vector<Statistics> table(PatchRuns& runs, const std::string& title, const std::vector<Level>& levels,
                              Real tensile, int stones, Real beta, int seeds) {
    std::cout << "\n## " << title
              << "\n\n| level | loosened | untied | bonds broken | worn, cm3 a stone | deepest square, mm | "
                 "time of a core, s | seeds |\n|---|---|---|---|---|---|---|---|\n";
    std::vector<Statistics> all;
    for (const Level& how : levels) {
        const std::string label = title + ", " + how.title;
        runs.make(label, struck(how, tensile, stones, beta), std::min(seeds, how.most_seeds));
        const Statistics& s = all.emplace_back(runs.of(label));
        std::cout << "| " << how.title << " | " << spread(s, &PatchAnswers::loosened) << " | "
                  << spread(s, &PatchAnswers::untied) << " | " << spread(s, &PatchAnswers::bonds_broken)
                  << " | " << spread(s, &PatchAnswers::worn, 1e-6) << " | "
                  << spread(s, &PatchAnswers::max_depth, 1e-3) << " | " << std::setprecision(3)
                  << runs.fastest(label) << " | " << s.seeds << (s.failed > 0 ? ", others failed" : "")
                  << " |" << std::endl;
    }
    return all;
}

}  // namespace

int main(int argc, char** argv) {
    set_thread_count(1);
    const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/loosened";
    std::filesystem::create_directories(folder);
    PatchRuns runs(folder / "loosened.csv");
    std::vector<Level> stands;
    for (Index cluster = 0; cluster <= 3; ++cluster)
        stands.push_back({"quasi_static, cluster " + std::to_string(cluster), ConcreteLevel::quasi_static,
                          cluster, cluster < 3 ? 1000 : 1});
    const auto first = [&](std::size_t count) {
        std::vector<Level> levels(stands.begin(), stands.begin() + static_cast<std::ptrdiff_t>(count));
        levels.push_back(moves);
        return levels;
    };
    const std::vector<Statistics> sound =
        table(runs, "2.7 MPa, 160 stones, beta 1000", first(4), 2.7e6, 160, 1000, 4);
    table(runs, "1 MPa, 160 stones, beta 1000", first(2), 1e6, 160, 1000, 4);
    // Of weak concrete soon nothing is left in place: its first stones tell.
    const std::vector<Statistics> weak =
        table(runs, "0.3 MPa, 20 stones, nothing wears", first(3), 0.3e6, 20, 1e-3, 8);

    std::vector<Curve> curves;
    const std::vector<Real> strengths{0.3, 0.5, 0.7, 1, 1.5, 2.7};
    std::cout << "\n## Bonds broken by 20 stones, nothing wears\n\n| MPa |";
    for (const Level& how : first(3)) {
        curves.push_back({.title = how.title, .x = {}, .y = {}});
        std::cout << " " << how.title << " |";
    }
    std::cout << "\n|---|---|---|---|---|\n";
    for (const Real tensile : strengths) {
        std::cout << "| " << tensile << " |";
        for (std::size_t n = 0; n < curves.size(); ++n) {
            const Level how = first(3)[n];
            const std::string label = to_text(tensile) + " MPa, 20 stones, nothing wears, " + how.title;
            runs.make(label, struck(how, 1e6 * tensile, 20, 1e-3), 8);
            const Statistics s = runs.of(label);
            std::cout << " " << spread(s, &PatchAnswers::bonds_broken) << " |" << std::flush;
            curves[n].x.push_back(tensile), curves[n].y.push_back(s.mean.bonds_broken);
        }
        std::cout << "\n";
    }
    draw(LineChart{.title = "Bonds that 20 stones break",
                   .x = {.label = "tensile strength", .unit = "MPa", .logarithmic = true},
                   .y = {.label = "bonds broken", .unit = "-", .min = 0.0},
                   .curves = curves},
         folder / "loosened_bonds.png");

    const nlohmann::ordered_json summary{
        {"sound_loosened_static", sound.front().mean.loosened},
        {"sound_loosened_dynamic", sound.back().mean.loosened},
        {"sound_worn_static_over_dynamic", sound.front().mean.worn / sound.back().mean.worn},
        {"weak_broken_static_over_dynamic", weak.front().mean.bonds_broken / weak.back().mean.bonds_broken}};
    std::ofstream(folder / "summary.json") << summary.dump(2) << "\n";
    std::cout << "\n" << summary.dump(2) << "\n";
}
