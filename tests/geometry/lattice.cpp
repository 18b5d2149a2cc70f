// Lattices of concrete: cells fill the body, spheres have room, neighbours are counted once.
#include <abrade/geometry/lattice.hpp>

#include "lattice_sums.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <set>

using namespace abrade;

namespace {

Real closest_pair(const Lattice& lattice) {
    Real closest = 1e300;
    for (const auto& [i, j] : lattice.bonds)
        closest = std::min(closest, (lattice.sites[static_cast<std::size_t>(i)].centre -
                                     lattice.sites[static_cast<std::size_t>(j)].centre)
                                        .norm());
    return closest;
}

constexpr Real round_off = 1e-12;

}  // namespace

TEST_CASE("flat: cells fill the slab, spheres lie inside it and do not overlap") {
    struct Slab {
        Real length, width, diameter;
        Index layers;
    };
    for (const Slab& slab :
         {Slab{0.2, 0.1, 0.02, 3}, {0.25, 0.11, 0.02, 1}, {0.02, 0.02, 0.02, 5}, {1.0, 0.333, 0.017, 2}}) {
        const Real length = slab.length, width = slab.width, d = slab.diameter;
        const Index layers = slab.layers;
        CAPTURE(length);
        CAPTURE(width);
        const Lattice lattice = flat_lattice(length, width, {.sphere_diameter = d, .layers = layers});
        CHECK(sum_of_cells(lattice) == doctest::Approx(length * width * d * layers).epsilon(round_off));
        CHECK(sum_of_areas(lattice) == doctest::Approx(length * width).epsilon(round_off));
        if (lattice.sites.size() > 1) CHECK(closest_pair(lattice) >= d * (1 - round_off));
        Real highest = -1, lowest = 1, left = 1, right = -1;
        for (const LatticeSite& s : lattice.sites) {
            highest = std::max(highest, s.centre.z()), lowest = std::min(lowest, s.centre.z());
            left = std::min(left, s.centre.x()), right = std::max(right, s.centre.x());
        }
        CHECK(highest + lattice.radius == doctest::Approx(0).epsilon(1e-15));  // the surface stands at z = 0
        CHECK(lowest - lattice.radius == doctest::Approx(-layers * d).epsilon(round_off));
        CHECK(left == doctest::Approx(-right).epsilon(round_off));
        CHECK(right + lattice.radius <= 0.5 * length * (1 + round_off));
    }
}

TEST_CASE("flat: a slab meant to hold n spheres holds n") {
    for (int n = 1; n < 200; ++n) {
        CHECK(flat_lattice(n * 0.02, 0.02, {.layers = 1}).count_along == n);
        CHECK(flat_lattice(0.1 * n, 0.1, {.sphere_diameter = 0.1, .layers = 1}).count_along == n);
    }
}

TEST_CASE("sites stand where site() says, neighbours are counted once") {
    const Lattice lattice = flat_lattice(0.1, 0.08, {.layers = 3});
    REQUIRE(lattice.count_along == 5);
    REQUIRE(lattice.count_across == 4);
    REQUIRE(lattice.count_layers == 3);
    REQUIRE(lattice.sites.size() == 60);
    for (Index s = 0; s < 60; ++s) {
        const LatticeSite& site = lattice.sites[static_cast<std::size_t>(s)];
        CHECK(lattice.site(site.along, site.across, site.layer) == s);
    }
    const auto pairs = lattice.bonds;
    CHECK(pairs.size() == 4 * 4 * 3 + 5 * 3 * 3 + 5 * 4 * 2);
    std::set<std::pair<Index, Index>> seen;
    for (const auto& [i, j] : pairs) {
        CHECK(i < j);
        CHECK(seen.insert({i, j}).second);
        CHECK((lattice.sites[static_cast<std::size_t>(i)].centre -
               lattice.sites[static_cast<std::size_t>(j)].centre)
                  .norm() < 0.02 * 1.001);
    }
}

TEST_CASE("invert: cells fill the arch") {
    struct Arch {
        Real width, radius;
        Index layers;
    };
    for (const Arch& arch : {Arch{1.0, 1.0, 3}, {0.5, 2.0, 1}, {0.6, 0.3, 4}, {1.0, 50.0, 2}}) {
        const Real width = arch.width, radius = arch.radius;
        const Index layers = arch.layers;
        CAPTURE(width);
        CAPTURE(radius);
        const Invert invert{.length = 0.3, .width = width, .arc_radius = radius};
        const Lattice lattice = invert_lattice(invert, {.layers = layers});
        const Real outer = radius + layers * 0.02,
                   exact = invert.half_angle() * (outer * outer - radius * radius) * 0.3;
        CHECK(sum_of_cells(lattice) == doctest::Approx(exact).epsilon(round_off));
        CHECK(sum_of_areas(lattice) ==
              doctest::Approx(2 * invert.half_angle() * radius * 0.3).epsilon(round_off));
        for (const LatticeSite& s : lattice.sites) {
            // Under the surface by half a sphere and whole layers.
            const Real depth = std::hypot(s.centre.y(), s.centre.z() - radius) - radius;
            CHECK(depth == doctest::Approx((s.layer + 0.5) * 0.02).epsilon(1e-9));
            CHECK(std::abs(s.centre.y()) < 0.5 * width + layers * 0.02);
            CHECK(s.centre.x() > 0);
            CHECK(s.centre.x() < 0.3);
        }
    }
}

