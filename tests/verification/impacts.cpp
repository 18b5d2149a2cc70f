// Impacts through the engine against closed forms and published tables.
#include "reference_table.hpp"

#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

/// A sphere thrown at a floor without gravity; returns the simulation once it has left again.
auto thrown(Real radius, Real mass, const Vec3& velocity, const LinearSpring& law, Real dt, Real gap) {
    Scene scene;
    scene.gravity.setZero();
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    scene.add_sphere(radius, {.position = {0, 0, radius + gap}, .velocity = velocity},
                     mass / (4.0 / 3 * pi * cube(radius)));
    auto sim = simulate(std::move(scene)).contact(law);
    const Real contact = pi * std::sqrt(mass / law.stiffness());
    sim.run({.end_time = 2 * contact + 2 * gap / -velocity.z() + 10 * dt, .time_step = dt});
    return sim;
}

}  // namespace

TEST_CASE("restitution comes out as it was put in, at 50 steps a contact, from any gap") {
    std::mt19937 random(2);
    std::uniform_real_distribution<Real> u(0, 1);
    Real worst = 0, worst_residue = 0;
    for (const Real e : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0}) {
        const LinearSpring law{{.stiffness = 1e6, .restitution = e}};
        const Real mass = 0.1, dt = pi * std::sqrt(mass / 1e6) / 50;
        for (int n = 0; n < 20; ++n) {
            const Real speed = 1 + u(random),
                       gap = (3 + u(random)) * speed * dt;  // touches anywhere within a step
            const auto sim = thrown(0.02, mass, {0, 0, -speed}, law, dt, gap);
            const Real out = sim.particles().velocity[0].z() / speed;
            worst = std::max(worst, std::abs(out - e));
            CHECK(std::abs(out - e) <= 0.005);  // the gate of the published audits of other codes
            // The ledger says the same, to the residue that it shows: second order, 2 % at 50 steps.
            const Real brought = 0.5 * mass * speed * speed, lost = brought * (1 - out * out);
            CHECK(sim.ledger().lost_normal + sim.ledger().integration_residue() ==
                  doctest::Approx(lost).scale(brought).epsilon(1e-12));
            CHECK(std::abs(sim.ledger().integration_residue()) < 0.04 * brought);
            worst_residue = std::max(worst_residue, std::abs(sim.ledger().integration_residue()) / brought);
        }
    }
    MESSAGE("worst |e_out - e_in| at 50 steps a contact: " << worst << ", worst integration residue: "
                                                           << worst_residue);
}

TEST_CASE("linear spring-dashpot: time of contact and greatest overlap (dem04)") {
    Real worst_depth = 0, worst_time = 0, worst_duration = 0;
    for (const auto& row : reference_table("dem04_linear_spring_dashpot_analytic.csv")) {
        // The table lets the contact pull, so it ends when the overlap does; the damping is given, not e.
        const Real k = row.at("k"), mass = row.at("mstar"), zeta = std::abs(row.at("zeta"));
        // The restitution that makes our clamped law use the same dashpot.
        const Real e = zeta > 0 ? std::exp(-2 * zeta * std::acos(zeta) / std::sqrt(1 - zeta * zeta)) : 1;
        const LinearSpring law{{.stiffness = k, .restitution = e}};
        CHECK(law.damping_ratio() == doctest::Approx(zeta).epsilon(1e-9).scale(1));
        const Real dt = row.at("t_c_us") * 1e-6 / 500;
        Real deepest = 0, at_deepest = 0, begin = -1, last_push = 0;
        Scene scene;
        scene.gravity.setZero();
        scene.add_wall({0, 0, 0}, {0, 0, 1});
        const Real radius = 0.01;
        scene.add_sphere(radius, {.position = {0, 0, radius + 1e-9}, .velocity = {0, 0, -1}},
                         mass / (4.0 / 3 * pi * cube(radius)));
        auto sim = simulate(std::move(scene)).contact(law);
        sim.run({.end_time = 1.1 * row.at("t_c_us") * 1e-6, .time_step = dt, .observe_every = dt},
                [&](const auto& s) {
                    const Real overlap = radius - s.particles().position[0].z();
                    if (overlap > 0 && begin < 0) begin = s.time() - overlap;  // at 1 m/s
                    if (overlap > deepest) deepest = overlap, at_deepest = s.time();
                    if (s.particles().force[0].z() > 0) last_push = s.time();
                });
        // A contact that may not pull ends when its force is spent, at 2 acos(zeta) / omega_d: without
        // damping that is the table's t_c. To a step of 1/500.
        const Real omega = std::sqrt(k / mass * (1 - zeta * zeta)), duration = 2 * std::acos(zeta) / omega;
        if (zeta == 0) CHECK(duration == doctest::Approx(row.at("t_c_us") * 1e-6).epsilon(1e-5).scale(0));
        CHECK(pi / omega == doctest::Approx(row.at("t_c_us") * 1e-6).epsilon(1e-5).scale(0));
        CHECK(last_push - begin == doctest::Approx(duration).epsilon(0.005).scale(0));
        CHECK(deepest == doctest::Approx(row.at("delta_max_um") * 1e-6).epsilon(0.005).scale(0));
        CHECK(at_deepest - begin ==
              doctest::Approx(row.at("t_max_us") * 1e-6).epsilon(0.01).scale(0));  // to a step of 1/500
        worst_depth = std::max(worst_depth, std::abs(deepest / (row.at("delta_max_um") * 1e-6) - 1));
        worst_time = std::max(worst_time, std::abs((at_deepest - begin) / (row.at("t_max_us") * 1e-6) - 1));
        worst_duration = std::max(worst_duration, std::abs((last_push - begin) / duration - 1));
    }
    MESSAGE("relative errors: greatest overlap " << worst_depth << ", its time " << worst_time
                                                 << ", duration " << worst_duration);
}

