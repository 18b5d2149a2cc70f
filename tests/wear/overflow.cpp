// Where wear goes that its site no longer has: craters, patches, epochs; all of it is somewhere.
#include "../message_of.hpp"

#include <abrade/core/parallel.hpp>
#include <abrade/geometry/surface_lattice.hpp>
#include <abrade/wear/concrete.hpp>

#include <doctest/doctest.h>

#include <functional>
#include <numeric>
#include <random>

using namespace abrade;

namespace {

constexpr Real forever = std::numeric_limits<Real>::infinity();

Concrete concrete_of(Lattice lattice, Overflow overflow = FillCrater{}, WornOut worn_out = WornOut::fines) {
    return Concrete(std::move(lattice), FractureVolume::cell, overflow, worn_out);
}
/// 11 x 11 columns of 0.02 m; the middle one is (5, 5), over x = y = 0.
Lattice slab(Index layers = 4) { return flat_lattice(0.22, 0.22, {.layers = layers}); }

/// All volume that the concrete knows of [m3].
Real all_volume(const Concrete& c) { return c.worn_volume() + c.overflow_volume() + c.waiting_volume(); }

std::vector<Real> fractures(const Concrete& c) {
    std::vector<Real> all;
    for (Index s = 0; s < c.sites(); ++s) all.push_back(c.fracture(s));
    return all;
}
/// Volume that is fractured in the sites that count [m3].
Real fractured_from(const Concrete& c, const std::function<bool(const LatticeSite&)>& counts) {
    Real volume = 0;
    for (Index s = 0; s < c.sites(); ++s)
        if (counts(c.lattice().sites[static_cast<std::size_t>(s)])) volume += c.fracture(s) * c.capacity(s);
    return volume;
}

struct Random {
    std::mt19937_64 engine{7};
    Real uniform() { return std::generate_canonical<Real, 53>(engine); }
    Index below(Index n) { return std::uniform_int_distribution<Index>(0, n - 1)(engine); }
};

/// Spheres of 0.02 m where chance has them, none nearer to another than a diameter.
Lattice thrown_spheres() {
    Random random;
    std::vector<Vec3> all;
    for (int thrown = 0; thrown < 40'000; ++thrown) {
        const Real x = 0.3 * random.uniform(), y = 0.3 * random.uniform(), z = 0.16 * random.uniform();
        const Vec3 next(x, y, z);
        if (std::none_of(all.begin(), all.end(), [&](const Vec3& a) { return (a - next).norm() < 0.02; }))
            all.push_back(next);
    }
    return lattice_of(all, 0.01, 1.44e-2, 0.2, 0.02);
}

struct Body {
    std::string name;
    Lattice lattice;
};
const std::vector<Body>& lattices() {
    const auto plane = [](Real x, Real y) { return -0.02 + 0.2 * x - 0.1 * y; };
    static const std::vector<Body> all{
        {"flat", flat_lattice(0.4, 0.3, {.layers = 6})},
        {"invert", invert_lattice({.length = 0.3, .width = 0.9, .arc_radius = 0.5}, {.layers = 4})},
        {"hexagonal", hexagonal_lattice(0.3, 0.25, {.layers = 8})},
        {"random", thrown_spheres()},
        {"cut by a surface", cut_below(hexagonal_lattice(0.3, 0.25, {.layers = 10}), plane)}};
    return all;
}

struct Way {
    std::string name;
    Overflow overflow;
};
const Way ways[] = {{"crater", FillCrater{}},
                    {"patch", SpreadOverPatch{0.09, 0.07}},
                    {"epochs", SpreadByEpoch{0.1, 0.3}},
                    {"drop", DropOverflow{}}};

/// A site, a volume [m3] and when [s].
struct Blow {
    Index site = 0;
    Real volume = 0, time = 0;
};
/// From a hundredth of a cell to some thirty, together about `share` of the body.
std::vector<Blow> blows(const Lattice& lattice, Real share) {
    Random random;
    Real body = 0;
    for (const LatticeSite& site : lattice.sites) body += site.cell_volume;
    std::vector<Blow> all;
    for (Real told = 0; told < share * body; told += all.back().volume)
        all.push_back({random.below(static_cast<Index>(lattice.sites.size())),
                       lattice.sites[0].cell_volume * std::pow(10, -2 + 3.5 * random.uniform()),
                       1e-3 * static_cast<Real>(all.size())});
    return all;
}

/// Sites by their distance from one, as a crater takes them.
std::vector<Index> nearest(const Lattice& lattice, Index from) {
    std::vector<std::pair<Real, Index>> order;
    const Vec3& x = lattice.sites[static_cast<std::size_t>(from)].centre;
    for (std::size_t s = 0; s < lattice.sites.size(); ++s) {
        const Real apart = (lattice.sites[s].centre - x).squaredNorm();
        order.emplace_back(std::round(apart / (1e-6 * square(lattice.radius))), static_cast<Index>(s));
    }
    std::sort(order.begin(), order.end());
    std::vector<Index> sites;
    for (const auto& each : order) sites.push_back(each.second);
    return sites;
}

}  // namespace