TEST_CASE("invert: no two neighbours stand nearer than a diameter, at any width and radius") {
    // Along the arc the spacing may be exactly a diameter; the straight line between two centres is shorter.
    Real worst = 1;
    for (const Real radius : {0.1, 0.3, 1.0})
        for (int n = 2; n < 10; ++n) {
            const Real span = n * 0.02 / (radius + 0.01);  // n spheres fit the surface layer exactly
            if (span >= pi) continue;
            const Invert invert{
                .length = 0.02, .width = 2 * radius * std::sin(0.5 * span), .arc_radius = radius};
            const Lattice lattice = invert_lattice(invert, {.layers = 2});
            worst = std::min(worst, closest_pair(lattice) / 0.02);
        }
    CHECK(worst >= 1 - round_off);
}

TEST_CASE("bodies and spheres that do not fit are refused, with the rule") {
    const Real nan = std::numeric_limits<Real>::quiet_NaN(), infinite = std::numeric_limits<Real>::infinity();
    for (const Real bad : {0.0, -0.02, nan, infinite})
        CHECK_THROWS_AS(flat_lattice(1, 1, {.sphere_diameter = bad}), InputError);
    CHECK_THROWS_WITH_AS(
        flat_lattice(1, 1, {.layers = 0}),
        "LatticeSize.layers must be at least 1, got 0; a scene without concrete has no lattice", InputError);
    CHECK_THROWS_AS(flat_lattice(1, 1, {.layers = -2}), InputError);
    CHECK_THROWS_WITH_AS(flat_lattice(0.01, 1, {}),
                         "flat_lattice.side must be at least one sphere diameter (0.02 m), got 0.01 m; take "
                         "smaller spheres or a larger body",
                         InputError);
    CHECK_THROWS_AS(flat_lattice(1, 0.01, {}), InputError);
    CHECK_THROWS_AS(flat_lattice(nan, 1, {}), InputError);
    CHECK_THROWS_AS(invert_lattice({.length = 0.01}, {}), InputError);
    CHECK_THROWS_AS(invert_lattice({.width = 0.01}, {}), InputError);
    CHECK_THROWS_AS(invert_lattice({.arc_radius = 0.1}, {}), InputError);
}

TEST_CASE("a slab with a NaN or infinite width is refused") {
    const Real nan = std::numeric_limits<Real>::quiet_NaN(), infinite = std::numeric_limits<Real>::infinity();
    CHECK_THROWS_AS(flat_lattice(1, nan, {}), InputError);
    CHECK_THROWS_AS(flat_lattice(1, infinite, {}), InputError);
    CHECK_THROWS_AS(flat_lattice(infinite, 1, {}), InputError);
}

TEST_CASE(
    "hexagonal lattice: twelve neighbours inside, none nearer than a diameter, the whole body's volume") {
    for (const Real stretch : {1.0, 1.03}) {
        const Real d = 0.02, length = d + 11.5 * d * stretch,
                   width = d + (11 - 2.0 / 3) * d * std::sqrt(0.75) * stretch;
        const Lattice lattice = hexagonal_lattice(length, width, {.sphere_diameter = d, .layers = 6});
        REQUIRE(lattice.count_along == 12);
        REQUIRE(lattice.count_across == 11);
        std::vector<int> degree(lattice.sites.size(), 0);
        for (const auto& [i, j] : lattice.bonds) {
            const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
            CHECK(i < j);
            CHECK((lattice.sites[a].centre - lattice.sites[b].centre).norm() >= d * (1 - 1e-9));
            ++degree[a], ++degree[b];
        }
        Real volume = 0, area = 0;
        int touching = 0;
        for (std::size_t s = 0; s < lattice.sites.size(); ++s) {
            const LatticeSite& site = lattice.sites[s];
            volume += site.cell_volume;
            const bool inside = site.along > 0 && site.along < 11 && site.across > 0 && site.across < 10 &&
                                site.layer > 0 && site.layer < 5;
            CHECK(site.held == (site.layer == 5));
            CHECK(std::abs(site.centre.x()) + 0.5 * d <= 0.5 * length * (1 + 1e-9));
            CHECK(std::abs(site.centre.y()) + 0.5 * d <= 0.5 * width * (1 + 1e-9));
            if (!inside) continue;
            CHECK(degree[s] == 12);
            ++touching;
        }
        for (const Real column : lattice.column_area) area += column;
        CHECK(touching == 10 * 9 * 4);
        const Real height = d + 5 * d * std::sqrt(2.0 / 3);
        CHECK(area == doctest::Approx(length * width).epsilon(1e-12).scale(0));
        CHECK(volume == doctest::Approx(length * width * height).epsilon(1e-12).scale(0));
    }
}

