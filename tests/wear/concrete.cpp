// The record of wear: capped, overflow apart, depth sums up to volume. Where overflow goes: overflow.cpp.
#include <abrade/geometry/surface_lattice.hpp>
#include <abrade/wear/concrete.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {
Real lost_by_depth(const Concrete& c) {
    Real volume = 0;
    const auto depth = c.depth();
    for (std::size_t k = 0; k < depth.size(); ++k) volume += depth[k] * c.lattice().column_area[k];
    return volume;
}
/// Spheres of 0.02 m where chance has them, none nearer to another than a diameter.
std::vector<Vec3> thrown_spheres() {
    std::mt19937_64 random(3);
    const auto uniform = [&] { return std::generate_canonical<Real, 53>(random); };
    std::vector<Vec3> all;
    for (int thrown = 0; thrown < 5000; ++thrown) {
        const Real x = 0.1 * uniform(), y = 0.1 * uniform(), z = 0.06 * uniform();
        const Vec3 next(x, y, z);
        if (std::none_of(all.begin(), all.end(), [&](const Vec3& a) { return (a - next).norm() < 0.02; }))
            all.push_back(next);
    }
    return all;
}
}  // namespace

TEST_CASE("a site wears until it is fully fractured; the rest is overflow") {
    Concrete c(flat_lattice(0.1, 0.1, {.layers = 2}), FractureVolume::cell, DropOverflow{});
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
    Concrete c(flat_lattice(0.1, 0.1, {.layers = 2}), FractureVolume::cell, DropOverflow{});
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

TEST_CASE("depth times area is the volume lost, for every kind of lattice") {
    const auto wave = [](Real x, Real y) { return 0.008 * std::sin(40 * x) * std::cos(30 * y); };
    const auto plane = [](Real x, Real y) { return -0.02 + 0.2 * x - 0.1 * y; };
    const std::pair<const char*, Lattice> kinds[] = {
        {"flat", flat_lattice(0.1, 0.06, {.layers = 3})},
        {"invert", invert_lattice({.length = 0.1, .width = 0.5, .arc_radius = 0.4}, {.layers = 3})},
        {"hexagonal", hexagonal_lattice(0.13, 0.11, {.layers = 3})},
        {"random", lattice_of(thrown_spheres(), 0.01, 6e-4, 0.2)},
        {"under a surface", lattice_under(wave, 0.11, 0.1, {.layers = 3})},
        {"cut by a surface", cut_below(hexagonal_lattice(0.13, 0.11, {.layers = 5}), plane)}};
    for (const auto& kind : kinds)
        for (const FractureVolume volume : {FractureVolume::cell, FractureVolume::sphere}) {
            CAPTURE(kind.first);
            Concrete c(kind.second, volume, DropOverflow{});
            REQUIRE(c.sites() > 40);
            const auto conserves = [&] {
                return lost_by_depth(c) ==
                       doctest::Approx(c.worn_volume() + c.detached_volume()).epsilon(1e-13).scale(0);
            };
            for (Index s = 0; s < c.sites(); s += 4) c.wear(s, 1e-7 * (1 + s % 11));
            CHECK(c.detached_volume() == 0);
            CHECK(conserves());
            for (Index s = 0; s < c.sites(); s += 3) c.set_gone(s);  // some of them worn, some not
            CHECK(c.gone(3));
            CHECK(!c.gone(4));
            CHECK(c.detached_volume() > 0);
            CHECK(conserves());
            const Real before = lost_by_depth(c);
            c.wear(0, 1e-7);  // a grain on its way still wears: what is lost in all stays the same
            CHECK(lost_by_depth(c) == before);
            CHECK(conserves());
            for (Index s = 0; s < c.sites(); ++s) c.wear(s, 1), c.set_gone(s);  // nothing is left
            Real cells = 0;
            for (const LatticeSite& site : kind.second.sites) cells += site.cell_volume;
            CHECK(lost_by_depth(c) == doctest::Approx(cells).epsilon(1e-13).scale(0));
            CHECK(conserves());
        }
}

TEST_CASE("a packing's column without a sphere at the surface: its depth begins with a deeper one") {
    // Two columns of one diameter; the second sphere of the first column reaches over the second column.
    Concrete c(lattice_of({{0, 0, 0}, {0.019, 0, 0.018}, {0.024, 0, -0.01}}, 0.01, 3e-5, 0.5));
    REQUIRE(c.lattice().column_area.size() == 2);
    c.set_gone(1);
    CHECK(c.depth()[0] == doctest::Approx(1e-5 / 4e-4));
    CHECK(c.depth()[1] == 0);
    c.set_gone(2);
    CHECK(c.depth()[1] == doctest::Approx(1e-5 / 4e-4));
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
    Concrete c(flat_lattice(0.1, 0.1, {.layers = 2}), FractureVolume::sphere, DropOverflow{});
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

TEST_CASE("what one collision wears counts its excess, wherever that goes and while it waits") {
    for (const Overflow& overflow : {Overflow(FillCrater{}), Overflow(SpreadOverPatch{0.1, 0.1}),
                                     Overflow(SpreadByEpoch{0.1, 1}), Overflow(DropOverflow{})}) {
        Concrete c(flat_lattice(0.1, 0.1, {.layers = 2}), FractureVolume::cell, overflow);
        for (int n = 0; n < 20; ++n) {
            c.wear(3, 0.2 * c.capacity(3), 1e-5 * n, 1e-5);
            c.settle(1e-5 * n);
        }
        CHECK(c.largest_collision_share() == doctest::Approx(4).epsilon(1e-12).scale(0));
        c.settle(std::numeric_limits<Real>::infinity());
        // Sites that settle wears have not been struck.
        CHECK(c.largest_collision_share() == doctest::Approx(4).epsilon(1e-12).scale(0));
    }
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
    CHECK(none.waiting_volume() == 0);
    CHECK(none.largest_collision_share() == 0);
    CHECK(!none.unsettled());
    CHECK(!none.worn_through());
    CHECK(Concrete().settle(1).empty());
}
