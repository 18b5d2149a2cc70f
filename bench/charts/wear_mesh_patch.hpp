#pragma once
// What stones wear off a patch and lose on it, against how the concrete is cut and computed and against
// stiffness: part of wear_mesh.cpp.

#include "../../examples/common/charts.hpp"
#include "patch_runs.hpp"

#include <nlohmann/json.hpp>

#include <iomanip>

namespace abrade::charts {

/// A patch on which nothing wears out or comes loose: beta = 1, and bonds that hold, so that the bed stays
/// the same for all.
inline Patch fresh_patch(Real sphere_diameter, ConcreteLevel level, Real stiffness = 1, Real bonds = 1) {
    Patch patch{.stones = 160, .tail = 0.4, .dashpot = false, .level = level};
    patch.lattice = {.sphere_diameter = sphere_diameter,
                     .layers = static_cast<Index>(std::lround(0.06 / sphere_diameter))};
    patch.contact.stiffness *= stiffness;
    patch.bond.stiffness = bonds * patch.contact.stiffness;
    patch.bond.tensile = 1e12;
    patch.wear.acceleration = 1;
    return patch;
}

class PatchChart {
public:
    /// `slow_seeds`: of the setting that takes half an hour a run; those that are there already count in any
    /// case.
    PatchChart(const std::filesystem::path& folder, PatchRuns& runs, int slow_seeds)
        : folder_(folder), runs_(runs), rows_(all_rows(slow_seeds)) {
        for (const Row& row : rows_) runs_.make(row.label(), row.patch(), row.seeds);
        std::erase_if(rows_, [&](const Row& row) { return runs_.of(row.label()).seeds == 0; });
    }

    /// Prints the table, draws the picture; returns what belongs in the summary.
    nlohmann::ordered_json make() {
        std::cout
            << "\n## A patch that stones strike and slide over\n\n| concrete | stiffness x | worn, mm3 a "
               "stone | lost in impacts, mJ | in sliding, mJ | impact share | bonds broken | let go | "
               "seeds | core, s |\n|---|---|---|---|---|---|---|---|---|---|\n";
        Real least = std::numeric_limits<Real>::infinity(), most = 0, error = 0;
        for (const Row& row : rows_) {
            const Statistics s = runs_.of(row.label());
            std::cout << "| " << row.title << " | " << row.stiffness << " | "
                      << text(s, &PatchAnswers::worn, 1e9) << " | "
                      << text(s, &PatchAnswers::lost_normal, 1e3) << " | "
                      << text(s, &PatchAnswers::lost_sliding, 1e3) << " | "
                      << text(s, &PatchAnswers::impact_share, 1) << " | " << std::setprecision(2)
                      << s.mean.bonds_broken << " | " << s.mean.grains << " | " << s.seeds_text() << " | "
                      << s.mean.processor << " |\n"
                      << std::flush;
            if (!row.counts()) continue;
            error = std::max(error, s.standard_error(&PatchAnswers::worn) / s.mean.worn);
            if (row.stiffness != 1) continue;
            least = std::min(least, s.mean.worn), most = std::max(most, s.mean.worn);
        }
        nlohmann::ordered_json summary{{"patch_worn_spread_relative", most / least - 1},
                                       {"patch_worn_largest_standard_error_relative", error}};
        std::cout << "\nLargest relative difference of worn volume, and largest difference of worn volume, "
                     "losses and impact share in standard errors:\n\n";
        compare(summary, "levels", &Row::sphere_diameter, &Row::stiffness);
        compare(summary, "sizes", &Row::level, &Row::stiffness);
        compare(summary, "stiffness", &Row::level, &Row::sphere_diameter);
        draw_stiffness();
        return summary;
    }

private:
    struct Row {
        std::string title;
        Real sphere_diameter;
        ConcreteLevel level;
        int seeds;
        Real stiffness = 1;  ///< of contacts, over 2e6 N/m
        Real bonds = 1;      ///< their stiffness over that of contacts

