// Our velocity Verlet as one of odeint's steppers.
#include <abrade/dem/time/stepper.hpp>

#include <doctest/doctest.h>
#include <boost/numeric/odeint/integrate/integrate_const.hpp>

#include <cmath>

using namespace abrade;

namespace {

struct Oscillator {
    Real x = 1, v = 0, a = -1;
    int kicks = 0, drifts = 0;
    friend void kick(Oscillator& s, Real dt) { s.v += s.a * dt, ++s.kicks; }
    friend void drift(Oscillator& s, Real dt) { s.x += s.v * dt, ++s.drifts; }
    Real energy() const { return 0.5 * (x * x + v * v); }
};

struct Spring {
    int* calls;
    Real *last_time, *last_step;
    void operator()(Oscillator& s, Real t, Real dt) const {
        s.a = -s.x, ++*calls, *last_time = t, *last_step = dt;
    }
};

struct OnlyKicks {
    [[maybe_unused]] friend void kick(OnlyKicks&, Real) {}
};

static_assert(MechanicalState<Oscillator>);
static_assert(!MechanicalState<OnlyKicks>);
static_assert(!MechanicalState<Real>);

Oscillator after(Real time, int steps) {
    Oscillator state;
    int calls = 0;
    Real t = 0, dt = 0;
    boost::numeric::odeint::integrate_const(VelocityVerlet<Oscillator>{}, Spring{&calls, &t, &dt}, state, 0.0,
                                            time * (1 + 1e-12), time / steps);
    CHECK(calls == steps);
    CHECK(state.drifts == steps);
    CHECK(state.kicks == 2 * steps);
    CHECK(t == doctest::Approx(time).epsilon(1e-12));
    CHECK(dt == doctest::Approx(time / steps).epsilon(1e-12).scale(0));
    return state;
}

}  // namespace

TEST_CASE("integrate_const drives it: the force once a step, at the end of the step") { after(10, 100); }

TEST_CASE("second order in position and velocity") {
    const auto error = [](int steps) {
        const Oscillator s = after(10, steps);
        return std::hypot(s.x - std::cos(10.0), s.v + std::sin(10.0));
    };
    CHECK(VelocityVerlet<Oscillator>{}.order() == 2);
    CHECK(std::log2(error(200) / error(400)) == doctest::Approx(2).epsilon(0.01));
    CHECK(std::log2(error(800) / error(1600)) == doctest::Approx(2).epsilon(0.01));
}

TEST_CASE("energy stays bounded over 1e6 steps and is unstable only beyond dt = 2/omega") {
    Oscillator s;
    VelocityVerlet<Oscillator> stepper;
    const auto force = [](Oscillator& state, Real, Real) { state.a = -state.x; };
    Real early = 0, late = 0;
    for (int n = 0; n < 1'000'000; ++n) {
        stepper.do_step(force, s, n * 0.1, 0.1);
        const Real error = std::abs(s.energy() / 0.5 - 1);
        if (n < 1000) early = std::max(early, error);
        if (n >= 999'000) late = std::max(late, error);
    }
    CHECK(early < 0.1 * 0.1 / 4 * 1.01);  // x^2 + v^2/(1 - dt^2/4) is conserved: the energy swings by dt^2/4
    CHECK(late == doctest::Approx(early).epsilon(0.01).scale(0));

    const auto grows = [&](Real dt) {
        Oscillator o;
        for (int n = 0; n < 10'000; ++n) stepper.do_step(force, o, 0, dt);
        return !(o.energy() < 1e6);  // also beyond what a double holds
    };
    CHECK(!grows(1.99));
    CHECK(grows(2.01));
}

TEST_CASE("each half kick's work is the change in kinetic energy, exactly") {
    Oscillator s;
    VelocityVerlet<Oscillator> stepper;
    Real work = 0;
    for (int n = 0; n < 1000; ++n) {
        // The same step by hand, with the pairing of the ledger.
        Oscillator twin = s;
        const Real v0 = twin.v;
        kick(twin, 0.05);
        work += twin.a * 0.5 * (v0 + twin.v) * 0.05;
        drift(twin, 0.1);
        twin.a = -twin.x;
        const Real v1 = twin.v;
        kick(twin, 0.05);
        work += twin.a * 0.5 * (v1 + twin.v) * 0.05;
        stepper.do_step([](Oscillator& state, Real, Real) { state.a = -state.x; }, s, 0, 0.1);
        REQUIRE(s.x == twin.x);
        REQUIRE(s.v == twin.v);
    }
    CHECK(std::abs(work - 0.5 * s.v * s.v) < 1e-13);  // 2000 roundings of numbers below 0.05
}
