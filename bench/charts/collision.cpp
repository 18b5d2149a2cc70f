// How wrong is the energy that a collision loses, and what does it cost to be less wrong?
//
//   bench/charts/run collision [--out FOLDER]
//
// Two spheres, two laws, four restitutions, six angles, six methods, of which one twice, 5 to 1000 steps a
// contact, 8 phases of the step in which they touch. Errors are against the reference solution
// (collision_reference.hpp), in shares of the kinetic energy brought into the collision.

#include "../../examples/common/textbook.hpp"
#include "../../tests/verification/collision_problem.hpp"
#include "panels.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <numeric>

using namespace abrade;
using namespace abrade::charts;
using namespace abrade::examples;
using namespace collision_problem;

namespace {

constexpr int some_phases = 8;
const std::vector<Real> restitutions{1, 0.8, 0.5, 0.2}, angles{0, 15, 30, 45, 60, 80};
const std::vector<Real> step_counts{5, 7, 10, 14, 20, 30, 50, 70, 100, 140, 200, 300, 500, 700, 1000};
const std::vector<Real> tolerances{1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12};
const std::string found_name = "Runge-Kutta 4, touch found";
const std::string adaptive_name = "Dormand-Prince, events found";
const std::vector<std::string> methods{PredictingVerlet::name, LaggedVerlet::name, SymplecticEuler::name,
                                       McLachlan4::name,       RungeKutta4::name,  found_name,
                                       adaptive_name};

struct Linear {
    static constexpr const char* title = "LinearSpring";
    static LinearSpring law(Real e) { return linear(e); }
};
struct Hertz {
    static constexpr const char* title = "HertzMindlin";
    static HertzMindlin law(Real e) { return hertz(e); }
};

/// One line of the CSV: root mean squares over the phases.
struct Row {
    std::string law{}, method{};
    Real restitution = 0, angle = 0;
    Real setting = 0;      ///< steps a contact, or tolerance
    Real evaluations = 0;  ///< of the law, in touch
    Real nanoseconds = 0;  ///< of one collision, the whole call
    Real lost = 0;         ///< reference, of the energy brought
    Real error = 0, error_normal = 0, error_tangential = 0, worst_phase = 0;  ///< of the energy brought
    Real restitution_error = 0;  ///< worst phase of |e_out - e|, head-on
};

/// Nanoseconds of one call of `work`, which returns a number that is used: the least of five, each long
/// enough to be measured. Others share the machine.
template <class Work>
Real nanoseconds(const Work& work) {
    using Clock = std::chrono::steady_clock;
    Real best = std::numeric_limits<Real>::infinity(), sum = 0;
    int calls = 1;
    for (int n = 0; n < 5; ++n) {
        const auto start = Clock::now();
        for (int k = 0; k < calls; ++k) sum += work();
        const std::chrono::duration<Real, std::nano> spent = Clock::now() - start;
        best = std::min(best, spent.count() / calls);
        calls = std::clamp(static_cast<int>(5e4 / best), 1, 1000);
    }
    require(std::isfinite(sum), {"energy lost", "finite", "J"}, sum);
    return best;
}

struct Sweep {
    std::vector<Row> rows{};
    Real reference_uncertainty = 0;  ///< of the energy brought: tolerance 1e-13 against 1e-14

