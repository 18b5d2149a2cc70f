// Volume, centre and inertia of unions of spheres against closed forms and independent integrals.
#include <abrade/geometry/sphere_union.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <random>

using namespace abrade;

namespace {

using Spheres = std::vector<Sphere>;

Real ball(Real r) { return 4.0 / 3 * pi * cube(r); }

/// Volume common to two balls whose surfaces cross (a lens), e.g.
/// mathworld.wolfram.com/Sphere-SphereIntersection.html.
Real lens(Real a, Real b, Real d) {
    return pi * square(a + b - d) * (d * d + 2 * d * (a + b) - 3 * square(a - b)) / (12 * d);
}

/// Moments by a midpoint rule over a grid of cells: shares nothing with the library but the definition.
SolidMoments by_cells(const Spheres& spheres, int cells) {
    Vec3 low = Vec3::Constant(1e300), high = -low;
    for (const Sphere& s : spheres) {
        low = low.cwiseMin((s.centre.array() - s.radius).matrix());
        high = high.cwiseMax((s.centre.array() + s.radius).matrix());
    }
    const Vec3 step = (high - low) / cells;
    Real volume = 0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    for (int i = 0; i < cells; ++i)
        for (int j = 0; j < cells; ++j)
            for (int k = 0; k < cells; ++k) {
                const Vec3 x = low + step.cwiseProduct(Vec3(i + 0.5, j + 0.5, k + 0.5));
                for (const Sphere& s : spheres)
                    if ((x - s.centre).squaredNorm() < square(s.radius)) {
                        volume += 1;
                        first += x;
                        second += x * x.transpose();
                        break;
                    }
            }
    const Real cell = step.prod();
    const Vec3 c = first / volume;
    const Mat3 covariance = cell * second - cell * volume * c * c.transpose();
    return {cell * volume, c, covariance.trace() * Mat3::Identity() - covariance};
}

/// Largest difference of two tensors over the size of the second.
Real apart(const Mat3& a, const Mat3& b) { return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff(); }

constexpr Real round_off = 1e-13;  // some tens of operations on numbers of one size

}  // namespace

TEST_CASE("one sphere") {
    for (const Real r : {1e-3, 1.0, 50.0}) {
        const SolidMoments m = union_moments(Spheres{{{1, -2, 3}, r}});
        CHECK(m.volume == doctest::Approx(ball(r)).epsilon(round_off));
        CHECK((m.centroid - Vec3(1, -2, 3)).norm() < round_off * 4);
        // The shift to the centroid cancels |x|^2 V against r^2 V.
        CHECK(apart(m.inertia, 0.4 * ball(r) * r * r * Mat3::Identity()) < round_off * (1 + 14 / (r * r)));
    }
}

TEST_CASE("two spheres: volume by the lens formula") {
    std::mt19937 random(3);
    std::uniform_real_distribution<Real> uniform(0, 1);
    for (int n = 0; n < 500; ++n) {
        const Real a = 0.2 + uniform(random), b = 0.2 + uniform(random);
        const Real d = std::abs(a - b) + uniform(random) * (a + b - std::abs(a - b));
        const Vec3 axis =
            Vec3(uniform(random) - 0.5, uniform(random) - 0.5, uniform(random) - 0.5).normalized();
        const SolidMoments m =
            union_moments(Spheres{{{0.1, 0.2, 0.3}, a}, {Vec3(0.1, 0.2, 0.3) + d * axis, b}});
        CAPTURE(a);
        CAPTURE(b);
        CAPTURE(d);
        CHECK(m.volume == doctest::Approx(ball(a) + ball(b) - lens(a, b, d)).epsilon(10 * round_off));
    }
}

