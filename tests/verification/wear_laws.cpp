// The wear laws through the engine: single impacts and sliding against closed forms (wear01 to wear04).
#include "reference_table.hpp"
#include "wear_scenes.hpp"

#include <doctest/doctest.h>

#include <random>

using namespace abrade;
using namespace abrade::verification;

namespace {

const Archard archard{{.coefficient = 1e-4, .hardness = 1e9}};
const Finnie finnie{{.flow_stress = 1e8}};
const SklarDietrich sklar{{.tensile = 7e6, .youngs = 5e10, .strength_coefficient = 1e6}};
const Ishibashi ishibashi{{.impact = 1e-9, .friction = 2e-10}};
const SubParticleAbrasion paper{{}};

/// Slope of log y over log x between two points.
Real exponent(Real x1, Real y1, Real x2, Real y2) { return std::log(y2 / y1) / std::log(x2 / x1); }

struct Rows {
    std::map<std::string, Real> value;
    explicit Rows(const std::string& table) {
        for (const auto& row : reference_table(table)) value[row.texts.at("quantity")] = row.at("value");
    }
};

/// A body that slides over flat concrete, in balance on its springs, until `end`. A foot off the middle
/// stands a little lower, which is as much as its spring is pressed.
auto slid(const Clump& body, Real mass, Real height, int feet, const ChosenWear& wear, Real end) {
    const Real stiffness = 1e6, ground = 1e4;  // falls off by 0.02 mm on the way
    const Real lower = feet > 1 ? square(0.05) / ground : 0;
    Scene scene;
    scene.concrete = flat_concrete(ground);
    scene.add_stone(body,
                    {.position = {0, 0, height - lower - mass * standard_gravity / (feet * stiffness)},
                     .velocity = {2, 0, 0}},
                    mass / body.volume);
    auto sim = simulate(std::move(scene))
                   .contact(LinearSpring{{.stiffness = stiffness, .restitution = 0.3, .friction = 0.3}})
                   .wear(wear);
    sim.run({.end_time = end, .time_step = 2e-5});
    return sim;
}

Clump ball() { return make_clump("ball", {{Vec3::Zero(), 0.02}}); }
Clump block() {
    return make_clump("block",
                      {{{0.05, 0.05, 0}, 0.02},
                       {{0.05, -0.05, 0}, 0.02},
                       {{-0.05, 0.05, 0}, 0.02},
                       {{-0.05, -0.05, 0}, 0.02}},
                      ClumpParts::apart);
}

}  // namespace

TEST_CASE("one oblique impact under each law (wear01)") {
    Real worst_finnie = 0, worst_normal = 0, worst_archard = 0, worst_friction = 0, worst_paper = 0;
    int sliding = 0;
    for (const auto& row : reference_table("wear01_impact_energy_partition_analytic.csv")) {
        if (row.at("vn") < 1e-6) continue;
        CAPTURE(row.at("angle_deg"));
        const Throw impact{.along = row.at("vn"), .across = row.at("vt"), .steps = 400};
        const auto error = [](Real value, Real expected) { return std::abs(value / expected - 1); };
        // Finnie: f by the table, m v^2 / (p psi K); head-on nothing is cut.
        const Real cut = worn_by(impact, finnie), per_f = impact.mass * 25 / (1e8 * 2 * 2);
        if (row.at("f_Finnie") > 1e-6) {
            worst_finnie = std::max(worst_finnie, error(cut, per_f * row.at("f_Finnie")));
        } else {
            CHECK(cut < 1e-15 * per_f);
        }
        const Real brought = row.at("KE_normal");
        worst_normal = std::max(worst_normal, error(worn_by(impact, sklar), brought / 4.9e8));
        if (!row.contains("W_friction")) continue;
        ++sliding;
        const Real friction = row.at("W_friction");
        worst_archard = std::max(worst_archard, error(worn_by(impact, archard), 1e-13 / 0.3 * friction));
        worst_friction =
            std::max(worst_friction, error(worn_by(impact, ishibashi), 1e-9 * brought + 2e-10 * friction));
        worst_paper = std::max(worst_paper,
                               error(worn_by(impact, paper), 0.55e-7 * (row.at("W_normal_loss") + friction)));
    }
    CHECK(sliding == 2);
    MESSAGE("worst relative error of one impact: Finnie "
            << worst_finnie << ", Sklar-Dietrich " << worst_normal << ", Archard " << worst_archard
            << ", Ishibashi " << worst_friction << ", sub-particle " << worst_paper);
    for (const Real worst : {worst_finnie, worst_normal, worst_archard, worst_friction, worst_paper})
        CHECK(worst < 0.01);  // the gate of wear01
}

