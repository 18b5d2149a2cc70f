// Columns stay straight when bodies come and go.
#include <abrade/dem/store/particles.hpp>
#include <abrade/geometry/stone_shapes.hpp>

#include "../message_of.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <random>

using namespace abrade;

namespace {

/// Every column has its length, every sphere knows its body, every body its spheres.
void check_straight(const Particles& p) {
    const auto bodies = static_cast<std::size_t>(p.bodies()), spheres = static_cast<std::size_t>(p.spheres());
    for (const std::size_t size :
         {p.velocity.size(), p.orientation.size(), p.angular_momentum.size(), p.force.size(), p.torque.size(),
          p.mass.size(), p.inverse_mass.size(), p.inverse_inertia.size(), p.volume.size(), p.kind.size(),
          p.id.size(), p.site.size(), p.material.size(), p.first_sphere.size(), p.sphere_count.size()})
        REQUIRE(size == bodies);
    for (const std::size_t size : {p.offset.size(), p.radius.size(), p.centre.size()})
        REQUIRE(size == spheres);
    std::size_t next = 0;
    for (std::size_t b = 0; b < bodies; ++b) {
        REQUIRE(static_cast<std::size_t>(p.first_sphere[b]) == next);
        for (Index k = 0; k < p.sphere_count[b]; ++k, ++next) {
            REQUIRE(p.body[next] == static_cast<Index>(b));
            const Vec3 at = p.position[b] + p.orientation[b] * p.offset[next];
            REQUIRE((p.centre[next] - at).norm() < 1e-14 * (1 + at.norm()));
        }
    }
    REQUIRE(next == spheres);
}

BodyState somewhere(std::mt19937& random) {
    std::uniform_real_distribution<Real> u(-1, 1);
    BodyState s{{u(random), u(random), u(random)},
                {u(random), u(random), u(random)},
                Quaternion(u(random), u(random), u(random), u(random)).normalized(),
                {u(random), u(random), u(random)}};
    return s;
}

}  // namespace

TEST_CASE("a body is what it was made of") {
    Particles p;
    const Clump stone = make_stone(StoneShape::angular, 0.05);
    const Quaternion turn(Eigen::AngleAxis<Real>(0.7, Vec3(1, 2, 3).normalized()));
    const BodyState state{{1, 2, 3}, {4, 5, 6}, turn, {7, 8, 9}};
    const Index b = p.add(stone, 2650, state, Kind::stone);
    check_straight(p);
    CHECK(b == 0);
    CHECK(p.id[0] == 0);
    CHECK(p.site[0] == -1);
    CHECK(p.mass[0] == doctest::Approx(2650 * stone.volume).scale(0));
    CHECK(p.volume[0] == stone.volume);
    CHECK((p.angular_velocity(0) - state.angular_velocity).norm() < 1e-12);
    // Kinetic energy by its definition: 1/2 m v^2 + 1/2 w . (R I R^T) w.
    const Mat3 inertia = turn.toRotationMatrix() * Mat3((2650 * stone.principal_moments).asDiagonal()) *
                         turn.toRotationMatrix().transpose();
    const Real expected = 0.5 * p.mass[0] * state.velocity.squaredNorm() +
                          0.5 * state.angular_velocity.dot(inertia * state.angular_velocity);
    CHECK(p.kinetic_energy(0) == doctest::Approx(expected).epsilon(1e-13).scale(0));
}

TEST_CASE("a fixed body has weight but no motion") {
    Particles p;
    p.add(make_stone(StoneShape::sphere, 0.05), 2400, {.velocity = {1, 1, 1}, .angular_velocity = {1, 0, 0}},
          Kind::fixed);
    CHECK(p.inverse_mass[0] == 0);
    CHECK(p.inverse_inertia[0] == Vec3::Zero());
    CHECK(p.velocity[0] == Vec3::Zero());
    CHECK(p.angular_momentum[0] == Vec3::Zero());
    CHECK(p.kinetic_energy(0) == 0);
    CHECK(p.mass[0] > 0);
}

