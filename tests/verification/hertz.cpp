// Hertz-Mindlin impacts through the engine against closed forms and published tables.
#include "reference_table.hpp"

#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

Real sphere_volume(Real radius) { return 4.0 / 3 * pi * cube(radius); }

/// Hertz' time of contact of an elastic impact [s].
Real contact_time(Real mass, Real radius, Real youngs, Real speed) {
    const Real deepest = std::pow(15 * mass * square(speed) / (16 * youngs * std::sqrt(radius)), 0.4);
    return 2.943275 * deepest / speed;
}

struct Impact {
    Real deepest = 0, largest_force = 0, duration = 0;  ///< [m], [N], [s]
};

}  // namespace

TEST_CASE("Chung & Ooi tests 1 and 2: elastic normal impact of spheres, and of a sphere on a wall (dem02)") {
    for (const auto& row : reference_table("dem02_chung_ooi_T1_T2_hertz_analytic.csv")) {
        const Real estar = row.at("Estar_Pa"), radius = row.at("Rstar_m"), mass = row.at("mstar_kg"),
                   speed = row.at("vrel_mps");
        // Any pair with these effective values: here a sphere of R*, m* on a floor. nu = 0: E* = E/2.
        const HertzMindlin law{{.youngs = 2 * estar, .poisson = 0}};
        CHECK(law.effective_youngs() == doctest::Approx(estar).epsilon(1e-14));
        const Real dt = row.at("t_c_us") * 1e-6 / 1000;
        Scene scene;
        scene.gravity.setZero();
        scene.add_wall({0, 0, 0}, {0, 0, 1});
        scene.add_sphere(radius, {.position = {0, 0, radius}, .velocity = {0, 0, -speed}},
                         mass / sphere_volume(radius));
        auto sim = simulate(std::move(scene)).contact(law);
        Impact impact;
        sim.run({.end_time = 1.05 * row.at("t_c_us") * 1e-6, .time_step = dt, .observe_every = dt},
                [&](const auto& s) {
                    const Real overlap = radius - s.particles().position[0].z();
                    impact.deepest = std::max(impact.deepest, overlap);
                    impact.largest_force = std::max(impact.largest_force, s.particles().force[0].z());
                    if (overlap > 0) impact.duration = s.time();
                });
        CHECK(impact.deepest == doctest::Approx(1e-6 * row.at("delta_max_um")).epsilon(1e-4).scale(0));
        CHECK(impact.largest_force == doctest::Approx(1e3 * row.at("F_max_kN")).epsilon(1e-4).scale(0));
        CHECK(impact.duration == doctest::Approx(1e-6 * row.at("t_c_us")).epsilon(0.005).scale(0));
        CHECK(sim.particles().velocity[0].z() == doctest::Approx(speed).epsilon(1e-5).scale(0));
    }
}

TEST_CASE("effective moduli: those of the materials, a rigid partner, two materials") {
    const HertzMindlin same{{.youngs = 7e10, .poisson = 0.33}};
    CHECK(same.effective_youngs() == doctest::Approx(7e10 / (2 * (1 - 0.33 * 0.33))));
    CHECK(same.effective_shear() == doctest::Approx(7e10 / (4 * (2 - 0.33) * (1 + 0.33))));
    const HertzMindlin rigid{{.youngs = 7e10, .poisson = 0.33, .youngs_other = 1e25, .poisson_other = 0.33}};
    CHECK(rigid.effective_youngs() == doctest::Approx(7e10 / (1 - 0.33 * 0.33)));
    const HertzMindlin one{{.youngs = 7e10, .poisson = 0.33, .youngs_other = 2e9, .poisson_other = 0.4}};
    const HertzMindlin two{{.youngs = 2e9, .poisson = 0.4, .youngs_other = 7e10, .poisson_other = 0.33}};
    CHECK(one.effective_youngs() == doctest::Approx(two.effective_youngs()).epsilon(1e-15));
    CHECK(one.effective_shear() == doctest::Approx(two.effective_shear()).epsilon(1e-15));
}