TEST_CASE("two spheres: one inside the other, touching, apart, the same") {
    const Real a = 0.7, b = 0.3;
    const auto volume = [&](Real d) {
        return union_moments(Spheres{{Vec3::Zero(), a}, {{0, d, 0}, b}}).volume;
    };
    CHECK(volume(0.1) == doctest::Approx(ball(a)).epsilon(round_off));
    CHECK(volume(a - b) == doctest::Approx(ball(a)).epsilon(round_off));  // touching from within
    CHECK(volume(0) == doctest::Approx(ball(a)).epsilon(round_off));
    CHECK(volume(a + b) == doctest::Approx(ball(a) + ball(b)).epsilon(round_off));  // touching from without
    CHECK(volume(5) == doctest::Approx(ball(a) + ball(b)).epsilon(round_off));
    CHECK(union_moments(Spheres{{Vec3::Zero(), a}, {Vec3::Zero(), a}}).volume ==
          doctest::Approx(ball(a)).epsilon(round_off));

    // A sphere within another changes nothing, whichever is named first.
    const SolidMoments inner_last = union_moments(Spheres{{{1, 0, 0}, a}, {{1.1, 0, 0}, b}});
    const SolidMoments inner_first = union_moments(Spheres{{{1.1, 0, 0}, b}, {{1, 0, 0}, a}});
    CHECK((inner_last.centroid - Vec3(1, 0, 0)).norm() < round_off);
    CHECK((inner_first.centroid - Vec3(1, 0, 0)).norm() < round_off);

    // Apart: parallel axes.
    const SolidMoments m = union_moments(Spheres{{{-2, 0, 0}, a}, {{2, 0, 0}, a}});
    CHECK(m.inertia(0, 0) == doctest::Approx(2 * 0.4 * ball(a) * a * a).epsilon(round_off));
    CHECK(m.inertia(1, 1) == doctest::Approx(2 * (0.4 * ball(a) * a * a + ball(a) * 4)).epsilon(round_off));
}

TEST_CASE("two overlapping spheres: centroid and inertia against an independent integral") {
    const Spheres pair{{{0.1, 0, 0.2}, 0.5}, {{0.4, 0.3, 0.1}, 0.35}};
    const SolidMoments exact = union_moments(pair), numeric = by_cells(pair, 200);
    // Cells on the surface are in or out at random: relative error about N^-2, N = 200 across; measured 2e-5.
    CHECK(std::abs(exact.volume / numeric.volume - 1) < 1e-4);
    CHECK((exact.centroid - numeric.centroid).norm() < 1e-4 * 0.5);
    CHECK(apart(exact.inertia, numeric.inertia) < 2e-4);
    CHECK(std::abs(numeric.inertia(0, 1)) >
          1e-3 * numeric.inertia(0, 0));  // the off-diagonal is really tested
}

TEST_CASE("many spheres against the closed form where there is one") {
    // Three spheres in a row of which only neighbours overlap: subtract two lenses.
    const Real r = 1, d = 1.4;
    const Spheres row{{{0, 0, 0}, r}, {{d, 0, 0}, r}, {{2 * d, 0, 0}, r}};
    const Real exact = 3 * ball(r) - 2 * lens(r, r, d);
    CHECK(std::abs(union_moments(row).volume / exact - 1) < 1e-4);  // what the header claims
    const Spheres upright{{{0, 0, 0}, r}, {{0, 0, d}, r}, {{0, 0, 2 * d}, r}};
    CHECK(std::abs(union_moments(upright).volume / exact - 1) < 1e-4);

    // Inertia of the same row, by two exact pairs less the sphere that they share.
    const SolidMoments m = union_moments(row), numeric = by_cells(row, 200);
    CHECK((m.centroid - Vec3(d, 0, 0)).norm() < 1e-4);
    CHECK(apart(m.inertia, numeric.inertia) < 5e-4);
}

