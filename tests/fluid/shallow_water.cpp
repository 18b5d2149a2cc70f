// Depth-averaged water: rest, conservation, symmetry, threads, what it costs where it is dry, what stones
// feel, bad input, and what goes wrong.
#include <abrade/fluid/shallow_water/shallow_water.hpp>
#include <abrade/fluid/uniform_flow.hpp>

#include "../message_of.hpp"

#include <doctest/doctest.h>

using namespace abrade;

namespace {

/// A bed of bumps with an island, and pits that are ponds of their own or dry.
Real bumps(Real x, Real y) {
    return 0.3 * std::sin(7 * x + 0.3) * std::cos(5 * y) +
           0.9 * std::exp(-40 * (square(x - 0.4) + square(y - 0.45)));
}

template <int Dim>
ShallowWaterParams<Dim> square_of(Index cells) {
    ShallowWaterParams<Dim> p;
    p.high.fill(1), p.cells.fill(cells);
    return p;
}

template <int Dim>
Real fastest(const ShallowWater<Dim>& water) {
    Real most = 0;
    for (int a = 0; a < Dim; ++a)
        for (Index j = 0; j < water.grid().count(1); ++j)
            for (Index i = 0; i < water.grid().count(0); ++i)
                most = std::max(most, std::abs(water.speed(a, i, j)));
    return most;
}

template <int Dim>
void check_rest(Real level, std::array<ShallowBoundary, 2> ends) {
    auto p = square_of<Dim>(60);
    p.bed = bumps;
    p.boundaries.fill(ends);
    p.surface = [level](Real, Real) { return level; };
    ShallowWater<Dim> water(p);
    const auto before = water.columns();
    Index dry = 0;
    for (const Real h : before.depth) dry += h == 0;
    CHECK(dry > 0);
    water.advance(5);
    CHECK(water.steps() > 500);
    CHECK(fastest(water) < 1e-13);
    const auto after = water.columns();
    Real moved = 0;
    for (std::size_t k = 0; k < before.depth.size(); ++k)
        moved = std::max(moved, std::abs(after.depth[k] - before.depth[k]));
    CHECK(moved < 1e-13);
}

/// A dam that breaks along x or along y of a square with a hill.
ShallowWater<2> dam_along(bool y) {
    auto p = square_of<2>(50);
    const auto turned = [y](auto f) { return [y, f](Real a, Real b) { return y ? f(b, a) : f(a, b); }; };
    p.bed = turned([](Real a, Real b) { return 0.2 * std::exp(-30 * (square(a - 0.7) + square(b - 0.4))); });
    p.surface = turned([](Real a, Real b) { return a + 0.2 * b < 0.5 ? 0.4 : 0.1; });
    p.manning = 0.01;
    return ShallowWater<2>(p);
}

/// Water that is poured into the corner of a large dry plain.
ShallowWater<2> puddle(Index cells) {
    auto p = square_of<2>(cells);
    p.bed = [](Real x, Real y) { return 0.1 * (x + y); };
    p.surface = [](Real x, Real y) { return square(x) + square(y) < 0.01 ? 0.05 : 0; };
    p.manning = 0.02;
    return ShallowWater<2>(p);
}

}  // namespace

TEST_CASE("a lake rests over any bed and shore, in one dimension and in two") {
    for (const Real level : {0.0, 0.25}) {
        check_rest<1>(level, {ShallowBoundary::wall(), ShallowBoundary::wall()});
        check_rest<2>(level, {ShallowBoundary::wall(), ShallowBoundary::wall()});
    }
    auto p = square_of<2>(60);
    p.bed = [](Real x, Real y) { return 0.3 * std::sin(2 * pi * x) * std::cos(2 * pi * y); };
    p.surface = [](Real, Real) { return 0.1; };
    p.boundaries.fill({ShallowBoundary::periodic(), ShallowBoundary::periodic()});
    ShallowWater<2> water(p);
    water.advance(5);
    CHECK(fastest(water) < 1e-13);
}

