// Shares of a grid's faces that bodies cover: their volume, their centroid, what flows in and out.
#include <abrade/coupling/mapping/solid_shares.hpp>
#include <abrade/geometry/stone_shapes.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

struct Held {
    Vec3 volume = Vec3::Zero();  ///< along each axis [m3]
    Vec3 moment = Vec3::Zero();  ///< of what pushes along an axis, about the other two [m4]
    Real out = 0, turned = 0;    ///< of what cells give, in all
    Real low = 1, high = 0;      ///< shares
    Real least_friction = 1e9;   ///< [1/m2]
};
Held held(const SolidCover& cover) {
    Held sum;
    for (const SolidFace& f : cover.faces) {
        sum.volume[f.axis] += f.share * f.volume();
        sum.moment += f.share * f.volume() * f.arm.cross(Vec3::Unit(f.axis));
        sum.low = std::min(sum.low, f.share), sum.high = std::max(sum.high, f.share);
        sum.least_friction = std::min(sum.least_friction, f.friction);
    }
    Vec3 way = Vec3::Zero(), turn = Vec3::Zero();
    for (const SolidCell& c : cover.cells) way += c.area, turn += c.area_moment;
    sum.out = way.norm(), sum.turned = turn.norm();
    return sum;
}
const auto nothing_closed = [](int, Offset) { return false; };

FlowBody body_of(const std::vector<Sphere>& spheres, const Vec3& centre, Real volume) {
    FlowBody body;
    body.position = centre, body.volume = volume, body.spheres = spheres;
    return body;
}

}  // namespace

TEST_CASE(
    "a sphere anywhere, of half a cell to ten: its volume and centroid to round-off, each axis by itself") {
    const Grid<3> grid({.cells = {24, 20, 22}, .low = Vec3(-1, -1, -1), .spacing = Vec3(0.1, 0.12, 0.09)});
    const auto boundaries = BoundaryConditions<3>::all(Boundary::free_slip);
    std::mt19937 random(3);
    std::uniform_real_distribution<Real> anywhere(-0.05, 0.05);
    for (const Real cells : {0.5, 0.9, 1.3, 2.0, 2.5, 4.0, 6.0, 10.0})
        for (int k = 0; k < 20; ++k) {
            const Vec3 centre =
                Vec3(0.2, 0.2, 0) + Vec3(anywhere(random), anywhere(random), anywhere(random));
            const std::vector<Sphere> spheres{{centre, 0.05 * cells}};
            const Real volume = 4.0 / 3 * pi * cube(spheres[0].radius);
            const Held sum =
                held(cover_of(grid, boundaries, body_of(spheres, centre, volume), nothing_closed));
            CAPTURE(cells);
            CHECK((sum.volume - Vec3::Constant(volume)).norm() < 1e-11 * volume);
            CHECK(sum.moment.norm() < 1e-11 * volume * spheres[0].radius);
            CHECK(sum.low >= 0);
            CHECK(sum.least_friction > 0);
            CHECK(sum.high <= 1);
            CHECK(sum.out < 1e-12 * square(spheres[0].radius));
            CHECK(sum.turned < 1e-12 * cube(spheres[0].radius));
        }
}

TEST_CASE("a clump, across a periodic side and on a stretched grid") {
    Grid<3>::Params params{.cells = {16, 16, 16}, .spacing = Vec3::Constant(0.1)};
    for (int k = 0; k <= 16; ++k) params.levels.push_back(0.1 * k + 0.002 * k * k);
    const Grid<3> grid(params);
    auto boundaries = BoundaryConditions<3>::all(Boundary::wall);
    boundaries[0] = {Boundary::periodic, Boundary::periodic};
    const Clump clump = make_stone(StoneShape::angular, 0.5);
    for (const Real x : {0.8, 0.03, 1.58}) {
        const Vec3 centre(x, 0.77, 1.0);
        std::vector<Sphere> spheres;
        for (const Sphere& member : clump.members) spheres.push_back({centre + member.centre, member.radius});
        const SolidCover cover =
            cover_of(grid, boundaries, body_of(spheres, centre, clump.volume), nothing_closed);
        const Held sum = held(cover);
        CHECK((sum.volume - Vec3::Constant(clump.volume)).norm() < 1e-10 * clump.volume);
        CHECK(sum.moment.norm() < 1e-10 * clump.volume * 0.25);
        for (const SolidFace& f : cover.faces) {
            const CellNumber<3> n = grid.layout().number(f.face);
            REQUIRE(grid.has(n));
            REQUIRE(f.plane == n[0]);
        }
    }
}

