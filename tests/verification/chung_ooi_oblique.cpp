// Chung & Ooi's tests 4 to 8: oblique impacts and spinning spheres, on a plane and on each other.
//
// Where the contact slides throughout, a closed form holds whatever the spring. Elsewhere the published
// curves show the forms of Mindlin's spring and of Coulomb's slider that the authors' codes had, and these
// differ from test to test; docs/verification/chung_ooi.md tells which and how it was found. So each curve is
// gated against the form that it shows (5 % of its range), and the library's own form against a finer step (2
// % of the range) and against the closed forms (1 %); its sticking regime has a published curve of its own in
// thornton.cpp.
#include "chung_ooi.hpp"

#include <doctest/doctest.h>

using namespace chung_ooi;

namespace {

constexpr Real steps = 100, fine_steps = 2000;  ///< a contact

/// Greatest |value - reference|, over the range of the reference.
struct Comparison {
    Real low = 1e300, high = -1e300, worst = 0;
    void add(Real value, Real reference) {
        low = std::min(low, reference), high = std::max(high, reference);
        worst = std::max(worst, std::abs(value - reference));
    }
    Real relative() const { return worst / (high - low); }
};

/// Comparisons by the name of their series.
struct Comparisons {
    std::map<std::string, Comparison> series{};

    void add(const ReferenceRow& row, Real value, Real reference) {
        series[row.texts.at("quantity") + " " + row.texts.at("series")].add(value, reference);
    }
    void report(const std::string& what) const {
        for (const auto& entry : series)
            MESSAGE(what << ", " << entry.first << ": " << 100 * entry.second.relative()
                         << " % of its range");
    }
    void gate(const std::string& what, Real most) const {
        report(what);
        for (const auto& entry : series) {
            CAPTURE(what);
            CAPTURE(entry.first);
            CHECK(entry.second.relative() <= most);
        }
    }
};

/// The larger sphere takes what the smaller brings, to round-off.
void check_momenta(const Momenta& before, const Momenta& after, const Impact& t) {
    const Real brought = sphere_mass(t.radius, t.material.density) * t.normal;
    CHECK((after.linear - before.linear).norm() <= 1e-12 * brought);
    CHECK((after.angular - before.angular).norm() <= 1e-10 * brought * 6 * t.radius);
}

Material material_of(const ReferenceRow& row) {
    const std::string name = row.texts.at("quantity") + " " + row.texts.at("series");
    const auto has = [&](const char* part) { return name.find(part) != std::string::npos; };
    return has("Al_oxide")       ? aluminium_oxide
           : has("Al_alloy")     ? aluminium_alloy
           : has("Steel")        ? steel
           : has("Polyethylene") ? polyethylene
           : has("Nylon")        ? nylon
                                 : throw std::runtime_error("no such material: " + name);
}

/// By how much of R the lever of friction is shorter, in the mean over an elastic impact: half the overlap,
/// which weighed by the force has the mean B(1.4, 0.5)/2 of the deepest. 0.5 % with steel, 1.1 % with
/// polyethylene, whose published spins show it: -4.96 for -5.
Real shorter_lever(const Impact& t) {
    const Real m = sphere_mass(t.radius, t.material.density), youngs = own_form(t).effective_youngs();
    const Real deepest = std::pow(15 * m * square(t.normal) / (16 * youngs * std::sqrt(t.radius)), 0.4);
    return 0.5 * (0.5 * std::beta(1.4, 0.5)) * deepest / t.radius;
}

}  // namespace

TEST_CASE("test 4, one speed, many angles: the published curves are those of a total spring (dem05)") {
    Comparisons curves, own_curves, refined, own_refined;
    for (const auto& row : reference_table("dem05_chung_ooi_T4_oblique_DEM_curves.csv")) {
        const Impact t = impact_4(material_of(row), row.at("incident_angle_deg"));
        const auto figure = [&](const Form& form, Real n) {
            return figure_4(row.texts.at("quantity"), t, off_plane(t, form, n));
        };
        const Real value = figure(total_form, steps), own = figure(own_form, steps);
        curves.add(row, value, row.at("value")), own_curves.add(row, own, row.at("value"));
        refined.add(row, value, figure(total_form, fine_steps)),
            own_refined.add(row, own, figure(own_form, fine_steps));
    }
    curves.gate("total spring against the curve", 0.05);
    refined.gate("total spring against a finer step", 0.02);
    own_refined.gate("incremental spring against a finer step", 0.02);
    own_curves.report("incremental spring against the curve (no gate)");
}