TEST_CASE("over a cliff and in pits a lake rests as well") {
    auto p = square_of<1>(40);
    p.bed = [](Real x, Real) { return x < 0.31 ? 0.5 : x > 0.6 && x < 0.63 ? 2.0 : -0.2; };
    p.surface = [](Real, Real) { return 0.7; };
    ShallowWater<1> water(p);
    water.advance(5);
    CHECK(fastest(water) < 1e-13);
}

TEST_CASE("a closed box keeps its volume while all in it moves") {
    ShallowWater<2> water = dam_along(false);
    const Real volume = water.volume();
    water.advance(3);
    CHECK(fastest(water) > 0.05);
    CHECK(std::abs(water.volume() / volume - 1) < 1e-13);
    for (int a = 0; a < 2; ++a)
        for (const bool high : {false, true}) CHECK(water.volume_in(a, high) == 0);
    for (Index j = 0; j < 50; ++j)
        for (Index i = 0; i < 50; ++i) CHECK(water.depth(i, j) >= 0);
}

TEST_CASE("along y water does what it does along x") {
    ShallowWater<2> along = dam_along(false), across = dam_along(true);
    along.advance(0.7), across.advance(0.7);
    Real apart = 0;
    for (Index j = 0; j < 50; ++j)
        for (Index i = 0; i < 50; ++i) {
            apart = std::max(apart, std::abs(along.depth(i, j) - across.depth(j, i)));
            apart = std::max(apart, std::abs(along.speed(0, i, j) - across.speed(1, j, i)));
            apart = std::max(apart, std::abs(along.speed(1, i, j) - across.speed(0, j, i)));
        }
    CHECK(apart < 1e-13);
}

TEST_CASE("rows of a plane that are all alike are the one-dimensional flow") {
    auto line = square_of<1>(100);
    line.surface = [](Real x, Real) { return x < 0.5 ? 1 : 0.2; };
    auto plane = square_of<2>(100);
    plane.high[1] = 0.05, plane.cells[1] = 5;
    plane.surface = line.surface;
    plane.boundaries[1].fill(ShallowBoundary::periodic());
    ShallowWater<1> one(line);
    ShallowWater<2> two(plane);
    // The plane's own step is shorter, for waves run across it as well.
    for (Real t = 0.0004; t < 0.1; t += 0.0004) one.advance(t), two.advance(t);
    for (Index i = 0; i < 100; ++i) {
        CHECK(two.depth(i, 2) == doctest::Approx(one.depth(i)).epsilon(1e-12).scale(0));
        CHECK(two.speed(1, i, 2) == 0);
    }
}

TEST_CASE("the same bits with one thread and with two") {
    std::vector<Real> depth[2];
    for (const int threads : {1, 2}) {
        const int before = thread_count();
        set_thread_count(threads);
        ShallowWater<2> water = puddle(300);  // several tiles
        water.advance(0.15);
        depth[threads - 1] = water.columns().depth;
        set_thread_count(before);
    }
    CHECK(depth[0] == depth[1]);
}

TEST_CASE("work is done where water is") {
    ShallowWater<2> water = puddle(600);
    water.advance(0.01);
    Index wet = 0;
    for (const Real h : water.columns().depth) wet += h > 0;
    CHECK(wet > 2000);
    CHECK(water.cells_worked_on() < 2 * wet);
    CHECK(water.cells_worked_on() < 360000 / 20);
    // A plain without any water takes no steps at all, however long it waits.
    ShallowWater<2> desert(square_of<2>(600));
    CHECK(desert.stable_step().seconds == std::numeric_limits<Real>::infinity());
    desert.advance(1e6);
    CHECK(desert.steps() == 1);
    CHECK(desert.cells_worked_on() == 0);
}

