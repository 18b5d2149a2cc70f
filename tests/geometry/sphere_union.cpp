// Volume, centre and inertia of unions of spheres against closed forms and independent integrals.
#include <abrade/geometry/sphere_slices.hpp>
#include <abrade/geometry/sphere_union.hpp>

#include "../message_of.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

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

/// What Gauss' rule between planes leaves: 1.2e-12 at worst in two thousand rows; twice that to spare.
constexpr Real slices = 3e-12;
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

TEST_CASE("rows of spheres against closed forms") {
    // Three spheres in a row of which only neighbours overlap: subtract two lenses.
    const Real r = 1, d = 1.4;
    for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0.48, -0.6, 0.64)}) {
        const SolidMoments m = union_moments(Spheres{{0 * axis, r}, {d * axis, r}, {2 * d * axis, r}});
        CHECK(m.volume == doctest::Approx(3 * ball(r) - 2 * lens(r, r, d)).epsilon(slices));
        CHECK((m.centroid - d * axis).norm() < slices);
    }
}

TEST_CASE("spheres on one axis: a solid of revolution, in closed form") {
    // The largest cross-section counts, and between two crossings one sphere has it throughout.
    const auto closed_form = [](const Spheres& row, const Vec3& axis) {
        std::vector<Real> cuts;
        for (const Sphere& a : row) {
            const Real x = a.centre.dot(axis);
            cuts.insert(cuts.end(), {x - a.radius, x + a.radius});
            for (const Sphere& b : row)
                if (const Real d = b.centre.dot(axis) - x; d != 0)
                    cuts.push_back(x + (d * d + square(a.radius) - square(b.radius)) / (2 * d));
        }
        std::sort(cuts.begin(), cuts.end());
        detail::RawMoments sum;
        for (std::size_t n = 1; n < cuts.size(); ++n) {
            const Real middle = 0.5 * (cuts[n] + cuts[n - 1]);
            const Sphere* widest = nullptr;
            Real widest2 = 0;
            for (const Sphere& s : row)
                if (const Real r2 = square(s.radius) - square(middle - s.centre.dot(axis)); r2 > widest2)
                    widest = &s, widest2 = r2;
            if (widest == nullptr) continue;
            const Real x = widest->centre.dot(axis);
            detail::add_ball_slice(sum, *widest, axis, cuts[n - 1] - x, cuts[n] - x);
        }
        return sum.about_centroid();
    };
    std::mt19937 random(17);
    std::uniform_real_distribution<Real> uniform(0, 1);
    for (int n = 0; n < 200; ++n) {
        Vec3 axis(uniform(random) - 0.5, uniform(random) - 0.5, uniform(random) - 0.5);
        axis = n % 5 == 0 ? Vec3(Vec3::Unit(n / 5 % 3)) : Vec3(axis.normalized());
        Spheres row;
        for (int k = 0; k < 3 + n % 10; ++k)
            row.push_back({3 * uniform(random) * axis, 0.3 + 0.5 * uniform(random)});
        const MomentsError error = moments_error(union_moments(row), closed_form(row, axis));
        CAPTURE(n);
        CHECK(std::abs(error.volume) < slices);
        CHECK(error.centroid < slices);
        CHECK(error.inertia < 2 * slices);  // second moments weigh what is far out
    }
}

TEST_CASE("two spheres by slices, as if there were more") {
    std::mt19937 random(23);
    std::uniform_real_distribution<Real> uniform(0, 1);
    for (int n = 0; n < 200; ++n) {
        const Spheres pair{
            {{uniform(random), uniform(random), uniform(random)}, 0.3 + 0.5 * uniform(random)},
            {{uniform(random), uniform(random), uniform(random)}, 0.3 + 0.5 * uniform(random)}};
        const MomentsError error = moments_error(detail::slice_moments(pair), union_moments(pair));
        CHECK(std::abs(error.volume) < slices);
        CHECK(error.centroid < slices);
        CHECK(error.inertia < 2 * slices);
    }
}

TEST_CASE("heaps of spheres that all overlap: turned, they have the turned moments") {
    std::mt19937 random(11);
    std::uniform_real_distribution<Real> uniform(-0.5, 0.5);
    for (const int count : {3, 4, 7, 20, 50}) {
        Spheres heap;
        for (int k = 0; k < count; ++k)
            heap.push_back(
                {{uniform(random), uniform(random), uniform(random)}, 0.4 + 0.3 * uniform(random)});
        const SolidMoments m = union_moments(heap);
        Quaternion q(uniform(random), uniform(random), uniform(random), uniform(random));
        const Mat3 turn = q.normalized().toRotationMatrix();
        Spheres turned = heap;
        for (Sphere& s : turned) s.centre = (turn * s.centre + Vec3(1, 2, 3)).eval();
        SolidMoments expected = m;
        expected.centroid = turn * m.centroid + Vec3(1, 2, 3);
        expected.inertia = turn * m.inertia * turn.transpose();
        const MomentsError error = moments_error(union_moments(turned), expected);
        CAPTURE(count);
        // Slices in other directions share no circle, no event and no node with those of the first.
        CHECK(std::abs(error.volume) < slices);
        CHECK(error.centroid < slices);
        CHECK(error.inertia < 2 * slices);

        const SolidMoments cells = by_cells(heap, 160);
        // 160 cells across: as above, 1e-3 leaves a factor of some ten.
        CHECK(std::abs(m.volume / cells.volume - 1) < 1e-3);
        CHECK((m.centroid - cells.centroid).norm() < 1e-3);
        CHECK(apart(m.inertia, cells.inertia) < 1e-3);
    }
}

