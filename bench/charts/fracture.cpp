// Concrete of small spheres that fractures, against concrete of large ones that a wear law wears (Fig. 1 of
// the paper on sub-particle abrasion): which blows break anything, what they take off, what it costs. Draws
// the pictures of docs/verification/fracture_or_wear.md, prints its tables and writes summary.json: chart_fracture
// [FOLDER].
//
// Its runs take some minutes. What they gave is kept in FOLDER as fracture.csv, and taken from there the
// next time; the series of blows are run each time.

#include "../../examples/common/charts.hpp"
#include "blow.hpp"
#include "panels.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <sstream>

using namespace abrade;
using namespace abrade::charts;
using namespace abrade::examples;

namespace {

/// Blows by name, kept in a table.
class BlowRuns {
public:
    explicit BlowRuns(std::filesystem::path table) : table_(std::move(table)) {
        std::ifstream file(table_);
        std::string line;
        std::getline(file, line);  // names of columns
        while (std::getline(file, line)) {
            std::istringstream text(line);
            std::string name, cell;
            std::getline(text, name, ';');
            BlowAnswers a;
            BlowAnswers::visit([&](const char*, auto member) {
                if (std::getline(text, cell, ';')) a.*member = std::stod(cell);
            });
            runs_[name] = a;
        }
    }

    const BlowAnswers& of(const Blow& blow) {
        const std::string name = name_of(blow);
        if (const auto known = runs_.find(name); known != runs_.end()) return known->second;
        const BlowAnswers a = runs_[name] = run(blow);
        std::ofstream file(table_, std::ios::app);
        if (file.tellp() == 0) {
            file << "blow";
            BlowAnswers::visit([&](const char* column, auto) { file << ';' << column; });
            file << '\n';
        }
        file << name;
        BlowAnswers::visit([&](const char*, auto member) { file << ';' << to_text(a.*member); });
        file << '\n';
        std::cerr << name << ": " << a.processor << " s\n";
        return runs_[name];
    }

private:
    static std::string name_of(const Blow& b) {
        std::string name = b.level == ConcreteLevel::dynamic ? "dynamic" : "quasi_static";
        name += b.wears ? ", wears" : ", fractures";
        for (const Real value :
             {b.diameter, static_cast<Real>(b.across), static_cast<Real>(b.layers), b.stone, b.speed, b.angle,
              b.in_hollow ? 1.0 : 0.0, b.contact_stiffness, b.safety})
            name += ", " + to_text(value);
        return name;
    }

