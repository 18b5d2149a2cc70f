// The methods on systems whose solution is known: order, energy over a long time, memory, the velocity lag.
#include <abrade/dem/time/odeint_steppers.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <string>

using namespace abrade;

namespace {

/// x'' = -x - 2 zeta v, two of them, the second at half the amplitude; remembers how often it was committed.
struct Oscillator {
    using Vector = std::array<Real, 2>;
    Real zeta = 0;
    long evaluations = 0, commits = 0;
    Vector acceleration(const Vector& x, const Vector& v) {
        ++evaluations;
        return {-x[0] - 2 * zeta * v[0], -x[1] - 2 * zeta * v[1]};
    }
    Vector acceleration_after(Real, const Vector& x, const Vector& v) { return acceleration(x, v); }
    void commit() { ++commits; }
};
static_assert(TrialSystem<Oscillator, 2>);
static_assert(!TrialSystem<Oscillator, 3>);

/// Without the last requirement.
struct NeverCommits {
    std::array<Real, 1> acceleration(const std::array<Real, 1>&, const std::array<Real, 1>&);
    std::array<Real, 1> acceleration_after(Real, const std::array<Real, 1>&, const std::array<Real, 1>&);
};
static_assert(!TrialSystem<NeverCommits, 1>);
static_assert(!Method<Oscillator>);

template <class M>
PhasePoint<2> after(Real time, int steps, Real zeta = 0) {
    Oscillator system{.zeta = zeta};
    PhasePoint<2> point{{1, 0.5}, {0, 0}};
    typename M::template Stepper<Oscillator, 2> stepper(system, point);
    for (int n = 0; n < steps; ++n) stepper.step(time / steps);
    return point;
}

template <class M>
Real error(Real time, int steps, Real zeta = 0) {
    const PhasePoint<2> p = after<M>(time, steps, zeta);
    const Real omega = std::sqrt(1 - square(zeta)), decay = std::exp(-zeta * time);
    const Real x = decay * (std::cos(omega * time) + zeta / omega * std::sin(omega * time));
    const Real v = -decay / omega * std::sin(omega * time);
    CHECK(p.position[1] == doctest::Approx(0.5 * p.position[0]).epsilon(1e-12));
    return std::hypot(p.position[0] - x, p.velocity[0] - v);
}

template <class M>
Real order(Real zeta = 0) {
    return std::log2(error<M>(5, 100, zeta) / error<M>(5, 200, zeta));
}

/// Largest error of the energy in the first thousand steps, and in the last thousand of a million.
struct Drift {
    Real early = 0, late = 0;
};
template <class M>
Drift drift() {
    Oscillator system;
    PhasePoint<2> point{{1, 0.5}, {0, 0}};
    typename M::template Stepper<Oscillator, 2> stepper(system, point);
    Drift drift;
    for (int n = 0; n < 1'000'000; ++n) {
        stepper.step(0.1);
        const Real wrong = std::abs(square(point.position[0]) + square(point.velocity[0]) - 1);
        if (n < 1000) drift.early = std::max(drift.early, wrong);
        if (n >= 999'000) drift.late = std::max(drift.late, wrong);
    }
    return drift;
}

}  // namespace

TEST_CASE_TEMPLATE("order on forces of positions only", M, PredictingVerlet, LaggedVerlet, SymplecticEuler,
                   McLachlan4, ForestRuth, RungeKutta4) {
    const Real measured = order<M>();
    MESSAGE(std::string(M::name) << ": order " << measured);
    CHECK(std::abs(measured - M::order) < 0.2);
}

TEST_CASE("order on forces of velocities, too: only those that say so keep it") {
    const auto says = [](const std::string& name, Real measured, Real expected) {
        MESSAGE(name << ", damped: order " << measured);
        CHECK(std::abs(measured - expected) < 0.2);
    };
    says(PredictingVerlet::name, order<PredictingVerlet>(0.1), 2);
    says(RungeKutta4::name, order<RungeKutta4>(0.1), 4);
    says(LaggedVerlet::name, order<LaggedVerlet>(0.1), 1);
    says(SymplecticEuler::name, order<SymplecticEuler>(0.1), 1);
    says(McLachlan4::name, order<McLachlan4>(0.1), 1);
    says(ForestRuth::name, order<ForestRuth>(0.1), 1);
}

TEST_CASE("the lag of the velocity is what makes odeint's own Verlet worse: 50 steps a half period") {
    const int steps = static_cast<int>(50 * 5 / pi);
    const Real ours = error<PredictingVerlet>(5, steps, 0.2), lagged = error<LaggedVerlet>(5, steps, 0.2);
    MESSAGE("error, zeta = 0.2: predicted velocity " << ours << ", lagged " << lagged);
    CHECK(lagged > 10 * ours);
    // Without damping they are one method.
    const PhasePoint<2> a = after<PredictingVerlet>(5, steps), b = after<LaggedVerlet>(5, steps);
    CHECK(std::abs(a.position[0] - b.position[0]) < 1e-13);
}

TEST_CASE_TEMPLATE("a million steps: the energy of symplectic methods stays bounded", M, PredictingVerlet,
                   LaggedVerlet, SymplecticEuler, McLachlan4, ForestRuth) {
    const Drift measured = drift<M>();
    MESSAGE(std::string(M::name) << ": energy error, first thousand steps " << measured.early << ", last "
                                 << measured.late);
    CHECK(measured.early > 1e-9);  // of the method, above round-off
    CHECK(measured.late < 1.05 * measured.early);
}

TEST_CASE("a million steps: the energy of Runge-Kutta drifts away") {
    const Drift measured = drift<RungeKutta4>();
    MESSAGE("Runge-Kutta 4: energy error, first thousand steps " << measured.early << ", last "
                                                                 << measured.late);
    // |R(i dt)|^2 = 1 - dt^6/72 + dt^8/576 a step.
    const Real per_step = -std::log1p(-1e-6 / 72 + 1e-8 / 576);
    CHECK(measured.early == doctest::Approx(1 - std::exp(-1e3 * per_step)).epsilon(1e-3).scale(0));
    CHECK(measured.late == doctest::Approx(1 - std::exp(-1e6 * per_step)).epsilon(1e-3).scale(0));
}

TEST_CASE_TEMPLATE("each step commits once", M, PredictingVerlet, LaggedVerlet, SymplecticEuler, McLachlan4,
                   ForestRuth, RungeKutta4) {
    Oscillator system;
    PhasePoint<2> point{{1, 0.5}, {0, 0}};
    typename M::template Stepper<Oscillator, 2> stepper(system, point);
    const long evaluations = system.evaluations, commits = system.commits;
    CHECK(commits == 1);
    for (int n = 0; n < 10; ++n) stepper.step(0.1);
    CHECK(system.commits == commits + 10);
    const bool one = M::order <= 2, five = std::string(M::name) == McLachlan4::name;
    CHECK(system.evaluations == evaluations + 10 * (one ? 1 : five ? 5 : 4));
}

TEST_CASE("Dormand-Prince: order 5, and what its tolerance says") {
    using State = std::array<Real, 2>;
    const auto rate = [](const State& y, State& out, Real) { out = {y[1], -y[0]}; };
    const auto fixed = [&](int steps) {
        DormandPrince<State> stepper;
        State y{1, 0};
        for (int n = 0; n < steps; ++n) stepper.do_step(rate, y, n * 5.0 / steps, 5.0 / steps);
        return std::hypot(y[0] - std::cos(5.0), y[1] + std::sin(5.0));
    };
    const Real order = std::log2(fixed(50) / fixed(100));
    MESSAGE("Dormand-Prince 5: order " << order);
    CHECK(std::abs(order - 5) < 0.2);

    for (const Real tolerance : {1e-6, 1e-9, 1e-12}) {
        auto stepper = adaptive_dormand_prince<State>(tolerance, tolerance);
        stepper.initialize(State{1, 0}, 0.0, 0.01);
        while (stepper.current_time() < 5) stepper.do_step(rate);
        State y;
        stepper.calc_state(5, y);
        CHECK(std::hypot(y[0] - std::cos(5.0), y[1] + std::sin(5.0)) < 20 * tolerance);
    }
}
