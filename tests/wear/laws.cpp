// The wear laws as functions: closed forms, units, packs, and increments that are never negative.
#include <abrade/core/simd.hpp>
#include <abrade/wear/archard.hpp>
#include <abrade/wear/finnie.hpp>
#include <abrade/wear/ishibashi.hpp>
#include <abrade/wear/sklar_dietrich.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <random>
#include <tuple>
#include <vector>

using namespace abrade;

namespace {

const std::tuple laws{Archard{{.coefficient = 1e-4, .hardness = 1e9}},
                      Finnie{{.flow_stress = 1e8}},
                      SklarDietrich{{.tensile = 2.7e6, .youngs = 2.68e10}},
                      Ishibashi{{.impact = 1e-10, .friction = 3e-11}},
                      SubParticleAbrasion{{}},
                      NoWear{}};

/// A contact that closes at `approach` and slides at `across` [m/s], pushed by `push` [N].
struct Case {
    ContactKinematics<Real> contact{.normal = {0, 0, 1},
                                    .overlap = 1e-6,
                                    .velocity = Vec3::Zero(),
                                    .inverse_mass = 4,
                                    .curvature = 100,
                                    .time_step = 1e-5};
    ContactLoad<Real> load{Vec3::Zero(), 0, 0, 0};
    Case(Real approach, Real across, Real push) {
        contact.velocity = {0.6 * across, 0.8 * across, -approach};
        contact.displacement = contact.time_step * contact.velocity;
        load.force = {0, 0, push};
    }
};

Real worn(const auto& law, const Case& c) {
    const auto [normal, tangential] = law.increment(c.contact, c.load);
    return normal + tangential;
}
doctest::Approx about(Real value) { return doctest::Approx(value).epsilon(1e-14).scale(0); }

}  // namespace

TEST_CASE("Archard: k / H times load times way, beta times as much") {
    const Archard law{{.coefficient = 1e-4, .hardness = 2e9, .acceleration = 50}};
    CHECK(worn(law, {0.5, 3, 200}) == about(50 * 1e-4 / 2e9 * 200 * 3 * 1e-5));
    CHECK(worn(law, {-0.5, 3, 200}) == about(50 * 1e-4 / 2e9 * 200 * 3 * 1e-5));  // parting, too
    CHECK(worn(law, {0.5, 0, 200}) == 0);
    CHECK(worn(law, {0.5, 3, -200}) == 0);  // what is pulled does not wear
}

TEST_CASE("Finnie: two branches that meet at tan(alpha) = K / 6 with one value and one slope") {
    for (const Real K : {1.0, 2.0, 5.0}) {
        const Finnie law{{.flow_stress = 1e8, .force_ratio = K, .depth_ratio = 3, .cutting_share = 0.5}};
        const Real mass = 0.2, v = 7;
        for (Real degrees = 0; degrees <= 90; degrees += 2.5) {
            const Real a = radians(degrees), sine = std::sin(a), cosine = std::cos(a);
            const Real f = std::tan(a) <= K / 6 && degrees < 90 ? std::sin(2 * a) - 6 / K * sine * sine
                                                                : K / 6 * cosine * cosine;
            CAPTURE(degrees);
            const Real expected = 0.5 * mass * v * v / (1e8 * 3 * K) * f;
            CHECK(law.volume(mass, v * sine, v * cosine) ==
                  doctest::Approx(expected).epsilon(1e-13).scale(mass * v * v / (1e8 * 3 * K)));
        }
        const Real a = std::atan(K / 6), small = 1e-5;
        const auto volume = [&](Real angle) {
            return law.volume(mass, v * std::sin(angle), v * std::cos(angle));
        };
        CHECK((volume(a + small) - volume(a)) / (volume(a) - volume(a - small)) ==
              doctest::Approx(1).epsilon(1e-3));
    }
}

TEST_CASE("Finnie: an impact is booked in the step in which it begins, and in no other") {
    const Finnie law{{.flow_stress = 1e8}};
    Case c(1, 2, 0);           // m_eff = 1/4 kg
    CHECK(worn(law, c) == 0);  // went on
    c.contact.touched = 0;
    CHECK(worn(law, c) == about(0.25 / (1e8 * 2 * 2) * (2.0 / 6) * 4));  // tan = 1/2 > 1/3
    c.contact.overlap = 0;
    CHECK(worn(law, c) == 0);
    c.contact.overlap = -1e-6;
    CHECK(worn(law, c) == 0);
}

TEST_CASE("Sklar-Dietrich and Ishibashi take the work of the normal force while the two approach") {
    const SklarDietrich sklar{
        {.tensile = 7e6, .youngs = 5e10, .strength_coefficient = 1e6, .acceleration = 10}};
    CHECK(sklar.energy_of_detachment() == about(4.9e8));
    CHECK(worn(sklar, {0.5, 3, 200}) == about(10 * 200 * 0.5 * 1e-5 / 4.9e8));
    const Ishibashi ishibashi{{.impact = 1e-9, .friction = 3e-9, .acceleration = 10}};
    Case c(0.5, 3, 200);
    c.load.lost_tangential = 7;
    CHECK(ishibashi.increment(c.contact, c.load).normal == about(10 * 1e-9 * 200 * 0.5 * 1e-5));
    CHECK(ishibashi.increment(c.contact, c.load).tangential == about(10 * 3e-9 * 7));
    for (const Case& nothing : {Case{-0.5, 3, 200}, Case{0.5, 3, -200}, Case{-0.5, 3, -200}}) {
        CHECK(worn(sklar, nothing) == 0);
        CHECK(ishibashi.increment(nothing.contact, nothing.load).normal == 0);
    }
}