    std::filesystem::path table_;
    std::map<std::string, BlowAnswers> runs_;
};

constexpr std::array<Real, 4> stones{0.02, 0.05, 0.1, 0.15};  ///< [m]

struct Model {
    std::string title;
    Blow blow;
};

/// Blocks of 2400 spheres, but for the coarsest ones.
const Model five{"5 mm", {.diameter = 0.005}};
const Model five_standing{"5 mm, quasi-static",
                          {.diameter = 0.005, .level = ConcreteLevel::quasi_static, .safety = 0.1}};
const Model fine{"2.5 mm", {.diameter = 0.0025}};
const Model coarse{"20 mm", {.diameter = 0.02, .across = 8, .layers = 4}};
const Model wearing{"sub-particle abrasion, 20 mm",
                    {.diameter = 0.02,
                     .across = 8,
                     .layers = 4,
                     .level = ConcreteLevel::quasi_static,
                     .wears = true,
                     .safety = 0.1}};

Blow struck(const Model& model, Real stone, Real speed, bool in_hollow = false) {
    Blow blow = model.blow;
    blow.stone = stone, blow.speed = speed, blow.in_hollow = in_hollow;
    return blow;
}

// --- the smallest blow that breaks anything -------------------------------------------------------------

/// The lowest speed [m/s], to 2 % from above, at which `happens(answers)`; NaN where none below `high` does.
template <class Happens>
Real threshold(BlowRuns& runs, const Model& model, Real stone, Real low, Real high, Happens&& happens) {
    const auto at = [&](Real speed) { return happens(runs.of(struck(model, stone, speed))); };
    while (!at(low * 2)) {
        low *= 2;
        if (2 * low > high) return std::numeric_limits<Real>::quiet_NaN();
    }
    Real above = 2 * low;
    while (above > 1.02 * low) {
        const Real middle = std::sqrt(low * above);
        (at(middle) ? above : low) = middle;
    }
    return above;
}

constexpr auto breaks_a_bond = [](const BlowAnswers& a) { return a.broken > 0; };
constexpr auto lets_go = [](const BlowAnswers& a) { return a.let_go > 0; };

struct Thresholds {
    Real worst_ratio = 0, least_ratio = 1e300;  ///< measured speed over closed form
};

Thresholds thresholds(BlowRuns& runs, const std::filesystem::path& folder) {
    Thresholds found;
    std::cout
        << "## Lowest speed of a blow on top of a sphere, m/s: the first bond breaks; the first sphere is "
           "let go\n\n| spheres | stone, m | closed form | breaks | over closed form | let go | energy of "
           "that blow, J |\n|---|---|---|---|---|---|---|\n";
    std::vector<Panel> panels;
    for (const Model& model : {fine, five, coarse, five_standing}) {
        const bool stands = model.blow.level != ConcreteLevel::dynamic;
        Curve estimate{.style = CurveStyle::dashed}, breaks, loose;
        for (const Real stone : stones) {
            if (model.title == fine.title && stone > 0.1) continue;
            const Real expected = struck(model, stone, 1).critical_speed();
            const Real first = threshold(runs, model, stone, 0.5 * expected, 16, breaks_a_bond);
            const Real let_go = stands ? std::numeric_limits<Real>::quiet_NaN()
                                       : threshold(runs, model, stone, 0.7 * first, 16, lets_go);
            // The closed form is that of a stone much heavier than the sphere that it strikes.
            if (stone > 2 * model.blow.diameter) {
                found.worst_ratio = std::max(found.worst_ratio, first / expected);
                found.least_ratio = std::min(found.least_ratio, first / expected);
            }
            std::cout << "| " << model.title << " | " << stone << " | " << short_text(expected) << " | "
                      << short_text(first) << " | " << short_text(first / expected) << " | "
                      << (std::isfinite(let_go) ? short_text(let_go) : "") << " | "
                      << (std::isfinite(let_go) ? short_text(struck(model, stone, let_go).energy()) : "")
                      << " |\n"
                      << std::flush;
            estimate.x.push_back(stone), estimate.y.push_back(expected);
            breaks.x.push_back(stone), breaks.y.push_back(first);
            loose.x.push_back(stone), loose.y.push_back(let_go);
        }
        if (!stands) panels.push_back({"spheres of " + model.title, {estimate, breaks, loose}});
    }
    draw(PanelChart{.title = "Lowest speed of a blow that fractures concrete of bonded spheres",
                    .x = {.label = "diameter of the stone",
                          .unit = "m",
                          .min = 0.015,
                          .max = 0.2,
                          .logarithmic = true},
                    .y = {.label = "speed", .unit = "m/s", .min = 0.01, .max = 20, .logarithmic = true},
                    .names = {"closed form of the first bond", "a bond breaks", "a sphere is let go"},
                    .panels = panels,
                    .columns = 3,
                    .panel_width = 330,
                    .panel_height = 380},
         folder / "fracture_threshold.png");
    return found;
}

// --- what one blow takes off ----------------------------------------------------------------------------

void one_blow(BlowRuns& runs, const std::filesystem::path& folder) {
    constexpr std::array<Real, 8> speeds{0.0625, 0.125, 0.25, 0.5, 1, 2, 4, 8};
    std::cout
        << "\n## One blow, mean of two places: on top of a sphere, and between four\n\n| model | stone, m "
           "| speed, m/s | energy, J | bonds broken | spheres let go | taken off, mm3 | over wear law | "
           "lost in contacts, share | in bonds | processor s |\n"
           "|---|---|---|---|---|---|---|---|---|---|---|\n";
    std::vector<Curve> volumes, bonds;
    for (const Model& model : {five, fine, five_standing, wearing}) {
        Curve volume{.title = model.blow.wears ? model.title : "fracture, " + model.title,
                     .x = {},
                     .y = {},
                     .style = CurveStyle::points};
        Curve broken = volume;
        for (const Real stone : stones) {
            if (model.title == fine.title && stone > 0.05) continue;
            for (const Real speed : speeds) {
                BlowAnswers mean;
                for (const bool hollow : {false, true}) {
                    const BlowAnswers& a = runs.of(struck(model, stone, speed, hollow));
                    BlowAnswers::visit([&](const char*, auto member) { mean.*member += 0.5 * a.*member; });
                }
                const Real law = Blow::abraded_volume(mean.energy);
                std::cout << "| " << model.title << " | " << stone << " | " << speed << " | "
                          << short_text(mean.energy) << " | ";
                if (mean.crushed > 0) {
                    std::cout << "| | ended: overlap | | | |\n";
                    continue;
                }
                std::cout << mean.broken << " | " << mean.let_go << " | " << short_text(1e9 * mean.removed)
                          << " | " << short_text(mean.removed / law) << " | "
                          << short_text(mean.lost_contact / mean.energy) << " | "
                          << short_text(mean.lost_bond / mean.energy) << " | " << short_text(mean.processor)
                          << " |\n"
                          << std::flush;
                if (mean.removed > 0) volume.x.push_back(mean.energy), volume.y.push_back(1e9 * mean.removed);
                if (mean.broken > 0) broken.x.push_back(mean.energy), broken.y.push_back(mean.broken);
            }
        }
        volumes.push_back(volume);
        if (!model.blow.wears) bonds.push_back(broken);
    }
    Curve law{.title = "C_w/2 (1 - e^2) E", .x = {1e-5, 100}, .y = {}};
    for (const Real energy : law.x) law.y.push_back(1e9 * Blow::abraded_volume(energy));
    volumes.push_back(law);
    draw(LineChart{.title = "What one blow takes off the concrete (blows that take nothing are not drawn)",
                   .x = {.label = "kinetic energy of the stone E",
                         .unit = "J",
                         .min = 1e-5,
                         .max = 100,
                         .logarithmic = true},
                   .y = {.label = "volume", .unit = "mm3", .logarithmic = true},
                   .curves = volumes},
         folder / "fracture_volume.png");
    draw(LineChart{.title = "Bonds that one blow breaks",
                   .x = {.label = "kinetic energy of the stone E",
                         .unit = "J",
                         .min = 1e-5,
                         .max = 100,
                         .logarithmic = true},
                   .y = {.label = "bonds", .logarithmic = true},
                   .curves = bonds},
         folder / "fracture_bonds.png");
}

// --- what it depends on: the contact's stiffness, an oblique blow ---------------------------------------

void stiffness_and_angle(BlowRuns& runs) {
    std::cout
        << "\n## Stiffness of the contact: spheres of 5 mm, a stone of 0.05 m\n\n| k_1, N/m | closed form, "
           "m/s | breaks | over closed form | let go |\n|---|---|---|---|---|\n";
    for (const Real stiffness : {2e6, 2e7, 2e8}) {
        Model model = five;
        model.blow.contact_stiffness = stiffness;
        const Real expected = struck(model, 0.05, 1).critical_speed();
        const Real first = threshold(runs, model, 0.05, 0.5 * expected, 16, breaks_a_bond);
        std::cout << "| " << stiffness << " | " << short_text(expected) << " | " << short_text(first) << " | "
                  << short_text(first / expected) << " | "
                  << short_text(threshold(runs, model, 0.05, 0.7 * first, 16, lets_go)) << " |\n"
                  << std::flush;
    }
    std::cout
        << "\n## Oblique blows on top of a sphere, 30 degrees\n\n| model | stone, m | speed, m/s | bonds "
           "broken | spheres let go | taken off, mm3 | processor s |\n|---|---|---|---|---|---|---|\n";
    for (const Model& model : {five, five_standing, wearing})
        for (const Real stone : {0.05, 0.1})
            for (const Real speed : {0.5, 1.0, 2.0, 4.0}) {
                Blow blow = struck(model, stone, speed);
                blow.angle = 30;
                const BlowAnswers& a = runs.of(blow);
                std::cout << "| " << model.title << " | " << stone << " | " << speed << " | ";
                if (a.crushed > 0)
                    std::cout << "| | ended: overlap | |\n";
                else
                    std::cout << a.broken << " | " << a.let_go << " | " << short_text(1e9 * a.removed)
                              << " | " << short_text(a.processor) << " |\n";
                std::cout << std::flush;
            }
}

// --- four stones at once: the scar ------------------------------------------------------------------------

/// Stones of 0.05 m at 4 m/s and 30 degrees, 58 mm apart give or take 5 mm.
struct Salvo {
    BlowAnswers answers;
    std::vector<Real> depth;  ///< [row x column] of the map [m]
    Real deepest = 0;         ///< [m]
};
constexpr int blows = 4;
constexpr Real map_side = 0.12, map_cell = 0.0025, end_time = 6e-3;  ///< [m], [m], [s]

Salvo salvo(Blow blow) {
    blow.stone = 0.05, blow.speed = 4, blow.angle = 30;
    Scene scene = blow.scene();
    for (int n = 0; n < blows; ++n) {
        const Real a = 0.7548776662466927 * n, b = 0.5698402909980532 * n;
        const Vec3 within(a - std::floor(a) - 0.5, b - std::floor(b) - 0.5, 0);
        const Vec3 at(n % 2 ? 0.029 : -0.029, n / 2 ? 0.029 : -0.029, 0);
        blow.add_stone(scene, at + 0.005 * within, 1e-4);
    }
    Salvo s;
    s.answers = blow.simulated(std::move(scene), [&](auto sim) {
        return answers_of(std::move(sim), end_time, blow.safety, [&](const auto& end) {
            const Concrete& concrete = end.concrete();
            const Lattice& lattice = concrete.lattice();
            const std::vector<Real> depth = concrete.depth();
            const auto cells = static_cast<std::size_t>(map_side / map_cell + 0.5);
            s.depth.assign(cells * cells, std::numeric_limits<Real>::quiet_NaN());
            for (std::size_t row = 0; row < cells; ++row)
                for (std::size_t column = 0; column < cells; ++column) {
                    const Real x = (static_cast<Real>(column) + 0.5) * map_cell - 0.5 * map_side,
                               y = (static_cast<Real>(row) + 0.5) * map_cell - 0.5 * map_side;
                    for (const LatticeSite& site : lattice.sites)
                        if (site.layer == 0 && std::abs(site.centre.x() - x) < lattice.radius &&
                            std::abs(site.centre.y() - y) < lattice.radius)
                            s.depth[row * cells + column] = depth[static_cast<std::size_t>(site.column)];
                }
            s.deepest = *std::max_element(depth.begin(), depth.end());
        });
    });
    return s;
}

void draw_scar(const Salvo& s, const std::string& title, const std::filesystem::path& picture) {
    std::vector<Real> in_mm = s.depth;
    for (Real& depth : in_mm) depth *= 1e3;
    const Axis along{.label = "along", .unit = "m", .min = -0.5 * map_side, .max = 0.5 * map_side};
    Axis across = along;
    across.label = "across";
    draw(ColourMap{.title = title,
                   .x = along,
                   .y = across,
                   .colour = {.label = "depth", .unit = "mm", .min = 0.0},
                   .columns = static_cast<std::size_t>(map_side / map_cell + 0.5),
                   .values = in_mm,
                   .equal_aspect = true,
                   .width = 800},
         picture);
}

void scars(const std::filesystem::path& folder) {
    std::cout
        << "\n## " << blows
        << " stones of 0.05 m at once, 4 m/s and 30 degrees\n\n| model | spheres | bonds broken | spheres "
           "let go | taken off, mm3 | deepest, mm | step, us | processor s | of a step, ns a sphere "
           "|\n|---|---|---|---|---|---|---|---|---|\n";
    const auto widened = [](Model model, Index across, bool wears) {
        model.blow.across = across, model.blow.wears = wears;
        return model;
    };
    Model wearing_fine = widened(five_standing, 24, true);
    wearing_fine.title = "sub-particle abrasion, 5 mm";
    for (const Model& model : {widened(five, 24, false), widened(five_standing, 24, false),
                               widened(wearing, 6, true), wearing_fine}) {
        const Salvo s = salvo(model.blow);
        const BlowAnswers& a = s.answers;
        const auto spheres = static_cast<Real>(model.blow.across * model.blow.across * model.blow.layers);
        std::cout << "| " << model.title << " | " << spheres << " | " << a.broken << " | " << a.let_go
                  << " | " << short_text(1e9 * a.removed) << " | " << short_text(1e3 * s.deepest) << " | "
                  << short_text(1e6 * end_time / a.steps) << " | " << short_text(a.processor) << " | "
                  << (model.blow.level == ConcreteLevel::dynamic
                          ? short_text(1e9 * a.processor / (a.steps * spheres))
                          : "")
                  << (a.crushed > 0 ? " ended: overlap" : "") << " |\n"
                  << std::flush;
        if (model.blow.level == ConcreteLevel::dynamic)
            draw_scar(s, "Four stones: 5 mm spheres that fracture", folder / "fracture_scar_spheres.png");
        if (model.title == wearing.title)
            draw_scar(s, "Four stones: sub-particle abrasion, 20 mm spheres",
                      folder / "fracture_scar_wear.png");
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/fracture";
    std::filesystem::create_directories(folder);
    BlowRuns runs(folder / "fracture.csv");
    const Thresholds found = thresholds(runs, folder);
    one_blow(runs, folder);
    stiffness_and_angle(runs);
    scars(folder);
    const nlohmann::ordered_json summary{{"threshold_over_closed_form_least", found.least_ratio},
                                         {"threshold_over_closed_form_largest", found.worst_ratio}};
    std::ofstream(folder / "summary.json") << summary.dump(2) << "\n";
    std::cout << "\n" << summary.dump(2) << "\n";
}
