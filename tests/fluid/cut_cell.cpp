// A plane in a cell: closed forms, the inverse, and normals that are parallel to faces, or nearly so.
#include <abrade/fluid/vof/plic.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

/// The usual closed form in three dimensions, in long double; alpha from the lower corner, n > 0.
long double sum_of_cubes(const std::array<Real, 3>& n, long double alpha) {
    const auto cube = [](long double x) { return x > 0 ? x * x * x : 0; };
    const long double a = n[0], b = n[1], c = n[2];
    return (cube(alpha) - cube(alpha - a) - cube(alpha - b) - cube(alpha - c) + cube(alpha - a - b) +
            cube(alpha - a - c) + cube(alpha - b - c) - cube(alpha - a - b - c)) /
           (6 * a * b * c);
}

template <int Dim>
std::array<Real, Dim> random_normal(std::mt19937& random, bool nearly_degenerate) {
    std::uniform_real_distribution<Real> uniform(-1, 1), exponent(-18, 0);
    std::array<Real, Dim> n;
    for (Real& x : n) x = uniform(random) * (nearly_degenerate ? std::pow(10, exponent(random)) : 1);
    return n;
}

template <int Dim>
void check_inverse(bool nearly_degenerate) {
    std::mt19937 random(7);
    std::uniform_real_distribution<Real> uniform(0, 1), exponent(-14, 0);
    Real worst = 0;
    for (int k = 0; k < 200'000; ++k) {
        const auto n = random_normal<Dim>(random, nearly_degenerate);
        Real f = uniform(random);
        if (k % 3 == 1) f = std::pow(10, exponent(random));
        if (k % 3 == 2) f = 1 - std::pow(10, exponent(random));
        const Real back = fraction_below<Dim>(n, plane_distance<Dim>(n, f));
        worst = std::max(worst, std::abs(back - f));
    }
    CHECK(worst < 1e-14);
}

}  // namespace

TEST_CASE("a plane against the sums of cubes") {
    std::mt19937 random(3);
    std::uniform_real_distribution<Real> part(0.1, 1);
    for (int k = 0; k < 20'000; ++k) {
        const std::array<Real, 3> n{part(random), part(random), part(random)};
        const Real all = n[0] + n[1] + n[2], alpha = all * (part(random) - 0.1) / 0.9;
        // long double loses 1e-19 / (6 a b c).
        CHECK(std::abs(fraction_below<3>(n, alpha, {1, 1, 1}) - static_cast<Real>(sum_of_cubes(n, alpha))) <
              1e-15);
    }
}

TEST_CASE("planes parallel to faces and edges, and of no normal at all") {
    for (const Real d : {-0.6, -0.5, -0.3, 0.0, 0.2, 0.5, 0.9}) {
        const Real slab = std::clamp(d + 0.5, 0.0, 1.0);
        CHECK(std::abs(fraction_below<3>(std::array<Real, 3>{0, 0, 1}, d) - slab) < 1e-15);
        CHECK(std::abs(fraction_below<3>(std::array<Real, 3>{0, -2, 0}, 2 * d) - slab) < 1e-15);
        CHECK(std::abs(fraction_below<2>(std::array<Real, 2>{1e-20, 1}, d) - slab) < 1e-15);
        CHECK(std::abs(fraction_below<3>(std::array<Real, 3>{1e-20, 1e-17, 1}, d) - slab) < 1e-15);
        // Parallel to an edge: a triangle or what it leaves.
        const Real reach = 0.5 - std::abs(d) / 2, tip = reach > 0 ? 2 * reach * reach : 0;
        CHECK(std::abs(fraction_below<3>(std::array<Real, 3>{1, 1e-19, 1}, d) - (d < 0 ? tip : 1 - tip)) <
              1e-15);
    }
    const Real f = fraction_below<3>(std::array<Real, 3>{0, 0, 0}, 0.0);
    CHECK((f >= 0 && f <= 1));
}

TEST_CASE("the inverse, to 1e-14") {
    check_inverse<2>(false);
    check_inverse<2>(true);
    check_inverse<3>(false);
    check_inverse<3>(true);
}

TEST_CASE("a box that is not a cube") {
    // z = 0.3 + 0.5 x in a box 2 x 3 x 1: mean height 0.3 + 0.5.
    CHECK(fraction_below<3>({-0.5, 0, 1}, 0.3, {2, 3, 1}) ==
          doctest::Approx(0.8 - 0.5 * 0.3 * 0.6 / 2).epsilon(1e-14));
    CHECK(plane_constant<3>({0, 0, 2}, 0.25, {2, 3, 1}) == doctest::Approx(0.5).epsilon(1e-14));
    CHECK(plane_constant<2>({1, 1}, 0.125, {1, 1}) == doctest::Approx(0.5).epsilon(1e-14));
}

TEST_CASE("slabs add up to the cell") {
    std::mt19937 random(11);
    std::uniform_real_distribution<Real> uniform(0, 1);
    for (int k = 0; k < 20'000; ++k) {
        CellPlane<3> plane{random_normal<3>(random, k % 2 == 0), 0};
        plane.distance = plane_distance<3>(plane.normal, uniform(random));
        const int axis = k % 3;
        const Real low = uniform(random);
        const Real sum = low * slab_fraction(plane, axis, -1.0, low) +
                         (1 - low) * slab_fraction(plane, axis, 1.0, 1 - low);
        CHECK(std::abs(sum - fraction_below(plane)) < 1e-14);
    }
}

TEST_CASE("packs answer as single numbers do") {
    std::mt19937 random(5);
    std::uniform_real_distribution<Real> uniform(0, 1);
    for (int k = 0; k < 2'000; ++k) {
        std::array<Pack, 3> normal{};
        Pack fraction{};
        for (int lane = 0; lane < pack_lanes; ++lane) {
            const auto n = random_normal<3>(random, lane % 2 == 0);
            for (std::size_t a = 0; a < 3; ++a) normal[a].set(lane, n[a]);
            fraction.set(lane, uniform(random));
        }
        const Pack distance = plane_distance<3>(normal, fraction);
        for (int lane = 0; lane < pack_lanes; ++lane) {
            const std::array<Real, 3> n{normal[0][lane], normal[1][lane], normal[2][lane]};
            CHECK(std::abs(distance[lane] - plane_distance<3>(n, fraction[lane])) <= 1e-15);
        }
    }
}