TEST_CASE("oblique impact in gross sliding: rebound speed and spin (dem06)") {
    // mu = 0.092, e = 0.98, R = 2.5 mm, 3.9 m/s, angle from the normal as in Chung & Ooi's test 4.
    const Real radius = 2.5e-3, speed = 3.9, mass = 4.0 / 3 * pi * cube(radius) * 4000;
    const LinearSpring law{{.stiffness = 1e7, .restitution = 0.98, .friction = 0.092}};
    const Real dt = pi * std::sqrt(mass / 1e7) / 200;
    for (const auto& row : reference_table("dem06_oblique_gross_sliding_analytic.csv")) {
        const Real theta = radians(row.at("theta_deg"));
        CAPTURE(row.at("theta_deg"));
        const auto sim =
            thrown(radius, mass, speed * Vec3(std::sin(theta), 0, -std::cos(theta)), law, dt, 1e-6);
        CHECK(sim.particles().velocity[0].x() / (speed * std::sin(theta)) ==
              doctest::Approx(row.at("e_t")).epsilon(0.01).scale(0));
        CHECK(sim.particles().angular_velocity(0).norm() ==
              doctest::Approx(row.at("omega_rad_s")).epsilon(0.01));
        CHECK(sim.particles().angular_velocity(0).y() > 0);  // rolls on in the direction of flight
    }
}

TEST_CASE("energy of a sliding impact: normal and frictional losses apart (wear01)") {
    const Real radius = 5e-3, mass = 1e-3;
    const LinearSpring law{{.stiffness = 1e7, .restitution = 0.6, .friction = 0.3}};
    const Real dt = pi * std::sqrt(mass / 1e7) / 400;
    int rows = 0;
    for (const auto& row : reference_table("wear01_impact_energy_partition_analytic.csv")) {
        if (row.at("vn") < 1e-6) continue;
        const auto sim = thrown(radius, mass, {row.at("vt"), 0, -row.at("vn")}, law, dt, 1e-6);
        CAPTURE(row.at("angle_deg"));
        CHECK(sim.ledger().lost_normal == doctest::Approx(row.at("W_normal_loss")).epsilon(0.01).scale(0));
        if (!row.contains("W_friction")) continue;
        CHECK(sim.ledger().lost_sliding == doctest::Approx(row.at("W_friction")).epsilon(0.01).scale(0));
        ++rows;
    }
    CHECK(rows == 2);
}

TEST_CASE("stick regime: the usual step agrees with a step forty times finer") {
    const Real radius = 5e-3, mass = 1e-3;
    for (const Real e : {1.0, 0.6})
        for (const Real degrees : {5.0, 20.0, 40.0}) {
            const LinearSpring law{{.stiffness = 1e7, .restitution = e, .friction = 0.5}};
            const Real contact = pi * std::sqrt(mass / 1e7);
            const Vec3 velocity = 3 * Vec3(std::sin(radians(degrees)), 0, -std::cos(radians(degrees)));
            const auto usual = thrown(radius, mass, velocity, law, contact / 50, 1e-6),
                       fine = thrown(radius, mass, velocity, law, contact / 2000, 1e-6);
            CAPTURE(e);
            CAPTURE(degrees);
            // Of the incoming speed: 2 %, the gate for the stick regime.
            CHECK((usual.particles().velocity[0] - fine.particles().velocity[0]).norm() < 0.02 * 3);
            CHECK((usual.particles().angular_velocity(0) - fine.particles().angular_velocity(0)).norm() *
                      radius <
                  0.02 * 3);
        }
}
