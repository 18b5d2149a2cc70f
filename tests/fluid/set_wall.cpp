// Walls that change between steps: no water is lost, it goes on as it flowed, and what cannot be
// leaves it as it was.
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <abrade/fluid/momentum/turbulence.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "../message_of.hpp"

using namespace abrade;

namespace {

/// A tank of 1 m in cells of 1/32 m, above a bed.
GridFluidParams<2> tank(Real bed, Real level) {
    GridFluidParams<2> params{.grid = {.cells = {32, 32}, .spacing = {1.0 / 32, 1.0 / 32}},
                              .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                              .gravity = {0, -9.81}};
    params.wall = [bed](const Point<2>& x) { return x[1] - bed; };
    params.water = [level](const Point<2>& x) { return level - x[1]; };
    return params;
}

/// Root mean square of the water's speed [m/s].
Real mean_speed(const GridFluid<2>& flow) {
    return std::sqrt(2 * flow.kinetic_energy() / (flow.params().density * flow.liquid().volume()));
}

/// The same bits of velocity and liquid.
bool same_water(const GridFluid<2>& a, const GridFluid<2>& b) {
    bool equal = true;
    a.grid().for_each([&](const auto&, Offset c) {
        for (int k = 0; k < 2; ++k) equal = equal && a.velocity()[k][c] == b.velocity()[k][c];
        equal = equal && a.liquid().fraction()[c] == b.liquid().fraction()[c] &&
                a.liquid().volume_defect()[c] == b.liquid().volume_defect()[c];
    });
    return equal;
}

}  // namespace

TEST_CASE("a bed that wears: the water sinks with it, and comes to rest") {
    Real bed = 0.243;
    GridFluid<2> flow(tank(bed, 0.613));
    const Real volume = flow.liquid().volume(), sinks = 2.0 / 32;
    for (int step = 0; step < 40; ++step) {  // a twentieth of a cell each
        bed -= sinks / 40;
        flow.set_wall([bed](const Point<2>& x) { return x[1] - bed; });
        CHECK(flow.liquid().volume() == doctest::Approx(volume).epsilon(1e-14));
        flow.advance(flow.time() + 0.025);
        if (step > 10) CHECK(mean_speed(flow) == doctest::Approx(sinks).epsilon(0.1));
    }
    flow.advance(flow.time() + 0.5);
    CHECK(flow.liquid().volume() == doctest::Approx(volume).epsilon(1e-13));
    MESSAGE("then " << mean_speed(flow) << " m/s");
    CHECK(mean_speed(flow) < 0.1 * sinks);
    for (const Real x : {0.1, 0.5, 0.9})
        CHECK(std::abs(flow.surface_at({x, 0}) - (0.613 - sinks)) < 0.05 / 32);
}

TEST_CASE(
    "a hole that wears into the bed and is filled again: the volume stays, and the surface comes back") {
    GridFluid<2> flow(tank(0.243, 0.613));
    const Real volume = flow.liquid().volume();
    Real fell = 0;
    for (int step = 0; step <= 60; ++step) {
        const Real depth = 0.09 * square(std::sin(pi * step / 60));  // three cells, a seventh of one a time
        flow.set_wall([depth](const Point<2>& x) {
            return x[1] - 0.243 + std::max(0.0, depth * (1 - square((x[0] - 0.4) / 0.2)));
        });
        flow.advance(flow.time() + 0.05);
        CHECK(std::abs(flow.liquid().volume() / volume - 1) < 1e-13);
        if (step == 30) fell = 0.613 - flow.surface_at({0.5, 0});
    }
    flow.advance(flow.time() + 1);
    MESSAGE("fell by " << fell << " m, then " << flow.surface_at({0.5, 0}) - 0.613 << " m off, at "
                       << mean_speed(flow) << " m/s");
    CHECK(fell == doctest::Approx(0.09 * 0.4 * 2 / 3).epsilon(0.1));
    for (const Real x : {0.1, 0.5, 0.9}) CHECK(std::abs(flow.surface_at({x, 0}) - 0.613) < 4e-3);
    CHECK(mean_speed(flow) < 0.05);
}