TEST_CASE("a sphere that slides until it rolls, and a block until it stops (wear02)") {
    const Rows table("wear02_archard_sliding_sphere_analytic.csv");
    const Real mass = 0.1;
    const auto sphere = slid(ball(), mass, 0.02, 1, archard, 0.3);
    CHECK(sphere.concrete().worn_volume() ==
          doctest::Approx(table.value.at("V_sphere")).epsilon(0.01).scale(0));
    CHECK(sphere.ledger().lost_sliding ==
          doctest::Approx(table.value.at("friction_work_sphere")).epsilon(0.01).scale(0));
    const auto slab = slid(block(), mass, 0.02, 4, archard, 0.75);
    CHECK(slab.concrete().worn_volume() == doctest::Approx(table.value.at("V_block")).epsilon(0.01).scale(0));
    CHECK(slab.ledger().lost_sliding ==
          doctest::Approx(table.value.at("friction_work_block")).epsilon(0.01).scale(0));
    MESSAGE("Archard: sphere " << sphere.concrete().worn_volume() / table.value.at("V_sphere") - 1
                               << ", block "
                               << slab.concrete().worn_volume() / table.value.at("V_block") - 1);

    // What the other laws say of the same block: friction is no impact.
    const Real friction = table.value.at("friction_work_block");
    const Real by_ishibashi = slid(block(), mass, 0.02, 4, ishibashi, 0.75).concrete().worn_volume();
    CHECK(by_ishibashi == doctest::Approx(2e-10 * friction).epsilon(0.01).scale(0));
    const Real by_paper = slid(block(), mass, 0.02, 4, paper, 0.75).concrete().worn_volume();
    CHECK(by_paper == doctest::Approx(0.55e-7 * friction).epsilon(0.01).scale(0));
    const Real by_sklar = slid(block(), mass, 0.02, 4, sklar, 0.75).concrete().worn_volume() * 4.9e8;
    CHECK(by_sklar < 1e-3 * friction);
    MESSAGE("block: Ishibashi " << by_ishibashi / (2e-10 * friction) - 1 << ", sub-particle "
                                << by_paper / (0.55e-7 * friction) - 1 << ", impact energy over friction "
                                << by_sklar / friction);
    // Placed in touch, which begins its contacts, at the 1e-5 m/s along the normal that the great sphere
    // makes.
    CHECK(slid(block(), mass, 0.02, 4, finnie, 0.75).concrete().worn_volume() <
          1e-4 * mass * 4 / (1e8 * 2 * 2));
}

TEST_CASE("Archard against the work of friction: the same in sliding, more of it where an impact sticks") {
    const Ishibashi by_work{{.impact = 0, .friction = 1e-13 / 0.3}};
    for (const Real degrees : {15.0, 30.0, 45.0, 60.0, 75.0}) {
        const Throw impact{
            .along = 5 * std::sin(radians(degrees)), .across = 5 * std::cos(radians(degrees)), .steps = 400};
        const Real ratio = worn_by(impact, archard) / worn_by(impact, by_work);
        MESSAGE(degrees << " degrees: Archard over k / (H mu) times the work of friction " << ratio);
        if (degrees < 31)
            CHECK(ratio == doctest::Approx(1).epsilon(0.01));
        else
            CHECK(ratio > 1);
    }
}