TEST_CASE("a cube of spheres: circles, and points where four spheres meet, all in line with the axes") {
    // Eight balls at the corners of a cube. Spheres across a face or the cube's diagonal do not meet while
    // d sqrt(2) > 2 r, so twelve lenses are all that is counted twice. At d sqrt(2) = 2 r they just touch.
    for (const Real d : {1.5, std::sqrt(2.0)}) {
        Spheres cube;
        for (int n = 0; n < 8; ++n) cube.push_back({d * Vec3(n & 1, n >> 1 & 1, n >> 2), 1});
        const SolidMoments m = union_moments(cube);
        CHECK(m.volume == doctest::Approx(8 * ball(1) - 12 * lens(1, 1, d)).epsilon(slices));
        CHECK((m.centroid - Vec3::Constant(0.5 * d)).norm() < slices);
        CHECK(apart(m.inertia, m.inertia.trace() / 3 * Mat3::Identity()) < slices);
    }
}

TEST_CASE("what is covered changes nothing, in slices too") {
    const Spheres pair{{{0, 0, 0}, 1}, {{1, 0, 0}, 0.8}};
    for (const Sphere& more : {pair[0], pair[1], Sphere{{0.2, 0.1, 0}, 0.3}, Sphere{{0.5, 0, 0}, 0.5}}) {
        const MomentsError error =
            moments_error(union_moments(Spheres{pair[0], pair[1], more}), union_moments(pair));
        CHECK(std::abs(error.volume) < slices);
        CHECK(error.inertia < slices);
    }
}

TEST_CASE("size does not matter, nor does a place far from the origin") {
    const Spheres three{{{0, 0, 0}, 1}, {{0.9, 0.2, 0}, 0.8}, {{0.3, 0.7, 0.4}, 0.6}};
    const SolidMoments m = union_moments(three);
    Spheres small = three;
    for (Sphere& s : small) s.centre *= 1e-4, s.radius *= 1e-4;
    CHECK(union_moments(small).volume == doctest::Approx(1e-12 * m.volume).epsilon(round_off).scale(0));
    CHECK(apart(union_moments(small).inertia, 1e-20 * m.inertia) < round_off);
    Spheres far = three;
    for (Sphere& s : far) s.centre += Vec3(1000, -2000, 500);
    // Coordinates of 2000 are given to 2e-13: that much of a radius is lost before anything is computed.
    CHECK(union_moments(far).volume == doctest::Approx(m.volume).epsilon(1e-11));
    CHECK(apart(union_moments(far).inertia, m.inertia) < 1e-11);
}

TEST_CASE("what is no solid is refused") {
    CHECK_THROWS_WITH_AS(union_moments(Spheres{}),
                         "union_moments.spheres must be at least 1 sphere, got 0; give each its centre and "
                         "its radius",
                         InputError);
    CHECK_THROWS_WITH_AS(union_moments(Spheres{{Vec3::Zero(), 0}}),
                         "union_moments.spheres[0].radius must be finite and > 0, got 0 m; was it left "
                         "unset? give a number above 0",
                         InputError);
    CHECK_THROWS_AS(union_moments(Spheres{{Vec3::Zero(), 1}, {Vec3::Zero(), -1}}), InputError);
    CHECK_THROWS_AS(union_moments(Spheres{{Vec3::Zero(), std::numeric_limits<Real>::quiet_NaN()}}),
                    InputError);
    CHECK_THROWS_AS(union_moments(Spheres{{Vec3::Constant(std::numeric_limits<Real>::quiet_NaN()), 1}}),
                    InputError);
}

TEST_CASE("a clump that is no solid is refused: the clump, the member and the component are named") {
    const Real infinite = std::numeric_limits<Real>::infinity();
    const auto refused = [](const Spheres& members) {
        return message_of([&] { make_clump("gravel", members); });
    };
    CHECK(refused({}) ==
          "Clump 'gravel'.members must be at least 1 sphere, got 0; give each its centre and its radius");
    Spheres members(5, {Vec3::Zero(), 1});
    members[3].centre.x() = infinite;
    CHECK(refused(members) ==
          "Clump 'gravel'.members[3].centre.x must be finite, got inf m; look for a division by 0 or an "
          "uninitialised number where it is set");
    members[2].radius = -1;  // the first that is wrong
    CHECK(refused(members) ==
          "Clump 'gravel'.members[2].radius must be finite and > 0, got -1 m; check its sign");
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
        const Clump clump = make_clump("chiral", members, ClumpParts::apart);
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
