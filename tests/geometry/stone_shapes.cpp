// Stones: nominal size means volume, spheres without gaps, the counts of the model.
#include <abrade/geometry/stone_shapes.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <random>

using namespace abrade;

namespace {
constexpr std::array shapes{StoneShape::sphere, StoneShape::ellipsoid, StoneShape::angular};
}

TEST_CASE("whatever its shape, a stone has the volume of a sphere of its size") {
    std::mt19937 random(1);
    for (const StoneShape shape : shapes) {
        const Real size = 0.05, nominal = pi / 6 * cube(size);
        const Clump stone = make_stone(shape, size);
        CAPTURE(stone.name);
        // Twice the error of the integral over many spheres, 1e-12.
        CHECK(std::abs(stone.volume / nominal - 1) < 1e-11);
        // Independently, by darts. 4e5 of them in the bounding box, share hit > 0.3: sigma below 0.25 %.
        Vec3 low = Vec3::Zero(), high = low;
        for (const Sphere& s : stone.members) {
            low = low.cwiseMin((s.centre.array() - s.radius).matrix());
            high = high.cwiseMax((s.centre.array() + s.radius).matrix());
        }
        std::uniform_real_distribution<Real> uniform(0, 1);
        int hits = 0;
        constexpr int darts = 400'000;
        for (int n = 0; n < darts; ++n) {
            const Vec3 x =
                low + (high - low).cwiseProduct(Vec3(uniform(random), uniform(random), uniform(random)));
            for (const Sphere& s : stone.members)
                if ((x - s.centre).squaredNorm() < square(s.radius)) {
                    ++hits;
                    break;
                }
        }
        CHECK(std::abs((high - low).prod() * hits / darts / nominal - 1) < 0.01);  // 4 sigma
    }
}

TEST_CASE("volume grows with the cube of size, inertia with the fifth power") {
    for (const StoneShape shape : shapes) {
        const Clump small = make_stone(shape, 0.01), large = make_stone(shape, 0.1);
        CHECK(large.volume / small.volume == doctest::Approx(1e3).epsilon(1e-12));
        CHECK(large.principal_moments.z() / small.principal_moments.z() ==
              doctest::Approx(1e5).epsilon(1e-9));
        CHECK(large.bounding_radius / small.bounding_radius == doctest::Approx(10).epsilon(1e-9));
    }
}

TEST_CASE("the spheres of a stone hang together without gaps") {
    for (const StoneShape shape : shapes) {
        const Clump stone = make_stone(shape, 1);
        CAPTURE(stone.name);
        std::vector<std::size_t> front{0};
        std::vector<char> reached(stone.members.size(), 0);
        reached[0] = 1;
        while (!front.empty()) {
            const Sphere& s = stone.members[front.back()];
            front.pop_back();
            for (std::size_t k = 0; k < stone.members.size(); ++k) {
                const Sphere& other = stone.members[k];
                // By at least a tenth of the smaller radius: touching in a point would not be a solid.
                if (!reached[k] && (s.centre - other.centre).norm() <
                                       s.radius + other.radius - 0.1 * std::min(s.radius, other.radius))
                    reached[k] = 1, front.push_back(k);
            }
        }
        for (const char r : reached) CHECK(r == 1);
        // Nothing but stone at the centroid.
        bool solid = false;
        for (const Sphere& s : stone.members) solid |= s.centre.norm() < s.radius;
        CHECK(solid);
    }
}

TEST_CASE("the shapes are different shapes") {
    const Clump sphere = make_stone(StoneShape::sphere, 1), pebble = make_stone(StoneShape::ellipsoid, 1),
                block = make_stone(StoneShape::angular, 1);
    CHECK(sphere.members.size() == 1);
    CHECK(pebble.members.size() == 7);
    CHECK(block.members.size() == 9);
    // Three different principal moments, in rising order, that obey the triangle inequality of solids.
    for (const Clump* stone : {&pebble, &block}) {
        const Vec3& m = stone->principal_moments;
        CHECK(m.x() < 0.99 * m.y());
        CHECK(m.y() < 0.99 * m.z());
        CHECK(m.x() + m.y() > m.z());
        CHECK(m.z() >
              sphere.principal_moments.z());  // of all bodies of one volume the sphere's is the smallest
    }
    CHECK(sphere.name == "sphere");
    CHECK(pebble.name == "ellipsoid");
    CHECK(block.name == "angular");
}

TEST_CASE("1 m3 of sediment holds the counts of the model") {
    const std::array<std::pair<Real, Real>, 5> counts{
        {{0.04, 29'800}, {0.05, 15'300}, {0.075, 4'530}, {0.10, 1'910}, {0.15, 566}}};
    for (const auto& [size, count] : counts)
        for (const StoneShape shape : shapes)
            CHECK(std::abs(1 / make_stone(shape, size).volume / count - 1) <
                  0.003);  // the counts are given to three figures
}

TEST_CASE("a size that is none is refused") {
    for (const Real size :
         {0.0, -0.04, std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity()})
        CHECK_THROWS_AS(make_stone(StoneShape::angular, size), InputError);
    CHECK_THROWS_WITH_AS(make_stone(StoneShape::sphere, -1),
                         "make_stone.size must be finite and > 0, got -1 m; check its sign", InputError);
}
