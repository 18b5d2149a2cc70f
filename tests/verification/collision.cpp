// One collision by every stepper against the reference solution and against the engine.
#include "collision_problem.hpp"

#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

#include <string>

using namespace abrade;
using namespace collision_problem;
using charts::ReferenceCollision;
using charts::ReferenceResult;

namespace {

/// Spins and velocities after 0.6 of an undamped contact that sticks, from first touch: no kink on the way.
template <class M, class Law>
std::array<Real, 4> pressed(const Law& law, const Collision& c, Real time, int steps) {
    PhasePoint<4> point{{c.radius_i + c.radius_j, 0, 0, 0}, {-c.normal_speed(), c.tangential_speed(), 0, 0}};
    PairForces<Law> forces(law, c, point.position);
    typename M::template Stepper<PairForces<Law>, 4> stepper(forces, point);
    for (int n = 0; n < steps; ++n) stepper.step(time / steps);
    auto v = point.velocity;
    v[2] *= c.radius_i, v[3] *= c.radius_j;
    return v;
}
template <class M, class Law>
Real order_while_sticking(const Law& law, int coarse) {
    const Collision c = spheres(30);
    const Real time = 0.6 * charts::ContinuousLaw(law, c).elastic_duration(c.normal_speed());
    const auto exact = pressed<M>(law, c, time, 20'000);
    const auto wrong = [&](int steps) {
        const auto v = pressed<M>(law, c, time, steps);
        Real sum = 0;
        for (std::size_t k = 0; k < 4; ++k) sum += square(v[k] - exact[k]);
        return std::sqrt(sum);
    };
    return std::log2(wrong(coarse) / wrong(4 * coarse)) / 2;
}

/// The same collision by the engine.
template <class Law>
auto in_engine(const Law& law, const Collision& c, Real dt, Real phase) {
    const Real before = (1 + phase) * dt;
    Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(
        c.radius_i,
        {.position = {c.radius_i + c.radius_j + before * c.normal_speed(), -before * c.tangential_speed(), 0},
         .velocity = {-c.normal_speed(), c.tangential_speed(), 0}},
        2650);
    scene.add_sphere(c.radius_j, {.position = {0, 0, 0}}, 2650);
    auto sim = simulate(std::move(scene)).contact(law);
    sim.run({.end_time = 3e-3, .time_step = dt});
    return sim;
}

/// Root mean square over eight phases of |lost - reference| / brought.
template <class M, class Law>
Real error(const Law& law, const Collision& c, Real steps) {
    ReferenceCollision reference(law, c);
    const Real exact = reference.solve().lost(), contact = reference.law().elastic_duration(c.normal_speed());
    Real sum = 0;
    for (int n = 0; n < 8; ++n)
        sum += square((collide<M>(law, c, contact / steps, (n + 0.5) / 8).lost() - exact) / c.brought());
    return std::sqrt(sum / 8);
}
template <class M, class Law>
Real order(const Law& law, const Collision& c) {
    return std::log2(error<M>(law, c, 100) / error<M>(law, c, 1600)) / 4;
}

}  // namespace

TEST_CASE_TEMPLATE("every stepper comes to the reference: loss, split, rebound", M, PredictingVerlet,
                   LaggedVerlet, SymplecticEuler, McLachlan4, ForestRuth, RungeKutta4) {
    // The law's own code on one side, the equations written down apart from it on the other.
    const auto look = [](const auto& law, const Collision& c) {
        ReferenceCollision reference(law, c);
        const ReferenceResult exact = reference.solve();
        const Real dt = reference.law().elastic_duration(c.normal_speed()) / 20'000;
        const CollisionResult r = collide<M>(law, c, dt, 0.3);
        CAPTURE(c.angle);
        CHECK(std::abs(r.lost_normal - exact.lost_normal) < 1e-4 * c.brought());
        CHECK(std::abs(r.lost_tangential - exact.lost_tangential) < 1e-4 * c.brought());
        CHECK(std::abs(r.normal_speed - exact.normal_speed) < 1e-4 * c.speed);
        CHECK(std::abs(r.tangential_speed - exact.tangential_speed) < 1e-4 * c.speed);
        CHECK(std::abs(r.spin_i - exact.spin_i) < 1e-4 * c.speed / c.radius_i);
        CHECK(std::abs(r.spin_j - exact.spin_j) < 1e-4 * c.speed / c.radius_j);
        CHECK(std::abs(r.duration - exact.duration) < 2e-3 * exact.duration);
        CHECK(std::abs(r.deepest - exact.deepest) < 3e-4 * exact.deepest);
    };
    for (const Real e : {1.0, 0.5})
        for (const Real angle : {0.0, 30.0, 60.0, 80.0}) {
            look(linear(e), spheres(angle));
            look(hertz(e), spheres(angle));
        }
    Collision spinning = spheres(30);
    spinning.spin_i = -80, spinning.spin_j = 20;
    look(linear(0.7), spinning);
    look(hertz(0.7), spinning);
}

TEST_CASE("a collision by velocity Verlet is the engine's, but for how dashpots look ahead") {
    // Alone it predicts from the acceleration, in the engine from the contact's last two velocities, whose
    // change also holds how the lever turned: of first order, and small beside the second-order error of
    // either.
    const auto apart = [&](const auto& law, Real dt) {
        const Collision c = spheres(40);
        const auto sim = in_engine(law, c, dt, 0.3);
        const CollisionResult r = collide<PredictingVerlet>(law, c, dt, 0.3);
        const auto& ledger = sim.ledger();
        return std::max({std::abs(ledger.kinetic_start - ledger.kinetic - r.lost()) / r.lost(),
                         std::abs(sim.particles().angular_velocity(0).z() - r.spin_i) / std::abs(r.spin_i),
                         std::abs(sim.particles().angular_velocity(1).z() - r.spin_j) / std::abs(r.spin_j)});
    };
    const auto look = [&](const auto& law) {
        const Real coarse = apart(law, 1e-5), fine = apart(law, 2.5e-6);
        MESSAGE("apart by " << coarse << " at 10 us, by " << fine << " at 2.5 us");
        CHECK(coarse < 5e-5);
        CHECK(fine < coarse / 3);
    };
    look(linear(0.6));
    look(hertz(0.6));
}

TEST_CASE("memory frozen through the stages, committed once: the order is that of the law's memory") {
    const auto says = [](const std::string& what, Real measured, Real expected) {
        MESSAGE(what << ", sticking: order " << measured);
        CHECK(std::abs(measured - expected) < 0.2);
    };
    // So stiff that it hardly turns: the way along the arc is of second order.
    const LinearSpring law = linear(1, 1e6, 1e10);
    says("velocity Verlet, linear", order_while_sticking<PredictingVerlet>(law, 5), 2);
    says("symplectic Euler, linear", order_while_sticking<SymplecticEuler>(law, 5), 1);
    says("symplectic 4th, linear", order_while_sticking<McLachlan4>(law, 5), 4);
    says("Runge-Kutta 4, linear", order_while_sticking<RungeKutta4>(law, 5), 4);
    // A Hertz contact begins to hold tangentially like the square root of time.
    says("velocity Verlet, Hertz", order_while_sticking<PredictingVerlet>(hertz(1, 1e6), 200), 2);
    says("Runge-Kutta 4, Hertz", order_while_sticking<RungeKutta4>(hertz(1, 1e6), 200), 1.25);
}

TEST_CASE(
    "what Hertz' tangential spring gives up and slips is booked where it goes: the residue stays small") {
    Real worst = 0;
    for (const Real angle : {15.0, 30.0, 45.0, 60.0}) {
        const Collision c = spheres(angle);
        const Real dt = charts::ContinuousLaw(hertz(1), c).elastic_duration(c.normal_speed()) / 100;
        for (const Real phase : {0.1, 0.4, 0.7}) {
            const auto sim = in_engine(hertz(1), c, dt, phase);
            worst = std::max(worst, std::abs(sim.ledger().integration_residue()) / c.brought());
            CHECK(sim.ledger().lost_sliding >= 0);
        }
    }
    MESSAGE("100 steps a contact, e = 1: worst integration residue, of the energy brought " << worst);
    CHECK(worst < 1e-4);
}

TEST_CASE("the order of a step is not that of a collision") {
    const auto says = [](const std::string& what, Real measured, Real least, Real most) {
        MESSAGE(what << ": order " << measured);
        CHECK(measured > least);
        CHECK(measured < most);
    };
    // Damping begins with a jump of the force. Verlet knows when within its step; stages do not.
    says("velocity Verlet, linear, e = 0.5, head-on", order<PredictingVerlet>(linear(0.5), spheres(0)), 1.8,
         2.2);
    says("Runge-Kutta 4, linear, e = 0.5, head-on", order<RungeKutta4>(linear(0.5), spheres(0)), 0.8, 1.2);
    says("symplectic 4th, linear, e = 0.5, head-on", order<McLachlan4>(linear(0.5), spheres(0)), 0.8, 1.2);
    says("lagged Verlet, linear, e = 0.5, head-on", order<LaggedVerlet>(linear(0.5), spheres(0)), 0.8, 1.2);
    // Hertz' dashpot begins like t^(1/4).
    says("velocity Verlet, Hertz, e = 0.5, head-on", order<PredictingVerlet>(hertz(0.5), spheres(0)), 1.1,
         1.6);
    // Without damping and friction only the kink of the spring is left: third order for linear springs.
    says("Runge-Kutta 4, linear, e = 1, head-on", order<RungeKutta4>(linear(1), spheres(0)), 2.7, 3.3);
}

TEST_CASE("a fourth order pays once the first touch is found") {
    const LinearSpring law = linear(0.5);
    const Collision c = spheres(0);
    const Real exact = 0.75 * c.brought(), contact = pi * std::sqrt(c.effective_mass() / law.stiffness());
    const auto wrong = [&](Real steps, Real phase) {
        return std::abs(collide<RungeKutta4>(law, c, contact / steps, phase).lost() - exact) / c.brought();
    };
    for (const Real steps : {20, 50, 100}) {
        MESSAGE(steps << " steps a contact, Runge-Kutta 4: touch anywhere " << wrong(steps, 0.5) << ", found "
                      << wrong(steps, 0));
        CHECK(wrong(steps, 0) < 0.02 * wrong(steps, 0.5));
    }
}

TEST_CASE("the lag of the velocity, 50 steps a contact: restitution by odeint's own Verlet and by ours") {
    Real worst_ours = 0, worst_lagged = 0;
    for (const Real e : {0.2, 0.5, 0.8}) {
        const Collision c = spheres(0);
        const LinearSpring law = linear(e);
        const Real dt = pi * std::sqrt(c.effective_mass() / law.stiffness()) / 50;
        Real ours = 0, lagged = 0;
        for (int n = 0; n < 8; ++n) {
            const Real phase = (n + 0.5) / 8;
            ours = std::max(ours, std::abs(collide<PredictingVerlet>(law, c, dt, phase).normal_speed - e));
            lagged = std::max(lagged, std::abs(collide<LaggedVerlet>(law, c, dt, phase).normal_speed - e));
        }
        MESSAGE("e = " << e << ": worst |e_out - e|, predicted velocity " << ours << ", lagged " << lagged);
        worst_ours = std::max(worst_ours, ours);
        worst_lagged = std::max(worst_lagged, lagged);
    }
    CHECK(worst_ours < 0.005);
    CHECK(worst_lagged > 3 * worst_ours);
}

TEST_CASE("a collision's input errors name field, value and rule") {
    const auto message = [](const Collision& c, Real dt = 1e-5, Real phase = 0.5) -> std::string {
        try {
            collide<PredictingVerlet>(linear(1), c, dt, phase);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    CHECK(message(spheres(0)) == "");
    CHECK(message(spheres(90)) == "Collision.angle must be in (-90, 90), got 90 degree; 0 is head-on");
    Collision c = spheres(0);
    c.mass_j = 0;
    CHECK(message(c) ==
          "Collision.mass_j must be finite and > 0, got 0 kg; was it left unset? give a number above 0");
    CHECK(message(spheres(0), -1) ==
          "collide.dt must be finite and > 0, got -1 s; a fiftieth of the time of contact resolves it");
    CHECK(message(spheres(0), 1e-5, 1) ==
          "collide.phase must be in [0, 1), got 1; 0.5 touches halfway through a step");
}
