// The reference solution of a collision against closed forms and against itself.
#include "collision_problem.hpp"

#include <doctest/doctest.h>

using namespace abrade;
using namespace collision_problem;
using charts::ReferenceCollision;
using charts::ReferenceResult;

TEST_CASE("reference: restitution of the spring and dashpot, head-on") {
    for (const Real e : {0.05, 0.2, 0.5, 0.8, 0.95, 1.0}) {
        const Collision c = spheres(0);
        const Real lost = 0.5 * c.effective_mass() * (1 - square(e));
        for (const ReferenceResult& r :
             {ReferenceCollision(linear(e), c).solve(), ReferenceCollision(hertz(e), c).solve()}) {
            CAPTURE(e);
            CHECK(std::abs(r.normal_speed - e) < 1e-11);
            CHECK(std::abs(r.lost_normal - lost) < 1e-11 * c.brought());
            CHECK(r.lost_tangential == 0);
        }
    }
    const HertzMindlin pulls{{.youngs = 1e9, .restitution = 0.5, .tension = true}};
    CHECK(std::abs(ReferenceCollision(pulls, spheres(0)).solve().normal_speed - 0.5) < 1e-11);
}

TEST_CASE("reference: Hertz' duration, overlap and force") {
    const Collision c = spheres(0);
    const HertzMindlin law = hertz(1);
    const ReferenceResult r = ReferenceCollision(law, c).solve();
    const Real overlap = std::pow(15 * c.effective_mass() * square(c.speed) /
                                      (16 * law.effective_youngs() * std::sqrt(c.effective_radius())),
                                  0.4);
    CHECK(r.deepest == doctest::Approx(overlap).epsilon(1e-11).scale(0));
    CHECK(r.turning_force ==
          doctest::Approx(4.0 / 3 * law.effective_youngs() * std::sqrt(c.effective_radius() * cube(overlap)))
              .epsilon(1e-11)
              .scale(0));
    // 2 int_0^1 dx / sqrt(1 - x^(5/2)) = 2.9432750...
    CHECK(r.duration == doctest::Approx(2.943275 * overlap / c.speed).epsilon(3e-7).scale(0));
}

TEST_CASE("reference: a tangential spring that sticks") {
    // Solid spheres: the slip has the mass 2/7 m, omega_t^2 = 7/2 k_t/m; undamped contact of length
    // pi/omega_n. What the spring holds at the end is lost. Turning is left out; it falls with the contact's
    // duration.
    // However high the friction, the spring slips in the end: for the last 1/friction of the duration or so.
    const Real ratio = 0.5, friction = 1e9;
    Real before = 0;
    for (const Real stiffness : {1e9, 1e11, 1e13}) {
        const Collision c = spheres(30);
        const LinearSpring law{{.stiffness = stiffness, .friction = friction, .tangential_ratio = ratio}};
        const ReferenceResult r = ReferenceCollision(law, c).solve();
        const Real held = 0.5 * c.effective_mass() * 2 / 7 *
                          square(c.tangential_speed() * std::sin(pi * std::sqrt(3.5 * ratio)));
        const Real wrong = std::abs(r.lost_tangential / held - 1);
        MESSAGE("k = " << stiffness << " N/m: off the closed form by " << wrong);
        if (before > 0) CHECK(wrong == doctest::Approx(0.1 * before).epsilon(0.3).scale(0));
        before = wrong;
    }
    CHECK(before < 1e-4);
}

TEST_CASE("reference: sliding throughout") {
    // The contact turns while it lasts, by some v t_c / (r_i + r_j): the error of the closed form.
    Real before = 0;
    for (const Real stiffness : {1e9, 1e11, 1e13}) {
        const Real e = 0.5, mu = 0.1;
        const Collision c = spheres(60);
        const Real vn = c.normal_speed(), vt = c.tangential_speed();
        const ReferenceResult r = ReferenceCollision(linear(e, mu, stiffness), c).solve();
        const Real lost = mu * c.effective_mass() * vn * (1 + e) * (vt - 7.0 / 4 * mu * (1 + e) * vn);
        const Real wrong = std::abs(r.lost_tangential / lost - 1);
        if (before > 0) CHECK(wrong < 0.15 * before);
        before = wrong;
    }
    CHECK(before < 1e-4);
}

TEST_CASE(
    "reference: its tolerance is met, works are the kinetic energy that is gone, losses the normal work") {
    Real worst = 0, worst_balance = 0, worst_loss = 0;
    const auto look = [&](const auto& law, const Collision& c) {
        ReferenceCollision reference(law, c);
        const ReferenceResult fine = reference.solve(1e-14), usual = reference.solve();
        const auto keep = [&](Real& most, Real difference) {
            most = std::max(most, std::abs(difference) / c.brought());
        };
        keep(worst, usual.lost_normal - fine.lost_normal);
        keep(worst, usual.lost_tangential - fine.lost_tangential);
        keep(worst_balance, usual.kinetic_lost - usual.lost());
        keep(worst_loss, usual.lost_normal - usual.dissipated_normal);
        CHECK(usual.lost_tangential > -1e-13 * c.brought());
    };
    for (const Real e : {1.0, 0.8, 0.5, 0.2})
        for (const Real angle : {0.0, 15.0, 30.0, 45.0, 60.0, 80.0, -45.0}) {
            look(linear(e), spheres(angle));
            look(hertz(e), spheres(angle));
            Collision spinning = spheres(angle);
            spinning.spin_i = 30, spinning.spin_j = -50;
            look(linear(e), spinning);
            look(hertz(e), spinning);
        }
    MESSAGE("reference, of the energy brought: tolerance 1e-13 against 1e-14 " << worst << ", balance "
                                                                               << worst_balance);
    CHECK(worst < 1e-12);
    CHECK(worst_balance < 1e-12);
    CHECK(worst_loss < 1e-12);
}

TEST_CASE("mirrored, a collision loses the same") {
    for (const Real angle : {20.0, 70.0}) {
        const ReferenceResult a = ReferenceCollision(hertz(0.7), spheres(angle)).solve(),
                              b = ReferenceCollision(hertz(0.7), spheres(-angle)).solve();
        CHECK(a.lost_tangential == doctest::Approx(b.lost_tangential).epsilon(1e-12).scale(0));
        const auto left = collide<RungeKutta4>(hertz(0.7), spheres(angle), 1e-6),
                   right = collide<RungeKutta4>(hertz(0.7), spheres(-angle), 1e-6);
        CHECK(left.lost() == doctest::Approx(right.lost()).epsilon(1e-12).scale(0));
        CHECK(left.spin_i == doctest::Approx(-right.spin_i).epsilon(1e-12).scale(0));
    }
}
