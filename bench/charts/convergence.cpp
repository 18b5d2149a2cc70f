// Draws the pictures of docs/verification/convergence.md and prints its first tables: chart_convergence [FOLDER [SEEDS]].
// The folder is made where it is not.
//
// Its runs take a quarter of an hour. What they gave is kept in FOLDER as convergence.csv, and taken from
// there the next time.

#include "../../examples/common/charts.hpp"
#include "panels.hpp"
#include "patch_runs.hpp"

#include <iomanip>
#include <iostream>

using namespace abrade;
using namespace abrade::charts;
using abrade::examples::Curve;

namespace {

/// One setting of the patch, compared with the setting named `base`.
struct Case {
    std::string group, label, base;
    Patch patch{};
    Real factor = 1;  ///< of what is varied, over the base's
    int seeds = 3;
};

constexpr Real worn_out = 1000;  ///< beta at which cells are used up and bonds break

std::vector<Case> all_cases(int seeds) {
    std::vector<Case> cases{{"base", "as it is", "as it is", {}, 1, 2 * seeds}};
    const auto add = [&](const std::string& group, const std::string& label, Real factor, auto&& set,
                         const std::string& base = "as it is") {
        Case one{group, label, base, {}, factor, seeds};
        set(one.patch);
        cases.push_back(one);
    };
    for (const Real f : {0.25, 4.0, 16.0})
        add("contact stiffness", "contact stiffness x " + to_text(f), f,
            [&](Patch& p) { p.contact.stiffness *= f; });
    for (const Real f : {0.25, 4.0, 16.0, 200.0})
        add("bond stiffness", "bond stiffness x " + to_text(f), f, [&](Patch& p) { p.bond.stiffness *= f; });
    for (const Real f : {0.25, 4.0, 16.0})
        add("both stiffnesses", "both stiffnesses x " + to_text(f), f,
            [&](Patch& p) { p.contact.stiffness *= f, p.bond.stiffness *= f; });
    for (const Real safety : {0.2, 0.4, 1.0})
        add("time step", to_text(safety) + " of the stable step", safety / Patch{}.safety,
            [&](Patch& p) { p.safety = safety; });
    // The same block: thickness, modulus E = k / d and density stay.
    const std::string medium = "spheres of 0.02 m, 6 layers";
    for (const LatticeSize& size : {LatticeSize{0.04, 3}, LatticeSize{0.02, 6}, LatticeSize{0.01, 12}}) {
        const Real factor = size.sphere_diameter / 0.02;
        add(
            "sphere size",
            "spheres of " + to_text(size.sphere_diameter) + " m, " + std::to_string(size.layers) + " layers",
            factor,
            [&](Patch& p) {
                p.lattice = size;
                p.bond.stiffness *= factor;
                p.wear.acceleration = 50, p.stones = 80;
            },
            medium);
    }
    for (const Real beta : {Patch{}.wear.acceleration, worn_out}) {
        const bool out = beta == worn_out;
        const std::string at = out ? ", worn out" : "", base = "as it is" + at;
        const auto choose = [&](const std::string& label, auto&& set) {
            add(
                "choice" + at, label + at, 1, [&](Patch& p) { p.wear.acceleration = beta, set(p); }, base);
        };
        if (out) choose("as it is", [](Patch&) {});
        choose("minimum in [3]", [](Patch& p) { p.bond.join = MohrCoulomb::Join::minimum; });
        choose("square area in [4]", [](Patch& p) { p.bond.area = MohrCoulomb::Area::square; });
        choose("V_omega is the sphere", [](Patch& p) { p.fracture_volume = FractureVolume::sphere; });
        choose("radius 0.02 m, 3 layers", [](Patch& p) {
            p.lattice.sphere_diameter = 0.04;
            p.bond.stiffness *= 2;
        });
        for (const Real phi : {25.0, 45.0})
            choose("friction angle of bonds " + to_text(phi), [&](Patch& p) { p.bond.friction_angle = phi; });
        choose("rigid concrete", [](Patch& p) { p.bonded = false; });
        if (out) continue;
        choose("rigid concrete, restitution 0.88",
               [](Patch& p) { p.bonded = false, p.contact.restitution = 0.88; });
        for (const Real zeta : {0.02, 0.5})
            choose("damping of bonds " + to_text(zeta), [&](Patch& p) { p.bond.damping = zeta; });
        for (const Real e : {0.3, 0.9})
            choose("restitution " + to_text(e), [&](Patch& p) { p.contact.restitution = e; });
        for (const Real mu : {0.3, 0.4})
            choose("friction of contacts " + to_text(mu), [&](Patch& p) { p.contact.friction = mu; });
    }
    return cases;
}

void print_tables(const std::vector<Case>& cases, PatchRuns& runs) {
    std::string group;
    for (const Case& c : cases) {
        if (c.group != group) {
            group = c.group;
            std::cout
                << "\n| " << group
                << " | worn, cm3 a stone | change | largest depth, mm | lost in impacts, J | in sliding, "
                   "J | bonds broken | overflow | largest share | core, s |\n"
                << "|---|---|---|---|---|---|---|---|---|---|\n";
        }
        const Statistics s = runs.of(c.label), b = runs.of(c.base);
        const std::string label =
            c.label + (s.failed > 0 ? " (" + std::to_string(s.failed) + " of " +
                                          std::to_string(s.seeds + s.failed) + " runs fail)"
                                    : "");
        const Real change = 100 * (s.mean.worn / b.mean.worn - 1);
        const Real error = 100 * s.mean.worn / b.mean.worn *
                           std::hypot(s.standard_error(&PatchAnswers::worn) / s.mean.worn,
                                      b.standard_error(&PatchAnswers::worn) / b.mean.worn);
        std::cout << std::setprecision(3) << "| " << label << " | " << 1e6 * s.mean.worn << " +- "
                  << 1e6 * s.standard_error(&PatchAnswers::worn) << " | ";
        if (c.label == c.base)
            std::cout << "sd " << 100 * s.deviation.worn / s.mean.worn << " %";
        else
            std::cout << std::showpos << change << std::noshowpos << " +- " << error << " %"
                      << (std::abs(change) > 2 * error ? " *" : "");
        std::cout << " | " << 1e3 * s.mean.max_depth << " +- "
                  << 1e3 * s.standard_error(&PatchAnswers::max_depth) << " | " << s.mean.lost_normal << " | "
                  << s.mean.lost_sliding << " | " << s.mean.bonds_broken << " +- "
                  << s.standard_error(&PatchAnswers::bonds_broken) << " | "
                  << 100 * s.mean.overflow / (s.mean.overflow + s.mean.worn) << " % | " << s.mean.share
                  << " | " << runs.fastest(c.label) << " |\n";
    }
}

constexpr std::string_view as_it_is = "as it is";

/// Of a group of cases: what each answer is over that of the base, against the factor.
Panel panel_of(const std::string& group, const std::vector<Case>& cases, const PatchRuns& runs) {
    static constexpr Real PatchAnswers::*answers[] = {&PatchAnswers::worn, &PatchAnswers::lost_normal,
                                                      &PatchAnswers::lost_sliding};
    Panel panel{group, std::vector<Curve>(std::size(answers))};
    std::map<Real, const Case*> in_order;
    for (const Case& c : cases)
        if (c.group == group) in_order[c.factor] = &c;
    if (!in_order.contains(1)) in_order[1] = &cases.front();
    for (const auto& [factor, c] : in_order)
        for (std::size_t n = 0; n < std::size(answers); ++n) {
            panel.curves[n].x.push_back(factor);
            panel.curves[n].y.push_back(runs.of(c->label).mean.*answers[n] /
                                        runs.of(c->base).mean.*answers[n]);
        }
    return panel;
}

void draw_numbers(const std::vector<Case>& cases, const PatchRuns& runs,
                  const std::filesystem::path& picture) {
    const Statistics base = runs.of(std::string(as_it_is));
    const Real scatter = base.deviation.worn / base.mean.worn;
    PanelChart chart{
        .title =
            "Wear and losses in concrete contacts over those of the base, against what is varied over "
            "its base",
        .x = {.label = "setting over the base's", .min = 0.1, .max = 300, .logarithmic = true},
        .y = {.label = "answer over the base's", .min = 0, .max = 4},
        .names = {"worn volume", "energy lost in impacts", "energy lost in sliding"},
        .slopes = {{0.1, 1 + scatter, 0, 1000, "a seed's"}, {0.1, 1 - scatter, 0, 1000, "scatter"}},
        .columns = 3,
        .panel_width = 400,
        .panel_height = 330};
    for (const char* group :
         {"contact stiffness", "bond stiffness", "both stiffnesses", "sphere size", "time step"})
        chart.panels.push_back(panel_of(group, cases, runs));
    draw(chart, picture);
}

/// Time of one core, of the fastest of all seeds.
void draw_costs(const std::vector<Case>& cases, const PatchRuns& runs, const std::filesystem::path& folder) {
    const std::pair<std::string, std::string> groups[] = {
        {"bonded, softer and stiffer bonds", "bond stiffness"},
        {"bonded, both springs softer and stiffer", "both stiffnesses"},
        {"bonded, other time steps", "time step"},
        {"rigid concrete", "choice"}};
    const auto points = [&](auto&& answer) {
        std::vector<Curve> curves;
        for (const auto& [title, group] : groups) {
            Curve curve{.title = title, .style = examples::CurveStyle::points};
            for (const Case& c : cases)
                if (c.group == group && (group != "choice" || c.label == "rigid concrete")) {
                    curve.x.push_back(runs.fastest(c.label));
                    curve.y.push_back(answer(runs.of(c.label).mean));
                }
            curves.push_back(curve);
        }
        curves.push_back({.title = "bonded, as it is",
                          .x = {runs.fastest(std::string(as_it_is))},
                          .y = {answer(runs.of(std::string(as_it_is)).mean)},
                          .style = examples::CurveStyle::points});
        return curves;
    };
    const examples::Axis cost{
        .label = "time of one core for a run", .unit = "s", .min = 0.2, .max = 20, .logarithmic = true};
    draw(examples::LineChart{.title = "Wear of rigid and of bonded concrete against what a run costs",
                             .x = cost,
                             .y = {.label = "worn volume a stone", .unit = "cm3", .min = 0, .max = 4},
                             .curves = points([](const PatchAnswers& a) { return 1e6 * a.worn; })},
         folder / "convergence_cost_wear.png");
    draw(examples::LineChart{.title = "Broken bonds against what a run costs",
                             .x = cost,
                             .y = {.label = "bonds broken", .min = 0},
                             .curves = points([](const PatchAnswers& a) { return a.bonds_broken; })},
         folder / "convergence_cost_bonds.png");
}

}  // namespace

int main(int argc, char** argv) {
    try {
        set_thread_count(1);
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/convergence";
        std::filesystem::create_directories(folder);
        const std::vector<Case> cases = all_cases(argc > 2 ? std::stoi(argv[2]) : 3);
        PatchRuns runs(folder / "convergence.csv");
        for (const Case& c : cases) runs.make(c.label, c.patch, c.seeds);
        print_tables(cases, runs);
        draw_numbers(cases, runs, folder / "convergence_numbers.png");
        draw_costs(cases, runs, folder);
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
