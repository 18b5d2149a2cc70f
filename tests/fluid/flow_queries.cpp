// What a user asks a flow: pressures, sections and levels are those of closed forms.
#include <abrade/fluid/embedded_boundary/solid_shapes.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/queries/flow_queries.hpp>
#include <abrade/fluid/setup/inflow.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "../message_of.hpp"

using namespace abrade;

namespace {

constexpr Real g = 9.81, rho = 1000;

/// A tank of 1 m by 1 m by 1 m with a surface at `level`, slip sides.
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

/// Largest error of `pressure_at` at random points in the water and above it, over rho g (1 m).
template <int Dim>
Real worst_at_rest(const GridFluid<Dim>& flow, Real level) {
    std::mt19937 random(7);
    std::uniform_real_distribution<Real> anywhere(0, 1);
    Real worst = 0;
    for (int n = 0; n < 2000; ++n) {
        Point<Dim> x;
        for (int a = 0; a < Dim; ++a) x[a] = anywhere(random);
        if (flow.params().wall && flow.params().wall(x) < 0) continue;
        const Real exact = std::max(level - x[Dim - 1], Real(0));
        worst = std::max(worst, std::abs(pressure_at(flow, x) / (rho * g) - exact));
    }
    return worst;
}

}  // namespace

TEST_CASE("water at rest: the pressure is that of the depth, up to the surface and to the walls") {
    // The first pressure is solved to 1e-12 of what a second of falling would make of the cells' volumes; of
    // that walls and single precision leave 2.5e-9 of the depth.
    constexpr Real solved = 1e-8;
    for (const Real level : {0.5, 0.613, 0.641, 0.655, 0.675}) {  // from a grid plane through one cell
        CAPTURE(level);
        CHECK(worst_at_rest(GridFluid<2>(tank<2>(16, level)), level) < solved);
        auto params = tank<2>(16, level);
        params.wall = WallUnion(PlaneWall<2>({0.2, 0}, {1, 0.37}), BallWall<2>({0.71, 0.3}, 0.2));
        CHECK(worst_at_rest(GridFluid<2>(params), level) < solved);
    }
    auto params = tank<3>(16, 0.731);
    params.wall = WallUnion(BoxWall<3>({0.1, 0.2, -1}, {0.33, 0.47, 0.51}),
                            CylinderWall({0.7, 0.7, -1}, {0.6, 0.7, 2}, 0.17));
    params.grid.levels.push_back(0);
    for (int k = 1; k <= 16; ++k) params.grid.levels.push_back(params.grid.levels.back() + 0.003 * (13 + k));
    CHECK(worst_at_rest(GridFluid<3>(params), 0.731) < solved);
}

TEST_CASE("water at rest: the pressure on walls is that of the depth") {
    auto params = tank<2>(20, 0.613);
    const PlaneWall<2> plane({0.2, 0}, {1, 0.37});
    params.wall = plane;
    const GridFluid<2> flow(params);
    for (Real z = 0.003; z < 0.999; z += 0.0071) {
        const Real exact = rho * g * std::max(0.613 - z, 0.0);
        const Real x = 0.2 - 0.37 * z;
        if (x > 0) CHECK(std::abs(pressure_on_wall(flow, {x, z}) - exact) < 1e-6 * rho * g);
        CHECK(std::abs(pressure_on_wall(flow, {1, z}) - exact) < 1e-6 * rho * g);
    }
    auto in_space = tank<3>(16, 0.9);
    in_space.wall =
        BoxWall<3>({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75});  // on grid planes: its cells are closed
    const GridFluid<3> about_box(in_space);
    for (const Real z : {0.25, 0.3, 0.61, 0.75}) {
        const Real exact = rho * g * (0.9 - z);
        CHECK(std::abs(pressure_on_wall(about_box, {0.25, 0.4, z}) - exact) < 1e-6 * rho * g);
        CHECK(std::abs(pressure_on_wall(about_box, {0.5, 0.75, z}) - exact) < 1e-6 * rho * g);
    }
    CHECK(std::abs(pressure_on_wall(about_box, {0.5, 0.5, 0.25}) - rho * g * 0.65) < 1e-6 * rho * g);
}

TEST_CASE("a wall that divides the tank: each side of it has its own level") {
    auto params = tank<2>(20, 0);
    params.wall = BoxWall<2>({0.48, -1}, {0.53, 2});  // a cell wide, off the grid planes
    params.water = [](const Point<2>& x) { return (x[0] < 0.5 ? 0.81 : 0.32) - x[1]; };
    const GridFluid<2> flow(params);
    for (const Real z : {0.03, 0.22, 0.31, 0.5, 0.79}) {
        CHECK(std::abs(pressure_on_wall(flow, {0.48, z}) - rho * g * (0.81 - z)) < 1e-6 * rho * g);
        CHECK(std::abs(pressure_on_wall(flow, {0.53, z}) - rho * g * std::max(0.32 - z, 0.0)) <
              1e-6 * rho * g);
        CHECK(std::abs(pressure_at(flow, {0.46, z}) - rho * g * (0.81 - z)) < 1e-6 * rho * g);
    }
}

