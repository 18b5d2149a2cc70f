// What a collision conserves and what it loses, and that the ledger closes.
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

Vec3 momentum(const Particles& p) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t b = 0; b < p.position.size(); ++b) sum += p.mass[b] * p.velocity[b];
    return sum;
}
Vec3 angular_momentum(const Particles& p) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t b = 0; b < p.position.size(); ++b)
        sum += p.mass[b] * p.position[b].cross(p.velocity[b]) + p.angular_momentum[b];
    return sum;
}

/// Two unequal spheres that meet off centre, both spinning.
Scene oblique(Real gap = 1e-3) {
    Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(0.02,
                     {.position = {0, 0, 0}, .velocity = {2, 0.3, 0}, .angular_velocity = {10, -20, 30}});
    scene.add_sphere(
        0.03,
        {.position = {0.045 + gap, 0.02, 0.01}, .velocity = {-1, 0, 0.2}, .angular_velocity = {-5, 8, 12}});
    return scene;
}

Scene head_on(Real gap) {
    Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(0.02, {.position = {0, 0, 0}, .velocity = {2, 0, 0}});
    scene.add_sphere(0.03, {.position = {0.05 + gap, 0, 0}, .velocity = {-1, 0, 0}});
    return scene;
}

template <class Law>
auto collide(Scene scene, const Law& law, Real time, Real dt) {
    auto sim = simulate(std::move(scene)).contact(law);
    sim.run({.end_time = time, .time_step = dt});
    return sim;
}

}  // namespace

TEST_CASE("an oblique impact of spinning spheres: momentum, angular momentum, the ledger") {
    Particles start;
    {
        auto still = simulate(oblique()).contact(LinearSpring{{.stiffness = 1e6}});
        still.run({.end_time = 0});
        start = still.particles();
    }
    for (const Real friction : {0.0, 0.2, 5.0})
        for (const Real restitution : {1.0, 0.5}) {
            CAPTURE(friction);
            CAPTURE(restitution);
            const auto sim = collide(
                oblique(), LinearSpring{{.stiffness = 1e6, .restitution = restitution, .friction = friction}},
                0.005, 2e-6);
            const Real size = 0.1 * 2;  // mass times speed
            CHECK((momentum(sim.particles()) - momentum(start)).norm() < 1e-12 * size);
            CHECK((angular_momentum(sim.particles()) - angular_momentum(start)).norm() < 1e-10 * size * 0.05);
            const Ledger& e = sim.ledger();
            CHECK(e.residual_relative() < 1e-12);
            CHECK(e.stored_contacts == 0);  // they have parted
            CHECK(e.lost_normal >= 0);
            CHECK(e.lost_sliding >= 0);
            if (restitution == 1)
                CHECK(e.lost_normal == 0);
            else
                CHECK(e.lost_normal > 0.1);
            if (friction > 0)
                CHECK(e.lost_sliding > 1e-6);
            else
                CHECK(e.lost_sliding < 1e-6 * e.lost_normal + 1e-7);
            CHECK(std::abs(e.integration_residue()) < 1e-3 * e.kinetic_start);
        }
}

TEST_CASE("a head-on impact loses 1/2 m_eff v^2 (1 - e^2), all of it normal") {
    for (const Real e : {0.9, 0.6, 0.3, 0.1}) {
        const LinearSpring law{{.stiffness = 1e6, .restitution = e, .friction = 0.5}};
        const auto sim = collide(head_on(3.3e-5), law, 0.003, 1e-6);
        const Particles& p = sim.particles();
        const Real m_eff = 1 / (p.inverse_mass[0] + p.inverse_mass[1]);
        CAPTURE(e);
        CHECK(sim.ledger().lost_normal == doctest::Approx(0.5 * m_eff * 9 * (1 - e * e))
                                              .epsilon(1e-3)
                                              .scale(0));  // some 500 steps a contact, second order
        CHECK(sim.ledger().lost_sliding < 1e-28);          // round-off of a unit vector, squared
        CHECK((p.velocity[1] - p.velocity[0]).x() == doctest::Approx(3 * e).epsilon(2e-3).scale(0));
    }
}

