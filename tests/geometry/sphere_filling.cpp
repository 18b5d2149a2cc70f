// Spheres that fill a mesh: inside it, in one piece, to the wanted gap, with the errors that are told.
#include <abrade/geometry/sphere_filling.hpp>

#include <doctest/doctest.h>

#include <string>
#include <vector>

using namespace abrade;

namespace {

/// An octahedron whose triangles are cut in four `times` times, on an ellipsoid.
SurfaceMesh ellipsoid(const Vec3& half_axes, int times) {
    std::vector<std::array<Vec3, 3>> loose;
    for (const Real x : {-1.0, 1.0})
        for (const Real y : {-1.0, 1.0})
            for (const Real z : {-1.0, 1.0}) loose.push_back({Vec3(x, 0, 0), Vec3(0, y, 0), Vec3(0, 0, z)});
    for (int n = 0; n < times; ++n) {
        std::vector<std::array<Vec3, 3>> finer;
        for (const auto& [a, b, c] : loose) {
            const Vec3 ab = (a + b).normalized(), bc = (b + c).normalized(), ca = (c + a).normalized();
            for (const auto& part : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
                finer.push_back(part);
        }
        loose = finer;
    }
    for (auto& triangle : loose)
        for (Vec3& v : triangle) v = v.cwiseProduct(half_axes).eval();
    return mesh_of_triangles(loose);
}

SurfaceMesh box(const Vec3& sides) {
    std::vector<Vec3> v;
    for (int n = 0; n < 8; ++n) v.push_back(sides.cwiseProduct(Vec3(n & 1, n >> 1 & 1, n >> 2)));
    return {v,
            {{0, 2, 3},
             {0, 3, 1},
             {4, 5, 7},
             {4, 7, 6},
             {0, 1, 5},
             {0, 5, 4},
             {2, 6, 7},
             {2, 7, 3},
             {0, 4, 6},
             {0, 6, 2},
             {1, 3, 7},
             {1, 7, 5}}};
}

std::string message_of(const SphereFilling& limits) {
    try {
        fill_with_spheres(box({1, 1, 1}), limits);
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing was thrown";
}

}  // namespace

TEST_CASE("the first sphere is the largest that fits") {
    CHECK(fill_with_spheres(box({1.3, 1, 0.8}), {.max_spheres = 1}).spheres[0].radius ==
          doctest::Approx(0.4).epsilon(1e-6));
    const SphereFillingResult cube = fill_with_spheres(box({2, 2, 2}), {.max_spheres = 1});
    CHECK(cube.spheres[0].radius == doctest::Approx(1).epsilon(1e-5));
    CHECK((cube.spheres[0].centre - Vec3::Ones()).norm() < 1e-3);
    // A ball in a cube: volume pi / 6 of it, gap (sqrt(3) - 1) at the corners less where the samples end.
    CHECK(cube.error.volume == doctest::Approx(pi / 6 - 1).epsilon(1e-4));
    CHECK(cube.largest_gap < std::sqrt(3.0) - 1);
    CHECK(cube.largest_gap > std::sqrt(3.0) - 1 - cube.sample_spacing);
}

TEST_CASE("every sphere keeps inside and hangs on, and what is told of them is true") {
    const std::array meshes{ellipsoid({1.4, 1, 0.7}, 2), box({1.3, 1, 0.8})};
    for (const SurfaceMesh& mesh : meshes) {
        const SphereFillingResult filled = fill_with_spheres(mesh, {.max_spheres = 40, .samples = 1500});
        const MeshDistance distance(mesh);
        CHECK(filled.spheres.size() == 40);
        for (std::size_t n = 0; n < filled.spheres.size(); ++n) {
            const Sphere& s = filled.spheres[n];
            CHECK(distance.depth(s.centre) > s.radius * (1 - 1e-9));
            bool hangs_on = n == 0;
            for (std::size_t k = 0; k < n; ++k)
                hangs_on |=
                    (s.centre - filled.spheres[k].centre).norm() <
                    s.radius + filled.spheres[k].radius - 0.09 * std::min(s.radius, filled.spheres[k].radius);
            CHECK(hangs_on);
        }
        const SolidMoments moments = union_moments(filled.spheres);
        CHECK(filled.error.volume == moments.volume / mesh.moments().volume - 1);
        CHECK(filled.error.volume < 0);
        // The gap, at points of the surface that are not those watched.
        Real widest = 0;
        for (std::size_t t = 0; t < mesh.triangles().size(); ++t)
            detail::each_part(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2), 30,
                              [&](const Vec3& x) {
                                  Real gap = 10;
                                  for (const Sphere& s : filled.spheres)
                                      gap = std::min(gap, (x - s.centre).norm() - s.radius);
                                  widest = std::max(widest, gap);
                              });
        CHECK(widest <= filled.largest_gap + filled.sample_spacing);
        CHECK(widest >= filled.largest_gap - filled.sample_spacing);
    }
}

TEST_CASE("more spheres leave less, and the errors fall together") {
    const SurfaceMesh mesh = ellipsoid({1.4, 1, 0.7}, 3);
    SphereFillingResult before = fill_with_spheres(mesh, {.max_spheres = 5, .samples = 1500});
    for (const Index count : {10, 20, 40, 80}) {
        const SphereFillingResult now = fill_with_spheres(mesh, {.max_spheres = count, .samples = 1500});
        CHECK(now.error.volume > before.error.volume);
        CHECK(now.error.inertia < before.error.inertia);
        CHECK(now.largest_gap < before.largest_gap);
        before = now;
    }
    // Spheres of a size between them each cover their patch to second order: some 1 / n of the volume.
    CHECK(std::abs(before.error.volume) < 0.03);
    CHECK(before.error.centroid < 0.003);
}

TEST_CASE("a wanted gap is reached, with no sphere that could be left out") {
    const SurfaceMesh mesh = ellipsoid({1.4, 1, 0.7}, 2);
    const SphereFillingResult filled =
        fill_with_spheres(mesh, {.max_spheres = 500, .largest_gap = 0.05, .samples = 1000});
    CHECK(filled.largest_gap <= 0.05);
    CHECK(filled.spheres.size() < 80);
    const SphereFillingResult wider =
        fill_with_spheres(mesh, {.max_spheres = 500, .largest_gap = 0.1, .samples = 1000});
    CHECK(wider.largest_gap <= 0.1);
    CHECK(wider.spheres.size() < filled.spheres.size());
}

TEST_CASE("no sphere below the smallest radius") {
    const SphereFillingResult filled = fill_with_spheres(
        box({1.3, 1, 0.8}), {.max_spheres = 200, .largest_gap = 0.01, .smallest_radius = 0.1});
    for (const Sphere& s : filled.spheres) CHECK(s.radius >= 0.1);
    // Balls of 0.1 in a corner: sqrt(3) - 1 of their radius is out of reach, at the least.
    CHECK(filled.largest_gap > 0.1 * (std::sqrt(3.0) - 1) - filled.sample_spacing);
}

TEST_CASE("a mesh becomes a clump, the same one each time") {
    const SurfaceMesh mesh = ellipsoid({0.028, 0.02, 0.014}, 2);
    const SphereFilling limits{.max_spheres = 20, .samples = 1000};
    const SphereFillingResult one = fill_with_spheres(mesh, limits), again = fill_with_spheres(mesh, limits);
    REQUIRE(one.spheres.size() == again.spheres.size());
    for (std::size_t n = 0; n < one.spheres.size(); ++n) {
        CHECK(one.spheres[n].centre == again.spheres[n].centre);
        CHECK(one.spheres[n].radius == again.spheres[n].radius);
    }
    const Clump clump = make_clump("pebble", one.spheres);
    CHECK(clump.volume == doctest::Approx(mesh.moments().volume * (1 + one.error.volume)).epsilon(1e-10));
}

TEST_CASE("limits that make no sense are refused") {
    CHECK(message_of({.max_spheres = 0}) ==
          "SphereFilling.max_spheres must be >= 1, got 0 spheres; more follow the surface closer");
    CHECK(message_of({.largest_gap = -1}) ==
          "SphereFilling.largest_gap must be finite and >= 0, got -1 m; 0 goes on up to max_spheres");
    CHECK(message_of({.samples = 0}) ==
          "SphereFilling.samples must be >= 1, got 0 points; more see smaller gaps");
    CHECK(message_of({.smallest_radius = 0.7})
              .find("SphereFilling.smallest_radius must be no larger than the "
                    "largest inscribed sphere (0.5 m), got 0.7 m; make it smaller, or check") == 0);
}
