#pragma once
// Few collisions that wear much against many that wear little: time acceleration beta with each way of
// overflow against beta = 1, on a patch worn three cells deep. Part of wear_mesh.cpp.

#include "../../examples/common/charts.hpp"
#include "panels.hpp"
#include "patch_runs.hpp"

#include <nlohmann/json.hpp>

#include <iomanip>

namespace abrade::charts {

class BetaChart {
public:
    BetaChart(const std::filesystem::path& folder, PatchRuns& runs) : folder_(folder), runs_(runs) {}

    /// Prints the table, draws the pictures; returns what belongs in the summary.
    nlohmann::ordered_json make() {
        const Way usual = default_way();
        const Statistics truth = truth_of(usual);
        const Real safe = std::floor(guard(truth.mean, 1));
        std::cout
            << "\n## Against many collisions that wear little: beta 1, " << truth.mean.fed << " stones, "
            << 1e3 * truth.mean.mean_depth << " mm deep in the mean, " << truth.mean.mean_depth / cell
            << " cells; the guard calls beta " << safe
            << " safe\n\n| way | beta | removed | impact share | profile: rms difference | of it from "
               "scatter | deepest square | overflow, % | largest share | guard: safe beta | seeds | core, "
               "s |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";
        for (const Way& way : ways()) print(way, 1, truth_of(way));
        for (const Way& way : ways())
            for (const Real beta : betas) print(way, beta, of(way, beta));

        const Statistics s = of(usual, safe);
        print(usual, safe, s);
        const Ratio removed = ratio(s, safe, truth, &PatchAnswers::removed, true),
                    share = ratio(s, safe, truth, &PatchAnswers::impact_share, false);
        const Difference profile = difference(s, safe, truth);
        draw_ratios();
        draw_profiles();
        return {
            {"beta_truth_error_relative", std::max({std::abs(removed.value - 1), std::abs(share.value - 1)})},
            {"beta_safe", safe},
            {"beta_safe_removed_over_truth", removed.value},
            {"beta_safe_removed_standard_error", removed.error},
            {"beta_safe_impact_share_over_truth", share.value},
            {"beta_safe_impact_share_standard_error", share.error},
            {"beta_safe_profile_rms_relative", profile.rms},
            {"beta_safe_profile_rms_of_scatter", profile.scatter},
            {"beta_truth_cells_deep", truth.mean.mean_depth / cell},
            {"beta_truth_seeds", truth.seeds}};
    }

private:
    static constexpr Real cell = 0.005;      // [m]
    static constexpr Real product = 80'000;  // beta times stones
    static constexpr int truth_seeds = 2;
    static constexpr std::array<Real, 4> betas{10, 100, 1000, 5000};

    struct Way {
        std::string title;
        WornOut worn_out;
        Overflow overflow;
    };
    static const std::vector<Way>& ways() {
        static const std::vector<Way> all{
            {"crater", WornOut::fines, FillCrater{}},
            {"patch", WornOut::fines, SpreadOverPatch{.length = 0.03, .width = 0.03}},
            {"epoch", WornOut::fines, SpreadByEpoch{.length = 0.05, .every = 0.3}},
            {"dropped", WornOut::fines, DropOverflow{}},
            {"recedes, crater", WornOut::recedes, FillCrater{}},
            {"recedes, patch", WornOut::recedes, SpreadOverPatch{.length = 0.03, .width = 0.03}},
            {"recedes, epoch", WornOut::recedes, SpreadByEpoch{.length = 0.05, .every = 0.3}},
        };
        return all;
    }
    /// Throws std::out_of_range where the library's default is none of the ways.
    static Way default_way() {
        const ConcreteBlock block;
        for (const Way& way : ways())
            if (way.worn_out == block.worn_out && way.overflow.index() == block.overflow.index()) return way;
        throw std::out_of_range("BetaChart: the default of ConcreteBlock is not among the ways");
    }

    /// Bonds that hold whatever is left of a sphere: spheres leave as they are worn out, or as they hang
    /// free.
    static Patch patch(const Way& way, Real beta) {
        Patch one{.side = 0.1,
                  .stones = static_cast<int>(std::lround(product / beta)),
                  .interval = 0.004,
                  .tail = 0.5,
                  .stone_size = 0.03,
                  .along = 1.35,
                  .down = 2.7,
                  .dashpot = false,
                  .level = ConcreteLevel::quasi_static,
                  .worn_out = way.worn_out,
                  .overflow = way.overflow};
        one.lattice = {.sphere_diameter = cell, .layers = 16};
        one.bond.tensile = 1e12;
        one.wear.acceleration = beta;
        return one;
    }
    /// So many that standard errors are some 3 %.
    static int seeds(Real beta) { return beta < 50 ? 3 : beta < 500 ? 8 : beta < 2000 ? 32 : 150; }

    Statistics of(const Way& way, Real beta) {
        const std::string label = way.title + ", beta " + to_text(beta);
        runs_.make(label, patch(way, beta), seeds(beta));
        return runs_.of(label);
    }
    /// At beta = 1 excess is next to nothing, so its way does not matter: craters.
    Statistics truth_of(const Way& way) {
        static constexpr std::array<const char*, 4> names{"fines", "grain", "recorded", "recedes"};
        const std::string label = std::string("beta 1, ") + names.at(static_cast<std::size_t>(way.worn_out));
        runs_.make(label, patch({"", way.worn_out, FillCrater{}}, 1), truth_seeds);
        return runs_.of(label);
    }
    static Real guard(const PatchAnswers& a, Real beta) {
        return Concrete::safe_collision_share * beta / a.share;
    }