TEST_CASE("equal spheres with mirrored spins meet without slip: spins stay (Chung & Ooi 2011, test 7)") {
    Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(0.02,
                     {.position = {-0.0201, 0, 0}, .velocity = {0.2, 0, 0}, .angular_velocity = {0, 0, 5}});
    scene.add_sphere(0.02,
                     {.position = {0.0201, 0, 0}, .velocity = {-0.2, 0, 0}, .angular_velocity = {0, 0, -5}});
    const auto sim = collide(
        std::move(scene), LinearSpring{{.stiffness = 1e6, .restitution = 0.7, .friction = 0.4}}, 0.005, 2e-6);
    CHECK(sim.particles().velocity[0].x() < 0);
    CHECK(sim.particles().angular_velocity(0).z() == doctest::Approx(5).epsilon(1e-10));
    CHECK(sim.particles().angular_velocity(1).z() == doctest::Approx(-5).epsilon(1e-10));
    CHECK(std::abs(sim.particles().velocity[0].y()) < 1e-12);
}

TEST_CASE("the integration residue falls with the step; its order is measured") {
    // One impact begins and ends within a step: the residue depends on where. So the mean over many gaps.
    const auto mean_residue = [](const LinearSpring& law, bool is_oblique, Real dt) {
        Real sum = 0;
        constexpr int gaps = 24;
        for (int n = 0; n < gaps; ++n) {
            const Real gap = 1e-4 + 4e-5 * (n + 0.37) / gaps;
            const auto sim = collide(is_oblique ? oblique(gap) : head_on(gap), law, 0.003, dt);
            sum += std::abs(sim.ledger().integration_residue()) / sim.ledger().kinetic_start / gaps;
        }
        return sum;
    };
    struct Case {
        std::string name;
        LinearSpring law;
        bool is_oblique;
    };
    for (const Case& c :
         {Case{"elastic head-on", LinearSpring{{.stiffness = 1e6}}, false},
          {"damped head-on", LinearSpring{{.stiffness = 1e6, .restitution = 0.5}}, false},
          {"elastic, sticking", LinearSpring{{.stiffness = 1e6, .friction = 5}}, true},
          {"damped, sliding", LinearSpring{{.stiffness = 1e6, .restitution = 0.5, .friction = 0.1}}, true}}) {
        const Real coarse = mean_residue(c.law, c.is_oblique, 4e-6),
                   fine = mean_residue(c.law, c.is_oblique, 5e-7);
        const Real order = std::log2(coarse / fine) / 3;
        MESSAGE(c.name << ": residue " << coarse << " at " << pi * std::sqrt(0.065 / 1e6) / 4e-6
                       << " steps a contact, " << fine << " at eight times as many; order " << order);
        CHECK(order > 1.8);
        CHECK(fine < 1e-4);
    }
}

TEST_CASE("a clump tumbling on a floor closes its ledger") {
    for (const StoneShape shape : {StoneShape::ellipsoid, StoneShape::angular}) {
        Scene scene;
        scene.add_stone(make_stone(shape, 0.05), {.position = {0, 0, 0.06},
                                                  .velocity = {1.5, 0.2, 0},
                                                  .orientation = Quaternion(1, 0.3, -0.2, 0.5).normalized(),
                                                  .angular_velocity = {5, 20, -7}});
        scene.add_wall({0, 0, 0}, {0, 0, 1});
        const auto sim =
            collide(std::move(scene), LinearSpring{{.stiffness = 1e6, .restitution = 0.6, .friction = 0.4}},
                    0.6, 1e-5);
        const Ledger& e = sim.ledger();
        CHECK(e.residual_relative() < 1e-12);
        CHECK(e.lost_normal > 0.05);
        CHECK(e.lost_sliding > 0.05);
        CHECK(std::abs(e.integration_residue()) < 2e-3 * e.throughput());
        CHECK(std::abs(sim.particles().orientation[0].norm() - 1) < 1e-14);
        // Where the energy went, without the works: start = now + lost, up to the residue that is shown.
        const Real start = e.kinetic_start + e.potential_start,
                   now = e.kinetic + e.potential + e.stored_contacts;
        CHECK(start - now - e.lost() ==
              doctest::Approx(e.integration_residue()).scale(e.throughput()).epsilon(1e-11));
    }
}