TEST_CASE("Sklar-Dietrich: published impacts (wear03), as a formula and through the engine") {
    Real worst = 0;
    for (const auto& row : reference_table("wear03_sklar_dietrich_single_impact.csv")) {
        const Real diameter = row.at("D_m"), w = row.at("w_normal_mps");
        const Real mass = 2650 * pi / 6 * cube(diameter), energy = 0.5 * mass * square(w);
        CAPTURE(diameter);
        // Six digits are printed: half a unit of the last is up to 5e-6.
        CHECK(energy == doctest::Approx(row.at("KE_J")).epsilon(5e-6).scale(0));
        CHECK(sklar.volume(energy) == doctest::Approx(row.at("V_eroded_m3")).epsilon(5e-6).scale(0));
        CHECK(sklar.energy_of_detachment() == doctest::Approx(row.at("eps_v_J_m3")).epsilon(1e-12).scale(0));
        // The formula itself, to the gate.
        CHECK(sklar.volume(energy) ==
              doctest::Approx(pi * 2650 * cube(diameter) * square(w) * 5e10 / (6 * 1e6 * square(7e6)))
                  .epsilon(1e-6)
                  .scale(0));
        const Throw impact{.radius = diameter / 2, .mass = mass, .along = w, .steps = 2000};
        const Real off = std::abs(worn_by(impact, sklar) / sklar.volume(energy) - 1);
        CHECK(off < 1e-5);
        worst = std::max(worst, off);
    }
    MESSAGE("Sklar-Dietrich through the engine, 2000 steps a contact: " << worst);
}

TEST_CASE("the energy of an impact is the work of approach: second order, whatever the restitution") {
    for (const Real e : {1.0, 0.6, 0.2}) {
        Real last = 0;
        for (const Real steps : {50.0, 100.0, 200.0, 400.0}) {
            Real worst = 0;
            for (const Real phase : {0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95}) {
                const Throw impact{.restitution = e, .steps = steps, .phase = phase};
                worst = std::max(worst, std::abs(worn_by(impact, sklar) * 4.9e8 / (0.5 * impact.mass) - 1));
            }
            MESSAGE("e " << e << ", " << steps << " steps: " << worst << ", order "
                         << (last > 0 ? std::log2(last / worst) : NAN));
            // The gate of wear01, at the usual step; its restitution is 0.6. Dashpots that are nearly
            // critical act at once, and need twice the steps for it.
            if (steps == 50) CHECK(worst < (e > 0.5 ? 0.01 : 0.02));
            if (last > 0) CHECK(worst < 0.35 * last);
            last = worst;
        }
    }
}

TEST_CASE("Finnie: each impact is seen once, grazing ones and those that touch as a step ends") {
    // Fast along the surface of a small sphere, where overlap does not grow by the way along the normal.
    Throw grazing{.along = 0.1, .across = 4, .stiffness = 1e5, .ground = 0.01};
    Throw aligned{.along = 2, .across = 5};
    const Real most = grazing.mass * 16 / (1e8 * 2 * 2), cut = worn_by(aligned, finnie);
    for (int n = 0; n < 200; ++n) {
        grazing.phase = (n + 0.5) / 200;
        const Real worn = worn_by(grazing, finnie);
        REQUIRE(worn > 0);
        REQUIRE(worn < 0.35 * most);  // f is at most 0.33
    }
    for (const Real phase : {0.0, 1e-15, 1e-12, 1e-9, 1 - 1e-9, 1 - 1e-12, 1 - 1e-15}) {
        aligned.phase = phase;
        CHECK(worn_by(aligned, finnie) == doctest::Approx(cut).epsilon(1e-6).scale(0));
    }
}

TEST_CASE("an elastic impact head-on: nothing is dissipated, so the sub-particle law wears nothing") {
    for (const Real phase : {0.0, 0.3, 0.7}) CHECK(worn_by({.restitution = 1, .phase = phase}, paper) == 0);
}

