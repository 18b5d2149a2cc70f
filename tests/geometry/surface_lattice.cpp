// Concrete under any surface: the body's volume, spheres that touch the surface and not each other, bonds to
// neighbours, special cases, and what cannot be followed.
#include <abrade/geometry/surface_lattice.hpp>

#include "../message_of.hpp"
#include "lattice_sums.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <limits>

using namespace abrade;

namespace {

using Surface = std::function<Real(Real, Real)>;

constexpr Real d = 0.02, length = 0.31, width = 0.23;
constexpr Index layers = 3;

Real wave(Real x, Real y) { return 0.02 * std::sin(15 * x) * std::cos(12 * y); }
Real ramp(Real x, Real y) { return 0.9 * x - 0.4 * y; }

/// By all pairs.
Real closest_pair(const Lattice& lattice) {
    Real closest2 = 1e300;
    for (std::size_t i = 0; i < lattice.sites.size(); ++i)
        for (std::size_t j = i + 1; j < lattice.sites.size(); ++j)
            closest2 = std::min(closest2, (lattice.sites[i].centre - lattice.sites[j].centre).squaredNorm());
    return std::sqrt(closest2);
}
/// Of a point below a surface, from points on it, an eighth of a millimetre apart.
Real distance_below(const Surface& surface, const Vec3& x) {
    Real nearest2 = 1e300;
    for (int i = -160; i <= 160; ++i)
        for (int j = -160; j <= 160; ++j) {
            const Real px = x.x() + 1.25e-4 * i, py = x.y() + 1.25e-4 * j;
            nearest2 = std::min(nearest2, (Vec3(px, py, surface(px, py)) - x).squaredNorm());
        }
    return std::sqrt(nearest2);
}

/// A close packing that stands askew, in a box of 0.2 m x 0.2 m: no axis is one of its own.
std::vector<Vec3> askew_packing(Real height) {
    const Quaternion turn = Quaternion(0.7, 0.4, -0.2, 0.5).normalized();
    std::vector<Vec3> all;
    for (int i = -40; i <= 40; ++i)
        for (int j = -40; j <= 40; ++j)
            for (int k = -40; k <= 40; ++k) {
                if ((i + j + k) % 2 != 0) continue;
                const Vec3 x = turn * (1.01 * d / std::sqrt(2.0) * Vec3(i, j, k));
                if (std::abs(x.x()) < 0.1 && std::abs(x.y()) < 0.1 && x.z() > 0 && x.z() < height)
                    all.push_back(x);
            }
    return all;
}

constexpr Real round_off = 1e-12;

}  // namespace

TEST_CASE("under a surface: cells fill the body, spheres touch the surface and do not overlap") {
    struct Case {
        Surface surface;
        Real area;  ///< of the surface over length x width [m2]
        Real area_error, tangent_error;
    };
    // The wave's area by 2000 x 2000 strips; columns see it to second order. Flat and ramp are exact.
    Real wave_area = 0;
    const int strips = 2000;
    for (int i = 0; i < strips; ++i)
        for (int j = 0; j < strips; ++j) {
            const Real x = ((i + 0.5) / strips - 0.5) * length, y = ((j + 0.5) / strips - 0.5) * width;
            wave_area += std::sqrt(1 + square(0.3 * std::cos(15 * x) * std::cos(12 * y)) +
                                   square(0.24 * std::sin(15 * x) * std::sin(12 * y)));
        }
    wave_area *= length * width / square(strips);
    for (const Case& c :
         {Case{[](Real, Real) { return 0.0; }, length * width, round_off, 1e-9},
          {ramp, length * width * std::sqrt(1 + 0.81 + 0.16), round_off, 2e-3},  // by points, not exact
          {wave, wave_area, 1e-3, 0.02}}) {
        const Lattice lattice = lattice_under(c.surface, length, width, {.layers = layers});
        lattice.validate();
        CHECK(lattice.count_along == 15);
        CHECK(lattice.count_across == 11);
        CHECK(sum_of_cells(lattice) ==
              doctest::Approx(length * width * layers * d).epsilon(round_off).scale(0));
        CHECK(sum_of_areas(lattice) == doctest::Approx(c.area).epsilon(c.area_error).scale(0));
        CHECK(closest_pair(lattice) >= d * (1 - round_off));
        Real worst = 0;
        for (const LatticeSite& s : lattice.sites)
            if (s.layer == 0 && s.along % 3 == 1)
                worst = std::max(worst, std::abs(distance_below(c.surface, s.centre) / (0.5 * d) - 1));
        MESSAGE("distance of the first layer's centres to the surface, off the radius by at most "
                << 100 * worst << " %; area off by " << 100 * (sum_of_areas(lattice) / c.area - 1) << " %");
        CHECK(worst < c.tangent_error);
    }
}