TEST_CASE("free flight is exact: a parabola, at any step") {
    for (const Real dt : {1e-3, 1e-2, 0.1}) {
        Scene scene;
        scene.add_sphere(0.02, {.velocity = {3, 0, 4}});
        const auto sim = collide(std::move(scene), LinearSpring{{.stiffness = 1}}, 1, dt);
        CHECK((sim.particles().position[0] - Vec3(3, 0, 4 - 0.5 * standard_gravity)).norm() < 1e-12);
        CHECK(std::abs(sim.ledger().integration_residue()) < 1e-12 * sim.ledger().throughput());
    }
}

TEST_CASE("a clump turns its spheres though its three moments are equal") {
    Clump cross = make_clump("cross",
                             {{{0.02, 0, 0}, 0.01},
                              {{-0.02, 0, 0}, 0.01},
                              {{0, 0.02, 0}, 0.01},
                              {{0, -0.02, 0}, 0.01},
                              {{0, 0, 0.02}, 0.01},
                              {{0, 0, -0.02}, 0.01}},
                             ClumpParts::apart);
    cross.principal_moments.setConstant(cross.principal_moments.mean());
    Scene scene;
    scene.gravity = Vec3::Zero();
    scene.add_stone(cross, {.position = {0, 0, 0}, .angular_velocity = {0, 0, 10}});
    for (const bool free_flight : {false, true}) {
        auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1e5}});
        sim.run({.end_time = 0.1, .time_step = 1e-5, .free_flight = free_flight});
        const Particles& p = sim.particles();
        const Real angle = 0.1 * 10;
        for (std::size_t s = 0; s < 6; ++s) {
            const Vec3 at = Eigen::AngleAxis<Real>(angle, Vec3::UnitZ()) * cross.members[s].centre;
            // Second order: (w dt)^2 / 12 of the angle, in flight with dt of the 256 steps that lists last.
            CHECK((p.centre[s] - at).norm() < (free_flight ? 1.1e-6 : 1e-9));
        }
    }
}

TEST_CASE("elastic bouncing neither gains nor loses over a thousand bounces") {
    Scene scene;
    scene.add_sphere(0.02, {.position = {0, 0, 0.03}});
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    auto sim = simulate(std::move(scene)).contact(LinearSpring{{.stiffness = 1e5}});
    // A bounce of 1 cm takes 0.09 s, of which the contact 3 ms.
    sim.run({.end_time = 90, .time_step = 5e-5});
    const Ledger& e = sim.ledger();
    const Real total = e.kinetic + e.potential + e.stored_contacts;
    CHECK(total == doctest::Approx(e.potential_start)
                       .epsilon(0.01)
                       .scale(0));  // each bounce errs by dt^2 at random: no drift of one sign
    CHECK(e.lost_normal == 0);
    CHECK(e.residual_relative() < 1e-12 * (1 + 90 / 5e-5 / 1e6));  // round-off of 1.8 million steps
}

TEST_CASE("a contact that overlaps at the start has its energy in the ledger from the start") {
    Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(0.02, {.position = {-0.0199, 0, 0}});
    scene.add_sphere(0.02, {.position = {0.0199, 0, 0}});
    const auto sim = collide(std::move(scene), LinearSpring{{.stiffness = 1e6}}, 0.003, 1e-6);
    const Real stored = 0.5 * 1e6 * square(2e-4);
    CHECK(sim.ledger().stored_start == doctest::Approx(stored).epsilon(1e-9).scale(0));
    CHECK(sim.ledger().kinetic == doctest::Approx(stored).epsilon(1e-3).scale(0));
    CHECK(std::abs(sim.ledger().integration_residue()) < 1e-3 * stored);
}