TEST_CASE("water at rest in a bowl that wears, at whatever pace, and one that grows: nothing is shot out") {
    const auto bowl = [](Real by) {
        return
            [by](const Point<2>& x) { return 0.45 + by - std::hypot(x[0] - 0.5, std::min(x[1] - 0.5, 0.0)); };
    };
    auto params = tank(0, 0.4);
    params.wall = bowl(0);
    for (const Real each : {0.05, 0.01, -0.04})
        for (const Real dt : {0.02, 0.005}) {
            CAPTURE(each);
            CAPTURE(dt);
            GridFluid<2> flow(params);
            const Real volume = flow.liquid().volume();
            for (int step = 1; step <= 60; ++step) {
                flow.set_wall(bowl(step * each / 32));
                flow.advance(flow.time() + dt);
                REQUIRE(mean_speed(flow) < 0.5);
            }
            CHECK(std::abs(flow.liquid().volume() / volume - 1) < 1e-13);
        }
}

TEST_CASE("a bed that wears under a film: no void is left below the water") {
    for (const Real cells : {0.6, 1.2, 1.5, 2.0, 2.5}) {
        CAPTURE(cells);
        GridFluid<2> flow(tank(0.243, 0.243 + cells / 32));
        Real bed = 0.243;
        for (int step = 0; step < 60; ++step) {
            bed -= 0.05 / 32;
            flow.set_wall([bed](const Point<2>& x) { return x[1] - bed; });
            flow.advance(flow.time() + 0.02);
        }
        const Field<Real>& f = flow.liquid().fraction();
        const Offset up = flow.grid().layout().stride[1];
        flow.grid().for_each([&](const auto& cell, Offset c) {
            if (cell[1] + 1 < 32 && flow.walls()->open_fraction()[c] > 0 && f[c + up] > 1e-3)
                CHECK(f[c] > 0.999);
        });
        CHECK(std::abs(flow.surface_at({0.5, 0}) - (bed + cells / 32)) < 0.1 / 32);
    }
}

TEST_CASE("a ball in still water that wears and grows: cells that open below it are no voids") {
    GridFluidParams<3> params;
    params.grid = {.cells = {13, 13, 14}, .spacing = {0.05, 0.05, 0.05}};
    params.boundaries = BoundaryConditions<3>::all(Boundary::free_slip);
    params.gravity = {0, 0, -9.81};
    params.water = [](const Point<3>& x) { return 0.52 - x[2]; };
    const auto ball = [](Real radius) {
        return [radius](const Point<3>& x) { return (x - Point<3>(0.325, 0.325, 0.26)).norm() - radius; };
    };
    params.wall = ball(0.15);
    GridFluid<3> flow(params);
    const Real before = flow.liquid().volume();
    std::mt19937 random(3);
    std::uniform_real_distribution<Real> change(-0.0005, 0.0005);  // a hundredth of a cell
    Real radius = 0.15, fastest = 0;
    for (int step = 0; step < 60; ++step) {
        if (step % 5 == 4) flow.set_wall(ball(radius -= change(random)));
        flow.step(flow.stable_step().seconds);
        fastest = std::max(fastest, detail::FastFace<3>(flow.grid(), flow.velocity()).speed);
    }
    CHECK(fastest < 1);  // what falls a cell deep
    CHECK(flow.liquid().volume() == doctest::Approx(before).epsilon(1e-12).scale(0));
}

TEST_CASE("the same wall moves no water") {
    auto waves = tank(0.243, 0.613);
    waves.water = [](const Point<2>& x) { return 0.6 + 0.02 * std::cos(pi * x[0]) - x[1]; };
    GridFluid<2> kept(waves), set(waves);
    kept.advance(0.1), set.advance(0.1);
    set.set_wall(waves.wall);
    CHECK(same_water(kept, set));
    kept.advance(0.5), set.advance(0.5);
    for (const Real x : {0.1, 0.3, 0.7})
        CHECK(std::abs(set.surface_at({x, 0}) - kept.surface_at({x, 0})) < 0.02 * 0.02);
}