TEST_CASE("bonds run to the nearest sphere of each neighbouring column, by brute force") {
    for (const Surface& surface : {Surface{wave}, Surface{ramp}}) {
        const Lattice lattice = lattice_under(surface, length, width, {.layers = layers});
        std::vector<std::pair<Index, Index>> expected;
        const auto at = [&](Index n) -> const LatticeSite& {
            return lattice.sites[static_cast<std::size_t>(n)];
        };
        const auto count = static_cast<Index>(lattice.sites.size());
        for (Index a = 0; a < count; ++a)
            for (Index b = 0; b < count; ++b) {
                const Index along = at(b).along - at(a).along, across = at(b).across - at(a).across;
                if (along == 0 && across == 0 && at(b).layer == at(a).layer + 1) expected.emplace_back(a, b);
                if (along + across != 1 || along < 0 || across < 0) continue;
                if (std::abs(at(b).centre.z() - at(a).centre.z()) < 0.5 * d) expected.emplace_back(a, b);
            }
        auto bonds = lattice.bonds;
        std::sort(bonds.begin(), bonds.end()), std::sort(expected.begin(), expected.end());
        CHECK(bonds == expected);
        Real longest = 0;
        for (const auto& [i, j] : bonds) longest = std::max(longest, (at(i).centre - at(j).centre).norm());
        CHECK(longest < std::sqrt(1.25) * length / 15);
    }
}

TEST_CASE("a flat surface gives the flat lattice, an arc nearly the invert's") {
    const Lattice flat = flat_lattice(length, width, {.layers = layers}),
                  under = lattice_under([](Real, Real) { return 0.0; }, length, width, {.layers = layers});
    REQUIRE(under.sites.size() == flat.sites.size());
    for (std::size_t n = 0; n < flat.sites.size(); ++n) {
        CHECK((under.sites[n].centre - flat.sites[n].centre).norm() < 1e-15);
        CHECK(under.sites[n].cell_volume == flat.sites[n].cell_volume);
        CHECK(under.sites[n].held == flat.sites[n].held);
        CHECK(under.sites[n].column == flat.sites[n].column);
    }
    for (std::size_t c = 0; c < flat.column_area.size(); ++c)
        CHECK(under.column_area[c] == doctest::Approx(flat.column_area[c]).epsilon(round_off).scale(0));
    auto a = under.bonds, b = flat.bonds;
    std::sort(a.begin(), a.end()), std::sort(b.begin(), b.end());
    CHECK(a == b);

    const Invert invert{.length = 0.3, .width = 1, .arc_radius = 1};
    const Lattice arc = invert_lattice(invert, {.layers = layers}),
                  below = lattice_under([&](Real, Real y) { return invert.bed_height(y); }, 0.3, 1,
                                        {.layers = layers});
    // The arc is longer than the width, and its columns stand along its normals.
    CHECK(arc.count_across == 52);
    CHECK(below.count_across == 50);
    Real off = 0;
    for (const LatticeSite& s : below.sites)
        if (s.layer == 0)
            off = std::max(off, std::abs(std::hypot(s.centre.y(), s.centre.z() - 1) - 1.01) / 0.01);
    const Real area_off = sum_of_areas(below) / sum_of_areas(arc) - 1;
    MESSAGE("first layer off the invert's depth by at most " << 100 * off << " % of a radius; area off by "
                                                             << area_off << ", volume by "
                                                             << sum_of_cells(below) / sum_of_cells(arc) - 1);
    CHECK(off < 0.003);
    CHECK(std::abs(area_off) < 1e-4);
    CHECK(sum_of_cells(below) == doctest::Approx(0.3 * 1 * layers * d).epsilon(round_off).scale(0));
}