TEST_CASE("all that was told to wear is worn, waits or is overflow, in every way and lattice") {
    for (const Body& body : lattices())
        for (const Way& way : ways)
            for (const FractureVolume volume : {FractureVolume::cell, FractureVolume::sphere})
                for (const Real share : {0.3, 1.6}) {  // 1.6: more than there is
                    CAPTURE(body.name);
                    CAPTURE(way.name);
                    CAPTURE(share);
                    Concrete c(body.lattice, volume, way.overflow);
                    REQUIRE(c.sites() > 1000);
                    Random random;
                    Real told = 0;
                    std::vector<Index> worn_out;
                    const auto settle = [&](Real time) {
                        const std::vector<Index> now = c.settle(time);
                        CHECK(std::is_sorted(now.begin(), now.end()));
                        worn_out.insert(worn_out.end(), now.begin(), now.end());
                        for (const Index site : now)
                            if (site % 2) c.set_gone(site);
                    };
                    for (const Blow& blow : blows(body.lattice, share)) {
                        c.wear(blow.site, blow.volume, blow.time);
                        told += blow.volume;
                        if (random.below(3) == 0) settle(blow.time);
                        if (random.below(20) == 0) c.set_gone(random.below(c.sites()));
                    }
                    // Round-off of some thousand sums.
                    CHECK(all_volume(c) == doctest::Approx(told).epsilon(1e-12).scale(0));
                    settle(forever);
                    CHECK(all_volume(c) == doctest::Approx(told).epsilon(1e-12).scale(0));
                    CHECK(c.waiting_volume() == 0);
                    CHECK(!c.unsettled());

                    Real removed = 0;
                    const std::vector<Real> depth = c.depth();
                    for (std::size_t n = 0; n < depth.size(); ++n)
                        removed += depth[n] * body.lattice.column_area[n];
                    CHECK(removed ==
                          doctest::Approx(c.worn_volume() + c.detached_volume()).epsilon(1e-12).scale(0));

                    // Each site that is fully fractured was told of, once.
                    std::sort(worn_out.begin(), worn_out.end());
                    std::vector<Index> full;
                    for (Index s = 0; s < c.sites(); ++s) {
                        REQUIRE(c.fracture(s) <= 1);
                        if (c.fracture(s) == 1) full.push_back(s);
                    }
                    CHECK(worn_out == full);
                    CHECK(!full.empty());
                }
}