TEST_CASE("many random spheres against cells and finer rays") {
    std::mt19937 random(11);
    std::uniform_real_distribution<Real> uniform(-0.5, 0.5);
    for (int n = 0; n < 3; ++n) {
        Spheres heap;
        for (int k = 0; k < 7; ++k)
            heap.push_back(
                {{uniform(random), uniform(random), uniform(random)}, 0.4 + 0.3 * uniform(random)});
        const SolidMoments coarse = union_moments(heap), fine = union_moments(heap, 1200),
                           cells = by_cells(heap, 160);
        CHECK(std::abs(coarse.volume / fine.volume - 1) < 1e-4);  // what the header claims
        CHECK(apart(coarse.inertia, fine.inertia) < 1e-3);
        // 160 cells across: as above, 1e-3 leaves a factor of some ten.
        CHECK(std::abs(coarse.volume / cells.volume - 1) < 1e-3);
        CHECK((coarse.centroid - cells.centroid).norm() < 1e-3);
        CHECK(apart(coarse.inertia, cells.inertia) < 1e-3);
    }
}

TEST_CASE("a sphere listed twice counts once, in the ray integral too") {
    const Spheres once{{{0, 0, 0}, 1}, {{1, 0, 0}, 0.8}}, thrice{once[0], once[1], once[0]};
    CHECK(std::abs(union_moments(thrice).volume / union_moments(once).volume - 1) < 1e-4);
}

TEST_CASE("what is no solid is refused") {
    CHECK_THROWS_AS(union_moments(Spheres{}), InputError);
    CHECK_THROWS_WITH_AS(union_moments(Spheres{{Vec3::Zero(), 0}}),
                         "Sphere.radius must be finite and > 0, got 0 m", InputError);
    CHECK_THROWS_AS(union_moments(Spheres{{Vec3::Zero(), 1}, {Vec3::Zero(), -1}}), InputError);
    CHECK_THROWS_AS(union_moments(Spheres{{Vec3::Zero(), std::numeric_limits<Real>::quiet_NaN()}}),
                    InputError);
    CHECK_THROWS_AS(union_moments(Spheres{{Vec3::Constant(std::numeric_limits<Real>::quiet_NaN()), 1}}),
                    InputError);
}

TEST_CASE("a clump stands in its principal frame") {
    const Clump clump = make_clump("test", {{{1, 2, 3}, 0.5}, {{1.3, 2.2, 3.1}, 0.4}});
    const SolidMoments again = union_moments(clump.members);
    CHECK(again.centroid.norm() < round_off);
    CHECK(clump.volume == doctest::Approx(again.volume).epsilon(round_off));
    const Mat3 moments = clump.principal_moments.asDiagonal();
    CHECK(apart(again.inertia, moments) < 10 * round_off);
    // A rotation, not a mirror, keeps distances and radii.
    CHECK((clump.members[0].centre - clump.members[1].centre).norm() ==
          doctest::Approx(Vec3(0.3, 0.2, 0.1).norm()).epsilon(round_off));
    CHECK(clump.bounding_radius >= (clump.members[0].centre.norm() + 0.5) * (1 - round_off));
    CHECK(clump.bounding_radius >= (clump.members[1].centre.norm() + 0.4) * (1 - round_off));
}

TEST_CASE("a chiral clump is rotated into its frame, never mirrored") {
    // The triple product of three arms tells left from right.
    const auto handedness = [](const Spheres& s) {
        return (s[1].centre - s[0].centre).cross(s[2].centre - s[0].centre).dot(s[3].centre - s[0].centre);
    };
    std::mt19937 random(5);
    std::uniform_real_distribution<Real> uniform(-1, 1);
    for (int n = 0; n < 10; ++n) {
        Spheres members;
        for (int k = 0; k < 4; ++k)
            members.push_back({{uniform(random), uniform(random), uniform(random)}, 0.6});
        const Clump clump = make_clump("chiral", members);
        CHECK(handedness(clump.members) == doctest::Approx(handedness(members)).epsilon(1e-9));
    }
}

TEST_CASE("a clump of one sphere is that sphere, to the last bit") {
    const Clump clump = make_clump("sphere", {{{7, 8, 9}, 0.25}});
    CHECK(clump.members[0].centre == Vec3::Zero());
    CHECK(clump.volume == 4.0 / 3 * pi * cube(0.25));
    CHECK(clump.principal_moments == Vec3::Constant(0.4 * clump.volume * 0.25 * 0.25));
    CHECK(clump.bounding_radius == 0.25);
}
