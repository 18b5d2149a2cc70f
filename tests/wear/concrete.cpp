// The record of wear: capped, overflow apart, depth sums up to volume.
#include <abrade/wear/concrete.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {
Real lost_by_depth(const Concrete& c) {
    Real volume = 0;
    const auto depth = c.depth();
    for (std::size_t k = 0; k < depth.size(); ++k) volume += depth[k] * c.lattice().column_area[k];
    return volume;
}
}  // namespace

TEST_CASE("a site wears until it is fully fractured; the rest is overflow") {
    Concrete c(flat_lattice(0.1, 0.1, {.layers = 2}));
    const Real cell = c.lattice().sites[7].cell_volume;
    CHECK(cell == doctest::Approx(8e-6).scale(0));
    c.wear(7, 0.75 * cell);
    CHECK(c.fracture(7) == doctest::Approx(0.75));
    CHECK(c.overflow_volume() == 0);
    c.wear(7, 0.75 * cell);
    CHECK(c.fracture(7) == 1);
    CHECK(c.overflow_volume() == doctest::Approx(0.5 * cell).scale(0));
    c.wear(7, cell);
    CHECK(c.fracture(7) == 1);
    CHECK(c.worn_volume() == doctest::Approx(cell).scale(0));
    CHECK(c.overflow_volume() == doctest::Approx(1.5 * cell).scale(0));
    CHECK(c.fracture(8) == 0);
}

TEST_CASE("nothing is lost between worn volume and overflow, however small the pieces") {
    Concrete c(flat_lattice(0.1, 0.1, {.layers = 2}));
    Real given = 0;
    for (int n = 0; n < 300'000; ++n) {
        const Real piece = 1e-10 * (1 + n % 7);
        c.wear(static_cast<Index>(n % 5), piece);
        given += piece;
        REQUIRE(c.fracture(static_cast<Index>(n % 5)) <= 1);
    }
    CHECK(c.worn_volume() + c.overflow_volume() ==
          doctest::Approx(given).epsilon(1e-11).scale(0));  // 3e5 roundings
    CHECK(c.overflow_volume() > 0);
}

TEST_CASE("depth times area is the volume lost: worn off those that stand, whole cells of those gone") {
    for (const Lattice& lattice :
         {flat_lattice(0.1, 0.06, {.layers = 3}),
          invert_lattice({.length = 0.1, .width = 0.5, .arc_radius = 0.4}, {.layers = 3})}) {
        Concrete c(lattice);
        for (Index s = 0; s < c.sites(); s += 4) c.wear(s, 1e-7 * (s % 11));
        CHECK(lost_by_depth(c) == doctest::Approx(c.worn_volume()).epsilon(1e-13).scale(0));
        CHECK(c.detached_volume() == 0);
        c.set_gone(4);
        c.set_gone(5);
        CHECK(c.gone(4));
        CHECK(!c.gone(6));
        CHECK(c.detached_volume() > 0);
        CHECK(lost_by_depth(c) ==
              doctest::Approx(c.worn_volume() + c.detached_volume()).epsilon(1e-13).scale(0));
        c.wear(4, 1e-7);  // a grain on its way still wears: what is lost in all stays the same
        const Real before = lost_by_depth(c);
        CHECK(before == doctest::Approx(c.worn_volume() + c.detached_volume()).epsilon(1e-13).scale(0));
    }
}

TEST_CASE("depth of a column whose top sphere is gone is one layer") {
    Concrete c(flat_lattice(0.1, 0.1, {.layers = 3}));
    c.set_gone(c.lattice().site(2, 3, 0));
    const auto depth = c.depth();
    for (Index i = 0; i < 5; ++i)
        for (Index j = 0; j < 5; ++j)
            CHECK(depth[static_cast<std::size_t>(i * 5 + j)] == doctest::Approx(i == 2 && j == 3 ? 0.02 : 0));
}

TEST_CASE("V_omega as the sphere: it is full sooner") {
    Concrete c(flat_lattice(0.1, 0.1, {.layers = 2}), FractureVolume::sphere);
    const Real sphere = pi / 6 * 8e-6;
    CHECK(c.capacity(0) == doctest::Approx(sphere).scale(0));
    c.wear(0, 8e-6);
    CHECK(c.fracture(0) == 1);
    CHECK(c.worn_volume() == doctest::Approx(sphere).scale(0));
    CHECK(c.overflow_volume() == doctest::Approx(8e-6 - sphere).scale(0));
}

TEST_CASE("what one collision wears: wear in consecutive steps, and the largest sum counts") {
    Concrete c(flat_lattice(0.1, 0.1, {.layers = 2}));
    const Real cell = c.capacity(0), dt = 1e-5;
    CHECK(c.largest_collision_share() == 0);
    Real t = 0.3;
    const auto collide = [&](Index site, int steps, Real share) {
        for (int n = 0; n < steps; ++n) c.wear(site, share / steps * cell, t, dt), t += dt;
    };
    collide(3, 50, 0.2);
    CHECK(c.largest_collision_share() == doctest::Approx(0.2).epsilon(1e-12));
    t += dt;  // one step without wear ends it
    collide(3, 80, 0.3);
    CHECK(c.largest_collision_share() == doctest::Approx(0.3).epsilon(1e-12));
    collide(4, 20, 0.25);  // of another sphere
    CHECK(c.largest_collision_share() == doctest::Approx(0.3).epsilon(1e-12));
    collide(3, 1, 0.1);  // a while later on the first again
    CHECK(c.largest_collision_share() == doctest::Approx(0.3).epsilon(1e-12));
    t += 1;
    collide(3, 1000, 2.5);  // more than there is left
    CHECK(c.fracture(3) == 1);
    CHECK(c.largest_collision_share() == doctest::Approx(2.5).epsilon(1e-12));
}

TEST_CASE("a collision that wears without a step is one of its own; V_omega is the yardstick") {
    Concrete c(flat_lattice(0.1, 0.1, {.layers = 2}), FractureVolume::sphere);
    for (int n = 0; n < 3; ++n) c.wear(1, 0.25 * c.capacity(1));
    CHECK(c.largest_collision_share() == doctest::Approx(0.25).epsilon(1e-12));
}

TEST_CASE("no concrete at all is no special case") {
    const Concrete none;
    CHECK(none.sites() == 0);
    CHECK(none.worn_volume() == 0);
    CHECK(none.depth().empty());
    CHECK(none.largest_collision_share() == 0);
}