TEST_CASE("neither the order of calls for different sites nor the number of threads changes a bit") {
    for (const Body& body : lattices())
        for (const Way& way : ways) {
            CAPTURE(body.name);
            CAPTURE(way.name);
            std::vector<std::vector<Real>> answers;
            for (int run = 0; run < 4; ++run) {
                Concrete c(body.lattice, FractureVolume::cell, way.overflow);
                Random random;
                std::mt19937_64 other(static_cast<unsigned>(run));
                set_thread_count(run % 2 ? 3 : 1);
                std::vector<Real> answer;
                for (int step = 0; step < 8; ++step) {
                    std::vector<Index> order(static_cast<std::size_t>(c.sites()));
                    std::vector<Real> volume;
                    std::iota(order.begin(), order.end(), 0);
                    for (Index s = 0; s < c.sites(); ++s)
                        volume.push_back(c.capacity(s) * (random.below(9) == 0 ? 3 : 0.01) *
                                         random.uniform());
                    std::shuffle(order.begin(), order.end(), other);
                    parallel_tasks(c.sites(), [&](Index n) {
                        const Index site = order[static_cast<std::size_t>(n)];
                        c.wear(site, volume[static_cast<std::size_t>(site)], 0.1 * step, 0.1);
                    });
                    for (const Index site : c.settle(0.1 * step)) {
                        answer.push_back(static_cast<Real>(site));
                        c.set_gone(site);
                    }
                }
                const std::vector<Real> end = fractures(c);
                answer.insert(answer.end(), end.begin(), end.end());
                answer.insert(answer.end(), {c.worn_volume(), c.overflow_volume(), c.waiting_volume(),
                                             c.largest_collision_share()});
                answers.push_back(answer);
            }
            set_thread_count(1);
            for (const auto& answer : answers) CHECK(answer == answers.front());
        }
}

TEST_CASE("a crater takes the nearest sites first, each before the next") {
    for (const Body& body : lattices()) {
        CAPTURE(body.name);
        Concrete c = concrete_of(body.lattice);
        std::vector<Real> left;
        for (Index s = 0; s < c.sites(); ++s) left.push_back(c.capacity(s));
        std::vector<char> gone(left.size(), 0);
        Random random;
        for (const Blow& blow : blows(body.lattice, 0.8)) {
            if (random.below(10) == 0) {
                const Index site = random.below(c.sites());
                c.set_gone(site);
                gone[static_cast<std::size_t>(site)] = 1;
            }
            if (gone[static_cast<std::size_t>(blow.site)]) continue;
            c.wear(blow.site, blow.volume);
            c.settle(0);
            Real volume = blow.volume;
            for (const Index site : nearest(body.lattice, blow.site)) {
                const auto s = static_cast<std::size_t>(site);
                if (gone[s]) continue;
                const Real taken = std::min(volume, left[s]);
                left[s] -= taken, volume -= taken;
                if (!(volume > 0)) break;
            }
        }
        REQUIRE(c.overflow_volume() == 0);
        for (std::size_t s = 0; s < left.size(); ++s)  // volumes of cells are some 1e-5 m3
            REQUIRE(c.capacity(static_cast<Index>(s)) * (1 - c.fracture(static_cast<Index>(s))) ==
                    doctest::Approx(left[s]).epsilon(1e-9).scale(1e-5));
    }
}

TEST_CASE("of sites at one distance the lower number is worn first, whatever the round-off of their places") {
    // 3 of the 5 neighbours of a sphere at the surface; the lattice stands far from the origin.
    Lattice lattice = slab(2);
    for (LatticeSite& site : lattice.sites) site.centre += Vec3(41.3, -7.7, 3.1);
    const Index middle = lattice.site(5, 5, 0);
    Concrete c = concrete_of(lattice);
    c.wear(middle, 4.5 * c.capacity(middle));
    CHECK(c.settle(0) ==
          std::vector<Index>{lattice.site(4, 5, 0), lattice.site(5, 4, 0), middle, lattice.site(5, 5, 1)});
    CHECK(c.fracture(lattice.site(5, 6, 0)) == doctest::Approx(0.5));
    CHECK(c.fracture(lattice.site(6, 5, 0)) == 0);
}

