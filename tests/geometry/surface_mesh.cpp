// Triangle meshes: moments against closed forms, distance and side, and what is no solid is refused.
#include <abrade/geometry/mesh_distance.hpp>
#include <abrade/geometry/surface_mesh.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

using namespace abrade;

namespace {

/// A box from the origin to `sides`, its triangles anticlockwise from outside.
struct BoxParts {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles{{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    explicit BoxParts(const Vec3& sides) {
        for (int n = 0; n < 8; ++n) vertices.push_back(sides.cwiseProduct(Vec3(n & 1, n >> 1 & 1, n >> 2)));
    }
    SurfaceMesh mesh() const { return {vertices, triangles}; }
};

std::string message_of(const BoxParts& parts) {
    try {
        parts.mesh();
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing was thrown";
}
bool has(const std::string& text, std::string_view part) { return text.find(part) != text.npos; }

constexpr Real round_off = 1e-13;
const Vec3 sides(1.3, 1.0, 0.8);
const Mat3 box_inertia = (sides.prod() / 12 * (sides.squaredNorm() * Vec3::Ones() - sides.cwiseAbs2()))
                             .asDiagonal()
                             .toDenseMatrix();

}  // namespace

TEST_CASE("a box: volume, area, centroid, inertia") {
    const SurfaceMesh mesh = BoxParts(sides).mesh();
    const MomentsError error = moments_error(mesh.moments(), {sides.prod(), 0.5 * sides, box_inertia});
    CHECK(std::abs(error.volume) < round_off);
    CHECK(error.centroid < round_off);
    CHECK(error.inertia < round_off);
    CHECK(mesh.area() == doctest::Approx(2 * (1.3 + 1.04 + 0.8)).epsilon(round_off));
    CHECK(mesh.low() == Vec3::Zero());
    CHECK(mesh.high() == sides);
}

TEST_CASE("a tetrahedron, anywhere: V = |a . (b x c)| / 6, centroid at the mean of its corners") {
    std::mt19937 random(3);
    std::uniform_real_distribution<Real> uniform(-1, 1);
    for (int n = 0; n < 50; ++n) {
        std::vector<Vec3> v;
        for (int k = 0; k < 4; ++k) v.emplace_back(uniform(random), uniform(random), 10 + uniform(random));
        const SurfaceMesh mesh(v, {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});  // of any sense
        const Real volume = std::abs((v[1] - v[0]).dot((v[2] - v[0]).cross(v[3] - v[0]))) / 6;
        // Flat ones are small differences of products of size 1.
        CHECK(std::abs(mesh.moments().volume - volume) < round_off);
        CHECK((mesh.moments().centroid - (v[0] + v[1] + v[2] + v[3]) / 4).norm() * volume < 1e-12);
        for (std::size_t t = 0; t < 4; ++t) {
            const Vec3 outwards = mesh.corner(t, 0) - (v[0] + v[1] + v[2] + v[3]) / 4;
            CHECK(mesh.normal(t).dot(outwards) > 0);
        }
    }
}

TEST_CASE("a mesh that is inside-out, in parts or as a whole, is turned over") {
    BoxParts inverted(sides);
    for (Triangle& t : inverted.triangles) std::swap(t[1], t[2]);
    CHECK(inverted.mesh().moments().volume == doctest::Approx(sides.prod()).epsilon(round_off));
    for (const int which : {0b1, 0b101101, 0b111111111110}) {
        BoxParts mixed(sides);
        for (std::size_t t = 0; t < 12; ++t)
            if (which >> t & 1) std::swap(mixed.triangles[t][1], mixed.triangles[t][2]);
        const SurfaceMesh mesh = mixed.mesh();
        CHECK(mesh.moments().volume == doctest::Approx(sides.prod()).epsilon(round_off));
        for (std::size_t t = 0; t < 12; ++t) CHECK(mesh.normal(t).dot(mesh.corner(t, 0) - 0.5 * sides) > 0);
    }
}

TEST_CASE("a cavity stays one") {
    BoxParts hollow(sides);
    const BoxParts hole(0.5 * sides);
    for (const Triangle& t : hole.triangles) hollow.triangles.push_back({t[0] + 8, t[2] + 8, t[1] + 8});
    for (const Vec3& v : hole.vertices) hollow.vertices.push_back(v + 0.25 * sides);
    const SurfaceMesh mesh = hollow.mesh();
    CHECK(mesh.moments().volume == doctest::Approx(0.875 * sides.prod()).epsilon(round_off));
    const MeshDistance distance(mesh);
    CHECK(!distance.inside(0.5 * sides));
    CHECK(distance.inside(0.1 * sides));
}

TEST_CASE("what is no solid is refused, with the place") {
    BoxParts open(sides);
    open.triangles.pop_back();
    CHECK(has(message_of(open),
              "SurfaceMesh must be closed and manifold, got 3 edges that do not, the first "
              "with 1 at (1.3, 0, 0) m; each edge belongs to two triangles"));
    BoxParts winged(sides);
    winged.vertices.emplace_back(2, 2, 2);
    winged.triangles.push_back({0, 1, 8});
    CHECK(has(message_of(winged), "the first with 3 at (0, 0, 0) m"));
    BoxParts nan(sides);
    nan.vertices[3].y() = std::numeric_limits<Real>::quiet_NaN();
    CHECK(has(message_of(nan), "SurfaceMesh.vertices[3].y must be finite, got nan m; look for"));
    BoxParts wrong(sides);
    wrong.triangles[5][1] = 8;
    CHECK(message_of(wrong) ==
          "SurfaceMesh.triangles[5] must be made of vertices below 8, got 8; they count from 0");
    BoxParts twice(sides);
    twice.triangles[2] = {4, 5, 5};
    CHECK(has(message_of(twice), "SurfaceMesh.triangles[2] must be a triangle with area"));
    BoxParts line(sides);
    line.vertices[5] = 0.5 * (line.vertices[4] + line.vertices[7]);
    CHECK(has(message_of(line), "SurfaceMesh.triangles[2] must be a triangle with area"));
    BoxParts none(sides);
    none.triangles.clear();
    CHECK(has(message_of(none), "SurfaceMesh.triangles must be at least 4, got 0 triangles"));
    // Two triangles back to back: closed, and nothing within.
    CHECK_THROWS_AS(SurfaceMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}), InputError);
}

TEST_CASE("a surface with one side is refused") {
    // The projective plane with six vertices: every edge has two triangles, and there is no outside.
    std::vector<Vec3> v;
    for (int n = 0; n < 6; ++n) v.emplace_back(std::cos(n), std::sin(2.0 * n), 0.3 * n * n);
    const std::vector<Triangle> plane{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1},
                                      {1, 2, 4}, {2, 3, 5}, {3, 4, 1}, {4, 5, 2}, {5, 1, 3}};
    CHECK_THROWS_WITH_AS(SurfaceMesh(v, plane),
                         "SurfaceMesh must be orientable, got a surface with one side; a solid has an "
                         "outside and an inside",
                         InputError);
}

