// Force and moment of water on walls: of water at rest by Archimedes and Stevin, of films by their weight.
#include <abrade/fluid/embedded_boundary/solid_shapes.hpp>
#include <abrade/fluid/momentum/turbulence.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/queries/flow_queries.hpp>
#include <abrade/fluid/queries/wall_loads.hpp>

#include <doctest/doctest.h>

#include <cmath>

#include "../message_of.hpp"

using namespace abrade;

namespace {

constexpr Real g = 9.81, rho = 1000;
/// What the first pressure is known to, as a share of a force: single precision solves, double corrects.
constexpr Real solved = 1e-7;

template <int Dim>
GridFluidParams<Dim> tank(int cells, Real level) {
    GridFluidParams<Dim> params;
    params.grid.cells.fill(cells);
    params.grid.spacing = Point<Dim>::Constant(1.0 / cells);
    params.boundaries = BoundaryConditions<Dim>::all(Boundary::free_slip);
    params.water = [level](const Point<Dim>& x) { return level - x[Dim - 1]; };
    params.gravity[Dim - 1] = -g;
    return params;
}

/// A cube of 12 triangles between two corners.
SurfaceMesh cube(const Vec3& low, const Vec3& high) {
    std::vector<Vec3> corners;
    for (int k = 0; k < 8; ++k)
        corners.push_back({k & 1 ? high[0] : low[0], k & 2 ? high[1] : low[1], k & 4 ? high[2] : low[2]});
    return {corners,
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

/// Of a solid under water: the buoyancy off the weight of the volume that the grid has of it, and the largest
/// other force, over it; that volume off the exact one; the moment about a point over force and cell.
struct Buoyancy {
    Real lift = 0, sideways = 0, volume = 0, moment = 0;
    void take(const Buoyancy& other) {
        lift = std::max(lift, other.lift), sideways = std::max(sideways, other.sideways);
        volume = std::max(volume, other.volume), moment = std::max(moment, other.moment);
    }
};
template <int Dim>
Buoyancy buoyancy(GridFluidParams<Dim> params, PlaceFunction<Dim> solid, const Point<Dim>& centre,
                  Real exact) {
    params.wall = std::move(solid);
    const GridFluid<Dim> flow(params);
    const Load<Dim> load = wall_load(flow, centre).pressure;
    const Real volume = 1 - flow.walls()->total_volume(), weight = rho * g * volume;
    Buoyancy b{std::abs(load.force[Dim - 1] / weight - 1), 0, std::abs(volume / exact - 1),
               load.moment.norm() / weight / params.grid.spacing[0]};
    for (int a = 0; a < Dim - 1; ++a) b.sideways = std::max(b.sideways, std::abs(load.force[a]) / weight);
    return b;
}

}  // namespace

TEST_CASE("a disc under water, at every tenth of a cell: it weighs less by the water it displaces") {
    Buoyancy worst;
    for (int i = 0; i < 10; ++i)
        for (int k = 0; k < 10; ++k) {
            const Point<2> centre(0.5 + 0.1 * i / 24, 0.4 + 0.1 * k / 24);
            worst.take(buoyancy<2>(tank<2>(24, 0.9), BallWall<2>(centre, 0.21), centre, pi * 0.21 * 0.21));
        }
    MESSAGE("lift " << worst.lift << ", sideways " << worst.sideways << ", volume " << worst.volume
                    << ", moment " << worst.moment << " of a cell");
    CHECK(worst.lift < solved);
    CHECK(worst.sideways < solved);
    CHECK(worst.volume < 0.01);  // 10 cells across: chords for arcs
    CHECK(worst.moment < 0.02);  // of a cell: forces stand in the middles of chords
}

TEST_CASE("a ball, an upright and an oblique cylinder, a box: the same") {
    Buoyancy worst;
    for (int i = 0; i < 10; ++i) {
        const Point<3> centre =
            Vec3(0.5, 0.5, 0.45) + Vec3(0.1 * i, 0.1 * (3 * i % 10), 0.1 * (7 * i % 10)) / 16;
        worst.take(buoyancy<3>(tank<3>(16, 0.96), BallWall<3>(centre, 0.21), centre,
                               4 * pi / 3 * std::pow(0.21, 3)));
    }
    MESSAGE("ball: lift " << worst.lift << ", sideways " << worst.sideways << ", volume " << worst.volume
                          << ", moment " << worst.moment << " of a cell");
    CHECK(worst.lift < solved);
    CHECK(worst.sideways < solved);
    CHECK(worst.volume < 0.02);  // 7 cells across
    CHECK(worst.moment < 0.02);
    for (const Vec3& half : {Vec3(0, 0, 0.2), Vec3(0.1, 0.07, 0.17)}) {
        const Vec3 centre(0.51, 0.49, 0.47);
        const Buoyancy b = buoyancy<3>(tank<3>(16, 0.96), CylinderWall(centre - half, centre + half, 0.2),
                                       centre, pi * square(0.2) * 2 * half.norm());
        MESSAGE("cylinder: lift " << b.lift << ", sideways " << b.sideways << ", volume " << b.volume
                                  << ", moment " << b.moment << " of a cell");
        CHECK(b.lift < solved);
        CHECK(b.sideways < solved);
        CHECK(b.volume < 0.03);
        CHECK(b.moment < 0.03);
    }
    const Buoyancy box = buoyancy<3>(tank<3>(16, 0.96), BoxWall<3>({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75}),
                                     {0.5, 0.5, 0.5}, 0.125);
    CHECK(box.volume < 1e-12);  // on grid planes
    CHECK(box.lift < solved);
    CHECK(box.moment < solved);
}

TEST_CASE("walls and sides carry the weight of the water, of whatever shape, with its surface anywhere") {
    for (const Real level : {0.5, 0.83}) {
        auto params = tank<3>(12, level);
        params.wall =
            WallUnion(CylinderWall({0.3, 0.6, 0}, {0.5, 0.4, 0.4}, 0.13),
                      PlaneWall<3>({0.9, 0.5, 0}, {-1, 0.2, 0.7}), BallWall<3>({0.2, 0.2, 0.2}, 0.11));
        const GridFluid<3> flow(params);
        Load<3> sum = wall_load(flow, {0, 0, 0}).pressure;
        for (int a = 0; a < 3; ++a)
            for (const bool high : {false, true})
                sum += side_load(flow, {.axis = a, .high = high}, {0, 0, 0}).pressure;
        const Real weight = rho * g * flow.liquid().volume();
        MESSAGE("level " << level << ": " << sum.force.transpose() / weight);
        // Where the surface cuts a wall, the wall is a plane in each cell.
        CHECK((sum.force / weight - Vec3(0, 0, -1)).norm() < (level == 0.5 ? 1e-6 : 1e-3));
    }
}

TEST_CASE("a vertical dam: rho g h^2 / 2 and its moment, wherever its face and the surface lie") {
    for (const Real level : {0.6, 0.613, 0.631, 0.649})
        for (const Real face : {0.7, 0.713, 0.738}) {
            CAPTURE(level);
            CAPTURE(face);
            auto params = tank<2>(20, level);
            params.wall = PlaneWall<2>({face, 0}, {-1, 0});
            const GridFluid<2> flow(params);
            const Real thrust = 0.5 * rho * g * level * level;
            const auto check = [&](const WallLoad<2>& load, Real sign) {
                CHECK(load.wetted == doctest::Approx(level).epsilon(solved));
                CHECK(load.pressure.force[0] == doctest::Approx(sign * thrust).epsilon(solved));
                CHECK(std::abs(load.pressure.force[1]) < solved * thrust);
                CHECK(load.pressure.moment[1] == doctest::Approx(sign * thrust * level / 3).epsilon(solved));
                CHECK(load.shear.force.norm() < 1e-6);  // at rest but for the first pressure's digits
            };
            check(wall_load(flow, {face, 0}), 1);
            check(side_load(flow, {.axis = 0, .high = false}, {0, 0}), -1);
        }
}

TEST_CASE("a dam in space: the moment about its toe, and a gate in it") {
    auto params = tank<3>(16, 0.83);
    params.wall = PlaneWall<3>({0.71, 0, 0}, {-1, 0, 0});
    const GridFluid<3> flow(params);
    const auto all = wall_load(flow, {0.71, 0.5, 0});
    const Real thrust = 0.5 * rho * g * square(0.83);
    CHECK(all.pressure.force[0] == doctest::Approx(thrust).epsilon(solved));
    CHECK(all.pressure.moment[1] == doctest::Approx(thrust * 0.83 / 3).epsilon(solved));
    CHECK(std::abs(all.pressure.moment[2]) < solved * thrust);
    // A gate between grid planes: depth of its middle times its area; the moment about its hinge at the top.
    const WithinBox<3> gate{{0.7, 0.25, 0.125}, {0.72, 0.75, 0.5}};
    const auto part = wall_load(flow, {0.71, 0.5, 0.5}, gate);
    const Real force = rho * g * (0.83 - 0.3125) * 0.5 * 0.375;
    CHECK(part.area == doctest::Approx(0.5 * 0.375));
    CHECK(part.pressure.force[0] == doctest::Approx(force).epsilon(solved));
    const Real hinge = -0.5 * rho * g * (0.33 * square(0.375) / 2 + std::pow(0.375, 3) / 3);
    CHECK(part.pressure.moment[1] == doctest::Approx(hinge).epsilon(solved));
    const auto rest = wall_load(flow, {0.71, 0.5, 0.5}, [&](const Point<3>& x) { return !gate(x); });
    CHECK(part.pressure.force[0] + rest.pressure.force[0] == doctest::Approx(thrust).epsilon(solved));
}

TEST_CASE("a sloping dam: thrust and weight upon it, its moment") {
    for (const Real level : {0.6, 0.613, 0.631, 0.649})
        for (const Real cotangent : {0.3, 0.8, 1.7}) {
            auto params = tank<2>(20, level);
            params.grid.cells[0] = 40;
            params.wall = PlaneWall<2>({0.413, 0}, {-1, cotangent});
            const GridFluid<2> flow(params);
            const auto load = wall_load(flow, {0.413, 0});
            const Real thrust = 0.5 * rho * g * level * level;
            CAPTURE(level);
            CAPTURE(cotangent);
            // The water line's cell: its liquid lies below a reconstructed surface, the load below p = 0.
            constexpr Real line = 1e-4;
            CHECK(load.pressure.force[0] == doctest::Approx(thrust).epsilon(line));
            CHECK(load.pressure.force[1] == doctest::Approx(-thrust * cotangent).epsilon(line));
            CHECK(load.pressure.moment[1] ==
                  doctest::Approx(thrust * level / 3 * (1 + square(cotangent))).epsilon(line));
        }
}

TEST_CASE("a mesh, as from an STL file, and a box of the same corners: the same load") {
    auto params = tank<3>(16, 0.73);
    const Vec3 low(0.31, 0.27, 0.22), high(0.64, 0.71, 0.58);
    params.wall = BoxWall<3>(low, high);
    const auto box = wall_load(GridFluid<3>(params), {0, 0, 0});
    params.wall = MeshWall(cube(low, high));
    const auto mesh = wall_load(GridFluid<3>(params), {0, 0, 0});
    CHECK(mesh.area == doctest::Approx(box.area).epsilon(1e-12));
    CHECK((mesh.pressure.force - box.pressure.force).norm() < solved * box.pressure.force.norm());
    CHECK((mesh.pressure.moment - box.pressure.moment).norm() < solved * box.pressure.moment.norm());
    MESSAGE("box off grid planes: lift " << box.pressure.force[2] / (rho * g * (high - low).prod()) - 1
                                         << " off that of its volume");
    CHECK(std::abs(box.pressure.force[2] / (rho * g * (high - low).prod()) - 1) < 0.02);  // its edges are cut
}

TEST_CASE("a box with a hole, a tank inside out: what is cut out holds water") {
    auto params = tank<3>(16, 2);
    const BoxWall<3> block({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75});
    params.wall = WallIntersection(block, InsideOut(CylinderWall({0.5, 0.5, 0}, {0.5, 0.5, 1}, 0.17)));
    CHECK(1 - GridFluid<3>(params).walls()->total_volume() ==
          doctest::Approx(0.125 - 0.5 * pi * square(0.17)).epsilon(0.01));
    params.wall = InsideOut(BallWall<3>({0.5, 0.5, 0.5}, 0.4));
    const GridFluid<3> flow(params);
    CHECK(flow.liquid().volume() == doctest::Approx(4 * pi / 3 * std::pow(0.4, 3)).epsilon(0.01));
    const auto load = wall_load(flow, {0.5, 0.5, 0.5});
    CHECK(load.pressure.force[2] == doctest::Approx(-rho * g * flow.liquid().volume()).epsilon(solved));
}

TEST_CASE("films and plates: shear carries what drives the water") {
    // Along x everything repeats itself; g_x drives, density and viscosity are 1.
    const auto steady = [](auto&& flow) {
        flow.advance(4);  // what is left of the start of a film: exp(-4 pi^2 / 4) = 5e-5
        return flow;
    };
    GridFluidParams<2> params{.grid = {.cells = {4, 20}, .spacing = {0.1, 0.1}},
                              .gravity = {0.5, -10},
                              .density = 1,
                              .viscosity = 1,
                              .tolerance = 1e-10};
    params.boundaries[0] = {Boundary::periodic, Boundary::periodic};
    params.water = [](const Point<2>& x) { return 1.03 - x[1]; };
    SUBCASE("on the floor") {
        const auto flow = steady(GridFluid<2>(params));
        const auto load = side_load(flow, {.axis = 1, .high = false}, {0, 0});
        MESSAGE("shear over weight - 1: " << load.shear.force[0] / (0.5 * 1.03 * 0.4) - 1);
        CHECK(load.shear.force[0] == doctest::Approx(0.5 * 1.03 * 0.4).epsilon(1e-3));
        CHECK(load.pressure.force[1] == doctest::Approx(-10 * 1.03 * 0.4).epsilon(1e-3));
    }
    SUBCASE("on a bed inside, wherever it lies in its cell") {
        for (const Real bed : {0.113, 0.137, 0.15, 0.163, 0.187, 0.194}) {
            params.wall = PlaneWall<2>({0, bed}, {0, 1});
            params.water = [bed](const Point<2>& x) { return bed + 1.03 - x[1]; };
            const auto flow = steady(GridFluid<2>(params));
            const auto load = wall_load(flow, {0, bed});
            MESSAGE("bed " << bed
                           << ": shear over weight - 1: " << load.shear.force[0] / (0.5 * 1.03 * 0.4) - 1);
            CHECK(load.shear.force[0] == doctest::Approx(0.5 * 1.03 * 0.4).epsilon(2e-3));
            CHECK(std::abs(load.shear.moment[1]) < 1e-6);  // the bed goes through the point
        }
    }
    SUBCASE("on a rough bed, before it is steady: what drives the water less what speeds it up") {
        for (const Real bed : {0.113, 0.15, 0.187}) {
            params.wall = PlaneWall<2>({0, bed}, {0, 1});
            params.water = [bed](const Point<2>& x) { return bed + 1.03 - x[1]; };
            params.wall_law = {WallLaw::Kind::logarithmic, 0.05};
            params.velocity = [](const Point<2>&) { return Point<2>(4, 0); };
            GridFluid<2> flow(params);
            flow.advance(1);
            const auto momentum = [&] { return section(flow, 0, 0.2).mass * 0.4; };
            const Real before = momentum(), first = wall_load(flow, {0, bed}).shear.force[0];
            flow.advance(1.1);
            const Real mean = 0.5 * (first + wall_load(flow, {0, bed}).shear.force[0]);
            const Real taken = 0.5 * 1.03 * 0.4 - (momentum() - before) / 0.1;
            MESSAGE("rough bed " << bed << ": shear " << mean << ", " << mean / taken - 1
                                 << " off the balance");
            CHECK(mean == doctest::Approx(taken).epsilon(0.02));
        }
    }
    SUBCASE("on a rough bed below turbulent water: the same balance") {
        for (const Real bed : {0.113, 0.15, 0.187}) {
            params.wall = PlaneWall<2>({0, bed}, {0, 1});
            params.water = [bed](const Point<2>& x) { return bed + 1.03 - x[1]; };
            params.wall_law = {WallLaw::Kind::logarithmic, 0.05};
            params.velocity = [](const Point<2>&) { return Point<2>(4, 0); };
            params.viscosity = 1e-5;
            GridFluid<2, Turbulent<MixingLength>> flow(params, MixingLength{{.depth = 1.03}});
            flow.advance(3);
            const auto momentum = [&] { return section(flow, 0, 0.2).mass * 0.4; };
            const Real before = momentum(), first = wall_load(flow, {0, bed}).shear.force[0];
            flow.advance(3.1);
            const Real mean = 0.5 * (first + wall_load(flow, {0, bed}).shear.force[0]);
            const Real taken = 0.5 * 1.03 * 0.4 - (momentum() - before) / 0.1;
            MESSAGE("turbulent, bed " << bed << ": shear " << mean << ", " << mean / taken - 1
                                      << " off the balance");
            CHECK(mean == doctest::Approx(taken).epsilon(0.05));
        }
    }
    SUBCASE("between plates, one of which moves") {
        params.water = {};
        params.gravity = {0.5, 0};
        params.boundaries[1] = {Boundary::wall, Boundary::wall};
        params.boundary_velocity = [](const Point<2>& x, Real) { return Point<2>(x[1] > 1 ? 3 : 0, 0); };
        GridFluid<2, FullBox> flow(params);
        flow.advance(8);
        const Real low = side_load(flow, {.axis = 1, .high = false}, {0, 0}).shear.force[0];
        const Real high = side_load(flow, {.axis = 1, .high = true}, {0, 0}).shear.force[0];
        CHECK(low == doctest::Approx(0.4 * (0.5 + 1.5)).epsilon(1e-3));  // g H / 2 + U / H
        CHECK(high == doctest::Approx(0.4 * (0.5 - 1.5)).epsilon(1e-3));
    }
}

TEST_CASE(
    "a dam breaks, also about a pillar: what walls and sides push is what the water gains in momentum") {
    for (const bool pillar : {false, true}) {
        GridFluidParams<2> params{.grid = {.cells = {48, 24}, .spacing = {1.0 / 24, 1.0 / 24}},
                                  .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                                  .gravity = {0, -g}};
        if (pillar) params.wall = BallWall<2>({1.31, 0.2}, 0.13);
        params.water = [](const Point<2>& x) { return std::min(0.5 - x[0], 0.6 - x[1]); };
        GridFluid<2> flow(params);
        const Grid<2>& grid = flow.grid();
        const auto held = [&](Offset c) {
            return flow.liquid().fraction()[c] * (flow.walls() ? flow.walls()->open_fraction()[c] : 1);
        };
        const auto momentum = [&] {
            Point<2> sum = Point<2>::Zero();
            grid.for_each([&](const CellNumber<2>& cell, Offset c) {
                for (int a = 0; a < 2; ++a)
                    if (cell[a] > 0)
                        sum[a] += rho * grid.volume(cell) * flow.velocity()[a][c] * 0.5 *
                                  (held(c) + held(c - grid.layout().stride[a]));
            });
            return sum;
        };
        Point<2> impulse = Point<2>::Zero();
        Real most = 0;  // momentum along
        for (const Real end : {0.5, 0.75, 1.0}) {
            while (flow.time() < end) {
                const Real dt = flow.stable_step().seconds;
                flow.step(dt);
                Load<2> load;
                if (pillar) load += wall_load(flow, {0, 0}).total();
                for (int a = 0; a < 2; ++a)
                    for (const bool high : {false, true})
                        load += side_load(flow, {.axis = a, .high = high}, {0, 0}).total();
                impulse += dt * load.force;
            }
            const Real weight = rho * g * flow.liquid().volume() * flow.time();
            const Point<2> gained = momentum();
            most = std::max(most, gained[0]);
            const Real along = (-impulse[0] - gained[0]) / most,
                       down = -impulse[1] / (weight + gained[1]) - 1;
            MESSAGE(std::string(pillar ? "with" : "without")
                    << " a pillar, " << end << " s: impulse along " << along
                    << " of the largest momentum, down " << down << " off");
            // Velocities stand half a step ahead; what the solver bounds in splashes and at narrow faces is
            // in no load.
            const bool splashes = end > 0.5;
            CHECK(std::abs(along) < (splashes ? 0.2 : 0.04));
            CHECK(std::abs(down) < 0.02);
        }
    }
}

TEST_CASE("a round pipe, full and not quite: shear carries what drives the water") {
    for (const bool full : {true, false}) {
        GridFluidParams<3> params{.grid = {.cells = {3, 12, 12}, .spacing = Vec3::Constant(1.0 / 12)},
                                  .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                                  .gravity = {0.5, 0, full ? 0.0 : -10.0},
                                  .density = 1,
                                  .viscosity = 1,
                                  .tolerance = 1e-9};
        params.boundaries[0] = {Boundary::periodic, Boundary::periodic};
        params.wall = InsideOut(CylinderWall({-9, 0.513, 0.5}, {9, 0.513, 0.5}, 0.4));
        params.water = [full](const Point<3>& x) { return full ? 1 : 0.61 - x[2]; };
        GridFluid<3> flow(params);
        flow.advance(0.6);  // what is left of the start of a full pipe: exp(-5.8 0.6 / 0.4^2) = 4e-10
        const auto load = wall_load(flow, {0, 0.513, 0.5});
        const Real off = load.shear.force[0] / (0.5 * flow.liquid().volume()) - 1;
        MESSAGE(std::string(full ? "full" : "not full") << ": shear over weight - 1: " << off);
        // Cells at the banks are partly wet, and the friction of what is wet of them is a mean.
        CHECK(std::abs(off) < (full ? 1e-6 : 0.1));
    }
}

TEST_CASE("bad questions are refused") {
    const GridFluid<2> flow(tank<2>(8, 0.5));
    CHECK(message_of([&] {
              wall_load(flow, {0, 0});
          }) == "wall_load: GridFluid.wall must be given, got none; the sides of the box have side_load");
    CHECK(message_of([&] {
              side_load(flow, {.axis = 2}, {0, 0});
          }) ==
          "side_load: side.axis must be 0 (x) or 1 (z), got 2; it is the axis that the side stands across");
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    CHECK(message_of([&] {
              side_load(flow, {.axis = 0}, {0, nan});
          }).starts_with("side_load: about.z must be finite"));
    auto params = tank<2>(8, 0.5);
    params.boundaries[0] = {Boundary::periodic, Boundary::periodic};
    CHECK(message_of([&] {
              side_load(GridFluid<2>(params), {.axis = 0}, {0, 0});
          }) ==
          "side_load: side must be closed (wall or slip), got periodic; section says what goes through an "
          "open one");
}
