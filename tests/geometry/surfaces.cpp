// Planes and the box of the world.
#include <abrade/geometry/surfaces.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace abrade;

TEST_CASE("a plane measures its distance along the normal") {
    const Plane wall{{1, 0, 0}, Vec3(1, 0, 1).normalized()};
    CHECK(wall.distance({1, 5, 0}) == doctest::Approx(0));
    CHECK(wall.distance({2, -3, 1}) == doctest::Approx(std::sqrt(2.0)));
    CHECK(wall.distance({0, 0, 0}) == doctest::Approx(-std::sqrt(0.5)));
    CHECK_NOTHROW(wall.validate());
    CHECK_THROWS_WITH_AS((Plane{{0, 0, 0}, {0, 0, 2}}.validate()),
                         "Plane.normal must be of length 1, got 2; normalise it", InputError);
    CHECK_THROWS_AS((Plane{{0, 0, 0}, {0, 0, std::nan("")}}.validate()), InputError);
}

TEST_CASE("a box contains its faces, nothing outside, and no NaN") {
    const Box box{{-1, -1, -1}, {1, 2, 3}};
    CHECK(box.contains({0, 0, 0}));
    CHECK(box.contains({1, 2, 3}));
    CHECK(!box.contains({1.0001, 0, 0}));
    CHECK(!box.contains({0, -1.0001, 0}));
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 x = Vec3::Zero();
        x[axis] = std::nan("");
        CHECK(!box.contains(x));
        CHECK(!Box{}.contains(x));
    }
    CHECK(Box{}.contains({1e300, -1e300, 0}));
}
