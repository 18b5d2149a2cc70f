// Packs of numbers: arithmetic, conditions, and the way of rows into columns.
#include <abrade/core/simd.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

Pack counting(Real first) {
    Pack pack(0);
    for (int lane = 0; lane < pack_lanes; ++lane) pack.set(lane, first + lane);
    return pack;
}

}  // namespace

TEST_CASE("arithmetic and conditions are those of each lane") {
    const Pack a = counting(1), b = counting(-2);
    const Pack quotient = (a + b) * a / (a - b) - b;
    for (int lane = 0; lane < pack_lanes; ++lane) {
        const Real x = a[lane], y = b[lane];
        CHECK(quotient[lane] == (x + y) * x / (x - y) - y);
        CHECK(max(a, -b)[lane] == std::max(x, -y));
        CHECK(min(a, -b)[lane] == std::min(x, -y));
        CHECK(select(b < Pack(0), a, b)[lane] == (y < 0 ? x : y));
        CHECK((a > b)[lane]);
        CHECK(sqrt(a)[lane] == std::sqrt(x));
    }
    CHECK(any(b == Pack(-1)));
    CHECK(!any(a < Pack(0)));
    CHECK(any(!(a < Pack(2))));
    CHECK(sum(a) == pack_lanes * (pack_lanes + 1) / 2);
    CHECK(largest(a) == pack_lanes);
}

TEST_CASE("reciprocals and roots are good to some units in the last place, over all sizes") {
    for (int exponent = -100; exponent < 100; ++exponent) {
        const Pack x = counting(1.234) * Pack(std::pow(10.0, exponent));
        for (int lane = 0; lane < pack_lanes; ++lane) {
            CHECK(reciprocal(x)[lane] == doctest::Approx(1 / x[lane]).epsilon(1e-15).scale(0));
            CHECK(rsqrt(x)[lane] == doctest::Approx(1 / std::sqrt(x[lane])).epsilon(1e-15).scale(0));
        }
    }
}

TEST_CASE("rows become columns, and rows again") {
    QuadRows row;
    for (std::size_t i = 0; i < row.size(); ++i)
        for (std::size_t c = 0; c < 4; ++c) row[i].value[c] = static_cast<Real>(100 * i + c);
    const QuadColumns column = columns(row);
    const QuadRows again = rows(column);
    for (std::size_t i = 0; i < row.size(); ++i)
        for (std::size_t c = 0; c < 4; ++c) {
            CHECK(column[c][static_cast<int>(i)] == static_cast<Real>(100 * i + c));
            const Real before = row[i].value[c], after = again[i].value[c];
            CHECK(after == before);
        }
}

TEST_CASE("packs are numbers of Eigen's vectors") {
    const Vec3Of<Pack> v(counting(1), counting(2), counting(3)), w(Pack(1), Pack(0), Pack(-1));
    for (int lane = 0; lane < pack_lanes; ++lane) {
        CHECK(v.dot(w)[lane] == -2);
        CHECK(v.cross(w).y()[lane] == v.z()[lane] * 1 - v.x()[lane] * -1);
    }
}