TEST_CASE("surfaces that a lattice cannot follow") {
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    CHECK(message_of([&] {
              lattice_under([&](Real x, Real) { return x > 0.1 ? nan : 0; }, 0.2, 0.2, {.layers = 2});
          }) == "nothing was thrown");  // beyond the body
    CHECK(message_of([&] {
              lattice_under([&](Real x, Real) { return x > 0.05 ? nan : 0; }, 0.2, 0.2, {.layers = 2});
          }).starts_with("lattice_under.surface at x = 0.06"));
    CHECK(message_of([&] { lattice_under([](Real x, Real) { return x; }, 0.2, 0.2, {}); }) ==
          "nothing was thrown");  // 45 degrees
    const std::string steep =
        message_of([&] { lattice_under([](Real, Real y) { return 1.1 * y; }, 0.2, 0.2, {}); });
    CHECK(steep.starts_with(
        "lattice_under.surface: step between columns at x = -0.09 m, y = -0.09 m and x = "));
    CHECK(steep.find("must be at most a sphere diameter (0.02 m), got 0.02") != std::string::npos);
    CHECK(
        steep.ends_with("turn the body so that its surface lies flatter, or cut a packing with cut_below()"));
    CHECK(message_of([&] { lattice_under(wave, 0.01, 1, {}); }).starts_with("lattice_under.side must be"));
}

TEST_CASE("a packing cut by a surface: what is below it stays, with its bonds, cells and columns") {
    const auto below = [](Real x, Real y) { return 0.1 + 0.2 * x - 0.1 * y + 0.01 * std::sin(30 * x); };
    const Lattice whole = lattice_of(askew_packing(0.2), 0.5 * d, 0.2 * 0.2 * 0.2, 0.05, 0.02);
    const Lattice part = cut_below(whole, below);
    part.validate();
    CHECK(part.sites.size() > 200);
    CHECK(part.sites.size() < 0.8 * static_cast<Real>(whole.sites.size()));
    CHECK(part.column_area == whole.column_area);
    std::size_t next = 0;
    std::vector<Index> number(whole.sites.size(), -1);
    Real volume = 0;
    for (std::size_t n = 0; n < whole.sites.size(); ++n) {
        const Vec3& c = whole.sites[n].centre;
        const bool kept = next < part.sites.size() && part.sites[next].centre == c;
        const Real deep = distance_below(below, c) * (below(c.x(), c.y()) > c.z() ? 1 : -1);
        if (kept)
            CHECK(deep > 0.49 * d);
        else
            CHECK(deep < 0.51 * d);
        if (!kept) continue;
        CHECK(part.sites[next].cell_volume == whole.sites[n].cell_volume);
        CHECK(part.sites[next].column == whole.sites[n].column);
        volume += whole.sites[n].cell_volume;
        number[n] = static_cast<Index>(next++);
    }
    CHECK(next == part.sites.size());
    CHECK(sum_of_cells(part) == doctest::Approx(volume).epsilon(round_off).scale(0));
    std::vector<std::pair<Index, Index>> expected;
    for (const auto& [i, j] : whole.bonds)
        if (const Index a = number[static_cast<std::size_t>(i)], b = number[static_cast<std::size_t>(j)];
            a >= 0 && b >= 0)
            expected.emplace_back(a, b);
    CHECK(part.bonds == expected);
}

TEST_CASE("a lattice cut at its own top is whole; one that a surface outreaches is refused, with the place") {
    const Lattice slab = flat_lattice(0.2, 0.1, {.layers = 3});
    CHECK(cut_below(slab, [](Real, Real) { return 0.0; }).sites.size() == slab.sites.size());
    CHECK(cut_below(slab, [](Real, Real) { return -0.02; }).sites.size() == slab.sites.size() / 3 * 2);
    CHECK(cut_below(slab, [](Real, Real) { return 0.0199; }).sites.size() == slab.sites.size());
    CHECK(
        message_of([&] { cut_below(slab, [](Real x, Real) { return x > 0.04 ? 0.03 : 0.0; }); }) ==
        "cut_below: gap between the surface and the spheres below it at x = 0.05 m, y = -0.04 m must be at "
        "most a sphere diameter (0.02 m), got 0.03 m; the lattice does not reach the surface there: make it "
        "higher, or lower the surface");
    // Nothing is left at all.
    CHECK(message_of([&] { cut_below(slab, [](Real, Real) { return -0.1; }); }).find("got inf m") !=
          std::string::npos);
    CHECK(message_of([&] {
              cut_below(slab, [](Real, Real y) { return std::sqrt(y); });
          }).starts_with("cut_below.surface at x = -0.08"));
}