        std::string label() const { return title + ", stiffness x" + to_text(stiffness); }
        /// Spheres of other sizes show where the sizes in question stand.
        bool counts() const { return sphere_diameter == 0.02 || sphere_diameter == 0.01; }
        Patch patch() const { return fresh_patch(sphere_diameter, level, stiffness, bonds); }
    };
    static std::vector<Row> all_rows(int slow_seeds) {
        using enum ConcreteLevel;
        return {
            {"static, 0.02 m", 0.02, quasi_static, 16},
            {"static, 0.01 m", 0.01, quasi_static, 16},
            {"rigid, 0.02 m", 0.02, rigid, 16},
            {"rigid, 0.01 m", 0.01, rigid, 16},
            {"dynamic, bonds x64, 0.02 m", 0.02, dynamic, 8, 1, 64},
            {"dynamic, bonds x64, 0.01 m", 0.01, dynamic, slow_seeds, 1, 64},
            {"static, 0.04 m", 0.04, quasi_static, 16},
            {"static, 0.005 m", 0.005, quasi_static, 16},
            {"static, 0.02 m", 0.02, quasi_static, 16, 4},
            {"static, 0.02 m", 0.02, quasi_static, 16, 16},
            {"static, 0.02 m", 0.02, quasi_static, 16, 64},
            {"static, 0.01 m", 0.01, quasi_static, 16, 4},
            {"static, 0.01 m", 0.01, quasi_static, 16, 16},
            {"static, 0.01 m", 0.01, quasi_static, 16, 64},
            {"dynamic, bonds x64, 0.02 m", 0.02, dynamic, 8, 0.25, 64},
        };
    }

    /// Compares rows that have both of `same` in common.
    void compare(nlohmann::ordered_json& summary, const std::string& what, auto Row::*same,
                 auto Row::*same_too) const {
        Real relative = 0, worn = 0, shares = 0;
        for (const Row& one : rows_)
            for (const Row& other : rows_) {
                if (&one >= &other || !one.counts() || !other.counts()) continue;
                if (one.*same != other.*same || one.*same_too != other.*same_too) continue;
                const Statistics a = runs_.of(one.label()), b = runs_.of(other.label());
                relative = std::max(relative, std::abs(a.mean.worn / b.mean.worn - 1));
                worn = std::max(worn, in_errors(a, b, &PatchAnswers::worn));
                for (const auto of :
                     {&PatchAnswers::impact_share, &PatchAnswers::lost_normal, &PatchAnswers::lost_sliding})
                    shares = std::max(shares, in_errors(a, b, of));
            }
        std::cout << "- " << what << ": " << relative << "; " << worn << ", " << shares << "\n";
        const std::string name = "patch_" + what + "_";
        summary[name + "worn_relative"] = relative;
        summary[name + "worn_standard_errors"] = worn;
        summary[name + "shares_standard_errors"] = shares;
    }
    /// Distance of two means over the standard error of their difference [-].
    static Real in_errors(const Statistics& a, const Statistics& b, Real PatchAnswers::*of) {
        const Real error = std::hypot(a.standard_error(of), b.standard_error(of));
        return error > 0 ? std::abs(a.mean.*of - b.mean.*of) / error : 0;
    }
    static std::string text(const Statistics& s, Real PatchAnswers::*of, Real unit) {
        std::ostringstream out;
        out << std::setprecision(3) << unit * s.mean.*of << " +- " << std::setprecision(2)
            << unit * s.standard_error(of);
        return out.str();
    }

    void draw_stiffness() const {
        using namespace examples;
        LineChart chart{.title = "Worn volume against stiffness, contacts and bonds together",
                        .x = {.label = "contact stiffness", .unit = "N/m", .logarithmic = true},
                        .y = {.label = "worn per stone", .unit = "mm3", .min = 0.0}};
        for (const Row& row : rows_) {
            const auto known = [&](const Curve& curve) { return curve.title == row.title; };
            if (row.level == ConcreteLevel::rigid) continue;  // as static
            if (std::any_of(chart.curves.begin(), chart.curves.end(), known)) continue;
            std::vector<Row> same;
            for (const Row& other : rows_)
                if (other.title == row.title) same.push_back(other);
            std::sort(same.begin(), same.end(),
                      [](const Row& a, const Row& b) { return a.stiffness < b.stiffness; });
            Curve curve{.title = row.title, .style = same.size() > 1 ? CurveStyle::line : CurveStyle::points};
            Band band{.title = "two standard errors of " + row.title, .x = {}, .low = {}, .high = {}};
            for (const Row& one : same) {
                const Statistics s = runs_.of(one.label());
                const Real worn = 1e9 * s.mean.worn, error = 2e9 * s.standard_error(&PatchAnswers::worn);
                curve.x.push_back(one.patch().contact.stiffness), curve.y.push_back(worn);
                band.low.push_back(worn - error), band.high.push_back(worn + error);
            }
            band.x = curve.x;
            if (chart.bands.empty()) chart.bands.push_back(band);
            chart.curves.push_back(curve);
        }
        draw(chart, folder_ / "wear_mesh_patch.png");
    }

    std::filesystem::path folder_;
    PatchRuns& runs_;
    std::vector<Row> rows_;  ///< that have results
};

}  // namespace abrade::charts