TEST_CASE("a crater goes on where all that is near is used up, and ends where the block ends") {
    Concrete c = concrete_of(slab(2));
    const Real cell = c.capacity(0);
    const Index middle = c.lattice().site(5, 5, 0);
    c.wear(middle, 200 * cell);
    c.settle(0);
    CHECK(c.overflow_volume() == 0);
    c.wear(middle, 41.5 * cell);  // 242 cells in all
    c.settle(0);
    CHECK(c.overflow_volume() == 0);
    c.wear(middle, 2 * cell);
    CHECK(c.waiting_volume() == doctest::Approx(2 * cell).scale(0));
    CHECK(c.settle(0).size() == 1);
    CHECK(c.overflow_volume() == doctest::Approx(1.5 * cell).scale(0));
    CHECK(c.worn_through());
    c.wear(0, cell);
    CHECK(c.settle(0).empty());
    CHECK(c.overflow_volume() == doctest::Approx(2.5 * cell).scale(0));
}

TEST_CASE("sites that are gone are passed over, and wear of a grain does not come back to the block") {
    Concrete c = concrete_of(slab(2));
    const Real cell = c.capacity(0);
    const Lattice& lattice = c.lattice();
    const Index middle = lattice.site(5, 5, 0), beside = lattice.site(4, 5, 0);
    c.set_gone(beside);
    c.wear(middle, 1.5 * cell);
    CHECK(c.settle(0) == std::vector<Index>{middle});
    CHECK(c.fracture(beside) == 0);
    CHECK(c.fracture(lattice.site(5, 4, 0)) == doctest::Approx(0.5));
    c.wear(beside, 3 * cell);
    CHECK(c.waiting_volume() == 0);
    CHECK(c.overflow_volume() == doctest::Approx(2 * cell).scale(0));
    CHECK(c.settle(0) == std::vector<Index>{beside});
    CHECK(c.fracture(lattice.site(5, 4, 0)) == doctest::Approx(0.5));
    CHECK(!c.worn_through());
    // A sphere that came loose in the step that wore it: its excess was the block's.
    const Index corner = lattice.site(0, 0, 0);
    c.wear(corner, 1.25 * cell);
    c.set_gone(corner);
    c.settle(0);
    CHECK(c.fracture(lattice.site(0, 0, 1)) == doctest::Approx(0.25));
}

TEST_CASE("each site that is worn out is told of once, and what waits is seen") {
    for (const Way& way : ways) {
        CAPTURE(way.name);
        Concrete c = concrete_of(slab(), way.overflow);
        CHECK(!c.unsettled());
        c.wear(9, 0.5 * c.capacity(9));
        CHECK(c.unsettled() == std::holds_alternative<SpreadByEpoch>(way.overflow));
        c.settle(forever);
        CHECK(!c.unsettled());
    }
    for (const Overflow& overflow : {Overflow(FillCrater{}), Overflow(DropOverflow{})}) {
        Concrete c = concrete_of(slab(), overflow);
        const Real cell = c.capacity(0);
        c.wear(8, cell);
        CHECK(c.unsettled());  // nothing waits, but the site is worn out
        CHECK(c.waiting_volume() == 0);
        c.wear(4, cell);
        CHECK(c.settle(0) == std::vector<Index>{4, 8});
        CHECK(c.settle(0).empty());
        c.wear(8, 0.1 * cell);
        CHECK(c.settle(0).empty());
    }
}

TEST_CASE("concrete is worn through where a held sphere is fully fractured, or where nothing is left") {
    for (const Way& way : ways) {
        CAPTURE(way.name);
        Concrete c = concrete_of(slab(3), way.overflow);
        for (Index layer = 0; layer < 3; ++layer) {
            CHECK(!c.worn_through());
            const Index site = c.lattice().site(2, 3, layer);
            c.wear(site, c.capacity(site));
            c.settle(forever);
            // A mean over the strip reaches no depth yet.
            if (std::holds_alternative<SpreadByEpoch>(way.overflow)) break;
        }
        CHECK(c.worn_through() == !std::holds_alternative<SpreadByEpoch>(way.overflow));
    }
    Lattice free = slab(1);
    for (LatticeSite& site : free.sites) site.held = false;
    for (const bool all_gone : {false, true}) {  // the rest worn out, or come loose
        Concrete c = concrete_of(free);
        for (Index s = 1; s < c.sites(); ++s)
            if (all_gone)
                c.set_gone(s);
            else
                c.wear(s, c.capacity(s));
        c.wear(0, c.capacity(0));
        c.settle(0);
        CHECK(c.overflow_volume() == 0);
        CHECK(!c.worn_through());  // exactly all: nothing more was to be taken
        c.wear(0, 1e-9);
        c.settle(0);
        CHECK(c.overflow_volume() == 1e-9);
        CHECK(c.worn_through());
    }
    Concrete dropped = concrete_of(free, DropOverflow{});
    dropped.wear(0, 2 * dropped.capacity(0));
    CHECK(!dropped.worn_through());  // the others have all of theirs
}