TEST_CASE("test 4, from 35 degrees on: the closed form of an impact that slides throughout (dem06)") {
    for (const auto& row : reference_table("dem06_oblique_gross_sliding_analytic.csv"))
        for (const Form& form : {own_form, total_form, springs_form}) {
            const Impact t = impact_4(aluminium_oxide, row.at("theta_deg"));
            const Rebound r = off_plane(t, form, steps);
            CAPTURE(row.at("theta_deg"));
            CHECK(r.tangential / t.tangential == doctest::Approx(row.at("e_t")).epsilon(0.01).scale(0));
            CHECK(-r.rim / t.radius == doctest::Approx(row.at("omega_rad_s")).epsilon(0.01));
            // 1 % of the angle, or 0.1 degrees where it is small.
            CHECK(figure_4("contact_rebound_angle_deg", t, r) ==
                  doctest::Approx(row.at("contact_rebound_angle_deg")).epsilon(0.01).scale(10));
        }
}

TEST_CASE("test 5, one normal speed, many tangential speeds: half Mindlin's stiffness, unscaled (dem07)") {
    // k_t is half of what E and nu give: (1 - nu)/(2 - nu) k_n, as if the plane, rigid to compression, were
    // as soft as the sphere to shear. The FEM series departs from both forms by up to 1.1 and is no gate.
    const OtherForm published{.spring = OtherHertzMindlin::Spring::unscaled, .shear = 0.5};
    Comparisons curves, own_curves, refined, own_refined, elastic_half_space;
    for (const auto& row : reference_table("dem07_chung_ooi_T5_oblique_constant_vn.csv")) {
        const Real x = row.at("Vt_over_muVn");
        if (row.is("series", "FEM")) {
            const Impact t = impact_5(steel, x);
            elastic_half_space.add(row, figure_5(row.texts.at("quantity"), t, off_plane(t, own_form, steps)),
                                   row.at("value"));
            continue;
        }
        const Impact t = impact_5(material_of(row), x);
        const auto figure = [&](const auto& form, Real n) {
            return figure_5(row.texts.at("quantity"), t, off_plane(t, form, n));
        };
        const Real value = figure(published, steps), own = figure(own_form, steps);
        curves.add(row, value, row.at("value")), own_curves.add(row, own, row.at("value"));
        refined.add(row, value, figure(published, fine_steps));
        own_refined.add(row, own, figure(own_form, fine_steps));
        if (x >
            7.1) {  // slides throughout: V_st' = x - 7, R w' = -5 in units of mu V_n, on a lever of length R
            const Real lever = 1 - shorter_lever(t);
            const Real exact =
                row.texts.at("quantity").starts_with("recoil") ? x - 2 - 5 * lever : -5 * lever;
            CHECK(own == doctest::Approx(exact).epsilon(0.01).scale(0));
            CHECK(value == doctest::Approx(exact).epsilon(0.01).scale(0));
        }
    }
    curves.gate("unscaled spring, k_t / 2, against the curve", 0.05);
    refined.gate("unscaled spring, k_t / 2, against a finer step", 0.02);
    own_refined.gate("incremental spring against a finer step", 0.02);
    own_curves.report("incremental spring against the curve (no gate)");
    elastic_half_space.report("incremental spring against finite elements (no gate)");
}

