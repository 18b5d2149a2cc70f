// Gravel: volume, axes and roundness as asked for, one body, the same for the same seed.
#include <abrade/geometry/gravel.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <string>
#include <vector>

using namespace abrade;

namespace {

/// Radii of the spheres that stand out: those that touch a plane laid against the clump, from all sides.
std::vector<Real> corner_radii(const Clump& clump) {
    std::vector<char> stands_out(clump.members.size(), 0);
    constexpr int directions = 4000;
    for (int n = 0; n < directions; ++n) {
        const Real z = 1 - (2 * n + 1.0) / directions, r = std::sqrt(1 - z * z),
                   angle = 2.399963229728653 * n;
        const Vec3 u(r * std::cos(angle), r * std::sin(angle), z);
        std::size_t farthest = 0;
        Real reach = -1;
        for (std::size_t k = 0; k < clump.members.size(); ++k)
            if (const Real d = u.dot(clump.members[k].centre) + clump.members[k].radius; d > reach)
                reach = d, farthest = k;
        stands_out[farthest] = 1;
    }
    std::vector<Real> radii;
    for (std::size_t k = 0; k < clump.members.size(); ++k)
        if (stands_out[k]) radii.push_back(clump.members[k].radius);
    return radii;
}

/// Wadell's roundness: mean radius of the corners over that of the largest inscribed sphere.
Real roundness_of(const Clump& clump) {
    Real largest = 0, sum = 0;
    for (const Sphere& s : clump.members) largest = std::max(largest, s.radius);
    const std::vector<Real> radii = corner_radii(clump);
    for (const Real r : radii) sum += r;
    return sum / static_cast<Real>(radii.size()) / largest;
}

/// How many bodies the spheres are, where two hang together that overlap by a tenth of the smaller radius.
int bodies(const Clump& clump) {
    std::vector<char> seen(clump.members.size(), 0);
    int count = 0;
    for (std::size_t start = 0; start < seen.size(); ++start) {
        if (seen[start]) continue;
        ++count;
        std::vector<std::size_t> front{start};
        seen[start] = 1;
        while (!front.empty()) {
            const Sphere s = clump.members[front.back()];
            front.pop_back();
            for (std::size_t k = 0; k < seen.size(); ++k) {
                const Sphere& other = clump.members[k];
                if (!seen[k] && (s.centre - other.centre).norm() <
                                    s.radius + other.radius - 0.1 * std::min(s.radius, other.radius))
                    seen[k] = 1, front.push_back(k);
            }
        }
    }
    return count;
}

std::string message_of(const Gravel& wanted) {
    try {
        make_gravel(wanted);
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing was thrown";
}

}  // namespace

TEST_CASE("size, form and roundness come out as they were asked for") {
    std::uint64_t seed = 1;
    for (const Real elongation : {1.0, 0.7, 0.4})
        for (const Real flatness : {1.0, 0.4})
            for (const Real roundness : {0.15, 0.5, 0.9, 1.0}) {
                const Clump stone = make_gravel({.size = 0.05,
                                                 .elongation = elongation,
                                                 .flatness = flatness,
                                                 .roundness = roundness,
                                                 .largest_gap = 0.05,
                                                 .max_spheres = 70,
                                                 .seed = ++seed});
                CAPTURE(elongation);
                CAPTURE(flatness);
                CAPTURE(roundness);
                CHECK(std::abs(stone.volume / (pi / 6 * cube(0.05)) - 1) < 1e-11);  // error of the integral
                // What make_gravel promises.
                CHECK(std::abs(form_of(stone).elongation() - elongation) < 1e-3);
                CHECK(std::abs(form_of(stone).flatness() - flatness) < 1e-3);
                CHECK(std::abs(roundness_of(stone) / roundness - 1) < 1e-3);
                CHECK(bodies(stone) == 1);
                CHECK(stone.members.size() <= 70);
                CHECK(union_moments(stone.members).centroid.norm() < 1e-12);
            }
}

TEST_CASE("the largest member is the largest inscribed sphere: no larger ball fits among the others") {
    const Clump stone =
        make_gravel({.size = 1, .elongation = 0.8, .flatness = 0.7, .roundness = 0.3, .seed = 4});
    Real largest = 0;
    for (const Sphere& s : stone.members) largest = std::max(largest, s.radius);
    // A ball inside the convex hull keeps within every plane laid against it: bounds its radius from above
    // at each centre of a fine grid.
    Real fits = 0;
    for (int i = -10; i <= 10; ++i)
        for (int j = -10; j <= 10; ++j)
            for (int k = -10; k <= 10; ++k) {
                const Vec3 x = 0.02 * Vec3(i, j, k);
                Real room = 1;
                for (int n = 0; n < 500 && room > fits; ++n) {
                    const Real z = 1 - (2 * n + 1.0) / 500, r = std::sqrt(1 - z * z),
                               angle = 2.399963229728653 * n;
                    const Vec3 u(r * std::cos(angle), r * std::sin(angle), z);
                    Real reach = 0;
                    for (const Sphere& s : stone.members) reach = std::max(reach, u.dot(s.centre) + s.radius);
                    room = std::min(room, reach - u.dot(x));
                }
                fits = std::max(fits, room);
            }
    // 500 planes leave up to a few hundredths more room than all of them would.
    CHECK(fits > largest * (1 - 0.03));
    CHECK(fits < largest * 1.05);
}

TEST_CASE("a stone of roundness 1 is a ball, a capsule or a tablet") {
    const Clump ball = make_gravel({.size = 0.1, .roundness = 1});
    REQUIRE(ball.members.size() == 1);
    CHECK(ball.members[0].radius == doctest::Approx(0.05).epsilon(1e-12).scale(0));

    // L / S = 2: two half balls and a cylinder, in spheres of one radius in a row.
    const Clump capsule = make_gravel({.size = 0.1, .elongation = 0.5, .roundness = 1, .largest_gap = 0.002});
    for (const Sphere& s : capsule.members) {
        CHECK(s.radius == doctest::Approx(capsule.members[0].radius).epsilon(1e-4).scale(0));
        CHECK(std::hypot(s.centre.y(), s.centre.z()) < 1e-4 * s.radius);
    }
    // With r = S / 2 a capsule with L = 4 r has the volume 4/3 pi r^3 + 2 r pi r^2. Gaps of 0.2 % of the
    // size are waists of the cylinder: at most 0.4 % of its radius and 0.8 % of its volume.
    const Real r = capsule.members[0].radius;
    CHECK(capsule.volume == doctest::Approx(10.0 / 3 * pi * cube(r)).epsilon(0.006).scale(0));
}

TEST_CASE("the same input gives the same bits, another seed another stone") {
    const Gravel wanted{
        .size = 0.04, .elongation = 0.8, .flatness = 0.6, .roundness = 0.5, .max_spheres = 30, .seed = 7};
    const Clump one = make_gravel(wanted), again = make_gravel(wanted);
    REQUIRE(one.members.size() == again.members.size());
    for (std::size_t n = 0; n < one.members.size(); ++n) {
        CHECK(one.members[n].centre == again.members[n].centre);
        CHECK(one.members[n].radius == again.members[n].radius);
    }
    Gravel other = wanted;
    other.seed = 8;
    CHECK((make_gravel(other).principal_moments / one.principal_moments.norm() -
           one.principal_moments.normalized())
              .norm() > 1e-3);
}

TEST_CASE("a seed gives the same directions of corners with every compiler") {
    const Vec3 first = detail::random_corners(1).front();  // as both g++ 12 and clang++ 14 had it
    CHECK((first - Vec3(0.47900827323925321, 0.8750080500959303, 0.070085565102000064)).norm() < 1e-14);
}

TEST_CASE("narrower gaps take more spheres, a rounder stone fewer") {
    const auto count = [](Real roundness, Real gap) {
        return make_gravel({.size = 1,
                            .flatness = 0.8,
                            .roundness = roundness,
                            .largest_gap = gap,
                            .max_spheres = 200,
                            .seed = 3})
            .members.size();
    };
    const std::size_t coarse = count(0.5, 0.1), fine = count(0.5, 0.06), round = count(0.8, 0.06);
    CHECK(coarse < fine);
    CHECK(round < fine);
    CHECK(fine < 200);  // done because the gaps are closed, not because there are no more
}

TEST_CASE("axes, of a clump that is known") {
    const StoneForm form = form_of(make_clump("row", {{{0, 0, 0}, 1}, {{0, 1, 0}, 1}, {{0, 2, 0}, 1}}));
    CHECK(form.longest == doctest::Approx(4).epsilon(1e-12));
    CHECK(form.intermediate == doctest::Approx(2).epsilon(1e-12));
    CHECK(form.shortest == doctest::Approx(2).epsilon(1e-12));
    CHECK(form.elongation() == doctest::Approx(0.5).epsilon(1e-12));
    CHECK(form.flatness() == doctest::Approx(1).epsilon(1e-12));
}

TEST_CASE("what no stone is, is refused") {
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    CHECK(message_of({.size = 0}) ==
          "Gravel.size must be finite and > 0, got 0 m; was it left unset? give a number above 0");
    CHECK(message_of({.size = nan}) ==
          "Gravel.size must be finite and > 0, got nan m; look for a division by 0 or an uninitialised "
          "number where it is set");
    CHECK(message_of({.size = 1, .elongation = 1.1}) ==
          "Gravel.elongation must be in [0.2, 1], got 1.1; it is I / L, 1 where both are equal");
    CHECK(message_of({.size = 1, .flatness = 0.1}) ==
          "Gravel.flatness must be in [0.2, 1], got 0.1; it is S / I, 1 where both are equal");
    CHECK(message_of({.size = 1, .roundness = nan}) ==
          "Gravel.roundness must be in [0.05, 1], got nan; 1 is round, less has sharper corners");
    CHECK(message_of({.size = 1, .largest_gap = 0}) ==
          "Gravel.largest_gap must be in [0.002, 1], got 0; it is a share of the size");
    CHECK(message_of({.size = 1, .max_spheres = 8}) ==
          "Gravel.max_spheres must be >= 9, got 8 spheres; one inside and one at each of eight corners");
    const std::string needle =
        message_of({.size = 1, .elongation = 0.3, .flatness = 0.3, .roundness = 0.1, .max_spheres = 20});
    CHECK(needle.find("Gravel.max_spheres must be at least ") == 0);
    CHECK(needle.find("for this form, got 20 spheres; or make it rounder") != needle.npos);
}