TEST_CASE("Chung & Ooi test 3: restitution comes out as put in, with and without tension (dem03)") {
    std::mt19937 random(3);
    std::uniform_real_distribution<Real> u(0, 1);
    const Real radius = 0.0025, mass = 4000 * sphere_volume(radius), speed = 3.9;
    Real worst[2] = {0, 0};
    for (const auto& row : reference_table("dem03_restitution_damping_map.csv"))
        for (const bool tension : {true, false}) {
            const Real e = row.at("e_in");
            // One contact, not twelve: t_H/50 is stable although `stable_dt` would not grant it.
            const HertzMindlin law{{.youngs = 3.8e11,
                                    .poisson = 0.23,
                                    .restitution = e,
                                    .tension = tension,
                                    .largest_overlap = 1e-3}};
            if (tension)
                CHECK(law.damping_ratio() == doctest::Approx(row.at("zeta_lsd")).epsilon(1e-5).scale(1));
            const Real time = contact_time(mass, radius, law.effective_youngs(), speed);
            for (const int steps : {50, 1000}) {
                const Real dt = time / steps, gap = (2 + u(random)) * speed * dt;
                Scene scene;
                scene.gravity.setZero();
                scene.add_wall({0, 0, 0}, {0, 0, 1});
                scene.add_sphere(radius, {.position = {0, 0, radius + gap}, .velocity = {0, 0, -speed}},
                                 4000);
                auto sim = simulate(std::move(scene)).contact(law);
                sim.run({.end_time = 3 * time, .time_step = dt});
                const Real out = sim.particles().velocity[0].z() / speed;
                CAPTURE(e);
                CAPTURE(tension);
                CAPTURE(steps);
                // The gate of a published audit of another code at t_H/50, and what it reached at t_H/1000.
                CHECK(std::abs(out - e) <= (steps == 50 ? 0.005 : 2.1e-4));
                if (steps == 50) worst[tension] = std::max(worst[tension], std::abs(out - e));
                CHECK(sim.ledger().residual_relative() < 1e-13);
            }
        }
    MESSAGE("worst |e_out - e_in| at t_H/50: " << worst[1] << " with tension, " << worst[0] << " without");
}

TEST_CASE("the map of damping to restitution is met where the contact may not pull (dem03)") {
    // The table's clamped column: the damping of the free contact, clamped, gives another restitution.
    for (const auto& row : reference_table("dem03_restitution_damping_map.csv"))
        CHECK(damping_ratio_without_tension(row.at("e_hertz_clamped")) ==
              doctest::Approx(row.at("zeta_lsd")).epsilon(2e-3).scale(0.1));
}

TEST_CASE("sticking elastic impacts make no energy, at any angle, and what they lose is booked") {
    const Real radius = 0.01, speed = 1;
    const HertzMindlin law{{.youngs = 7e10, .poisson = 0.33, .friction = 1e3}};
    const Real mass = 2700 * sphere_volume(radius),
               time = contact_time(mass, radius, law.effective_youngs(), speed);
    for (const Real degrees : {5., 30., 60., 85.}) {
        Scene scene;
        scene.gravity.setZero();
        scene.add_wall({0, 0, 0}, {0, 0, 1});
        const Real a = radians(degrees);
        scene.add_sphere(
            radius, {.position = {0, 0, radius}, .velocity = {speed * std::sin(a), 0, -speed * std::cos(a)}},
            2700);
        auto sim = simulate(std::move(scene)).contact(law);
        sim.run({.end_time = 4 * time, .time_step = time / 1000});
        const Ledger& e = sim.ledger();
        const Real brought = 0.5 * mass * square(speed);
        CAPTURE(degrees);
        CHECK(sim.particles().velocity[0].z() > 0);
        CHECK(e.kinetic <= brought * (1 + 1e-6));
        CHECK(e.lost_sliding >= 0);
        CHECK(e.kinetic + e.lost_sliding == doctest::Approx(brought).epsilon(2e-5).scale(0));
        CHECK(e.residual_relative() < 1e-13);
    }
}