namespace {

/// Above this x, at the three smallest spins, aluminium's beta in test 6 and in case A of test 8 falls to
/// -0.34, where nylon's and that of case B stay at -0.11. No form of Hertz' and Mindlin's laws can do both:
/// beta depends on x, mu, e and k_t/k_n alone, and k_t/k_n is the same in cases A and B. Below, the series
/// agree.
constexpr Real largest_consistent_x = 6;

bool consistent(const ReferenceRow& row) {
    const bool aluminium_beta =
        (row.is("quantity", "beta_tangential_restitution") && row.is("series", "Al_alloy")) ||
        (row.is("quantity", "beta_Al_alloy") && row.is("series", "caseA"));
    return !aluminium_beta || row.at("x") < largest_consistent_x;
}

/// Tests 6 and 8: `throw_it(row, impact, form, steps)`.
template <class ThrowIt>
void spinning_sphere(const std::string& table, ThrowIt&& throw_it) {
    Comparisons curves, own_curves, refined, own_refined;
    // A series that has but the points in which it differs from another is measured by the other's range.
    const auto add_range = [](Comparisons& all, const ReferenceRow& row) {
        if (!row.is("quantity", "recoil_Al_alloy") || !row.is("series", "caseB")) return;
        const Comparison& a = all.series.at("recoil_Al_alloy caseA");
        Comparison& b = all.series["recoil_Al_alloy caseB"];
        b.low = a.low, b.high = a.high;
    };
    for (const auto& row : reference_table(table)) {
        const std::string& quantity = row.texts.at("quantity");
        Impact t =
            impact_6(row.is("series", "Nylon") || quantity.ends_with("Nylon") ? nylon : aluminium_alloy,
                     quantity, row.at("x"));
        if (row.is("series", "caseA")) t.youngs_other = 1000 * t.material.youngs;
        if (row.is("series", "caseB")) t.youngs_other = t.material.youngs;
        const auto figure = [&](const Form& form, Real n) {
            return figure_6(quantity, t, throw_it(t, form, n));
        };
        const Real value = figure(springs_form, steps), own = figure(own_form, steps);
        if (consistent(row)) curves.add(row, value, row.at("value"));
        own_curves.add(row, own, row.at("value"));
        refined.add(row, value, figure(springs_form, fine_steps));
        own_refined.add(row, own, figure(own_form, fine_steps));
        for (Comparisons* all : {&curves, &own_curves, &refined, &own_refined}) add_range(*all, row);
        if (slides_throughout_6(t)) {
            const Real exact = sliding_6(quantity, t);
            // A recoil near 0 is a difference of two terms of 4.2.
            const Real scale = quantity.starts_with("beta") ? 0.1 : 1;
            CHECK(own == doctest::Approx(exact).epsilon(0.01).scale(scale));
            CHECK(value == doctest::Approx(exact).epsilon(0.01).scale(scale));
        }
    }
    curves.gate("total spring, springs slide, against the curve", 0.05);
    refined.gate("total spring, springs slide, against a finer step", 0.02);
    own_refined.gate("incremental spring against a finer step", 0.02);
    own_curves.report("incremental spring against the curve (no gate)");
}

/// The whole of aluminium's beta, with the three smallest spins: a slider whose spring takes the whole limit
/// as soon as spring and dashpot together exceed it, which they do as a contact begins. k_t is fitted.
template <class ThrowIt>
void aluminium_beta(const std::string& table, const std::string& series, ThrowIt&& throw_it) {
    const auto compare = [&](Real shear) {
        const OtherForm form{.spring = OtherHertzMindlin::Spring::total,
                             .shear = shear,
                             .limit_by_push = true,
                             .tension = true};
        Comparisons curve;
        for (const auto& row : reference_table(table)) {
            if (!row.texts.at("quantity").starts_with("beta") || !row.is("series", series)) continue;
            const Impact t = impact_6(aluminium_alloy, "beta", row.at("x"));
            curve.add(row, figure_6("beta", t, throw_it(t, form, 4 * steps)), row.at("value"));
        }
        return curve;
    };
    compare(1.12).gate("the limit in the spring, 1.12 k_t, against the curve", 0.05);
    compare(1).report("the limit in the spring, k_t, against the curve (no gate)");
}

const auto on_plane = [](const Impact& t, const auto& form, Real n) { return off_plane(t, form, n); };
const auto on_sphere = [](const Impact& t, const auto& form, Real n) {
    return off_sphere(t, form, n,
                      [&](const Momenta& before, const Momenta& after) { check_momenta(before, after, t); });
};

}  // namespace

TEST_CASE("test 6, a spinning sphere on a plane: Coulomb's limit holds the springs (dem08)") {
    spinning_sphere("dem08_chung_ooi_T6_spin_sphere_plane.csv", on_plane);
}

TEST_CASE("test 6, aluminium at small spins: another slider (dem08)") {
    aluminium_beta("dem08_chung_ooi_T6_spin_sphere_plane.csv", "Al_alloy", on_plane);
}

TEST_CASE("test 7, equal spheres whose surfaces do not slip: spins stay, nothing moves sideways (dem09)") {
    for (const auto& row : reference_table("dem09_chung_ooi_T7_two_equal_spinning_spheres.csv"))
        for (const Material& material : {aluminium_alloy, copper})
            for (const Form& form : {own_form, springs_form}) {
                const Real radius = 0.1, speed = 0.2, omega = row.at("omega_in");
                const Impact t{.material = material,
                               .radius = radius,
                               .normal = speed,
                               .restitution = 0.5,
                               .friction = 0.4,
                               .youngs_other = material.youngs};
                const HertzMindlin law = form(t);
                const Real mass = sphere_mass(radius, material.density);
                const Real time = contact_time(2 * speed, law.effective_youngs(), 0.5 * radius, 0.5 * mass);
                Scene scene = empty_scene();
                for (const int side : {-1, 1})
                    scene.add_sphere(radius,
                                     {.position = {side * (radius + 0.25 * time / steps * speed), 0, 0},
                                      .velocity = {-side * speed, 0, 0},
                                      .angular_velocity = {0, -side * omega, 0}},
                                     material.density);
                auto sim = simulate(std::move(scene)).contact(law);
                sim.run({.end_time = 3 * time, .time_step = time / steps});
                const Particles& p = sim.particles();
                for (std::size_t b = 0; b < 2; ++b) {
                    const Real side = b == 0 ? -1 : 1;
                    const Vec3 spin = p.angular_velocity(static_cast<Index>(b)), v = p.velocity[b];
                    CHECK(std::abs(v.x() * side / speed - 0.5) <= 0.005);  // dem03's gate
                    CHECK((spin - Vec3(0, -side * row.at("omega_out"), 0)).norm() <= 1e-10 * omega);
                    CHECK(std::abs(v.y()) + std::abs(v.z()) <= 1e-10 * speed);
                }
                CHECK((p.velocity[0] + p.velocity[1]).norm() <= 1e-12 * speed);
            }
}