TEST_CASE("where water has been and gone, both copies of the state agree") {
    // A film is left behind that the steps no longer touch; it must not flicker.
    auto p = square_of<2>(64);
    p.cells = {400, 4}, p.high = {4, 0.04};
    p.bed = [](Real x, Real) { return -0.3 * x; };
    p.surface = [](Real x, Real) { return x < 0.3 ? 0.02 : -10; };
    p.boundaries[0][1] = ShallowBoundary::outflow();
    ShallowWater<2> water(p);
    water.advance(20);
    CHECK(water.volume_in(0, true) < 0);
    CHECK(water.volume_residual() < 1e-12);
    const auto before = water.columns().depth;
    for (int n = 1; n <= 4; ++n) {
        water.advance(20 + n * 1e-4);
        const auto now = water.columns().depth;
        for (std::size_t k = 0; k < now.size(); ++k) CHECK(std::abs(now[k] - before[k]) < 1e-5);
    }
}

TEST_CASE("a single cell of water spreads, a single cell of grid rests") {
    auto p = square_of<2>(9);
    p.surface = [](Real x, Real y) { return std::abs(x - 0.5) < 0.05 && std::abs(y - 0.5) < 0.05 ? 1.0 : 0; };
    ShallowWater<2> water(p);
    water.advance(0.2);
    CHECK(water.depth(4, 4) < 0.5);
    CHECK(std::abs(water.volume() * 81 - 1) < 1e-13);
    for (Index j = 0; j < 9; ++j)
        for (Index i = 0; i < 9; ++i) {
            CHECK(water.depth(i, j) == doctest::Approx(water.depth(8 - i, j)).epsilon(1e-10));
            CHECK(water.depth(i, j) == doctest::Approx(water.depth(j, i)).epsilon(1e-10));
        }
    for (const auto side : {ShallowBoundary::wall(), ShallowBoundary::periodic()}) {
        auto one = square_of<1>(1);
        one.boundaries[0].fill(side);
        one.surface = [](Real, Real) { return 1.0; };
        ShallowWater<1> tub(one);
        tub.advance(1);
        CHECK(tub.depth(0) == 1);
        CHECK(tub.speed(0, 0) == 0);
    }
}

TEST_CASE("what comes in and goes out is the change of volume") {
    auto p = square_of<2>(0);
    p.cells = {40, 20}, p.high = {4, 1};
    p.bed = [](Real x, Real y) { return 0.05 * std::cos(3 * x) + 0.2 * square(y - 0.5); };
    p.boundaries = {{{ShallowBoundary::inflow(0.3), ShallowBoundary::outflow()},
                     {ShallowBoundary::inflow(0.1, 0.03), ShallowBoundary::outflow()}}};
    p.manning = 0.015;
    ShallowWater<2> water(p);
    water.advance(10);
    CHECK(water.volume_in(0, false) == doctest::Approx(3).epsilon(1e-12).scale(0));
    CHECK(water.volume_in(1, false) == doctest::Approx(1).epsilon(1e-12).scale(0));
    CHECK(water.volume_in(0, true) < -0.5);
    CHECK(water.volume_in(1, true) < -0.5);
    CHECK(water.volume_residual() < 1e-13);
    // The same through the other ends, mirrored.
    auto mirrored = p;
    mirrored.bed = [bed = p.bed](Real x, Real y) { return bed(4 - x, y); };
    std::swap(mirrored.boundaries[0][0], mirrored.boundaries[0][1]);
    ShallowWater<2> back(mirrored);
    back.advance(10);
    CHECK(back.volume() == doctest::Approx(water.volume()).epsilon(1e-9).scale(0));
    CHECK(back.speed(0, 10, 10) == doctest::Approx(-water.speed(0, 29, 10)).epsilon(1e-6).scale(0));
}

