// How large may a time step be, and what happens beyond?
//
//   bench/charts/run stability [--out FOLDER]
//
// The largest stable step of a pair, a row, a crystal, a poured packing and a stack of clumps, with and
// without damping and friction, by bisection on whether disturbances grow; against 2/omega and against what
// the library predicts. Then where runs go wrong: tunnelling, lost tangential memory, energy drift.

#include "../../examples/common/textbook.hpp"
#include "panels.hpp"
#include "stability_failures.hpp"

using namespace abrade;
using namespace abrade::charts;
using namespace abrade::examples;

namespace {

struct Row {
    std::string bed{}, law{};
    Real restitution = 1, friction = 0;
    Real measured = 0, predicted = 0;  ///< stable steps [s]
    Real unit = 0;  ///< 2/omega of two such bodies at the stiffest contact, omega^2 = 2 k/m [s]
};

template <class MakeLaw>
void measure(std::vector<Row>& rows, const std::string& name, const Bed& bed, const std::string& law_name,
             const MakeLaw& make_law) {
    for (const Real friction : {0.0, 1e6})
        for (const Real restitution : {1.0, 0.9, 0.7, 0.5, 0.3, 0.1}) {
            const auto law = make_law(restitution, friction);
            using C = std::remove_const_t<decltype(law)>;
            Row row{.bed = name, .law = law_name, .restitution = restitution, .friction = friction};
            row.predicted = Shaken<C>(bed, law).predicted();
            row.measured = measured_limit(bed, law, row.predicted, 1000);
            const auto elastic = make_law(1, 0);
            row.unit = 2 / std::sqrt(2 * Shaken<C>(bed, elastic).stiffest() / bed.bodies[0].mass());
            rows.push_back(row);
        }
}

std::string number(Real value) { return short_text(value); }

Summary stability(const OutputFolder& folder) {
    const Clump ball = make_clump("ball", {{Vec3::Zero(), 0.5 * ball_diameter}});
    const std::vector<std::string> beds{"pair", "row of 20", "crystal", "poured packing", "clumps"};
    std::vector<Row> rows;
    const auto all = [&](const std::string& law_name, const auto& law) {
        measure(rows, beds[0], pair_bed(), law_name, law);
        measure(rows, beds[1], row_bed(20), law_name, law);
        measure(rows, beds[2], crystal_bed(2), law_name, law);
        measure(rows, beds[3], poured_bed(ball, 1.05 * ball_diameter, 3, law(0.5, 0.0)), law_name, law);
        measure(rows, beds[4], clump_bed(), law_name, law);
    };
    all("LinearSpring", linear_law);
    all("HertzMindlin", hertz_law);

    std::ofstream csv(folder.path("limits.csv")), markdown(folder.path("tables.md"));
    csv << "bed,law,restitution,friction,measured_s,predicted_s,two_over_omega_s\n";
    for (const Row& row : rows)
        csv << row.bed << "," << row.law << "," << row.restitution << "," << row.friction << ","
            << number(row.measured) << "," << number(row.predicted) << "," << number(row.unit) << "\n";
    markdown << "Predicted over measured.\n\n| law | bed | smooth, e = 1 | 0.5 | 0.1 | sticking, e = 1 | 0.5 "
                "| 0.1 "
                "|\n|---|---|---|---|---|---|---|---|\n";
    Real highest = 0, lowest = 1e9;
    for (const Row& row : rows) {
        const Real share = row.predicted / row.measured;
        highest = std::max(highest, share), lowest = std::min(lowest, share);
    }
    for (const char* law : {"LinearSpring", "HertzMindlin"})
        for (const std::string& bed : beds) {
            markdown << "| " << law << " | " << bed << " |";
            for (const Real friction : {0.0, 1e6})
                for (const Real e : {1.0, 0.5, 0.1})
                    for (const Row& row : rows)
                        if (row.law == law && row.bed == bed && row.friction == friction &&
                            row.restitution == e)
                            markdown << " " << number(row.predicted / row.measured) << " |";
            markdown << "\n";
        }

    PanelChart map{.title = "Largest stable step, measured, over 2/omega of a lone elastic contact",
                   .x = {.label = "restitution", .min = 0.05, .max = 1.05},
                   .y = {.label = "step over 2/omega", .min = 0.005, .max = 3, .logarithmic = true},
                   .names = beds};
    PanelChart shares{.title = "Predicted over measured stable step: must lie between 0.5 and 1",
                      .x = map.x,
                      .y = {.label = "predicted / measured", .min = 0.4, .max = 1.1},
                      .names = beds};
    for (const char* law : {"LinearSpring", "HertzMindlin"})
        for (const Real friction : {0.0, 1e6}) {
            Panel steps{.title = std::string(law) + (friction > 0 ? ", sticking" : ", smooth")};
            Panel share{.title = steps.title};
            for (const std::string& bed : beds) {
                Curve step, ratio;
                for (const Row& row : rows)
                    if (row.law == law && row.bed == bed && row.friction == friction) {
                        step.x.push_back(row.restitution), step.y.push_back(row.measured / row.unit);
                        ratio.x.push_back(row.restitution), ratio.y.push_back(row.predicted / row.measured);
                    }
                steps.curves.push_back(step), share.curves.push_back(ratio);
            }
            map.panels.push_back(steps), shares.panels.push_back(share);
        }
    draw(map, folder.path("stability_map.png"));
    draw(shares, folder.path("stability_predicted.png"));

    std::vector<int> marks;
    for (Real n = 10; n < 1.01e6; n *= std::sqrt(10.0)) marks.push_back(static_cast<int>(std::lround(n)));
    PanelChart drift{.title = "Largest error of the energy so far, undamped, omega dt = 0.1",
                     .x = {.label = "steps", .min = 8, .max = 1.3e6, .logarithmic = true},
                     .y = {.label = "share of the energy", .min = 1e-8, .max = 10, .logarithmic = true},
                     .names = {"the engine", "symplectic Euler", "symplectic, 4th order", "Runge-Kutta 4",
                               "explicit Euler"},
                     .columns = 1,
                     .panel_width = 900};
    Panel panel{.title = "a ball between two fixed ones; an oscillator"};
    const auto add = [&](const std::vector<Real>& errors) {
        Curve curve;
        for (std::size_t n = 0; n < marks.size(); ++n)
            if (errors[n] < 10) curve.x.push_back(marks[n]), curve.y.push_back(errors[n]);
        panel.curves.push_back(curve);
        return errors.back();
    };
    Summary summary{{"predicted_over_measured_lowest", lowest}, {"predicted_over_measured_highest", highest}};
    summary["energy_error_after_1e6_steps: engine"] = add(engine_errors(marks));
    summary["energy_error_after_1e6_steps: symplectic Euler"] = add(energy_errors<SymplecticEuler>(marks));
    summary["energy_error_after_1e6_steps: symplectic, 4th order"] = add(energy_errors<McLachlan4>(marks));
    summary["energy_error_after_1e6_steps: Runge-Kutta 4"] = add(energy_errors<RungeKutta4>(marks));
    add(euler_errors(marks));
    drift.panels.push_back(panel);
    draw(drift, folder.path("stability_drift.png"));

    markdown << "\nSpeed of parting over speed of approach against the speed over r sqrt(8 k/m).\n\n| speed "
                "| parting "
                "|\n|---|---|\n";
    for (const Real share : {0.1, 0.5, 0.9, 0.99, 1.01, 1.1, 2.0})
        markdown << "| " << number(share) << " | " << number(parting_speed(share)) << " |\n";
    markdown << "\nA stone on an incline of 10 degrees, friction 0.5, half a second.\n\n| memory | slid, mm "
                "| expected, mm "
                "| integration residue over the work of gravity |\n|---|---|---|---|\n";
    for (const Keeping keeping : {Keeping::once_a_step, Keeping::never}) {
        const Rest rest = rest_on_incline(keeping);
        const bool kept = keeping == Keeping::once_a_step;
        markdown << "| " << (kept ? "kept once a step" : "dropped") << " | " << number(1e3 * rest.slid)
                 << " | " << number(kept ? 0 : 1e3 * rest.creep * rest.duration) << " | "
                 << number(kept ? 0 : rest.residue) << " |\n";
        summary[kept ? "slid_with_memory_m" : "slid_without_memory_m"] = rest.slid;
    }
    csv.close(), markdown.close();
    if (!csv || !markdown) throw FileError("cannot write the tables of the stability chart");
    return summary;
}

}  // namespace

int main(int argc, char** argv) {
    return textbook_main(argc, argv, "charts/stability",
                         "How large may a time step be, and what happens beyond?", stability);
}
