// Contacts that lose by yielding, in the engine: concrete of small spheres loses as that of large ones, and a
// heap comes to rest.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/dem/laws/elastic_plastic_hertz.hpp>
#include <abrade/dem/laws/linear_hysteretic.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

template <class Law>
auto simulation(const Scene& scene, const Law& law, Real bond_stiffness = 2e7) {
    return simulate(scene).contact(law).bond(MohrCoulomb{{.tensile = 1e12, .stiffness = bond_stiffness}});
}

/// A sphere of 5 cm that strikes a bonded block 0.12 m thick at 1 m/s: share of its energy that contacts with
/// concrete lost along their normals. The block is as stiff whatever its spheres.
template <class Law>
Real share_lost(const Law& law, Real sphere_diameter) {
    Scene scene;
    scene.gravity.setZero();
    scene.concrete =
        ConcreteBlock{flat_lattice(0.2, 0.2,
                                   {.sphere_diameter = sphere_diameter,
                                    .layers = static_cast<Index>(std::lround(0.12 / sphere_diameter))})};
    scene.add_sphere(0.025, {.position = {0.003, -0.002, 0.0251}, .velocity = {0, 0, -1}});
    auto sim = simulation(scene, law, 1e9 * sphere_diameter);
    sim.run({.end_time = 4e-3});
    const Ledger& ledger = sim.ledger();
    CHECK(ledger.residual_relative() < 1e-12);
    CHECK(std::abs(ledger.integration_residue()) < 1e-3 * ledger.kinetic_start);
    return ledger.concrete_lost_normal / ledger.kinetic_start;
}

}  // namespace

TEST_CASE("what concrete loses to an impact does not fall with the size of its spheres") {
    const LinearSpring dashpot{{.stiffness = 3e6, .restitution = 0.6, .friction = 0.5}};
    const LinearHysteretic hysteretic{{.stiffness = 3e6, .restitution = 0.6, .friction = 0.5}};
    const Real coarse = share_lost(hysteretic, 0.04), middle = share_lost(hysteretic, 0.02),
               fine = share_lost(hysteretic, 0.01);
    const Real dashpot_coarse = share_lost(dashpot, 0.04), dashpot_middle = share_lost(dashpot, 0.02),
               dashpot_fine = share_lost(dashpot, 0.01);
    MESSAGE("share lost with spheres of 4, 2 and 1 cm: hysteretic "
            << coarse << ", " << middle << ", " << fine << "; dashpot " << dashpot_coarse << ", "
            << dashpot_middle << ", " << dashpot_fine);
    // The rest of 1 - e^2 = 0.64 goes into waves in the block: small spheres yield more.
    CHECK(coarse == doctest::Approx(0.58).epsilon(0.05));
    CHECK(fine > 0.7 * coarse);
    CHECK(dashpot_fine < 0.2 * dashpot_coarse);
}

TEST_CASE("concrete of large spheres or small, flat to an elastic-plastic contact") {
    const auto share = [](Real diameter) {
        return share_lost(ElasticPlasticHertz{{.youngs = 2.7e10,
                                               .poisson = 0.2,
                                               .yield_pressure = 5e7,
                                               .friction = 0.5,
                                               .softening = 0.05,
                                               .flat_radius = 0.5 * diameter}},
                          diameter);
    };
    const Real coarse = share(0.04), middle = share(0.02), fine = share(0.01);
    MESSAGE("share lost with spheres of 4, 2 and 1 cm: " << coarse << ", " << middle << ", " << fine);
    CHECK(fine == doctest::Approx(coarse).epsilon(0.1));
}

TEST_CASE("a heap comes to rest, asleep or awake, and then loses next to nothing, or nothing") {
    Scene scene;
    scene.periodic_along = {true, true, false};
    scene.bounds = {{-0.07, -0.07, -1}, {0.07, 0.07, 2}};
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    std::mt19937 random(5);
    const auto uniform = [&] { return std::uniform_real_distribution<Real>(-1e-3, 1e-3)(random); };
    for (int n = 0; n < 108; ++n) {
        const Real y = uniform(), x = uniform();
        const Vec3 at = 0.0212 * Vec3(n / 6 % 6 - 2.5, n % 6 - 2.5, n / 36 + 0.5);
        scene.add_sphere(0.01, {.position = at + Vec3(x, y, 0)});  // some overlap
    }
    const LinearHysteretic law{{.stiffness = 5e4, .restitution = 0.6, .friction = 0.5}};
    for (const Real sleep_speed : {0.0, 2e-3}) {
        CAPTURE(sleep_speed);
        auto sim = simulation(scene, law);
        std::vector<Real> lost;
        bool slept = false, all_asleep = false;  // as of the last observation, and of the one before
        sim.run({.end_time = 2.5, .observe_every = 0.25, .sleep_speed = sleep_speed}, [&](const auto& now) {
            const Ledger& e = now.ledger();
            REQUIRE(e.residual_relative() < 1e-12);
            lost.push_back(e.lost_normal);
            all_asleep = std::exchange(slept, now.world().state().sleep.count == now.particles().bodies());
        });
        const Ledger& e = sim.ledger();
        const Real fallen = e.potential_start - e.potential;
        MESSAGE("fallen " << fallen << " J, kinetic " << e.kinetic << " J, lost in the last 0.25 s "
                          << lost.back() - lost[lost.size() - 2] << " J, residue " << e.integration_residue()
                          << " J");
        CHECK(lost.front() == 0);          // found pressed: no work, no loss
        CHECK(e.kinetic < 1e-5 * fallen);  // some still roll: nothing resists that here
        CHECK(std::abs(e.integration_residue()) < 1e-3 * fallen);
        CHECK(lost.back() - lost[lost.size() - 2] <= (all_asleep ? 0 : 1e-6 * fallen));
    }
}