TEST_CASE(
    "what stones feel: the log profile of uniform flow, or one speed for all; depth below the surface") {
    auto p = square_of<2>(20);
    p.bed = [](Real x, Real) { return 0.1 * x; };
    p.surface = [](Real x, Real y) { return x < 0.9 ? 0.5 + 0.2 * y : 0.0; };
    p.speed = {PlaneFunction([](Real, Real) { return 2.0; }), PlaneFunction([](Real x, Real) { return x; })};
    p.manning = 0.015, p.density = 998, p.viscosity = 1e-3;
    const ShallowWater<2> water(p);
    const Vec3 x{0.4, 0.3, 0.24};
    const FluidSample here = water.sample(x, 0);
    CHECK(here.depth == doctest::Approx(0.56 - 0.24).epsilon(1e-12));
    CHECK(here.density == 998);
    CHECK(here.viscosity == 1e-3);
    CHECK(here.velocity.y() / here.velocity.x() == doctest::Approx(0.2).epsilon(1e-12));
    CHECK(here.velocity.z() == 0);
    // The mean over the depth is the speed of the column; at its bed water rests.
    const int parts = 20000;
    Real mean = 0;
    for (int n = 0; n < parts; ++n)
        mean += water.sample({0.4, 0.3, 0.04 + (n + 0.5) / parts * 0.52}, 0).velocity.x() / parts;
    CHECK(mean == doctest::Approx(2).epsilon(1e-4));
    CHECK(water.sample({0.4, 0.3, 0.04}, 0).velocity.x() == doctest::Approx(0));
    CHECK(water.sample({0.4, 0.3, 5}, 0).depth < 0);
    // The same profile as UniformFlow's.
    const UniformFlow uniform{{.discharge = 0.5, .manning = 0.015}};
    const Real high = uniform.sample({0, 0, 0.1}, 0).velocity.x(),
               low = uniform.sample({0, 0, 0.05}, 0).velocity.x();
    CHECK(water.sample({0.4, 0.3, 0.14}, 0).velocity.x() / water.sample({0.4, 0.3, 0.09}, 0).velocity.x() ==
          doctest::Approx(high / low).epsilon(1e-9));
    // Dry: above the bed is above the water. Beyond the grid: as at its edge. A NaN is no place in any
    // column.
    CHECK(water.sample({0.97, 0.5, 0.1}, 0).depth < 0);
    CHECK(water.sample({0.97, 0.5, 0.1}, 0).velocity.isZero());
    CHECK(water.sample({-3, 0.3, 0.1}, 0).velocity.x() > 0);
    CHECK_NOTHROW(water.sample({std::nan(""), 0.3, 0.1}, 0));
    p.profile = VelocityProfile::uniform;
    CHECK(ShallowWater<2>(p).sample(x, 0).velocity.x() == doctest::Approx(2));
}

TEST_CASE("time goes to where it is asked to go, in steps that leave no sliver") {
    ShallowWater<1> water{{.low = {0},
                           .high = {1},
                           .cells = {100},
                           .surface = [](Real x, Real) { return 1 + 0.1 * x; },
                           .start_time = -1}};
    CHECK(water.time() == -1);
    const FluidStep step = water.stable_step();
    CHECK(step.limit == "CFL");
    CHECK(step.cell == 99);
    CHECK(step.seconds == doctest::Approx(0.5 * 0.01 / std::sqrt(standard_gravity * 1.0995)).epsilon(1e-8));
    water.advance(-1 + 1.1 * step.seconds);
    CHECK(water.steps() == 2);
    water.advance(0);
    CHECK(water.time() == 0);
    water.advance(-0.5);
    CHECK(water.time() == 0);
}

TEST_CASE("steps that empty a cell are repeated at half their length") {
    // At a Courant number of 1 nothing promises that depths stay positive.
    auto p = square_of<2>(40);
    p.courant = 1;
    p.surface = [](Real x, Real y) { return std::sin(40 * x) * std::sin(37 * y) > 0.9 ? 0.5 : 0; };
    p.speed = {PlaneFunction([](Real x, Real) { return 20 * std::sin(30 * x); }),
               PlaneFunction([](Real, Real y) { return 20 * std::cos(30 * y); })};
    ShallowWater<2> water(p);
    water.advance(0.3);
    MESSAGE(water.steps_repeated() << " of " << water.steps() << " steps were repeated");
    for (const Real h : water.columns().depth) CHECK(h >= 0);
    CHECK(water.volume_residual() < 1e-13);
}