TEST_CASE("how wear scales (wear04)") {
    std::map<std::string, Real> expected;
    for (const auto& row : reference_table("wear04_ishibashi_and_missing.csv"))
        expected[row.texts.at("test")] = row.at("expected_exponent");
    const auto gate = [](Real value) { return doctest::Approx(value).epsilon(0.02).scale(1); };
    const auto sklar_of = [](Real tensile, Real youngs) {
        return worn_by({.steps = 200}, SklarDietrich{{.tensile = tensile, .youngs = youngs}});
    };
    const Throw slow{.along = 1, .steps = 200}, fast{.along = 3, .steps = 200};
    CHECK(exponent(1, worn_by(slow, sklar), 9, worn_by(fast, sklar)) == gate(expected.at("V_vs_normal_KE")));
    CHECK(exponent(1, worn_by(slow, ishibashi), 9, worn_by(fast, ishibashi)) ==
          gate(expected.at("V_vs_normal_KE")));
    CHECK(exponent(2e6, sklar_of(2e6, 3e10), 6e6, sklar_of(6e6, 3e10)) == gate(expected.at("V_vs_sigma_T")));
    CHECK(exponent(1e10, sklar_of(3e6, 1e10), 5e10, sklar_of(3e6, 5e10)) == gate(expected.at("V_vs_Y")));
    // At one mass flux and speed, volume over mass is what counts: larger spheres, fewer of them.
    const Real small = 2650 * 4.0 / 3 * pi * cube(0.01), large = 8 * small;
    CHECK(exponent(1, worn_by({.radius = 0.01, .mass = small, .steps = 200}, sklar) / small, 2,
                   worn_by({.radius = 0.02, .mass = large, .steps = 200}, sklar) / large) ==
          gate(expected.at("V_rate_vs_D_at_fixed_mass_flux_and_w")));
    // Friction: in mass, and in speed squared; Archard as 1/mu where mu N L is given by the impact.
    const Throw grazing{.along = 1, .across = 10, .steps = 200};
    Throw heavy = grazing, twice = grazing;
    heavy.mass *= 4, twice.along *= 2, twice.across *= 2;
    CHECK(exponent(1, worn_by(grazing, archard), 4, worn_by(heavy, archard)) == gate(1));
    CHECK(exponent(1, worn_by(grazing, archard), 2, worn_by(twice, archard)) == gate(2));
    CHECK(exponent(1, worn_by(grazing, finnie), 4, worn_by(heavy, finnie)) == gate(1));
    CHECK(exponent(1, worn_by(grazing, finnie), 2, worn_by(twice, finnie)) == gate(2));
}

TEST_CASE("worn volume and fracture never fall and are never negative, in any law") {
    const auto check = [](const ChosenWear& wear) {
        Scene scene;
        scene.concrete = ConcreteBlock{.lattice = flat_lattice(0.2, 0.2, {.layers = 1}),
                                       .worn_out = WornOut::grain,
                                       .overflow = DropOverflow{}};
        scene.add_wall({-0.1, 0, 0}, {1, 0, 0}).add_wall({0.1, 0, 0}, {-1, 0, 0});
        scene.add_wall({0, -0.1, 0}, {0, 1, 0}).add_wall({0, 0.1, 0}, {0, -1, 0});
        std::mt19937 random(3);
        std::uniform_real_distribution<Real> u(-1, 1);
        for (int n = 0; n < 20; ++n)
            scene.add_stone(make_stone(StoneShape::angular, 0.03),
                            {.position = {0.04 * (n % 4 - 1.5), 0.04 * (n / 4 - 2), 0.03 + 0.001 * (n % 3)},
                             .velocity = Vec3(u(random), u(random), -1)});
        std::vector<Real> before(scene.concrete->lattice.sites.size(), 0);
        auto sim = simulate(std::move(scene))
                       .contact(LinearSpring{{.stiffness = 1e6, .restitution = 1, .friction = 0.4}})
                       .wear(wear);
        Real overflow = 0;
        sim.run({.end_time = 0.1, .time_step = 1e-5, .observe_every = 1e-4}, [&](const auto& now) {
            for (Index s = 0; s < now.concrete().sites(); ++s) {
                Real& last = before[static_cast<std::size_t>(s)];
                REQUIRE(now.concrete().fracture(s) >= last);
                REQUIRE(now.concrete().fracture(s) <= 1);
                last = now.concrete().fracture(s);
            }
            REQUIRE(now.concrete().overflow_volume() >= overflow);
            overflow = now.concrete().overflow_volume();
        });
        CHECK(sim.concrete().worn_volume() > 0);
        return sim.concrete().overflow_volume();
    };
    check(Archard{{.coefficient = 1e-4, .hardness = 1e9}});
    check(Finnie{{.flow_stress = 1e8}});
    check(sklar);
    check(ishibashi);
    check(paper);
    // A site that is worn through stands on under a law of volume alone; the rest is overflow.
    CHECK(check(Archard{{.coefficient = 1e-4, .hardness = 1e9, .acceleration = 1e11}}) > 0);
}
