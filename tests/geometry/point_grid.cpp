// Points near a place, against all of them.
#include <abrade/geometry/point_grid.hpp>

#include <doctest/doctest.h>

#include <random>
#include <set>

using namespace abrade;

TEST_CASE("all points within reach are visited, each once, and not many others") {
    std::mt19937 random(2);
    const auto uniform = [&](Real from, Real to) {
        return std::uniform_real_distribution<Real>(from, to)(random);
    };
    for (const Vec3& size : {Vec3(1, 1, 1), Vec3(40, 1, 0.05), Vec3(1, 0, 0), Vec3(0, 0, 0)})
        for (const Real cell : {0.04, 1e-6, 100.0}) {
            std::vector<Vec3> points;
            for (int n = 0; n < 500; ++n) {
                const Real x = uniform(0, 1), y = uniform(0, 1), z = uniform(0, 1);
                points.push_back(Vec3(x, y, z).cwiseProduct(size) + Vec3(3, -2, 5));
            }
            const PointGrid grid(points, cell);
            for (int n = 0; n < 50; ++n) {
                const Real a = uniform(-0.2, 1.2), b = uniform(-0.2, 1.2), c = uniform(-0.2, 1.2);
                const Vec3 x = Vec3(a, b, c).cwiseProduct(size) + Vec3(3, -2, 5);
                const Real reach = uniform(0, 0.3);
                std::multiset<Index> seen;
                grid.each_about(x, reach, [&](Index p) { seen.insert(p); });
                for (Index p = 0; p < 500; ++p) {
                    const bool near = (points[static_cast<std::size_t>(p)] - x).norm() <= reach;
                    CHECK(seen.count(p) <= 1);
                    if (near) CHECK(seen.count(p) == 1);
                }
            }
        }
}

TEST_CASE("cells are small where points allow it, and no points is no trouble") {
    std::vector<Vec3> points;
    for (int n = 0; n < 1000; ++n) points.push_back({0.02 * n, 0, 0});
    const PointGrid grid(points, 0.04);
    Index visited = 0;
    grid.each_about({10, 0, 0}, 0.02, [&](Index) { ++visited; });
    CHECK(visited >= 3);
    CHECK(visited <= 8);
    PointGrid().each_about({0, 0, 0}, 1, [](Index) { FAIL("there is none"); });
    PointGrid({}, 1).each_about({0, 0, 0}, 1, [](Index) { FAIL("there is none"); });
}