TEST_CASE("over a drop in a dry bed a stream runs no faster than it falls") {
    for (const Real drop : {0.05, 0.5})
        for (const Real manning : {0.0, 0.03})
            for (const Index cells : {50, 200}) {
                CAPTURE(drop);
                CAPTURE(manning);
                CAPTURE(cells);
                const Real discharge = 0.01;
                ShallowWaterParams<1> p;
                p.high = {10}, p.cells = {cells}, p.manning = manning;
                p.boundaries[0] = {ShallowBoundary::inflow(discharge), ShallowBoundary::outflow()};
                p.bed = [drop](Real x, Real) { return x < 5 ? drop : 0; };
                ShallowWater<1> water(p);
                Real most = 0;
                for (int n = 1; n <= 400; ++n) {
                    water.advance(0.25 * n);
                    most = std::max(most, fastest(water));
                }
                // Over the brink it goes with its critical head, 3/2 of (q^2/g)^(1/3).
                const Real head = 1.5 * std::cbrt(square(discharge) / standard_gravity);
                CHECK(most < std::sqrt(2 * standard_gravity * (drop + head)));
                // Friction fills the flat bed behind the drop for long.
                const Index passed = manning > 0 ? cells / 2 - 2 : cells - 2;
                CHECK(water.discharge(passed) == doctest::Approx(discharge).epsilon(0.01).scale(0));
                CHECK(water.volume_residual() < 1e-13);
            }
    // Waves of the bed, up to 1.6 m of rise to 1 m of run, that water runs onto from one end.
    ShallowWaterParams<2> p;
    p.high = {10, 10}, p.cells = {80, 80}, p.manning = 0.03;
    p.boundaries[0] = {ShallowBoundary::inflow(2), ShallowBoundary::outflow()};
    p.bed = [](Real x, Real y) { return 0.2 * std::sin(7.3 * x) * std::cos(5.1 * y) - 0.1 * x; };
    ShallowWater<2> water(p);
    Real most = 0;
    for (int n = 1; n <= 100; ++n) {
        water.advance(0.1 * n);
        most = std::max(most, fastest(water));
    }
    CHECK(most < 5);  // our own; it runs at 2.8, and without a limit to slopes beyond 100
}

TEST_CASE("what goes wrong stops with the cell, its speed and the cause, and leaves the state before it") {
    auto p = square_of<2>(10);
    p.surface = [](Real, Real) { return 1.0; };
    p.gravity = {500, 0, -9.81};
    p.boundaries[0].fill(ShallowBoundary::periodic());
    p.velocity_limit = 20;
    ShallowWater<2> water(p);
    const std::string said = message_of<FluidError>([&] { water.advance(1); });
    CAPTURE(said);
    CHECK(said.find("cell (") != std::string::npos);
    CHECK(said.find("is faster than ShallowWater.velocity_limit, 20 m/s") != std::string::npos);
    CHECK(said.find("depth 1 m") != std::string::npos);
    CHECK(fastest(water) <= 20);
    CHECK(fastest(water) > 15);
    CHECK(water.time() < 0.05);
    const Real time = water.time();
    CHECK(message_of<FluidError>([&] { water.advance(1); }) == said);
    CHECK(water.time() == time);

    p.gravity = {1e308, 0, -9.81};
    ShallowWater<2> absurd(p);
    CHECK(message_of<FluidError>([&] { absurd.advance(1); }).find("is not finite") != std::string::npos);
    CHECK(fastest(absurd) == 0);
}