    template <class Method, class Law>
    void fixed(const std::string& title, const Law& law, Real e, Real angle, const ReferenceResult& exact,
               Real contact, bool found = false) {
        const Collision c = spheres(angle);
        for (const Real steps : step_counts) {
            Row row{.law = title,
                    .method = found ? found_name : Method::name,
                    .restitution = e,
                    .angle = angle,
                    .setting = steps};
            row.lost = exact.lost() / c.brought();
            const int phases = found ? 1 : some_phases;
            for (int n = 0; n < phases; ++n) {
                const CollisionResult r =
                    collide<Method>(law, c, contact / steps, found ? 0 : (n + 0.5) / phases);
                const Real normal = (r.lost_normal - exact.lost_normal) / c.brought(),
                           tangential = (r.lost_tangential - exact.lost_tangential) / c.brought();
                row.evaluations += static_cast<Real>(r.evaluations) / phases;
                row.error += square(normal + tangential) / phases;
                row.error_normal += square(normal) / phases;
                row.error_tangential += square(tangential) / phases;
                row.worst_phase = std::max(row.worst_phase, std::abs(normal + tangential));
                if (angle == 0)
                    row.restitution_error =
                        std::max(row.restitution_error, std::abs(r.normal_speed / c.speed - e));
            }
            for (Real* error : {&row.error, &row.error_normal, &row.error_tangential})
                *error = std::sqrt(*error);
            row.nanoseconds = nanoseconds(
                [&] { return collide<Method>(law, c, contact / steps, found ? 0 : 0.4).lost_normal; });
            rows.push_back(row);
        }
    }

    template <class Kind>
    void run() {
        for (const Real e : restitutions)
            for (const Real angle : angles) {
                const auto law = Kind::law(e);
                const Collision c = spheres(angle);
                ReferenceCollision reference(law, c);
                const ReferenceResult exact = reference.solve(1e-13), finer = reference.solve(1e-14);
                reference_uncertainty =
                    std::max(reference_uncertainty, std::abs(exact.lost() - finer.lost()) / c.brought());
                const Real contact = reference.law().elastic_duration(c.normal_speed());
                fixed<PredictingVerlet>(Kind::title, law, e, angle, exact, contact);
                fixed<LaggedVerlet>(Kind::title, law, e, angle, exact, contact);
                fixed<SymplecticEuler>(Kind::title, law, e, angle, exact, contact);
                fixed<McLachlan4>(Kind::title, law, e, angle, exact, contact);
                fixed<RungeKutta4>(Kind::title, law, e, angle, exact, contact);
                fixed<RungeKutta4>(Kind::title, law, e, angle, exact, contact, true);
                for (const Real tolerance : tolerances) {
                    const ReferenceResult r = reference.solve(tolerance);
                    Row row{.law = Kind::title, .method = adaptive_name, .restitution = e, .angle = angle};
                    row.setting = tolerance;
                    row.evaluations = static_cast<Real>(r.evaluations);
                    row.lost = exact.lost() / c.brought();
                    row.error = row.worst_phase = std::abs(r.lost() - exact.lost()) / c.brought();
                    row.error_normal = std::abs(r.lost_normal - exact.lost_normal) / c.brought();
                    row.error_tangential = std::abs(r.lost_tangential - exact.lost_tangential) / c.brought();
                    row.nanoseconds = nanoseconds([&] { return reference.solve(tolerance).lost_normal; });
                    rows.push_back(row);
                }
            }
    }