TEST_CASE("adding and removing at random keeps columns straight and ids unique") {
    std::mt19937 random(4);
    Particles p;
    std::vector<Index> alive;
    const std::array clumps{make_stone(StoneShape::sphere, 0.03), make_stone(StoneShape::ellipsoid, 0.04),
                            make_stone(StoneShape::angular, 0.05)};
    for (int round = 0; round < 60; ++round) {
        for (int n = 0; n < 5; ++n) {
            const Index b = p.add(clumps[random() % 3], 2650, somewhere(random),
                                  random() % 4 ? Kind::stone : Kind::fixed);
            p.site[static_cast<std::size_t>(b)] = 10 * p.id[static_cast<std::size_t>(b)];
            alive.push_back(p.id[static_cast<std::size_t>(b)]);
        }
        check_straight(p);
        std::vector<char> gone(static_cast<std::size_t>(p.bodies()));
        for (char& g : gone) g = random() % 3 == 0;
        if (round % 10 == 9) std::fill(gone.begin(), gone.end(), char{1});
        if (round % 10 == 4) std::fill(gone.begin(), gone.end(), char{0});
        const Particles before = p;
        const auto moved = p.remove(gone);
        check_straight(p);
        for (std::size_t b = gone.size(); b-- > 0;)
            if (gone[b]) alive.erase(alive.begin() + static_cast<std::ptrdiff_t>(b));
        REQUIRE(p.id == alive);  // the order of the rest stays
        for (std::size_t s = 0; s < moved.size(); ++s) {
            const auto b = static_cast<std::size_t>(before.body[s]);
            REQUIRE((moved[s] < 0) == (gone[b] != 0));
            if (moved[s] < 0) continue;
            const auto to = static_cast<std::size_t>(moved[s]), body = static_cast<std::size_t>(p.body[to]);
            REQUIRE(p.id[body] == before.id[b]);
            REQUIRE(p.site[body] == 10 * before.id[b]);
            REQUIRE(p.centre[to] == before.centre[s]);
            REQUIRE(p.radius[to] == before.radius[s]);
            REQUIRE(p.velocity[body] == before.velocity[b]);
            REQUIRE(p.mass[body] == before.mass[b]);
            REQUIRE(p.kind[body] == before.kind[b]);
        }
    }
    CHECK(p.next_id == 300);
}

TEST_CASE("a body that cannot be is refused and leaves no trace") {
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    const Clump sphere = make_stone(StoneShape::sphere, 0.05);
    Particles p;
    for (const Real density : {0.0, -1.0, nan})
        CHECK_THROWS_AS(p.add(sphere, density, {}, Kind::stone), InputError);
    CHECK_THROWS_WITH_AS(p.add(sphere, -1, {}, Kind::stone),
                         "Particles.add.density must be finite and > 0, got -1 kg/m3; stone has 2500 to 2800",
                         InputError);
    CHECK(message_of([&] {
              p.add(sphere, 1, {.position = {0, nan, 0}}, Kind::stone);
          }).starts_with("BodyState.position.y must be finite, got nan m; look for"));
    Clump flat = sphere;
    flat.principal_moments.x() = 0;
    CHECK_THROWS_WITH_AS(p.add(flat, 1, {}, Kind::stone),
                         "Clump.principal_moments must be > 0, got 0 m5; make clumps with make_clump()",
                         InputError);
    CHECK_THROWS_AS(
        p.add(sphere, 1, {.velocity = {0, 0, std::numeric_limits<Real>::infinity()}}, Kind::stone),
        InputError);
    CHECK_THROWS_AS(p.add(sphere, 1, {.angular_velocity = {nan, 0, 0}}, Kind::stone), InputError);
    check_straight(p);
    CHECK(p.bodies() == 0);
}

TEST_CASE("an orientation that is none is refused") {
    const Clump stone = make_stone(StoneShape::angular, 0.05);
    Particles p;
    CHECK_THROWS_AS(
        p.add(stone, 1, {.orientation = Quaternion(std::numeric_limits<Real>::quiet_NaN(), 0, 0, 0)},
              Kind::stone),
        InputError);
    CHECK_THROWS_AS(p.add(stone, 1, {.orientation = Quaternion(0, 0, 0, 0)}, Kind::stone), InputError);
}