TEST_CASE(
    "an invert that wears under running water, with eddies: as deep and fast as one that was built so") {
    const auto worn = [](Real by) {
        return [by](const Point<2>& x) { return x[1] - 0.1 + (x[0] > 0.5 && x[0] < 1.5 ? by : 0.0); };
    };
    GridFluidParams<2> params{.grid = {.cells = {100, 24}, .spacing = {0.02, 0.02}},
                              .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                              .wall = worn(0),
                              .wall_law = {WallLaw::Kind::logarithmic, 1e-3},
                              .water = [](const Point<2>& x) { return 0.25 - x[1]; },
                              .velocity = [](const Point<2>&) { return Point<2>(2, 0); },
                              .gravity = {0.3, -9.8}};
    params.boundaries[0] = {Boundary::inflow, Boundary::outflow};
    params.boundary_velocity = [](const Point<2>& x, Real) { return Point<2>(x[1] > 0.1 ? 2 : 0, 0); };
    params.inflow_water = params.water;
    GridFluid<2, Turbulent<MixingLength>> flow(params, MixingLength{{.depth = 0.15}});
    flow.advance(0.5);
    for (int step = 1; step <= 20; ++step) {
        flow.set_wall(worn(0.03 * step / 20));
        flow.advance(flow.time() + 0.05);
    }
    flow.advance(4);
    params.wall = worn(0.03);
    GridFluid<2, Turbulent<MixingLength>> built(params, MixingLength{{.depth = 0.15}});
    built.advance(4);
    for (const Real x : {0.4, 1.0, 1.8}) {
        CHECK(flow.surface_at({x, 0}) == doctest::Approx(built.surface_at({x, 0})).epsilon(0.02));
        CHECK(flow.sample({x, 0, 0.2}, 0).velocity.x() ==
              doctest::Approx(built.sample({x, 0, 0.2}, 0).velocity.x()).epsilon(0.02));
    }
}

TEST_CASE("walls that come and go") {
    auto params = tank(0, 0.5);
    params.wall = {};
    GridFluid<2> flow(params);
    const Real volume = flow.liquid().volume();
    flow.set_wall([](const Point<2>& x) { return (x - Point<2>(0.5, 0.3)).norm() - 0.02; });
    CHECK(flow.liquid().volume() == doctest::Approx(volume).epsilon(1e-14));
    flow.advance(0.2);
    flow.set_wall({});
    CHECK(flow.walls() == nullptr);
    flow.advance(0.4);
    CHECK(flow.liquid().volume() == doctest::Approx(volume).epsilon(1e-13));
    CHECK(mean_speed(flow) < 0.1);
}

TEST_CASE("what cannot be is named and changes nothing") {
    GridFluid<2> flow(tank(0.243, 0.613));
    flow.advance(0.1);
    GridFluid<2> before = flow;
    const auto says = [&](PlaceFunction<2> wall) {
        return message_of([&] { flow.set_wall(std::move(wall)); });
    };
    CHECK(says([](const Point<2>& x) { return x[1] - 0.5; }).starts_with("GridFluid.set_wall: wall at x = "));
    CHECK(says([](const Point<2>& x) { return std::sqrt(0.2 - x[1]); }).starts_with("GridFluid.wall at x ="));
    CHECK(says([](const Point<2>&) {
              return -1.0;
          }).starts_with("GridFluid.wall, cells of the grid that it leaves open"));
    CHECK(same_water(before, flow));
    GridFluid<2> brimful(tank(0.243, 2));
    CHECK(message_of([&] { brimful.set_wall([](const Point<2>& x) { return x[1] - 0.25; }); })
              .starts_with(
                  "GridFluid.set_wall: room that the wall leaves must be at least that of the water, for"));
    flow.advance(0.2), before.advance(0.2);
    CHECK(same_water(before, flow));
}