TEST_CASE("vortices between slip sides: pressures in the water and on the sides are of second order") {
    // Taylor and Green: u = sin x cos z, w = -cos x sin z, p = rho (cos 2x + cos 2z) / 4, in a box of pi.
    const auto errors = [](int cells) {
        const Real size = std::numbers::pi / cells;
        const GridFluid<2, FullBox> still({.grid = {.cells = {cells, cells}, .spacing = {size, size}},
                                           .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                                           .velocity =
                                               [](const Point<2>& x) {
                                                   return Point<2>(std::sin(x[0]) * std::cos(x[1]),
                                                                   -std::cos(x[0]) * std::sin(x[1]));
                                               },
                                           .density = 1,
                                           .viscosity = 0,
                                           .tolerance = 1e-9});
        GridFluid<2, FullBox> flow = still;
        flow.advance(0.2);
        const auto exact = [](Real x, Real z) { return 0.25 * (std::cos(2 * x) + std::cos(2 * z)); };
        const Real base = pressure_at(flow, {1.571, 1.571}) - exact(1.571, 1.571);
        Real inside = 0, boundaries = 0;
        for (Real s = 0.05; s < 3.1; s += 0.0713) {
            for (Real z = 0.06; z < 3.1; z += 0.0519)
                inside = std::max(inside, std::abs(pressure_at(flow, {s, z}) - base - exact(s, z)));
            boundaries = std::max(boundaries, std::abs(pressure_on_wall(flow, {s, 0}) - base - exact(s, 0)));
            boundaries = std::max(
                boundaries, std::abs(pressure_on_wall(flow, {std::numbers::pi, s}) - base - exact(0, s)));
        }
        return std::pair(inside, boundaries);
    };
    const auto coarse = errors(16), fine = errors(32);
    MESSAGE("largest error over the range of the pressure: inside "
            << fine.first << ", order " << std::log2(coarse.first / fine.first) << "; on sides "
            << fine.second << ", order " << std::log2(coarse.second / fine.second));
    CHECK(std::log2(coarse.first / fine.first) > 1.7);
    CHECK(std::log2(coarse.second / fine.second) > 1.7);
    CHECK(std::max(fine.first, fine.second) < 0.01);
}

TEST_CASE("a full box and uniform flow: discharge, mass, kinetic energy, area, speed") {
    BoundaryConditions<3> boundaries = BoundaryConditions<3>::all(Boundary::free_slip);
    boundaries[0] = {Boundary::inflow, Boundary::outflow};
    GridFluid<3, FullBox> flow({.grid = {.cells = {8, 5, 4}, .spacing = {0.1, 0.2, 0.3}},
                                .boundaries = boundaries,
                                .boundary_velocity = [](const Point<3>&, Real) { return Point<3>(2, 0, 0); },
                                .velocity = [](const Point<3>&) { return Point<3>(2, 0, 0); }});
    flow.advance(0.1);
    for (const Real x : {0.0, 0.1, 0.44, 0.8}) {
        const FlowSection s = section(flow, 0, x);
        CHECK(s.area == doctest::Approx(1.2));
        CHECK(s.discharge == doctest::Approx(2.4));
        CHECK(s.mass == doctest::Approx(2400));
        CHECK(s.energy == doctest::Approx(2400 * 2.0));
        CHECK(s.mean_velocity() == doctest::Approx(2));
        CHECK(s.mean_depth() == doctest::Approx(1.2));
    }
    CHECK(std::abs(section(flow, 1, 0.37).discharge) < 1e-12);
    CHECK(section(flow, 2, 0.6).width == 0);
}