TEST_CASE("recorded wear has no limit, changes no sphere and shows in the depth") {
    for (const Way& way : ways) {
        CAPTURE(way.name);
        Concrete c = concrete_of(slab(2), way.overflow, WornOut::recorded);
        const Real cell = c.capacity(0);
        const Index held = c.lattice().site(1, 2, 1);
        for (int n = 0; n < 10; ++n) c.wear(held, 1.5 * cell);
        c.wear(0, 0.25 * cell);
        CHECK(!c.unsettled());
        CHECK(c.settle(forever).empty());
        CHECK(c.fracture(held) == 1);
        CHECK(c.fracture(0) == doctest::Approx(0.25));
        CHECK(c.worn_volume() == doctest::Approx(15.25 * cell).scale(0));
        CHECK(c.overflow_volume() == 0);
        CHECK(c.waiting_volume() == 0);
        CHECK(c.depth()[1 * 11 + 2] == doctest::Approx(15 * 0.02));
        CHECK(!c.worn_through());
        c.set_gone(held);
        CHECK(c.depth()[1 * 11 + 2] == doctest::Approx(15 * 0.02));
        CHECK(c.detached_volume() == 0);
        for (Index s = 0; s < c.sites(); ++s) c.wear(s, cell), c.set_gone(s);
        CHECK(!c.worn_through());
    }
}

TEST_CASE("excess over a patch: the same depth for each column, deeper as they fill") {
    // 5 x 3 columns about the middle one, 15 in all; layers of 0.02 m.
    Concrete c = concrete_of(slab(), SpreadOverPatch{0.1, 0.06});
    const Lattice& lattice = c.lattice();
    const Real cell = c.capacity(0);
    const Index middle = lattice.site(5, 5, 0);
    const auto in_patch = [](const LatticeSite& s) {
        return std::abs(s.along - 5) <= 2 && std::abs(s.across - 5) <= 1;
    };
    c.wear(middle, cell);  // no excess
    c.settle(0);
    CHECK(fractured_from(c, [](const LatticeSite&) { return true; }) == doctest::Approx(cell).scale(0));
    c.wear(middle, 0.5 * 15 * cell);
    CHECK(c.settle(0).empty());
    for (Index s = 0; s < c.sites(); ++s) {
        const LatticeSite& site = lattice.sites[static_cast<std::size_t>(s)];
        const Real top = site.column == lattice.sites[static_cast<std::size_t>(middle)].column ? 1 : 0;
        const Real expected = !in_patch(site)                        ? 0
                              : static_cast<Real>(site.layer) == top ? 0.5
                              : static_cast<Real>(site.layer) < top  ? 1
                                                                     : 0;
        CHECK(c.fracture(s) == doctest::Approx(expected));
    }
    c.wear(middle, 1.25 * 15 * cell);
    const std::vector<Index> worn_out = c.settle(0);
    CHECK(worn_out.size() == 15);  // the columns' sites that were half worn
    for (Index i = 3; i <= 7; ++i)
        for (Index j = 4; j <= 6; ++j)
            CHECK(c.depth()[static_cast<std::size_t>(i * 11 + j)] ==
                  doctest::Approx(0.02 * (i == 5 && j == 5 ? 2.75 : 1.75)));
    CHECK(c.worn_volume() == doctest::Approx((1 + 1.75 * 15) * cell).scale(0));
    CHECK(fractured_from(c, in_patch) == doctest::Approx(c.worn_volume()).scale(0));
}