TEST_CASE("hexagonal lattice: one layer, one row, rows stretched by a third; sides too short") {
    const auto volume_of = [](const Lattice& lattice) {
        Real volume = 0;
        for (const LatticeSite& site : lattice.sites) volume += site.cell_volume;
        return volume;
    };
    const Real d = 0.02;
    const Lattice layer = hexagonal_lattice(0.2, 0.2, {.sphere_diameter = d, .layers = 1});
    CHECK(volume_of(layer) == doctest::Approx(0.2 * 0.2 * d).epsilon(1e-12).scale(0));
    const Lattice row = hexagonal_lattice(0.2, 1.5 * d, {.sphere_diameter = d, .layers = 1});
    CHECK(row.count_across == 1);
    CHECK(row.bonds.size() == row.sites.size() - 1);
    const Lattice wide = hexagonal_lattice(2.4 * d, 0.2, {.sphere_diameter = d, .layers = 3});
    CHECK(wide.count_along == 1);
    const Lattice pairs = hexagonal_lattice(2.9 * d, 0.2, {.sphere_diameter = d, .layers = 1});
    CHECK(pairs.count_along == 2);
    CHECK(static_cast<Real>(pairs.bonds.size()) / static_cast<Real>(pairs.sites.size()) > 1.5);
    for (const Real side : {1.4 * d, 1.5 * d * (1 - 1e-9)})
        CHECK_THROWS_WITH_AS(hexagonal_lattice(side, 0.2, {.sphere_diameter = d, .layers = 2}),
                             doctest::Contains("hexagonal_lattice.side"), InputError);
}

TEST_CASE("a body from spheres that stand anywhere: bonds by brute force, shares, columns, what is held") {
    std::vector<Vec3> centres;
    const Real r = 0.01;
    for (int n = 0; n < 400; ++n) {  // a spiral of sorts, so that no axis is special
        const Vec3 next(0.06 * std::cos(1.7 * n), 0.05 * std::sin(2.3 * n), 0.0005 * n);
        const auto near = [&](const Vec3& x) { return (x - next).norm() < 1.001 * r; };
        if (std::none_of(centres.begin(), centres.end(), near)) centres.push_back(next);
    }
    const auto count = static_cast<Index>(centres.size());
    REQUIRE(count > 200);
    const Lattice lattice = lattice_of(centres, r, 3e-3, 0.1, 0.01);
    std::vector<std::pair<Index, Index>> pairs;
    for (Index i = 0; i < count; ++i)
        for (Index j = i + 1; j < count; ++j)
            if ((centres[static_cast<std::size_t>(i)] - centres[static_cast<std::size_t>(j)]).norm() <=
                2.2 * r)
                pairs.emplace_back(i, j);
    CHECK(lattice.bonds == pairs);
    Real volume = 0;
    for (std::size_t s = 0; s < lattice.sites.size(); ++s) {
        const LatticeSite& site = lattice.sites[s];
        CHECK(site.centre == centres[s]);
        CHECK(site.held == (centres[s].z() < 0.01));
        REQUIRE(site.column >= 0);
        REQUIRE(static_cast<std::size_t>(site.column) < lattice.column_area.size());
        volume += site.cell_volume;
    }
    CHECK(volume == doctest::Approx(3e-3).epsilon(1e-12).scale(0));
    CHECK_THROWS_AS(lattice_of({}, r, 1e-3), InputError);
    CHECK_THROWS_AS(lattice_of(centres, 0, 1e-3), InputError);
    CHECK_THROWS_AS(lattice_of(centres, r, -1), InputError);
    centres[9] = centres[4];
    CHECK_THROWS_WITH_AS(lattice_of(centres, r, 1e-3), doctest::Contains("centres[4] and [9]"), InputError);
    centres[9].x() = 1e12;
    CHECK_THROWS_WITH_AS(lattice_of(centres, r, 1e-3), doctest::Contains("stands far from the others"),
                         InputError);
    centres[7].y() = std::nan("");
    CHECK_THROWS_WITH_AS(lattice_of(centres, r, 1e-3), doctest::Contains("lattice_of.centres[7].y"),
                         InputError);
}
