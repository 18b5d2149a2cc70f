// Draws the pictures of docs/verification/normal_impacts.md: chart_normal_impacts [FOLDER], which is made
// where it is not.

#include "../../examples/common/charts.hpp"
#include "../../tests/verification/reference_table.hpp"

#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/sim/simulation.hpp>

#include <iostream>

using namespace abrade;
using namespace abrade::examples;

namespace {

struct Impact {
    std::vector<Real> time, overlap, force;  ///< [s], [m], [N]
    Real rebound = 0;                        ///< speed [m/s]
};

/// A sphere that meets a floor at its first step.
template <class Law>
Impact impact(const Law& law, Real radius, Real mass, Real speed, Real end_time, Real dt) {
    Scene scene;
    scene.gravity.setZero();
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    scene.add_sphere(radius, {.position = {0, 0, radius}, .velocity = {0, 0, -speed}},
                     mass / (4.0 / 3 * pi * cube(radius)));
    auto sim = simulate(std::move(scene)).contact(law);
    Impact out;
    sim.run({.end_time = end_time, .time_step = dt, .observe_every = dt}, [&](const auto& now) {
        out.time.push_back(now.time());
        out.overlap.push_back(radius - now.particles().position[0].z());
        out.force.push_back(now.particles().force[0].z());
    });
    out.rebound = sim.particles().velocity[0].z();
    return out;
}

/// Hertz' impact in its own units, x'' = -5/4 x^(3/2), x' = 1 at x = 0: the largest overlap is 1.
Curve exact_hertz() {
    Curve c{.title = "exact", .style = CurveStyle::dashed};
    const Real whole = 2.943275, dt = whole / 4000;
    const auto a = [](Real x) { return -1.25 * std::pow(std::max(x, 0.0), 1.5); };
    Real x = 0, v = 1;
    for (int n = 0; n <= 4000; ++n) {
        if (n % 40 == 0) c.x.push_back(n * dt / whole), c.y.push_back(std::pow(std::max(x, 0.0), 1.5));
        const Real v1 = v + 0.5 * dt * a(x);
        x += dt * v1, v = v1 + 0.5 * dt * a(x);
    }
    return c;
}

void hertz(const std::filesystem::path& folder) {
    LineChart chart{.title = "Elastic impacts of Chung & Ooi's tests 1 and 2, 50 steps a contact",
                    .x = {.label = "time / Hertz' duration", .min = 0, .max = 1.1},
                    .y = {.label = "force / Hertz' largest", .min = 0, .max = 1.1}};
    for (const auto& row : reference_table("dem02_chung_ooi_T1_T2_hertz_analytic.csv")) {
        const Real time = 1e-6 * row.at("t_c_us");
        const HertzMindlin law{{.youngs = 2 * row.at("Estar_Pa"), .poisson = 0, .largest_overlap = 1e-3}};
        const Impact i =
            impact(law, row.at("Rstar_m"), row.at("mstar_kg"), row.at("vrel_mps"), 1.1 * time, time / 50);
        std::string material = row.texts.at("material");
        std::replace(material.begin(), material.end(), '_', ' ');
        Curve c{.title = row.texts.at("test") + ", " + material, .style = CurveStyle::points};
        // Every fourth of them, each series from another one on, or the points would hide each other.
        for (std::size_t n = chart.curves.size(); n < i.time.size(); n += 4)
            c.x.push_back(i.time[n] / time), c.y.push_back(1e-3 * i.force[n] / row.at("F_max_kN"));
        chart.curves.push_back(std::move(c));
    }
    chart.curves.push_back(exact_hertz());
    draw(chart, folder / "verification_normal_hertz.png");
}

void restitution(const std::filesystem::path& folder) {
    const Real radius = 0.0025, mass = 4000 * 4. / 3 * pi * cube(radius), speed = 3.9;
    Curve same{.title = "as put in"}, measured{.title = "measured", .style = CurveStyle::points},
        clamped{.title = "damping only cut off", .style = CurveStyle::dashed};
    for (const auto& row : reference_table("dem03_restitution_damping_map.csv")) {
        const Real e = row.at("e_in");
        same.x.push_back(e), same.y.push_back(e);
        clamped.x.push_back(e), clamped.y.push_back(row.at("e_hertz_clamped"));
        for (const bool tension : {true, false}) {
            const HertzMindlin law{{.youngs = 3.8e11,
                                    .poisson = 0.23,
                                    .restitution = e,
                                    .tension = tension,
                                    .largest_overlap = 1e-3}};
            const Real deepest = std::pow(
                           15 * mass * square(speed) / (16 * law.effective_youngs() * std::sqrt(radius)),
                           0.4),
                       time = 2.943275 * deepest / speed;
            const Impact i = impact(law, radius, mass, speed, 3 * time, time / 50);
            measured.x.push_back(e), measured.y.push_back(i.rebound / speed);
        }
    }
    draw(LineChart{.title = "Chung & Ooi's test 3: restitution against what was put in",
                   .x = {.label = "restitution put in", .min = 0, .max = 1.05},
                   .y = {.label = "restitution that came out", .min = 0, .max = 1.05},
                   .curves = {same, clamped, measured}},
         folder / "verification_normal_restitution.png");
}

void linear(const std::filesystem::path& folder) {
    LineChart chart{.title = "Linear spring and dashpot, 1e5 N/m, 1 g, 1 m/s: until the force is spent",
                    .x = {.label = "time", .unit = "us", .min = 0, .max = 330},
                    .y = {.label = "overlap", .unit = "um", .min = 0, .max = 110}};
    Curve closed{.title = "closed form", .style = CurveStyle::dashed},
        peaks{.title = "deepest, by the table", .style = CurveStyle::points};
    for (const auto& row : reference_table("dem04_linear_spring_dashpot_analytic.csv")) {
        const Real k = row.at("k"), mass = row.at("mstar"), zeta = std::abs(row.at("zeta"));
        if (k != 1e5) continue;
        const Real omega = std::sqrt(k / mass), damped = omega * std::sqrt(1 - square(zeta)),
                   end = 2 * std::acos(zeta) / damped,
                   e = zeta > 0 ? std::exp(-zeta * omega * end) : 1;  // that the clamped law shows
        const Impact i =
            impact(LinearSpring{{.stiffness = k, .restitution = e}}, 0.01, mass, 1, end, end / 200);
        Curve c{.title = "damping ratio " + row.texts.at("zeta")};
        if (zeta == 0) c.title = "no damping";
        for (std::size_t n = 0; n < i.time.size(); ++n)
            c.x.push_back(1e6 * i.time[n]), c.y.push_back(1e6 * i.overlap[n]);
        chart.curves.push_back(std::move(c));
        for (int n = 0; n <= 100; ++n) {
            const Real t = n * end / 100;
            closed.x.push_back(1e6 * t);
            closed.y.push_back(1e6 / damped * std::exp(-zeta * omega * t) * std::sin(damped * t));
        }
        closed.x.push_back(NAN), closed.y.push_back(NAN);
        peaks.x.push_back(row.at("t_max_us")), peaks.y.push_back(row.at("delta_max_um"));
    }
    chart.curves.push_back(std::move(closed)), chart.curves.push_back(std::move(peaks));
    draw(chart, folder / "verification_normal_linear.png");
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/normal_impacts";
        std::filesystem::create_directories(folder);
        hertz(folder), restitution(folder), linear(folder);
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
