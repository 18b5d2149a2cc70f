// Stones that never move: beds and obstacles.
#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/fluid/uniform_flow.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

const LinearSpring law{{.stiffness = 1e5, .restitution = 0.5, .friction = 0.5}};
const Clump ball = make_clump("ball", {{Vec3::Zero(), 0.02}}),
            dumbbell = make_clump("dumbbell", {{{-0.015, 0, 0}, 0.02}, {{0.015, 0, 0}, 0.02}});

}  // namespace

TEST_CASE("a fixed stone stays, whatever falls on it, and takes part in no account") {
    for (const Clump& clump : {ball, dumbbell}) {
        Scene scene;
        const Quaternion turned(Eigen::AngleAxisd(0.3, Vec3::UnitZ()));
        scene.add_fixed(clump, {0, 0, 0}, turned);
        scene.add_sphere(0.02, {.position = {0.002, 0.001, 0.06}});
        auto sim = simulate(std::move(scene)).contact(law);
        sim.run({.end_time = 0});
        const Particles before = sim.particles();
        CHECK(sim.ledger().kinetic == 0);
        sim.run({.end_time = 0.15});
        const Particles& p = sim.particles();
        REQUIRE(p.kind[0] == Kind::fixed);
        CHECK(p.position[0] == before.position[0]);
        CHECK(p.orientation[0].coeffs() == before.orientation[0].coeffs());
        for (std::size_t s = 0; s < clump.members.size(); ++s) CHECK(p.centre[s] == before.centre[s]);
        CHECK(p.velocity[0] == Vec3::Zero());
        CHECK(sim.ledger().lost_normal > 0);  // it was hit
        CHECK(p.position[1].head<2>().norm() > 0.003);
        CHECK(sim.ledger().potential ==
              doctest::Approx(p.mass[1] * standard_gravity * p.position[1].z()).scale(0));
        CHECK(sim.ledger().residual_relative() < 1e-12);
    }
}

TEST_CASE("a sphere between fixed ones comes to rest on them, and they carry its weight") {
    Scene scene;
    for (const Real angle : {0., 120., 240.})
        scene.add_fixed(ball, 0.025 * Vec3(std::cos(radians(angle)), std::sin(radians(angle)), 0));
    scene.add_sphere(0.02, {.position = {0, 0, 0.05}});
    auto sim = simulate(std::move(scene)).contact(law);
    sim.run({.end_time = 1});
    const Particles& p = sim.particles();
    CHECK(p.velocity[3].norm() < 1e-6);
    Vec3 carried = Vec3::Zero();
    int contacts = 0;
    sim.world().each_contact([&](Index first, Index second, const auto&, const auto& load) {
        carried += (first == 3 ? 1 : -1) * load.force;
        CHECK((first == 3) != (second == 3));  // fixed ones do not meet each other
        ++contacts;
    });
    CHECK(contacts == 3);
    CHECK((carried - Vec3(0, 0, p.mass[3] * standard_gravity)).norm() < 1e-6 * p.mass[3] * standard_gravity);
}

TEST_CASE("fixed stones may overlap each other, but no other stone") {
    Scene scene;
    scene.add_fixed(ball, {0, 0, 0}).add_fixed(ball, {0.01, 0, 0});
    simulate(scene).contact(law).run({.end_time = 1e-3});
    scene.add_sphere(0.02, {.position = {0, 0, 0.01}});
    CHECK_THROWS_AS(simulate(scene).contact(law).run({.end_time = 1e-3}), InputError);
}

TEST_CASE("water does not carry a fixed stone away") {
    Scene scene;
    scene.add_fixed(ball, {0, 0, 0.1});
    auto sim = simulate(std::move(scene)).contact(law).fluid(UniformFlow{{.discharge = 2}});
    sim.run({.end_time = 0.1});
    CHECK(sim.particles().position[0] == Vec3(0, 0, 0.1));
    CHECK(sim.ledger().drag_input == 0);
}