TEST_CASE("test 8, a spinning sphere on a larger, heavier one: as on a plane (dem10)") {
    spinning_sphere("dem10_chung_ooi_T8_unequal_spheres.csv", on_sphere);
}

TEST_CASE("test 8, nylon: the springs slide at all spins (dem10)") {
    spinning_sphere("dem10_chung_ooi_T8_nylon.csv", on_sphere);
}

TEST_CASE("test 8, aluminium at small spins: another slider (dem10)") {
    aluminium_beta("dem10_chung_ooi_T8_unequal_spheres.csv", "caseA", on_sphere);
}

TEST_CASE("tests 6 and 8: how stiff the partner is does not matter, so cases A and B cannot differ") {
    for (const Form& form : {own_form, springs_form})
        for (const Real x : {1.2, 3., 8., 24.}) {
            Impact t = impact_6(aluminium_alloy, "beta", x);
            const Real on_rigid_plane = figure_6("beta", t, off_plane(t, form, fine_steps));
            for (const Real factor : {1000., 1.}) {
                t.youngs_other = factor * t.material.youngs;
                CAPTURE(x);
                // 0.001: the larger sphere is not quite immovable, and the lever shrinks with the overlap.
                CHECK(std::abs(figure_6("beta", t, on_sphere(t, form, fine_steps)) - on_rigid_plane) < 0.001);
            }
        }
}

TEST_CASE(
    "a total spring makes energy or drops it: that is no loss, but a residue that no finer step removes") {
    Impact real = impact_4(aluminium_alloy, 15), sticking = impact_4(aluminium_alloy, 30);
    sticking.restitution = 1, sticking.friction = 1e3;
    for (const Impact& t : {real, sticking}) {
        const Real brought =
            0.5 * sphere_mass(t.radius, t.material.density) * (square(t.normal) + square(t.tangential));
        for (const Real n : {steps, fine_steps}) {
            const Ledger e = off_plane(t, total_form, n).ledger, own = off_plane(t, own_form, n).ledger;
            for (const Ledger& ledger : {e, own}) {
                CHECK(ledger.residual_relative() < 1e-13);
                CHECK(ledger.lost_normal >= 0);
                CHECK(ledger.lost_sliding >= 0);
                CHECK(ledger.stored_contacts == 0);
            }
            const Real made = (e.kinetic + e.lost() - brought) / brought;
            MESSAGE(n << " steps, e = " << t.restitution << ": a total spring makes " << 100 * made
                      << " % of what the impact brought, an incremental one "
                      << 100 * (own.kinetic + own.lost() - brought) / brought << " %");
            CHECK(-e.integration_residue() / brought == doctest::Approx(made).epsilon(1e-9));
            CHECK(made == doctest::Approx(t.restitution < 1 ? 9.7e-4 : -1.16e-2).epsilon(0.1).scale(0));
            // The worse is the sticking impact, of order 1.5: 1.5e-4 at 100 steps, 2.1e-6 at 2000.
            CHECK(std::abs(own.integration_residue()) < (n == steps ? 2e-4 : 3e-6) * brought);
        }
    }
}

TEST_CASE("the rebound of a sticking impact converges with order 1.5, for k_t begins as the root of time") {
    // First order, with 1.4 % at 50 steps, where an incremental spring grows by k_t at the end of the step.
    Impact t = impact_4(aluminium_alloy, 25);
    t.restitution = 1, t.friction = 1e3;
    const Real speed = 3.9, exact = off_plane(t, own_form, 20000).patch;
    Real before = 0;
    for (const Real n : {50., 100., 200.}) {
        const Real error = std::abs(off_plane(t, own_form, n).patch - exact) / speed;
        MESSAGE(n << " steps: the patch's velocity is off by " << 100 * error << " % of the speed");
        if (n == 50) CHECK(error < 0.002);
        if (n > 50) CHECK(before / error > 2.6);  // order 1.4
        before = error;
    }
}
