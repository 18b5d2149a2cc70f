// The cell list finds exactly the pairs that testing every pair finds.
#include <abrade/dem/store/neighbours.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

struct Spheres {
    std::vector<Vec3> centre;
    std::vector<Real> radius;
    std::vector<Index> body;
    std::vector<SearchRole> role;

    void add(const Vec3& x, Real r, Index of, bool is_passive = false) {
        centre.push_back(x), radius.push_back(r), body.push_back(of),
            role.push_back(is_passive ? SearchRole::passive : SearchRole::all);
    }
    Vec3 period = Vec3::Zero();
    NeighbourQuery query(Real skin) const { return {centre, radius, body, role, skin, period}; }
};

struct Random {
    explicit Random(unsigned seed) : engine(seed) {}
    std::mt19937 engine;
    Real uniform(Real low, Real high) { return std::uniform_real_distribution<Real>(low, high)(engine); }
    Vec3 in_box(const Vec3& size) {
        return size.cwiseProduct(Vec3(uniform(0, 1), uniform(0, 1), uniform(0, 1)));
    }
};

/// Both lists; REQUIREs that they hold the same pairs, each once.
std::size_t compare(const Spheres& s, Real skin) {
    auto fast = verlet_pairs(s.query(skin)), slow = verlet_pairs_brute_force(s.query(skin));
    std::sort(fast.begin(), fast.end()), std::sort(slow.begin(), slow.end());
    REQUIRE(fast == slow);
    REQUIRE(std::adjacent_find(fast.begin(), fast.end()) == fast.end());
    for (const VerletPair& p : fast) REQUIRE(p.first < p.second);
    return fast.size();
}

}  // namespace

TEST_CASE("no sphere, one sphere, two spheres") {
    Spheres s;
    CHECK(compare(s, 0.1) == 0);
    s.add({1, 2, 3}, 0.5, 0);
    CHECK(compare(s, 0.1) == 0);
    s.add({2.05, 2, 3}, 0.5, 1);
    CHECK(compare(s, 0.1) == 1);
    CHECK(compare(s, 0.0499) == 0);
    CHECK(compare(s, 0) == 0);
    s.body[1] = 0;  // of one stone
    CHECK(compare(s, 0.1) == 0);
}

TEST_CASE(
    "random spheres of sizes 1:20, several skins, with and without passive ones, in boxes of all shapes") {
    std::size_t found = 0;
    unsigned seed = 0;
    for (const Vec3& box : {Vec3(1, 1, 1), Vec3(20, 1, 0.1), Vec3(0.01, 0.01, 30), Vec3(3, 3, 0)})
        for (const Real skin : {0.0, 0.002, 0.05, 0.6})
            for (const Real passive_share : {0.0, 0.5, 0.95}) {
                Random random(++seed);
                Spheres s;
                for (Index n = 0; n < 350; ++n)
                    s.add(random.in_box(box), 0.01 * std::pow(20, random.uniform(0, 1)), n / 3,
                          random.uniform(0, 1) < passive_share);
                found += compare(s, skin);
            }
    CHECK(found > 10'000);
}

TEST_CASE("all of one size, on a lattice: pairs at a hair's breadth, cells at exactly their edges") {
    Spheres s;
    for (Index i = 0; i < 8; ++i)
        for (Index j = 0; j < 8; ++j)
            for (Index k = 0; k < 8; ++k) s.add(Vec3(i, j, k) * 0.02, 0.01, (i * 8 + j) * 8 + k, k < 3);
    for (const Real skin : {-1e-9, 1e-9, 0.0025, 0.0199}) compare(s, skin);
}

TEST_CASE("sizes at exactly a power of two apart") {
    Random random(5);
    Spheres s;
    for (Index n = 0; n < 300; ++n)
        s.add(random.in_box(Vec3::Ones()), 0.01 * std::pow(2.0, n % 5), n, n % 4 == 0);
    CHECK(compare(s, 0.01) > 100);
    Spheres thirds;
    for (Index n = 0; n < 300; ++n)
        thirds.add(random.in_box(Vec3::Ones()), (0.1 / 3) * std::pow(2.0, n % 3), n, n % 4 == 0);
    CHECK(compare(thirds, 0.01) > 100);
}

TEST_CASE("clusters, far-flung outliers, all at one place") {
    Random random(9);
    Spheres s;
    for (Index n = 0; n < 300; ++n) {
        const Vec3 cluster = 50 * Vec3(n % 3, (n % 5) * 0.3, 0);
        s.add(cluster + random.in_box(Vec3::Constant(0.2)), random.uniform(0.01, 0.05), n, n % 2 == 0);
    }
    compare(s, 0.005);
    s.add({1e6, -1e6, 1e6}, 0.02, 1000);
    s.add({-1e9, 0, 0}, 0.02, 1001, true);
    s.add({1e6, -1e6, 1e6 + 0.03}, 0.02, 1002);
    CHECK(compare(s, 0.005) > 100);
    Spheres heap;
    for (Index n = 0; n < 60; ++n) heap.add({1, 1, 1}, 0.1, n, n < 20);
    CHECK(compare(heap, 0) == 60 * 59 / 2 - 20 * 19 / 2);
}

TEST_CASE("one boulder among sand, searching and searched for") {
    for (const bool boulder_passive : {false, true})
        for (const bool sand_passive : {false, true}) {
            Random random(13);
            Spheres s;
            for (Index n = 0; n < 800; ++n) s.add(random.in_box(Vec3(1, 1, 0.3)), 0.004, n, sand_passive);
            s.add({0.5, 0.5, 0.2}, 0.15, 5000, boulder_passive);
            const std::size_t pairs = compare(s, 0.001);
            if (!(boulder_passive && sand_passive))
                CHECK(pairs > 10);
            else
                CHECK(pairs == 0);
        }
}

TEST_CASE("periodic along one, two and three axes: pairs across the edge, each once") {
    unsigned seed = 100;
    std::size_t across = 0;
    for (const Vec3& period : {Vec3(1, 0, 0), Vec3(0, 0.6, 0), Vec3(1, 0.5, 0), Vec3(1, 0.7, 0.5)})
        for (const Real skin : {0.0, 0.01})
            for (const Real passive_share : {0.0, 0.5}) {
                Random random(++seed);
                Spheres open, s;
                s.period = period;
                for (Index n = 0; n < 400; ++n) {
                    const Vec3 at = random.in_box((period.array() > 0).select(period, Vec3::Ones()));
                    s.add(at, 0.01 * std::pow(5, random.uniform(0, 1)), n / 2,
                          random.uniform(0, 1) < passive_share);
                }
                open = s;
                open.period.setZero();
                across += compare(s, skin) - compare(open, skin);
            }
    CHECK(across > 50);
}