TEST_CASE("loose triangles are joined where their corners are equal, or near when that is asked for") {
    const BoxParts parts(sides);
    std::vector<std::array<Vec3, 3>> loose;
    for (const auto& [a, b, c] : parts.triangles)
        loose.push_back({parts.vertices[a], parts.vertices[b], parts.vertices[c]});
    CHECK(mesh_of_triangles(loose).vertices().size() == 8);
    loose[7][1].x() += 1e-7;
    CHECK_THROWS_AS(mesh_of_triangles(loose), InputError);
    const SurfaceMesh mesh = mesh_of_triangles(loose, 1e-6);
    CHECK(mesh.vertices().size() == 8);
    CHECK(mesh.moments().volume == doctest::Approx(sides.prod()).epsilon(1e-6));
    CHECK_THROWS_AS(mesh_of_triangles(loose, -1), InputError);
    CHECK_THROWS_AS(mesh_of_triangles({}), InputError);
}

TEST_CASE("distance and side, against those of a box") {
    const SurfaceMesh mesh = BoxParts(sides).mesh();
    const MeshDistance distance(mesh);
    std::mt19937 random(7);
    std::uniform_real_distribution<Real> uniform(-0.5, 1.5);
    int inside = 0;
    for (int n = 0; n < 2000; ++n) {
        const Vec3 x = sides.cwiseProduct(Vec3(uniform(random), uniform(random), uniform(random)));
        const Vec3 beyond = (x - sides).cwiseMax(-x);  // > 0: outside of that pair of faces
        const Real depth = beyond.maxCoeff() <= 0 ? -beyond.maxCoeff() : -beyond.cwiseMax(0).norm();
        inside += depth > 0;
        CHECK(distance.depth(x) == doctest::Approx(depth).epsilon(1e-12));
        CHECK(std::abs(distance.winding_number(x) - (depth > 0 ? 1 : 0)) < 1e-12);
    }
    CHECK(inside > 100);
}