    std::vector<Row> where(const std::function<bool(const Row&)>& keep) const {
        std::vector<Row> kept;
        std::copy_if(rows.begin(), rows.end(), std::back_inserter(kept), keep);
        return kept;
    }
    /// Over the angles: the worst error against the mean cost, one point for each setting.
    Curve worst_over_angles(const std::string& law, const std::string& method, Real e, bool time) const {
        std::map<Real, std::pair<Real, std::pair<Real, int>>> by_setting;
        for (const Row& row : rows)
            if (row.law == law && row.method == method && row.restitution == e) {
                auto& [error, cost] = by_setting[method == adaptive_name ? -row.setting : row.setting];
                error = std::max(error, row.error);
                cost.first += time ? 1e-3 * row.nanoseconds : row.evaluations;
                ++cost.second;
            }
        Curve curve;
        for (const auto& [setting, point] : by_setting) {
            curve.x.push_back(point.second.first / point.second.second);
            curve.y.push_back(point.first);
        }
        return curve;
    }
    Curve over_angles(const std::string& law, const std::string& method, Real e, Real setting) const {
        Curve curve;
        for (const Row& row : rows)
            if (row.law == law && row.method == method && row.restitution == e && row.setting == setting) {
                curve.x.push_back(row.angle);
                curve.y.push_back(std::max(row.error, 1e-12));
            }
        return curve;
    }
    Real worst(const std::string& law, const std::string& method, Real setting, Real e = -1) const {
        Real most = 0;
        for (const Row& row : rows)
            if (row.law == law && row.method == method && row.setting == setting &&
                (e < 0 || row.restitution == e))
                most = std::max(most, row.error);
        return most;
    }
    Real median(const std::string& law, const std::string& method, Real setting) const {
        std::vector<Real> errors;
        for (const Row& row : rows)
            if (row.law == law && row.method == method && row.setting == setting) errors.push_back(row.error);
        std::sort(errors.begin(), errors.end());
        return 0.5 * (errors[(errors.size() - 1) / 2] + errors[errors.size() / 2]);
    }
};

std::string percent(Real share) { return short_text(100 * share) + " %"; }

std::string tables(const Sweep& sweep) {
    std::string text =
        "Error of the energy lost, of the energy brought: median / worst of four restitutions and six "
        "angles.\n\n| law | method | 20 steps a contact | 50 | 100 |\n|---|---|---|---|---|\n";
    for (const char* law : {Linear::title, Hertz::title})
        for (const std::string& method : methods) {
            if (method == adaptive_name) continue;
            text += "| " + std::string(law) + " | " + method + " |";
            for (const Real steps : {20, 50, 100})
                text += " " + percent(sweep.median(law, method, steps)) + " / " +
                        percent(sweep.worst(law, method, steps)) + " |";
            text += "\n";
        }
    text +=
        "\nHead-on, worst of eight phases of |e_out - e|.\n\n| law | e | method | 20 steps a contact | 50 | "
        "100 "
        "|\n|---|---|---|---|---|---|\n";
    for (const char* law : {Linear::title, Hertz::title})
        for (const Real e : {0.8, 0.5, 0.2})
            for (const std::string& method : {methods[0], methods[1]}) {
                text += "| " + std::string(law) + " | " + short_text(e) + " | " + method + " |";
                for (const Real steps : {20, 50, 100})
                    for (const Row& row : sweep.rows)
                        if (row.law == law && row.method == method && row.restitution == e &&
                            row.angle == 0 && row.setting == steps)
                            text += " " + short_text(row.restitution_error) + " |";
                text += "\n";
            }
    text +=
        "\nOrder of the error over 100 to 1000 steps a contact, all angles.\n\n| law | method | e = 1 | 0.8 "
        "| 0.5 "
        "| 0.2 |\n|---|---|---|---|---|---|\n";
    for (const char* law : {Linear::title, Hertz::title})
        for (const std::string& method : methods) {
            if (method == adaptive_name) continue;
            text += "| " + std::string(law) + " | " + method + " |";
            for (const Real e : restitutions) {
                std::vector<Real> step, error;
                for (const Real n : {100.0, 140.0, 200.0, 300.0, 500.0, 700.0, 1000.0})
                    step.push_back(1 / n), error.push_back(sweep.worst(law, method, n, e));
                char order[20];
                std::snprintf(order, sizeof order, " %.1f |", measured_order(step, error));
                text += order;
            }
            text += "\n";
        }
    return text;
}

Summary collision(const OutputFolder& folder) {
    Sweep sweep;
    sweep.run<Linear>();
    sweep.run<Hertz>();

    std::ofstream csv(folder.path("collision.csv"));
    csv << "law,method,restitution,angle_degree,steps_per_contact_or_tolerance,evaluations,nanoseconds,lost_"
           "of_brought,"
           "error_of_brought_rms,error_of_brought_worst_phase,error_normal_rms,error_tangential_rms,error_of_"
           "loss_rms\n";
    for (const Row& row : sweep.rows) {
        csv << row.law << ",\"" << row.method << "\"";
        const Real of_loss = row.lost > 1e-9 ? row.error / row.lost : std::numeric_limits<Real>::quiet_NaN();
        for (const Real value :
             {row.restitution, row.angle, row.setting, row.evaluations, row.nanoseconds, row.lost, row.error,
              row.worst_phase, row.error_normal, row.error_tangential, of_loss})
            csv << "," << short_text(value);
        csv << "\n";
    }
    csv.close();
    std::ofstream markdown(folder.path("tables.md"));
    markdown << tables(sweep);
    markdown.close();
    if (!csv || !markdown) throw FileError("cannot write the tables of the collision chart");

    const Axis error{.label = "error of the energy lost, share of that brought",
                     .min = 1e-8,
                     .max = 1,
                     .logarithmic = true};
    for (const char* law : {Linear::title, Hertz::title}) {
        PanelChart chart{
            .title = std::string(law) +
                     ": error of the energy lost in a collision against its cost, worst of six angles",
            .x = {.label = "force evaluations in touch", .min = 3, .max = 1e4, .logarithmic = true},
            .y = error,
            .names = methods,
            .slopes = {{5, 1e-6, -1, 6, "order 1"}, {5, 1e-6, -2, 6, "order 2"}}};
        for (const Real e : restitutions) {
            Panel panel{.title = "restitution " + short_text(e)};
            for (const std::string& method : methods)
                panel.curves.push_back(sweep.worst_over_angles(law, method, e, false));
            chart.panels.push_back(panel);
        }
        draw(chart, folder.path(std::string("collision_error_cost_") +
                                (law == Linear::title ? "linear" : "hertz") + ".png"));
    }

    PanelChart time{
        .title = "Error of the energy lost against measured time, restitution 0.5, worst of six angles",
        .x = {.label = "one collision", .unit = "microseconds", .min = 0.1, .max = 1000, .logarithmic = true},
        .y = error,
        .names = methods};
    PanelChart by_angle{
        .title = "Error of the energy lost at 50 steps a contact against the angle of the collision",
        .x = {.label = "angle from head-on", .unit = "degree", .min = -3.0, .max = 83.0},
        .y = {.label = error.label, .min = 1e-7, .max = 1e-1, .logarithmic = true},
        .names = {methods.begin(), methods.end() - 2}};
    for (const char* law : {Linear::title, Hertz::title}) {
        Panel panel{.title = law};
        for (const std::string& method : methods)
            panel.curves.push_back(sweep.worst_over_angles(law, method, 0.5, true));
        time.panels.push_back(panel);
        for (const Real e : {1.0, 0.5}) {
            Panel angle{.title = std::string(law) + ", restitution " + short_text(e)};
            for (const std::string& method : by_angle.names)
                angle.curves.push_back(sweep.over_angles(law, method, e, 50));
            by_angle.panels.push_back(angle);
        }
    }
    draw(time, folder.path("collision_error_cost_time.png"));
    draw(by_angle, folder.path("collision_error_cost_angle.png"));

    Summary summary{{"collisions", sweep.rows.size()},
                    {"reference_uncertainty_of_brought", sweep.reference_uncertainty}};
    const auto evaluation_time = [&](const std::string& law, const std::string& method) {
        std::vector<Real> times;
        for (const Row& row : sweep.rows)
            if (row.law == law && row.method == method && row.evaluations > 200)
                times.push_back(row.nanoseconds / row.evaluations);
        std::nth_element(times.begin(), times.begin() + static_cast<long>(times.size() / 2), times.end());
        return times[times.size() / 2];
    };
    for (const char* law : {Linear::title, Hertz::title})
        for (const std::string& method : methods) {
            const std::string key = std::string(law) + ", " + method;
            if (method != adaptive_name)
                summary["error_at_50_steps_worst_of_brought: " + key] = sweep.worst(law, method, 50);
            summary["time_per_evaluation_ns: " + key] = evaluation_time(law, method);
        }
    return summary;
}

}  // namespace

int main(int argc, char** argv) {
    return textbook_main(argc, argv, "charts/collision", "Energy lost in a collision: error against cost",
                         collision);
}
