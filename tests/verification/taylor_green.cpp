// The decaying vortices of G. Taylor and A. Green 1937, doi 10.1098/rspa.1937.0036, in two dimensions:
//   u = sin x cos z exp(-2 nu t), w = -cos x sin z exp(-2 nu t): orders in space and in time, decay of
//   energy.
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

constexpr Real nu = 0.05;

Point<2> exact(const Point<2>& x, Real t) {
    return std::exp(-2 * nu * t) *
           Point<2>(std::sin(x[0]) * std::cos(x[1]), -std::cos(x[0]) * std::sin(x[1]));
}

template <AdvectionScheme Scheme, class State = Real>
GridFluid<2, InPrecision<State, Advected<Scheme, FullBox>>> vortices(int n, Real shift = 0) {
    // Shifted by parts of a cell nothing may change.
    return GridFluid<2, InPrecision<State, Advected<Scheme, FullBox>>>({.grid = {.cells = {n, n},
                                                          .low = Point<2>::Constant(shift),
                                                          .spacing = Point<2>::Constant(2 * pi / n)},
                                                 .boundaries = BoundaryConditions<2>::all(Boundary::periodic),
                                                 .velocity = [](const Point<2>& x) { return exact(x, 0); },
                                                 .density = 1,
                                                 .viscosity = nu,
                                                 .courant = 1,
                                                 .tolerance = 1e-11});
}

Real error(const auto& flow) {
    Real sum = 0;
    Index count = 0;
    flow.grid().for_each([&](const CellNumber<2>& cell, Offset c) {
        for (int a = 0; a < 2; ++a) {
            sum += square(static_cast<Real>(flow.velocity()[a][c]) -
                          exact(flow.grid().face_centre(a, cell), flow.time())[a]);
            ++count;
        }
    });
    return std::sqrt(sum / count);
}

template <AdvectionScheme Scheme>
Real error_of(int n, int steps) {
    auto flow = vortices<Scheme>(n);
    for (int k = 0; k < steps; ++k) flow.step(1.0 / steps);
    return error(flow);
}

}  // namespace

TEST_CASE("second order in space") {
    const Real coarse = error_of<Central>(32, 32), fine = error_of<Central>(64, 64);
    MESSAGE("central: " << coarse << " and " << fine << ", order " << std::log2(coarse / fine));
    CHECK(std::log2(coarse / fine) > 1.9);
    const Real limited_coarse = error_of<Koren>(32, 32), limited_fine = error_of<Koren>(64, 64);
    MESSAGE("limited: " << limited_coarse << " and " << limited_fine << ", order "
                        << std::log2(limited_coarse / limited_fine));
    CHECK(std::log2(limited_coarse / limited_fine) > 1.9);
}

TEST_CASE("second order in time") {
    // On one grid: what changes with the step is the error of time.
    constexpr int n = 32;
    std::vector<std::vector<Real>> states;
    for (const int steps : {16, 32, 64}) {
        auto flow = vortices<Central>(n, 0.1);
        for (int k = 0; k < steps; ++k) flow.step(1.0 / steps);
        const auto& u = flow.velocity()[0];
        std::vector<Real>& state = states.emplace_back();
        flow.grid().for_each([&](const CellNumber<2>&, Offset c) { state.push_back(u[c]); });
    }
    Real first = 0, second = 0;
    for (std::size_t k = 0; k < states[0].size(); ++k) {
        first += square(states[0][k] - states[1][k]);
        second += square(states[1][k] - states[2][k]);
    }
    const Real order = 0.5 * std::log2(first / second);
    MESSAGE("order in time " << order);
    CHECK(order > 1.9);
}

TEST_CASE("energy decays as exp(-4 nu t)") {
    auto flow = vortices<Central>(64);
    const Real before = flow.kinetic_energy();
    flow.advance(1);
    const Real expected = before * std::exp(-4 * nu);
    MESSAGE("energy off by " << 100 * (flow.kinetic_energy() / expected - 1) << " %");
    CHECK(flow.kinetic_energy() == doctest::Approx(expected).epsilon(1e-3).scale(0));
}