TEST_CASE("a patch over the edge of the block has fewer columns; what they no longer have is a crater") {
    Concrete c = concrete_of(slab(2), SpreadOverPatch{0.1, 0.1});
    const Real cell = c.capacity(0);
    const auto in_patch = [](const LatticeSite& s) { return s.along <= 2 && s.across <= 2; };
    c.wear(0, (1 + 9) * cell);  // 9 columns of 2, one of which has worn once already
    c.settle(0);
    CHECK(fractured_from(c, in_patch) == doctest::Approx(10 * cell).scale(0));
    CHECK(c.depth()[0] == doctest::Approx(0.04));
    CHECK(c.depth()[1] == doctest::Approx(0.02));
    CHECK(c.worn_through());  // the first column ends at the held layer
    c.wear(0, 10 * cell);     // 8 are left in the patch
    c.settle(0);
    CHECK(fractured_from(c, in_patch) == doctest::Approx(18 * cell).scale(0));
    CHECK(c.worn_volume() == doctest::Approx(20 * cell).scale(0));
    CHECK(c.overflow_volume() == 0);
    CHECK(c.fracture(c.lattice().site(0, 3, 0)) == 1);  // 0.06 m off, as site (3, 0, 0)
    CHECK(c.fracture(c.lattice().site(3, 0, 0)) == doctest::Approx(1));
}

TEST_CASE("a patch wears irregular columns evenly too, from those whose top is in the rectangle") {
    for (const Body& body : lattices()) {
        CAPTURE(body.name);
        const SpreadOverPatch patch{0.1, 0.08};
        // The topmost site of each column, by brute force.
        std::vector<Index> top(body.lattice.column_area.size(), -1);
        const auto at = [&](Index s) -> const LatticeSite& {
            return body.lattice.sites[static_cast<std::size_t>(s)];
        };
        for (Index s = 0; s < static_cast<Index>(body.lattice.sites.size()); ++s)
            if (Index& best = top[static_cast<std::size_t>(at(s).column)];
                best < 0 || at(s).centre.z() > at(best).centre.z())
                best = s;
        Index struck = 0;  // nearest to the middle
        Vec3 middle = Vec3::Zero();
        for (const LatticeSite& site : body.lattice.sites)
            middle += site.centre / static_cast<Real>(body.lattice.sites.size());
        for (const Index s : top)
            if (s >= 0 &&
                (at(s).centre - middle).head<2>().norm() < (at(struck).centre - middle).head<2>().norm())
                struck = s;
        Concrete c = concrete_of(body.lattice, patch);
        c.wear(struck, c.capacity(struck));
        Real area = 0;
        std::vector<Index> columns;
        for (const Index s : top) {
            // Its own column has the second site on top by now: that is left out of the comparison below.
            if (s < 0 || s == struck) continue;
            const Vec3 apart = at(s).centre - at(struck).centre;
            if (std::abs(apart.x()) > 0.05 + 1e-9 || std::abs(apart.y()) > 0.04 + 1e-9) continue;
            columns.push_back(at(s).column);
            area += body.lattice.column_area[static_cast<std::size_t>(at(s).column)];
        }
        REQUIRE(columns.size() > 6);
        const Real excess = 1e-3 * area;
        c.wear(struck, excess);
        c.settle(0);
        CHECK(c.overflow_volume() == 0);
        const std::vector<Real> depth = c.depth();
        const Real first = depth[static_cast<std::size_t>(columns.front())];
        CHECK(first == doctest::Approx(1e-3).epsilon(0.15).scale(0));  // but for the struck column's share
        Index worn = 0;
        for (const Real d : depth) worn += d > 0;
        CHECK(worn <= static_cast<Index>(columns.size()) + 1);
        for (const Index column : columns)
            CHECK(depth[static_cast<std::size_t>(column)] == doctest::Approx(first).epsilon(1e-12).scale(0));
    }
}