    struct Ratio {
        Real value = 1, error = 0;
    };
    /// Of a mean over that of the truth; volumes are over beta.
    static Ratio ratio(const Statistics& s, Real beta, const Statistics& truth, Real PatchAnswers::*of,
                       bool per_beta) {
        const Real value = s.mean.*of / (truth.mean.*of * (per_beta ? beta : 1));
        return {value, value * std::hypot(s.standard_error(of) / (s.mean.*of),
                                          truth.standard_error(of) / (truth.mean.*of))};
    }
    struct Difference {
        Real rms = 0;      ///< of the mean profiles across, over the truth's mean [-]
        Real scatter = 0;  ///< what the standard errors of both alone would make of it [-]
    };
    static Difference difference(const Statistics& s, Real beta, const Statistics& truth) {
        const Real per_stone = truth.mean.fed / (s.mean.fed * beta);  // a stone may have found no room
        Difference found;
        Real mean = 0;
        for (std::size_t n = 0; n < PatchAnswers::places; ++n) {
            const Real one = s.mean.profile[n] * per_stone, other = truth.mean.profile[n];
            found.rms += square(one - other), mean += other / PatchAnswers::places;
            found.scatter += square(s.deviation.profile[n] * per_stone) / s.seeds +
                             square(truth.deviation.profile[n]) / truth.seeds;
        }
        for (Real* each : {&found.rms, &found.scatter})
            *each = std::sqrt(*each / PatchAnswers::places) / mean;
        return found;
    }

    void print(const Way& way, Real beta, const Statistics& s) {
        const Statistics truth = truth_of(way);
        const Ratio removed = ratio(s, beta, truth, &PatchAnswers::removed, true),
                    share = ratio(s, beta, truth, &PatchAnswers::impact_share, false);
        const Difference profile = difference(s, beta, truth);
        const PatchAnswers& a = s.mean;
        std::cout << std::setprecision(3) << "| " << (beta == 1 ? "truth of " : "") << way.title << " | "
                  << beta << " | " << removed.value << " +- " << std::setprecision(2) << removed.error
                  << " | " << std::setprecision(3) << share.value << " +- " << std::setprecision(2)
                  << share.error << " | " << profile.rms << " | " << profile.scatter << " | "
                  << std::setprecision(3)
                  << a.max_depth / (beta * a.fed) / (truth.mean.max_depth / truth.mean.fed) << " | "
                  << 100 * a.overflow / (a.overflow + a.worn) << " | " << a.share << " | " << guard(a, beta)
                  << " | " << s.seeds_text() << " | " << a.processor << " |\n"
                  << std::flush;
    }

    void draw_ratios() {
        using namespace examples;
        PanelChart chart{.title = "Over the same at beta = 1; the patch is worn three cells of 5 mm deep",
                         .x = {.label = "time acceleration beta",
                               .unit = "-",
                               .min = 0.8,
                               .max = 8000,
                               .logarithmic = true},
                         .y = {.label = "over beta = 1", .unit = "-", .min = 0.0, .max = 1.8},
                         .columns = 3,
                         .panel_width = 420};
        Panel removed{.title = "volume removed"}, share{.title = "share of impacts"},
            profile{.title = "profile across: rms difference"};
        for (const Way& way : ways()) {
            chart.names.push_back(way.title);
            const Statistics truth = truth_of(way);
            Curve a{.x = {1}, .y = {1}}, b = a, c{.x = {1}, .y = {0}};
            for (const Real beta : betas) {
                const Statistics s = of(way, beta);
                for (Curve* each : {&a, &b, &c}) each->x.push_back(beta);
                a.y.push_back(ratio(s, beta, truth, &PatchAnswers::removed, true).value);
                b.y.push_back(ratio(s, beta, truth, &PatchAnswers::impact_share, false).value);
                c.y.push_back(difference(s, beta, truth).rms);
            }
            removed.curves.push_back(a), share.curves.push_back(b), profile.curves.push_back(c);
        }
        chart.panels = {removed, share, profile};
        draw(chart, folder_ / "wear_mesh_beta.png");
    }

    void draw_profiles() {
        using namespace examples;
        const Real side = patch(ways().front(), 1).side;
        PanelChart chart{.title = "Depth across the patch, mean along it and over seeds",
                         .x = {.label = "across", .unit = "m", .min = -0.5 * side, .max = 0.5 * side},
                         .y = {.label = "depth", .unit = "mm", .min = 0.0},
                         .names = {"beta 1"},
                         .panel_width = 520,
                         .panel_height = 330};
        for (const Real beta : betas) chart.names.push_back("beta " + to_text(beta));
        for (const Way& way : ways()) {
            Panel panel{.title = way.title};
            const auto add = [&](const Statistics& s, Real beta) {
                Curve& curve = panel.curves.emplace_back();
                for (std::size_t n = 0; n < PatchAnswers::places; ++n) {
                    curve.x.push_back(((static_cast<Real>(n) + 0.5) / PatchAnswers::places - 0.5) * side);
                    curve.y.push_back(1e3 * s.mean.profile[n] * product / (s.mean.fed * beta));
                }
            };
            add(truth_of(way), 1);
            for (const Real beta : betas) add(of(way, beta), beta);
            chart.panels.push_back(panel);
        }
        draw(chart, folder_ / "wear_mesh_profiles.png");
    }

    std::filesystem::path folder_;
    PatchRuns& runs_;
};

}  // namespace abrade::charts
