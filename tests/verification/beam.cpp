// bpm01: a cantilever of bonded spheres against the beam that it stands for.
#include <abrade/bond/parallel_bond.hpp>
#include <abrade/sim/simulation.hpp>

#include "reference_table.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace abrade;

namespace {

/// A row of the table: a round straw that is clamped at x = 0.
struct Straw {
    Real length, area, second_moment, youngs, poisson, density, f1;
};

Straw straw_of_table() {
    for (const ReferenceRow& row : reference_table("bpm01_cantilever_beam_analytic.csv"))
        if (row.is("case", "straw_circular_d"))
            return {row.at("L"),  row.at("A"),   row.at("I"),    row.at("E"),
                    row.at("nu"), row.at("rho"), row.at("f1_Hz")};
    throw std::runtime_error("no such row");
}

/// Released from its straight form, it swings about where it would hang.
struct Swing {
    Real tip;          ///< its mean deflection [m]
    Real frequency;    ///< of its first mode [Hz]
    Real unaccounted;  ///< of the most energy that was passed on [-]
};

/// `count` bonds; the first sphere is held. No damping: what moves goes on.
Swing swing(const Straw& straw, int count) {
    const Real spacing = straw.length / count, ball = 0.5 * spacing;
    std::vector<Vec3> centres;
    for (int n = 0; n <= count; ++n) centres.push_back({n * spacing, 0, -1e-9 * (n == 0)});
    Scene scene;
    scene.gravity = {0, 0, -1};
    const Real density = straw.density * straw.area * spacing / (4.0 / 3 * pi * cube(ball));
    scene.concrete =
        ConcreteBlock{lattice_of(centres, ball, straw.length * straw.area, 0.05, -1e-10), density};
    const Real shear = 6 * (1 + straw.poisson) / (7 + 6 * straw.poisson) / (2 * (1 + straw.poisson));
    auto sim = simulate(scene)
                   .contact(LinearSpring{{.stiffness = 1}})
                   .bond(ParallelBond{{.youngs = straw.youngs,
                                       .stiffness_ratio = shear,
                                       .tensile = 1e12,
                                       .cohesion = 1e12,
                                       .radius_factor = std::sqrt(straw.area / pi) / ball,
                                       .damping = 0}});
    // The tip swings as 1 - cos(omega t): its mean over whole periods is the deflection at rest.
    std::vector<Real> times, tips;
    Real most = 0;
    sim.run({.end_time = 4.4 / straw.f1, .observe_every = 0.002 / straw.f1}, [&](const auto& now) {
        most = std::max(most, now.ledger().throughput());
        times.push_back(now.time());
        tips.push_back(-now.particles().position.back().z());
    });
    Real middle = 0;
    for (const Real tip : tips) middle = std::max(middle, 0.5 * tip);
    std::vector<std::size_t> rises;  // through the middle
    for (std::size_t n = 1; n < tips.size(); ++n)
        if (tips[n - 1] < middle && tips[n] >= middle &&
            (rises.empty() || times[n] - times[rises.back()] > 0.5 / straw.f1))
            rises.push_back(n);
    REQUIRE(rises.size() >= 4);
    const std::size_t first = rises.front(), last = rises.back();
    Real sum = 0;
    for (std::size_t n = first; n < last; ++n) sum += tips[n];
    return {sum / static_cast<Real>(last - first),
            static_cast<Real>(rises.size() - 1) / (times[last] - times[first]),
            std::abs(sim.ledger().residual()) / most};
}

/// Deflection of the tip of a Timoshenko beam under equal weights at x = l, 2 l, ... L: bpm01's
/// P x^2 (3 L - x) / (6 E I) + P x / (kappa A G), added up.
Real tip_of(const Straw& s, int count) {
    const Real weight = s.density * s.area * s.length / count;
    const Real kappa = 6 * (1 + s.poisson) / (7 + 6 * s.poisson), shear = s.youngs / (2 * (1 + s.poisson));
    Real tip = 0;
    for (int n = 1; n <= count; ++n) {
        const Real x = s.length * n / count;
        tip += weight * (square(x) * (3 * s.length - x) / (6 * s.youngs * s.second_moment) +
                         x / (kappa * s.area * shear));
    }
    return tip;
}

}  // namespace

TEST_CASE("bpm01: a cantilever of parallel bonds hangs as deep as the beam, and swings as fast") {
    const Straw straw = straw_of_table();
    for (const int count : {10, 20, 60}) {
        const Swing seen = swing(straw, count);
        const Real tip = tip_of(straw, count);
        // Every sphere has the whole mass of its piece, the last one too: half a piece more than the beam.
        const Real f1 = straw.f1 / square(1 + 0.5 / count);
        MESSAGE(count << " bonds: tip " << seen.tip << " m, beam " << tip << " m; f1 " << seen.frequency
                      << " Hz, beam " << straw.f1 << " Hz, half a piece longer " << f1 << " Hz; residual "
                      << seen.unaccounted);
        CHECK(seen.tip == doctest::Approx(tip).epsilon(0.01).scale(0));
        CHECK(seen.frequency == doctest::Approx(f1).epsilon(0.005).scale(0));
        if (count == 60) CHECK(seen.frequency == doctest::Approx(straw.f1).epsilon(0.02).scale(0));
        CHECK(seen.unaccounted < 1e-12);
    }
}
