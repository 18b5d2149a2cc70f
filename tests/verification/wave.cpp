// P-waves along rows and through blocks of bonded spheres, without damping: each mode against the chain's
// own.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

#include <vector>

using namespace abrade;

namespace {

constexpr Real spacing = 0.02, stiffness = 4e6, density = 2400;
const Real mass = density * pi / 6 * cube(spacing);
const Real bond_frequency = std::sqrt(stiffness / mass);  ///< sqrt(k_n / m) [1/s]

/// Of mode j = 1 ... N of N equal masses on springs of which the first is held [1/s].
Real chain_frequency(int mode, int count) {
    return 2 * bond_frequency * std::sin((2 * mode - 1) * pi / (2 * (2 * count + 1)));
}

/// How spheres moved along z, summed over layers 1 ... N above the held one with the shape of one mode.
using Amplitudes = std::vector<std::vector<Real>>;  ///< [mode][time] [m]

struct Waves {
    Amplitudes amplitude;
    Real sample = 0;       ///< time between two samples [s]
    Real sideways = 0;     ///< largest displacement across z [m]
    Real along = 0;        ///< largest displacement along z [m]
    Real uneven = 0;       ///< largest difference between two spheres of a layer [m]
    Real unaccounted = 0;  ///< of the energy that was passed on [-]
};

/// Gravity that pulls upward is put on at once; the body then swings in all its modes for four periods of the
/// first. `layer_of(body)` counts from the held layer, 0.
template <class LayerOf>
Waves release(Lattice lattice, int count, const LayerOf& layer_of) {
    std::vector<Vec3> start;
    for (const LatticeSite& site : lattice.sites) start.push_back(site.centre);
    Scene scene;
    scene.gravity = {0, 0, 10};
    scene.concrete = ConcreteBlock{std::move(lattice), density};
    auto sim = simulate(scene)
                   .contact(LinearSpring{{.stiffness = 1}})
                   .bond(MohrCoulomb{{.tensile = 1e12, .stiffness = stiffness, .damping = 0}});
    const Real time_step = 0.02 / bond_frequency;
    Waves seen{Amplitudes(static_cast<std::size_t>(count)), 10 * time_step};
    const Real samples = std::ceil(4 * 2 * pi / chain_frequency(1, count) / seen.sample);
    Real most = 0;
    sim.run({.end_time = samples * seen.sample, .time_step = time_step, .observe_every = seen.sample},
            [&](const auto& now) {
                most = std::max(most, now.ledger().throughput());
                std::vector<Real> first(static_cast<std::size_t>(count) + 1, NAN);
                for (auto& mode : seen.amplitude) mode.push_back(0);
                for (std::size_t b = 0; b < start.size(); ++b) {
                    const Vec3 moved = now.particles().position[b] - start[b];
                    const int layer = layer_of(static_cast<Index>(b));
                    Real& of_layer = first[static_cast<std::size_t>(layer)];
                    if (std::isnan(of_layer)) of_layer = moved.z();
                    seen.uneven = std::max(seen.uneven, std::abs(moved.z() - of_layer));
                    seen.along = std::max(seen.along, std::abs(moved.z()));
                    seen.sideways = std::max(seen.sideways, moved.head(2).norm());
                    for (int j = 1; j <= count; ++j)
                        seen.amplitude[static_cast<std::size_t>(j - 1)].back() +=
                            std::sin(layer * (2 * j - 1) * pi / (2 * count + 1)) * moved.z();
                }
            });
    CHECK(sim.bonds_broken() == 0);
    seen.unaccounted = std::abs(sim.ledger().residual()) / most;
    return seen;
}

/// Of an oscillation about any mean: q(t + h) + q(t - h) = 2 cos(omega h) q(t) + const. The lag h is about a
/// quarter of the period expected [1/s].
Real frequency_of(const std::vector<Real>& q, Real sample, Real expected) {
    const auto lag = static_cast<std::size_t>(std::max(std::round(0.5 * pi / (expected * sample)), Real(1)));
    Real x = 0, y = 0, xx = 0, xy = 0, n = 0;
    for (std::size_t t = lag; t + lag < q.size(); ++t) {
        const Real sum = q[t + lag] + q[t - lag];
        x += q[t], y += sum, xx += square(q[t]), xy += q[t] * sum, ++n;
    }
    const Real slope = (xy - x * y / n) / (xx - x * x / n);
    return std::acos(0.5 * slope) / (static_cast<Real>(lag) * sample);
}

Real frequency_of(const Waves& waves, int mode, int count) {
    return frequency_of(waves.amplitude[static_cast<std::size_t>(mode - 1)], waves.sample,
                        chain_frequency(mode, count));
}

Lattice row(int count) {
    std::vector<Vec3> centres;
    for (int n = 0; n <= count; ++n) centres.push_back({0, 0, n * spacing});
    return lattice_of(centres, 0.5 * spacing, count * cube(spacing), 0.05, 1e-9);
}

/// The speed of long waves from the first mode, f = c / (4 L). Half a sphere stands beyond the last centre.
Real speed(const Waves& waves, int count) {
    return frequency_of(waves, 1, count) / (2 * pi) * 4 * (count + 0.5) * spacing;
}

}  // namespace

TEST_CASE("a row of bonds swings along itself in the chain's own modes; long waves run at d sqrt(k_n/m)") {
    const Real c = spacing * bond_frequency;
    for (const int count : {5, 10, 20, 60}) {
        const Waves waves = release(row(count), count, [](Index b) { return static_cast<int>(b); });
        Real worst = 0;
        for (int j = 1; j <= count; ++j) {
            const Real expected = chain_frequency(j, count);
            // Steps of 0.02 sqrt(m/k) raise the highest, 2 sqrt(k/m), by (0.04)^2 / 24.
            const Real error = frequency_of(waves, j, count) / expected - 1;
            CHECK(std::abs(error) < 1e-4);
            worst = std::max(worst, std::abs(error));
        }
        const Real seen = speed(waves, count);
        MESSAGE(count << " bonds: c " << seen << " m/s, of long waves " << c << " m/s ("
                      << 100 * (seen / c - 1) << " %); worst of all modes " << worst << "; residual "
                      << waves.unaccounted);
        // The chain's own dispersion: sin(x) / x, x = pi / (2 (2 N + 1)).
        const Real x = pi / (2 * (2 * count + 1));
        CHECK(seen == doctest::Approx(c * std::sin(x) / x).epsilon(1e-5).scale(0));
        CHECK(waves.sideways == 0);
        CHECK(waves.unaccounted < 1e-12);
    }
}

TEST_CASE("through a cubic block a plane wave runs as along a row") {
    constexpr int count = 20;
    const Waves waves =
        release(flat_lattice(5 * spacing, 5 * spacing, {.sphere_diameter = spacing, .layers = count + 1}),
                count, [](Index b) { return count - static_cast<int>(b) % (count + 1); });
    Real worst = 0;
    for (int j = 1; j <= count; ++j)
        worst = std::max(worst, std::abs(frequency_of(waves, j, count) / chain_frequency(j, count) - 1));
    MESSAGE("c " << speed(waves, count) << " m/s, of long waves " << spacing * bond_frequency
                 << " m/s; worst of all modes " << worst << "; sideways " << waves.sideways / waves.along
                 << ", uneven " << waves.uneven / waves.along << " of the largest; residual "
                 << waves.unaccounted);
    CHECK(worst < 1e-4);
    CHECK(waves.sideways < 1e-9 * waves.along);
    CHECK(waves.uneven < 1e-9 * waves.along);
    CHECK(waves.unaccounted < 1e-12);
}