TEST_CASE("epochs: nothing is fractured before the end, then each strip and row its mean") {
    // 20 columns along x, in strips of 5; 3 rows.
    Concrete c = concrete_of(flat_lattice(0.4, 0.06, {.layers = 3}), SpreadByEpoch{0.1, 0.5});
    const Lattice& lattice = c.lattice();
    const Real cell = c.capacity(0);
    const auto depth = [&](Index i, Index j) { return c.depth()[static_cast<std::size_t>(i * 3 + j)]; };
    c.wear(lattice.site(1, 0, 0), 2 * cell, 0.1);
    c.wear(lattice.site(4, 0, 1), 0.5 * cell, 0.2);
    c.wear(lattice.site(7, 2, 0), 0.25 * cell, 0.4);
    CHECK(c.settle(0.4).empty());
    CHECK(c.worn_volume() == 0);
    CHECK(c.waiting_volume() == doctest::Approx(2.75 * cell).scale(0));
    CHECK(c.fracture(lattice.site(1, 0, 0)) == 0);
    CHECK(c.settle(0.5).empty());
    CHECK(c.waiting_volume() == 0);
    for (Index i = 0; i < 20; ++i)
        for (Index j = 0; j < 3; ++j)
            CHECK(depth(i, j) == doctest::Approx(i < 5 && j == 0              ? 0.01
                                                 : i >= 5 && i < 10 && j == 2 ? 0.001
                                                                              : 0));
    // The next epochs pass without wear: the one that begins to collect in [1, 1.5) ends at 1.5.
    c.wear(lattice.site(2, 0, 0), 5 * cell, 1.2);
    CHECK(c.settle(1.2).empty());
    CHECK(c.settle(1.4999).empty());
    CHECK(depth(2, 0) == doctest::Approx(0.01));
    const std::vector<Index> worn_out = c.settle(1.5);
    CHECK(worn_out.size() == 5);
    for (Index i = 0; i < 5; ++i) {
        CHECK(worn_out[static_cast<std::size_t>(i)] == lattice.site(i, 0, 0));
        CHECK(c.fracture(lattice.site(i, 0, 0)) == 1);
        CHECK(c.fracture(lattice.site(i, 0, 1)) == doctest::Approx(0.5));
    }
    // The end of a run places all.
    c.wear(lattice.site(12, 1, 0), cell, 1.6);
    CHECK(c.settle(1.7).empty());
    CHECK(c.waiting_volume() == doctest::Approx(cell).scale(0));
    c.settle(forever);
    CHECK(c.waiting_volume() == 0);
    CHECK(depth(14, 1) == doctest::Approx(0.004));
    // And a run that goes on collects again.
    c.wear(lattice.site(12, 1, 0), cell, 1.8);
    c.settle(1.8);
    CHECK(c.waiting_volume() == doctest::Approx(cell).scale(0));
}

TEST_CASE("a strip that is used up goes on as a crater, after each strip has had its own") {
    Concrete c = concrete_of(flat_lattice(0.2, 0.06, {.layers = 2}), SpreadByEpoch{0.1, 1});
    const Lattice& lattice = c.lattice();
    const Real cell = c.capacity(0);
    c.wear(lattice.site(2, 0, 0), 12 * cell, 0.1);  // the strip has 10
    c.wear(lattice.site(2, 1, 0), 5 * cell, 0.1);
    c.settle(1);
    CHECK(c.overflow_volume() == 0);
    CHECK(c.worn_volume() == doctest::Approx(17 * cell).scale(0));
    CHECK(c.worn_through());
    CHECK(fractured_from(c, [](const LatticeSite& s) { return s.across == 0; }) ==
          doctest::Approx(10 * cell).scale(0));
    // The row beside it has lost its first layer to its own mean; the crater took two more from its second.
    CHECK(c.fracture(lattice.site(2, 1, 1)) == 1);
    CHECK(fractured_from(c, [](const LatticeSite& s) { return s.across == 1; }) +
              fractured_from(c, [](const LatticeSite& s) { return s.across == 2; }) ==
          doctest::Approx(7 * cell).scale(0));
}