TEST_CASE("on a floor, by a side and in a corner: what they take of the shares, the rest has") {
    const Grid<3> grid({.cells = {16, 16, 16}, .spacing = Vec3::Constant(0.1)});
    const auto boundaries = BoundaryConditions<3>::all(Boundary::wall);
    for (const Real cells : {2.0, 2.5, 4.0, 7.0}) {
        const Real radius = 0.05 * cells;
        for (const Vec3& centre :
             {Vec3(0.81, 0.77, radius), Vec3(0.81, radius, radius), Vec3(radius, radius, radius)}) {
            const std::vector<Sphere> spheres{{centre, radius}};
            const Real volume = 4.0 / 3 * pi * cube(radius);
            const Held sum =
                held(cover_of(grid, boundaries, body_of(spheres, centre, volume), nothing_closed));
            CAPTURE(cells);
            CAPTURE(centre.transpose());
            CHECK((sum.volume - Vec3::Constant(volume)).norm() < 1e-10 * volume);
            CHECK(sum.moment.norm() < 1e-10 * volume * radius);
        }
    }
}

TEST_CASE("shares are those of the sphere: near the truth by counting points, 1 % of a cell at 4 cells") {
    const Real h = 0.1, radius = 2 * h;
    const Grid<3> grid({.cells = {16, 16, 16}, .spacing = Vec3::Constant(h)});
    const Vec3 centre(0.81, 0.775, 0.79);
    const std::vector<Sphere> spheres{{centre, radius}};
    const Real volume = 4.0 / 3 * pi * cube(radius);
    const SolidCover cover = cover_of(grid, BoundaryConditions<3>::all(Boundary::wall),
                                      body_of(spheres, centre, volume), nothing_closed);
    Real squares = 0, worst = 0, count = 0;
    for (const SolidFace& f : cover.faces) {
        if (f.share == 0) continue;
        constexpr int points = 24;
        int in = 0;
        for (int i = 0; i < points; ++i)
            for (int j = 0; j < points; ++j)
                for (int k = 0; k < points; ++k)
                    in += (f.arm + h * (Vec3(i + 0.5, j + 0.5, k + 0.5) / points - Vec3::Constant(0.5)))
                              .squaredNorm() < square(radius);
        const Real error = f.share - static_cast<Real>(in) / cube(points);
        squares += square(error), worst = std::max(worst, std::abs(error)), ++count;
    }
    const Real mean = std::sqrt(squares / count);
    MESSAGE("root mean square " << mean << ", worst " << worst);
    CHECK(mean < 0.01);
    CHECK(worst < 0.04);
}

TEST_CASE(
    "friction acts at all faces less than a cell from the surface, by the distance in cells across it") {
    const Vec3 size(0.1, 0.12, 0.09), centre(0.83, 0.97, 0.71);
    const Grid<3> grid({.cells = {16, 16, 16}, .spacing = size});
    const std::vector<Sphere> spheres{{centre, 0.24}};
    const SolidCover cover = cover_of(grid, BoundaryConditions<3>::all(Boundary::wall),
                                      body_of(spheres, centre, 4.0 / 3 * pi * cube(0.24)), nothing_closed);
    const auto across = [&](const Vec3& arm) { return arm.cwiseProduct(size).norm() / arm.norm(); };
    for (const SolidFace& f : cover.faces) {
        const Real h = across(f.arm), d = (f.arm.norm() - 0.24) / h;
        if (d > -0.99) CHECK(f.friction * square(h) == doctest::Approx((1 - d) / (1 + d)));
    }
    for (int a = 0; a < 3; ++a) {
        Index near = 0;
        for (const SolidFace& f : cover.faces) near += f.axis == a;
        for (int i = 0; i < 16; ++i)
            for (int j = 0; j < 16; ++j)
                for (int k = 0; k < 16; ++k) {
                    Vec3 x(i + 0.5, j + 0.5, k + 0.5);
                    x[a] -= 0.5;
                    const Vec3 arm = x.cwiseProduct(size) - centre;
                    near -= arm.norm() - 0.24 < across(arm);
                }
        CHECK(near == 0);
    }
}