TEST_CASE("bad input is named with its value, its unit and what helps") {
    const auto said = [](auto change) {
        auto p = square_of<2>(4);
        change(p);
        return message_of([&] { ShallowWater<2> water(p); });
    };
    using P = ShallowWaterParams<2>;
    CHECK(said([](P& p) { p.cells[1] = 0; }) ==
          "ShallowWater.cells.y must be at least 1, got 0 cells; length over spacing");
    CHECK(said([](P& p) {
              p.cells = {100000, 20000};
          }) == "ShallowWater.cells must be below 1e9 in all, got 2e+09 cells; take larger ones");
    CHECK(said([](P& p) {
              p.start_time = -1e17;
          }).starts_with("ShallowWater.start_time must be from -1e9 to 1e9, got -1e+17 s; beyond"));
    CHECK(said([](P& p) { p.high[0] = -1; }) ==
          "ShallowWater.high.x must be above low.x (0 m), got -1 m; swap them or widen the plane");
    CHECK(said([](P& p) {
              p.gravity.z() = 9.81;
          }).starts_with("ShallowWater.gravity.z must be below 0, got 9.81 m/s2"));
    CHECK(said([](P& p) {
              p.manning = -0.01;
          }).starts_with("ShallowWater.manning must be finite and >= 0, got -0.01"));
    CHECK(said([](P& p) {
              p.viscosity = -1;
          }).starts_with("ShallowWater.viscosity must be finite and > 0, got -1 Pa s"));
    CHECK(said([](P& p) { p.courant = 1.5; }).starts_with("ShallowWater.courant must be in (0, 1], got 1.5"));
    CHECK(said([](P& p) {
              p.dry_depth = 0;
          }).starts_with("ShallowWater.dry_depth must be finite and > 0, got 0 m"));
    CHECK(said([](P& p) {
              p.boundaries[0][1] = ShallowBoundary::inflow(0);
          }).starts_with("ShallowWater.boundaries.x.high.discharge must be finite and > 0, got 0 m3/s"));
    CHECK(said([](P& p) {
              p.boundaries[1][0] = ShallowBoundary::inflow(1, -1);
          }).starts_with("ShallowWater.boundaries.y.low.depth must be finite and >= 0, got -1 m"));
    CHECK(said([](P& p) { p.boundaries[1][0] = ShallowBoundary::periodic(); })
              .starts_with("ShallowWater.boundaries.y must be periodic at both ends or at none, got only low "
                           "periodic; water"));
    CHECK(said([](P& p) {
              p.boundaries[1][0].discharge = 1;
          }).starts_with("ShallowWater.boundaries.y.low.discharge must be 0 but at an inflow, got 1 m3/s"));
    CHECK(said([](P& p) {
              p.bed = [](Real x, Real) { return x > 0.5 ? std::nan("") : 0; };
          }).starts_with("ShallowWater.bed in cell (2, 0) at (0.625, 0.125) m must be finite, got nan m"));
    CHECK(said([](P& p) {
              p.surface = [](Real, Real) { return 1.0; };
              p.speed[0] = [](Real, Real) { return 1e3; };
          })
              .starts_with("ShallowWater.speed in cell (0, 0) at (0.125, 0.125) m must be within "
                           "ShallowWater.velocity_limit"));
    CHECK(said([](P& p) {
              p.surface = [](Real, Real) { return 1.0; };
              p.speed[1] = [](Real, Real) { return std::nan(""); };
          }).find("must be finite, got nan m/s") != std::string::npos);
    ShallowWater<2> lake(square_of<2>(4));
    CHECK(message_of([&] {
              lake.advance(std::nan(""));
          }).starts_with("ShallowWater.advance: to_time must be finite, got nan s"));
    CHECK(message_of([&] {
              lake.advance(std::numeric_limits<Real>::infinity());
          }).starts_with("ShallowWater.advance: to_time must be finite, got inf s"));
    auto line = square_of<1>(4);
    line.gravity.y() = 1;
    CHECK(message_of([&] { ShallowWater<1> water(line); }).find("ShallowWater<2>") != std::string::npos);
}