TEST_CASE("a loose grain wears itself at once, whatever is collected") {
    Concrete c = concrete_of(slab(), SpreadByEpoch{0.1, 1});
    c.set_gone(40);
    c.wear(40, 1.5 * c.capacity(40), 0.1);
    CHECK(c.fracture(40) == 1);
    CHECK(c.waiting_volume() == 0);
    CHECK(c.unsettled());
    CHECK(c.settle(0.1) == std::vector<Index>{40});
}

TEST_CASE("columns that do not stand in rows are averaged by where they are") {
    const Lattice rows = flat_lattice(0.4, 0.1, {.layers = 3});
    std::vector<Index> number(rows.column_area.size());
    std::iota(number.begin(), number.end(), 0);
    Random random;
    std::shuffle(number.begin(), number.end(), random.engine);
    Lattice mixed = rows;
    for (LatticeSite& site : mixed.sites) site.column = number[static_cast<std::size_t>(site.column)];
    Concrete a = concrete_of(rows, SpreadByEpoch{0.1, 1}), b = concrete_of(mixed, SpreadByEpoch{0.1, 1});
    for (const Blow& blow : blows(rows, 0.4)) a.wear(blow.site, blow.volume), b.wear(blow.site, blow.volume);
    a.settle(1), b.settle(1);
    REQUIRE(a.overflow_volume() == 0);
    for (Index s = 0; s < a.sites(); ++s)
        CHECK(a.fracture(s) == doctest::Approx(b.fracture(s)).epsilon(1e-12));
}

TEST_CASE("columns of unequal surface are worn by one depth") {
    Lattice lattice = flat_lattice(0.1, 0.02, {.layers = 2});
    for (std::size_t n = 0; n < 5; ++n) lattice.column_area[n] *= 1 + 0.1 * static_cast<Real>(n);
    const Real area = std::accumulate(lattice.column_area.begin(), lattice.column_area.end(), 0.0);
    Concrete c = concrete_of(lattice, SpreadByEpoch{1, 1});
    c.wear(0, 2e-3 * area);
    c.settle(1);
    for (const Real depth : c.depth()) CHECK(depth == doctest::Approx(2e-3));
}

TEST_CASE("fracture rates that are renewed by parts see what settle placed") {
    Concrete c = concrete_of(flat_lattice(0.4, 0.4, {.layers = 8}));
    std::vector<Real> rates;
    std::vector<std::uint32_t> seen;
    c.renew_fracture_rates(rates, seen);
    Random random;
    for (int n = 0; n < 20; ++n) {
        c.wear(random.below(c.sites()), 30 * c.capacity(0));
        c.settle(0);
        c.renew_fracture_rates(rates, seen);
        REQUIRE(rates == fractures(c));
    }
    const auto from = c.taken_from();
    for (const Index site : from) CHECK(c.fracture(site) > 0);
    CHECK(!from.empty());
    c.settle(0);
    CHECK(c.taken_from().empty());
}

TEST_CASE("bad parameters of overflow are named, with value, unit and remedy") {
    const auto said = [](Overflow overflow) { return message_of([&] { concrete_of(slab(), overflow); }); };
    CHECK(said(SpreadOverPatch{0, 1}) ==
          "SpreadOverPatch.length must be finite and > 0, got 0 m; give the patch's side along x, or take "
          "FillCrater");
    CHECK(said(SpreadOverPatch{1, -2}).find("SpreadOverPatch.width must be finite and > 0, got -2 m; ") == 0);
    CHECK(said(SpreadByEpoch{forever, 1}).find("SpreadByEpoch.length must be finite and > 0, got inf m; ") ==
          0);
    CHECK(said(SpreadByEpoch{1, std::nan("")})
              .find("SpreadByEpoch.every must be finite and > 0, got nan s; ") == 0);
    CHECK_NOTHROW(validate(FillCrater{}));
    CHECK_NOTHROW(validate(DropOverflow{}));
}