TEST_CASE("a fast uniform stream: what comes in goes through each section, and so does its energy") {
    // Down a slope without friction in the bed's own coordinates; gravity across it alone.
    BoundaryConditions<2> boundaries = BoundaryConditions<2>::all(Boundary::free_slip);
    boundaries[0] = {Boundary::inflow, Boundary::outflow};
    const auto below = [](const Point<2>& x) { return 0.213 - x[1]; };
    GridFluid<2> flow({.grid = {.cells = {40, 16}, .spacing = {0.025, 0.025}},
                       .boundaries = boundaries,
                       .boundary_velocity = [](const Point<2>&, Real) { return Point<2>(3, 0); },
                       .water = below,
                       .inflow_water = below,
                       .velocity = [](const Point<2>&) { return Point<2>(3, 0); },
                       .gravity = {0, -g}});
    flow.advance(0.5);
    Real worst = 0, energy = 0;
    for (Real x = 0; x <= 0.7; x += 0.0621) {  // the last ten cells feel that the outflow holds nothing back
        const FlowSection s = section(flow, 0, x);
        worst = std::max(worst, std::abs(s.discharge / (3 * 0.213) - 1));
        energy = std::max(energy, std::abs(s.energy_head(g) / (4.5 / g + 0.213) - 1));
        CHECK(s.mean_depth() == doctest::Approx(0.213).epsilon(1e-5));
        CHECK(gauge(flow, x) == doctest::Approx(0.213).epsilon(1e-5));
    }
    MESSAGE("discharge " << worst << ", energy head " << energy << " off");
    // The outflow still counts 0.3 m before it: 1.3e-5 and 4.1e-5 measured.
    CHECK(worst < 1e-4);
    CHECK(energy < 1e-4);
}

TEST_CASE("the invert channel: the section has the discharge that the inflow was asked for") {
    const Invert invert{};
    GridFluidParams<3> params;
    params.grid = {.cells = {10, 52, 16}, .low = {0, -0.52, -0.04}, .spacing = {0.05, 0.02, 0.02}};
    params.boundaries = BoundaryConditions<3>::all(Boundary::free_slip);
    params.boundaries[0][1] = Boundary::outflow;
    params.gravity = {0, 0, -g};
    params.wall = InvertWall(invert);
    params.wall_law.kind = WallLaw::Kind::slip;
    const Inflow<3> stream({.discharge = 0.5, .depth = 0.15, .section = invert});
    stream.give_to(params);
    params.water = [&](const Point<3>& x) { return stream.depth_at(x); };
    params.velocity = [&](const Point<3>&) { return Point<3>(stream.mean_velocity(), 0, 0); };
    GridFluid<3> flow(params);
    flow.advance(0.3);
    for (const Real x : {0.0, 0.13, 0.3, 0.47}) {
        const FlowSection s = section(flow, 0, x);
        CAPTURE(x);
        MESSAGE("Q " << s.discharge << ", A " << s.area << " of " << stream.area() << ", T " << s.width
                     << ", head " << s.energy_head());
        CHECK(s.discharge == doctest::Approx(0.5).epsilon(2e-3));
        CHECK(s.area == doctest::Approx(stream.area()).epsilon(5e-3));
        CHECK(s.energy_head() ==
              doctest::Approx(square(stream.mean_velocity()) / (2 * g) + 0.15).epsilon(5e-3));
    }
    CHECK(gauge(flow, 0.2, 0.013) == doctest::Approx(0.15).epsilon(2e-3));
}

TEST_CASE("bad questions are refused: field, value, unit, rule, remedy") {
    const GridFluid<2> flow(tank<2>(8, 0.5));
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    CHECK(message_of([&] {
              pressure_at(flow, {0.5, 1.5});
          }) ==
          "pressure_at: x.z must be inside the box (0 to 1 m), got 1.5 m; nothing is known outside; was "
          "another "
          "corner taken as origin?");
    CHECK(message_of([&] {
              pressure_at(flow, {nan, 0.5});
          }).starts_with("pressure_at: x.x must be finite, got nan m"));
    CHECK(message_of([&] {
              pressure_on_wall(flow, {0.5, 0.5});
          }) ==
          "pressure_on_wall: distance of x from a wall must be at most that of a cell (0.125 m), got 0.5 m; "
          "pressure_at answers in the water");
    CHECK(message_of([&] { section(flow, 2, 0.5); }) ==
          "section: axis must be 0 (x) or 1 (z), got 2; it is the axis that the plane stands across");
    CHECK(message_of([&] {
              section(flow, 0, -0.1);
          }).starts_with("section: at.x must be inside the box (0 to 1 m), got -0.1 m"));
    CHECK(message_of([&] { section(flow, 0, nan); }).starts_with("section: at.x must be finite"));
    CHECK(message_of([&] {
              gauge(flow, 7);
          }).starts_with("gauge.x must be inside the box (0 to 1 m), got 7 m"));
    CHECK(message_of([] {
              BoxWall<2>({0, 0}, {1, 0});
          }) ==
          "BoxWall.high.z must be finite and above low (0 m), got 0 m; give the lower corner, then the upper "
          "one");
    CHECK(message_of([] {
              BallWall<3>({0, 0, 0}, -1);
          }) == "BallWall.radius must be finite and > 0, got -1 m; check its sign");
    CHECK(message_of([] {
              CylinderWall({0, 0, 1}, {0, 0, 1}, 1);
          }).starts_with("CylinderWall: half of its length must be finite and > 0, got 0 m"));
}

static_assert(GridFlow<GridFluid<2>> && GridFlow<GridFluid<3, FullBox>> && !GridFlow<InvertWall>);