TEST_CASE("whatever the contact does, no increment is negative, and packs answer as contacts do") {
    std::mt19937 random(4);
    std::uniform_real_distribution<Real> u(-1, 1);
    const auto anything = [&] { return Vec3(u(random), u(random), u(random)); };
    std::apply(
        [&](const auto&... law) {
            const auto check = [&](const auto& one) {
                int wears = 0;
                for (int n = 0; n < 2000; ++n) {
                    ContactKinematics<Pack> all{};
                    ContactLoad<Pack> loads{Vec3Of<Pack>::Zero(), 0, 0, 0};
                    all.time_step = 1e-5;
                    std::vector<Case> cases(pack_lanes, Case{0, 0, 0});
                    for (int lane = 0; lane < pack_lanes; ++lane) {
                        Case& c = cases[static_cast<std::size_t>(lane)];
                        c.contact.normal = anything().normalized();
                        c.contact.velocity = anything();
                        c.contact.displacement = 1e-5 * anything();
                        c.contact.overlap = 1e-5 * u(random);
                        c.contact.touched = u(random) > 0;
                        const bool touches = c.contact.overlap > 0;  // else laws answer without force
                        c.load = {touches ? Vec3(1e3 * anything()) : Vec3::Zero(), 0,
                                  touches ? std::abs(u(random)) : 0, std::abs(u(random))};
                        for (int a = 0; a < 3; ++a) {
                            all.normal[a].set(lane, c.contact.normal[a]);
                            all.velocity[a].set(lane, c.contact.velocity[a]);
                            all.displacement[a].set(lane, c.contact.displacement[a]);
                            loads.force[a].set(lane, c.load.force[a]);
                        }
                        all.overlap.set(lane, c.contact.overlap), all.inverse_mass.set(lane, 4);
                        all.touched.set(lane, c.contact.touched);
                        loads.lost_normal.set(lane, c.load.lost_normal);
                        loads.lost_tangential.set(lane, c.load.lost_tangential);
                    }
                    const auto packed = one.increment(all, loads);
                    for (int lane = 0; lane < pack_lanes; ++lane) {
                        const Case& c = cases[static_cast<std::size_t>(lane)];
                        const auto alone = one.increment(c.contact, c.load);
                        REQUIRE(alone.normal >= 0);
                        REQUIRE(alone.tangential >= 0);
                        wears += alone.normal + alone.tangential > 0;
                        REQUIRE(packed.normal[lane] ==
                                doctest::Approx(alone.normal).epsilon(1e-12).scale(1e-20));
                        REQUIRE(packed.tangential[lane] ==
                                doctest::Approx(alone.tangential).epsilon(1e-12).scale(1e-20));
                    }
                }
                if constexpr (!std::same_as<std::remove_cvref_t<decltype(one)>, NoWear>) CHECK(wears > 200);
            };
            (check(law), ...);
        },
        laws);
}

TEST_CASE("laws of volume alone leave strength as it is") {
    for (const Real fracture : {0.0, 0.5, 1.0}) {
        CHECK(std::get<Archard>(laws).strength_left(fracture) == 1);
        CHECK(std::get<Finnie>(laws).strength_left(fracture) == 1);
        CHECK(std::get<SklarDietrich>(laws).strength_left(fracture) == 1);
        CHECK(std::get<Ishibashi>(laws).strength_left(fracture) == 1);
    }
}

TEST_CASE("parameters that make no sense, or are not given, are refused by name") {
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    for (const Real bad : {0.0, -1.0, nan}) {
        CHECK_THROWS_AS(Archard({.coefficient = bad, .hardness = 1e9}), InputError);
        CHECK_THROWS_AS(Archard({.coefficient = 1e-4, .hardness = bad}), InputError);
        CHECK_THROWS_AS(Archard({.coefficient = 1e-4, .hardness = 1e9, .acceleration = bad}), InputError);
        CHECK_THROWS_AS(Finnie({.flow_stress = bad}), InputError);
        CHECK_THROWS_AS(Finnie({.flow_stress = 1e8, .force_ratio = bad}), InputError);
        CHECK_THROWS_AS(Finnie({.flow_stress = 1e8, .depth_ratio = bad}), InputError);
        CHECK_THROWS_AS(Finnie({.flow_stress = 1e8, .cutting_share = bad}), InputError);
        CHECK_THROWS_AS(Finnie({.flow_stress = 1e8, .acceleration = bad}), InputError);
        CHECK_THROWS_AS(SklarDietrich({.tensile = bad, .youngs = 2e10}), InputError);
        CHECK_THROWS_AS(SklarDietrich({.tensile = 2e6, .youngs = bad}), InputError);
        CHECK_THROWS_AS(SklarDietrich({.tensile = 2e6, .youngs = 2e10, .strength_coefficient = bad}),
                        InputError);
        CHECK_THROWS_AS(SklarDietrich({.tensile = 2e6, .youngs = 2e10, .acceleration = bad}), InputError);
        CHECK_THROWS_AS(Ishibashi({.impact = 1e-9, .friction = 1e-9, .acceleration = bad}), InputError);
    }
    for (const Real bad : {-1e-9, nan}) {
        CHECK_THROWS_AS(Ishibashi({.impact = bad, .friction = 1e-9}), InputError);
        CHECK_THROWS_AS(Ishibashi({.impact = 1e-9, .friction = bad}), InputError);
    }
    CHECK_THROWS_AS(Finnie({.flow_stress = 1e8, .cutting_share = 1.5}), InputError);
    CHECK_THROWS_WITH_AS(Ishibashi({.impact = 1e-9}), doctest::Contains("Ishibashi.friction"), InputError);
    CHECK_NOTHROW(Ishibashi({.impact = 1e-9, .friction = 0}));  // the impact term alone
}
