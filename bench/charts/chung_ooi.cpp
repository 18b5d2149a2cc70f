// Draws the pictures of docs/verification/chung_ooi.md: chart_chung_ooi [FOLDER], which is made where it is
// not.

#include "../../tests/verification/chung_ooi.hpp"
#include "../../examples/common/charts.hpp"

#include <iostream>

using namespace chung_ooi;
using namespace abrade::examples;

namespace {

constexpr Real steps = 400;  ///< a contact

std::vector<Real> spread(Real from, Real to, int count) {
    std::vector<Real> x;
    for (int i = 0; i < count; ++i) x.push_back(from + (to - from) * i / (count - 1));
    return x;
}

/// The rows of a table that `keep` keeps, as points.
template <class Keep>
Curve points(const std::string& title, const std::string& table, const std::string& x, Keep&& keep) {
    Curve c{.title = title, .style = CurveStyle::points};
    for (const auto& row : reference_table(table))
        if (keep(row)) c.x.push_back(row.at(x)), c.y.push_back(row.at("value"));
    return c;
}
Curve points(const std::string& title, const std::string& table, const std::string& x,
             const std::string& quantity, const std::string& series) {
    return points(title, table, x, [&](const ReferenceRow& row) {
        return row.is("quantity", quantity) && row.is("series", series);
    });
}

/// `value(x)` over a range.
template <class Value>
Curve line(const std::string& title, const std::vector<Real>& x, Value&& value,
           CurveStyle style = CurveStyle::line) {
    Curve c{.title = title, .x = x, .style = style};
    for (const Real at : x) c.y.push_back(value(at));
    return c;
}

const std::string by_default = "library's default: incremental", by_total = "total spring",
                  by_springs = "total spring, springs slide", slides = "slides throughout";

void test_4(const std::filesystem::path& folder) {
    const std::string table = "dem05_chung_ooi_T4_oblique_DEM_curves.csv";
    const auto angles = spread(2, 88, 87), sliding = spread(33, 88, 56);
    const struct {
        std::string quantity, picture, label, unit;
    } figures[] = {{"tangential_restitution", "4_restitution", "tangential restitution V_t' / V_t", ""},
                   {"angular_velocity_rad_s", "4_spin", "angular velocity", "rad/s"},
                   {"contact_rebound_angle_deg", "4_angle", "rebound angle of the contact patch", "degrees"}};
    for (const auto& f : figures) {
        const auto of = [&](const Form& form) {
            return [&f, form](Real angle) {
                const Impact t = impact_4(aluminium_oxide, angle);
                return figure_4(f.quantity, t, off_plane(t, form, steps));
            };
        };
        const auto closed = [&](Real angle) {
            const Impact t = impact_4(aluminium_oxide, angle);
            const Real kick = t.friction * (1 + t.restitution) * t.normal;
            return figure_4(f.quantity, t,
                            {.normal = t.restitution * t.normal,
                             .tangential = t.tangential - kick,
                             .rim = -2.5 * kick,
                             .patch = t.tangential - 3.5 * kick,
                             .ledger = {}});
        };
        draw(
            LineChart{
                .title = "Test 4: one speed, many angles; aluminium oxide",
                .x = {.label = "angle of incidence from the normal", .unit = "degrees", .min = 0, .max = 90},
                .y = {.label = f.label, .unit = f.unit},
                .curves = {points("published", table, "incident_angle_deg", f.quantity, "DEM_Al_oxide"),
                           line(by_total, angles, of(total_form)), line(by_default, angles, of(own_form)),
                           line(slides, sliding, closed, CurveStyle::dashed)}},
            folder / ("verification_chung_ooi_" + f.picture + ".png"));
    }
}

void test_5(const std::filesystem::path& folder) {
    const std::string table = "dem07_chung_ooi_T5_oblique_constant_vn.csv";
    const auto xs = spread(0.05, 10, 120);
    const OtherForm published{.spring = OtherHertzMindlin::Spring::unscaled, .shear = 0.5};
    const struct {
        std::string quantity, picture, label;
    } figures[] = {{"recoil_Vst1_over_muVcn1", "5_recoil", "V_st' / (mu V_cn')"},
                   {"spin_Rw1_over_muVcn", "5_spin", "R w' / (mu V_cn)"}};
    for (const auto& f : figures) {
        const bool recoil = f.quantity.starts_with("recoil");
        const auto shown = [&](const std::string& series) {
            return [&f, series](const ReferenceRow& row) {
                return row.is("quantity", f.quantity) && row.is("series", series) &&
                       row.at("Vt_over_muVn") <= 10;
            };
        };
        const auto of = [&](const auto& form) {
            return [&f, form](Real x) {
                const Impact t = impact_5(steel, x);
                return figure_5(f.quantity, t, off_plane(t, form, steps));
            };
        };
        draw(LineChart{.title = "Test 5: one normal speed, many tangential speeds; lines: steel",
                       .x = {.label = "V_t / (mu V_n)", .min = 0, .max = 10},
                       .y = {.label = f.label, .min = recoil ? -3.2 : -5.5},
                       .curves = {points("published, steel", table, "Vt_over_muVn", shown("Steel")),
                                  line("unscaled spring, k_t / 2", xs, of(published)),
                                  line(by_default, xs, of(own_form)),
                                  line(
                                      slides, spread(7, 10, 2), [&](Real x) { return recoil ? x - 7 : -5; },
                                      CurveStyle::dashed),
                                  points("published, polyethylene", table, "Vt_over_muVn",
                                         shown("Polyethylene")),
                                  points("finite elements (no gate)", table, "Vt_over_muVn", shown("FEM"))}},
             folder / ("verification_chung_ooi_" + f.picture + ".png"));
    }
}

/// Tests 6 and 8: sliding at high spins, x < 1 in beta, x > 2.1 in the recoil.
void tests_6_and_8(const std::filesystem::path& folder) {
    const std::string t6 = "dem08_chung_ooi_T6_spin_sphere_plane.csv",
                      t8 = "dem10_chung_ooi_T8_unequal_spheres.csv", t8n = "dem10_chung_ooi_T8_nylon.csv";
    const auto of = [](const std::string& quantity, const auto& form) {
        return [quantity, form](Real x) {
            const Impact t = impact_6(aluminium_alloy, quantity, x);
            return figure_6(quantity, t, off_plane(t, form, steps));
        };
    };
    const auto closed = [](const std::string& quantity) {
        return [quantity](Real x) { return sliding_6(quantity, impact_6(aluminium_alloy, quantity, x)); };
    };
    const OtherForm aluminium{
        .spring = OtherHertzMindlin::Spring::total, .shear = 1.12, .limit_by_push = true, .tension = true};
    std::vector<Real> xs;
    for (const Real e : spread(std::log(0.15), std::log(25), 150)) xs.push_back(std::exp(e));
    const Axis beta_x{.label = "3.5 mu (1 + e) V_n / V_st", .min = 0.15, .max = 26, .logarithmic = true},
        beta_y{.label = "beta = -V_st' / V_st", .min = -0.9, .max = 0.3};
    const auto dashed = line(slides, spread(0.15, 1, 40), closed("beta"), CurveStyle::dashed);
    draw(LineChart{.title = "Test 6: a spinning sphere on a plane; lines: aluminium",
                   .x = beta_x,
                   .y = beta_y,
                   .curves = {points("published, nylon", t6, "x", "beta_tangential_restitution", "Nylon"),
                              line(by_springs, xs, of("beta", springs_form)),
                              line(by_default, xs, of("beta", own_form)), dashed,
                              points("published, aluminium", t6, "x", "beta_tangential_restitution",
                                     "Al_alloy"),
                              line("the limit in the spring, 1.12 k_t", xs, of("beta", aluminium))}},
         folder / "verification_chung_ooi_6_beta.png");
    draw(LineChart{.title = "Test 8: a spinning sphere on a larger, heavier one; lines: test 6",
                   .x = beta_x,
                   .y = beta_y,
                   .curves = {points("published, nylon, cases A and B", t8n, "x", "beta_Nylon", "caseA"),
                              line(by_springs, xs, of("beta", springs_form)),
                              points("published, aluminium, case B", t8, "x", "beta_Al_alloy", "caseB"),
                              dashed,
                              points("published, aluminium, case A", t8, "x", "beta_Al_alloy", "caseA"),
                              line("the limit in the spring, 1.12 k_t", xs, of("beta", aluminium))}},
         folder / "verification_chung_ooi_8_beta.png");
    const auto recoil_xs = spread(0.02, 3, 150);
    const auto small = [](const std::string& quantity, const std::string& series) {
        return [=](const ReferenceRow& row) {
            return row.is("quantity", quantity) && row.is("series", series) && row.at("x") <= 3;
        };
    };
    draw(
        LineChart{.title = "Tests 6 and 8: recoil; lines: aluminium",
                  .x = {.label = "V_st / V_n", .min = 0, .max = 3},
                  .y = {.label = "V_st' / V_cn'", .min = -0.6, .max = 2},
                  .curves = {points("test 6, nylon", t6, "x", small("recoil_Vst1_over_Vcn1", "Nylon")),
                             line(by_springs, recoil_xs, of("recoil", springs_form)),
                             line(by_default, recoil_xs, of("recoil", own_form)),
                             line(slides, spread(2.1, 3, 2), closed("recoil"), CurveStyle::dashed),
                             points("test 6, aluminium", t6, "x", small("recoil_Vst1_over_Vcn1", "Al_alloy")),
                             points("test 8, aluminium, case A", t8, "x", small("recoil_Al_alloy", "caseA")),
                             points("test 8, case B where it differs", t8, "x",
                                    small("recoil_Al_alloy", "caseB"))}},
        folder / "verification_chung_ooi_6_8_recoil.png");
}

void thornton(const std::filesystem::path& folder) {
    std::vector<Curve> curves;
    for (const Real e : {0.9, 0.75, 0.5, 0.25}) {
        const std::string title = "e = " + abrade::to_text(e);
        curves.push_back(points("published, " + title, "dem15_thornton2013_oblique_hertz.csv", "psi",
                                [&](const ReferenceRow& row) {
                                    return row.is("quantity", "patch") && row.at("restitution") == e;
                                }));
        curves.push_back(line("library's default, " + title, spread(0.1, 9.5, 120), [&](Real psi) {
            const Impact t = impact_thornton(psi, e);
            return figure_thornton("patch", t, off_plane(t, own_form, steps));
        }));
    }
    draw(LineChart{.title = "Thornton, Cummins & Cleary: the incremental spring in its own paper",
                   .x = {.label = "2 V_t / (mu (1 + e) V_n)", .min = 0, .max = 10},
                   .y = {.label = "2 V_st' / (mu (1 + e) V_n)"},
                   .curves = curves},
         folder / "verification_thornton_recoil.png");
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/chung_ooi";
        std::filesystem::create_directories(folder);
        test_4(folder), test_5(folder), tests_6_and_8(folder), thornton(folder);
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
