// Water on a grid: rest, drops, closed boxes, films, errors that leave it as it was, bits that do not depend
// on threads.
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

#include "../message_of.hpp"

using namespace abrade;

namespace {

constexpr Real g = 9.81;

/// A basin of n x n cells of 1 m in all, filled below `surface`.
GridFluid<2>::Params basin(int n, PlaceFunction<2> water) {
    return {.grid = {.cells = {n, n}, .spacing = Point<2>::Constant(1.0 / n)},
            .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
            .water = std::move(water),
            .gravity = {0, -g}};
}

template <class Flow>
Real fastest(const Flow& flow) {
    Real most = 0;
    flow.grid().for_each([&](const auto&, Offset c) {
        if (flow.liquid().fraction()[c] > 0)
            for (const auto& u : flow.velocity()) most = std::max(most, std::abs(u[c]));
    });
    return most;
}

}  // namespace

TEST_CASE("water at rest stays at rest, its pressure is that of the depth") {
    auto params = basin(16, [](const Point<2>& x) { return 0.53 - x[1]; });
    params.tolerance = 1e-10;
    GridFluid<2> flow(params);
    flow.advance(1);
    MESSAGE("fastest " << fastest(flow) << " m/s after " << flow.steps() << " steps");
    CHECK(fastest(flow) < 1e-6 * std::sqrt(g * 0.53));
    const Offset c = flow.grid().layout().at({5, 2});
    CHECK(flow.pressure()[c] == doctest::Approx(g * (0.53 - 2.5 / 16)).epsilon(1e-6).scale(0));
    CHECK(flow.surface_at({0.4, 0}) == doctest::Approx(0.53).epsilon(1e-9));
    CHECK(flow.sample({0.4, 0, 0.2}, 0).depth == doctest::Approx(0.33).epsilon(1e-9));
}

TEST_CASE("rest does not ask where a cell's centre lies: level and tilted surfaces through centres") {
    for (const Real slope : {0.0, 0.05}) {
        auto params = basin(25, [slope](const Point<2>& x) {
            return std::sqrt(1 - square(slope)) * (0.5 - x[1]) + slope * (x[0] - 0.5);
        });
        params.gravity = {g * slope, -g * std::sqrt(1 - square(slope))};
        params.tolerance = 1e-8;
        GridFluid<2> flow(params);
        Real most = 0;
        while (flow.time() < 3) {
            flow.step(flow.stable_step().seconds);
            most = std::max(most, fastest(flow));
        }
        MESSAGE("tilted by " << slope << ": " << most / std::sqrt(g * 0.5) << " sqrt(g h)");
        CHECK(most < 1e-6 * std::sqrt(g * 0.5));
    }
}

TEST_CASE("a drop smaller than a cell falls freely; it ends on the floor and no volume is lost") {
    auto params = basin(16, {});
    params.water = [](const Point<2>& x) { return 0.04 - (x - Point<2>(0.5, 0.75)).norm(); };
    GridFluid<2> flow(params);
    const Real volume = flow.liquid().volume();
    CHECK(volume > 0);
    const auto height = [&] {
        Real sum = 0, all = 0;
        flow.grid().for_each([&](const CellNumber<2>& cell, Offset c) {
            sum += flow.liquid().fraction()[c] * flow.grid().centre(1, cell[1]);
            all += flow.liquid().fraction()[c];
        });
        return sum / all;
    };
    const Real start = height();
    flow.advance(0.2);
    MESSAGE("fell " << start - height() << " m in 0.2 s, freely " << 0.5 * g * square(0.2));
    CHECK(start - height() == doctest::Approx(0.5 * g * square(0.2)).epsilon(0.2));
    flow.advance(1.5);
    CHECK(height() < 2.0 / 16);
    CHECK(flow.liquid().volume() == doctest::Approx(volume).epsilon(1e-12).scale(0));
}

TEST_CASE("a closed box full of water: the pressure is known but for a constant") {
    auto params = basin(16, [](const Point<2>&) { return 1.0; });
    params.tolerance = 1e-9;
    GridFluid<2> flow(params);
    flow.advance(0.05);
    CHECK(fastest(flow) < 1e-7);
    const auto p = [&](int k) { return flow.pressure()[flow.grid().layout().at({7, k})]; };
    CHECK(p(2) - p(9) == doctest::Approx(g * 7 / 16).epsilon(1e-5));
}

TEST_CASE("a dry box and a single wet cell") {
    GridFluid<2> dry(basin(8, {}));
    dry.advance(0.1);
    CHECK(dry.wet_cells() == 0);
    GridFluid<2> one(
        basin(8, [](const Point<2>& x) { return 0.075 - (x - Point<2>(0.5625, 0.8125)).norm(); }));
    const Real volume = one.liquid().volume();
    CHECK(one.wet_cells() == 1);
    one.advance(0.1);
    CHECK(one.liquid().volume() == doctest::Approx(volume).epsilon(1e-12).scale(0));
    CHECK(std::isfinite(fastest(one)));
}

TEST_CASE("samples beyond the box, and at places that are no number") {
    const GridFluid<2> flow(basin(16, [](const Point<2>& x) { return 0.5 - x[1]; }));
    constexpr Real inf = std::numeric_limits<Real>::infinity();
    for (const Real x : {-inf, -1e300, -1.0, 2.0, 1e300, inf})
        CHECK(flow.sample({x, 0, 0.2}, 0).depth == doctest::Approx(0.3));
    CHECK(std::isnan(flow.sample({std::nan(""), 0, 0.2}, 0).depth));
    CHECK(std::isnan(flow.sample({0.2, 0, std::nan("")}, 0).depth));
}

TEST_CASE("one copy goes on as the other") {
    GridFluid<2> flow(basin(16, [](const Point<2>& x) { return std::min(0.4 - x[0], 0.6 - x[1]); }));
    flow.advance(0.05);
    GridFluid<2> copy = flow;
    flow.advance(0.1), copy.advance(0.1);
    flow.grid().for_each(
        [&](const auto&, Offset c) { REQUIRE(flow.velocity()[1][c] == copy.velocity()[1][c]); });
}

/// Velocities and fractions after 0.25 s, with so many threads.
template <int Dim>
std::vector<Real> bits_by(int threads, const GridFluidParams<Dim>& params) {
    set_thread_count(threads);
    GridFluid<Dim> flow(params);
    flow.advance(0.25);
    set_thread_count(1);
    std::vector<Real> bits;
    flow.grid().for_each([&](const auto&, Offset c) {
        for (const auto& u : flow.velocity()) bits.push_back(u[c]);
        bits.push_back(flow.liquid().fraction()[c]);
    });
    return bits;
}
bool same_bits(const std::vector<Real>& a, const std::vector<Real>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Real)) == 0;
}

TEST_CASE("the same bits for a long box, of which momentum is carried in parts, and three threads") {
    const GridFluidParams<2> params{
        .grid = {.cells = {280, 24}, .spacing = Point<2>::Constant(0.02)},
        .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
        .wall = [](const Point<2>& x) { return (x - Point<2>(3, 0)).norm() - 0.1; },
        .water = [](const Point<2>& x) { return x[0] < 2.5 ? 0.4 - x[1] : 0.1 - x[1]; },
        .gravity = {0, -g}};
    const auto bits = bits_by(1, params);
    CHECK(same_bits(bits, bits_by(2, params)));
    CHECK(same_bits(bits, bits_by(3, params)));
}

TEST_CASE("the same bits for one thread and two") {
    const GridFluidParams<3> params{
        .grid = {.cells = {40, 12, 24}, .spacing = Point<3>::Constant(0.05)},
        .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
        .wall = [](const Point<3>& x) { return (x - Point<3>(1, 0.3, 0)).norm() - 0.2; },
        .water = [](const Point<3>& x) { return std::min(0.6 - x[0], 0.8 - x[2]); },
        .gravity = {0, 0, -g}};
    CHECK(same_bits(bits_by(1, params), bits_by(2, params)));
}

TEST_CASE("steps name their limit") {
    GridFluid<2> flow(basin(16, [](const Point<2>& x) { return 0.5 - x[1]; }));
    CHECK(flow.stable_step().seconds > 0);
    CHECK(flow.stable_step().limit == "CFL");
    auto thick = basin(16, [](const Point<2>& x) { return 0.5 - x[1]; });
    thick.viscosity = 1e4;
    CHECK(GridFluid<2>(thick).stable_step().limit == "viscosity");
    thick.largest_step = 1e-9;
    CHECK(GridFluid<2>(thick).stable_step().limit == "largest_step");
}

TEST_CASE("a step that is too long in a full box is refused before it is taken, with its limit") {
    GridFluid<2, FullBox> flow(
        {.grid = {.cells = {16, 16}, .spacing = Point<2>::Constant(1.0 / 16)},
         .boundary_velocity = [](const Point<2>& x, Real) { return Point<2>(x[1] > 1 - 1e-9 ? 1 : 0, 0); },
         .density = 1,
         .viscosity = 1e-2});
    flow.advance(1);
    const Real time = flow.time();
    const Real before = flow.kinetic_energy();
    const std::string message = message_of<FluidError>([&] { flow.step(100 * flow.stable_step().seconds); });
    MESSAGE(message);
    CHECK(message.find("beyond stable_step(), which CFL limits to ") != std::string::npos);
    CHECK(flow.kinetic_energy() == before);
    CHECK(flow.time() == time);
}

TEST_CASE("bad input names field, value, rule and remedy") {
    const auto says = [](GridFluid<2>::Params params) -> std::string {
        try {
            GridFluid<2> flow(std::move(params));
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    const auto good = basin(8, [](const Point<2>& x) { return 0.5 - x[1]; });
    auto params = good;
    params.viscosity = -1;
    CHECK(says(params).starts_with("GridFluid.viscosity must be finite and >= 0, got -1 Pa s; water has"));
    params = good;
    params.grid.spacing[1] = 0;
    CHECK(says(params).starts_with("Grid.spacing.z must be finite and > 0, got 0 m"));
    params = good;
    params.boundaries[0] = {Boundary::periodic, Boundary::wall};
    CHECK(says(params).find("periodic at both ends") != std::string::npos);
    params = good;
    params.boundaries[1] = {Boundary::periodic, Boundary::periodic};
    CHECK(says(params) ==
          "GridFluid.boundaries.z must be not periodic where there is a surface, got periodic; close the "
          "floor, "
          "or take a FullBox");
    params = good;
    params.boundaries[0][0] = Boundary::inflow;
    CHECK(says(params).starts_with("GridFluid.boundary_velocity must be given where a side is an inflow"));
    params = good;
    params.wall = [](const Point<2>&) { return -1.0; };
    CHECK(says(params).find("leaves open") != std::string::npos);
    params = good;
    params.courant = 2;
    CHECK(says(params).starts_with("GridFluid.courant must be in (0, 1], got 2"));
    constexpr Real nan = std::numeric_limits<Real>::quiet_NaN(), inf = std::numeric_limits<Real>::infinity();
    params = good;
    params.grid.cells[1] = 2, params.grid.levels = {0, 0.5, inf};
    CHECK(says(params).starts_with("Grid.levels[2] must be finite, got inf m"));
    params = good;
    params.grid.low[0] = 1e15;
    CHECK(says(params).starts_with("Grid.low.x must be within 1e12 cells of 0, got 1e+15 m; numbers cannot"));
    params = good;
    params.velocity = [](const Point<2>& x) { return Point<2>(0, x[0] > 0.9 && x[1] > 0.8 ? nan : 0); };
    CHECK(says(params).starts_with("GridFluid.velocity.z at x = 0.9375 m, z = 0.875 m, t = 0 s must"));
    params.velocity = [](const Point<2>&) { return Point<2>(1e200, 0); };
    CHECK(
        says(params).starts_with("GridFluid.velocity.x at x = 0 m, z = 0.0625 m, t = 0 s must be at most "
                                 "GridFluid.velocity_limit, 100, got 1e+200 m/s"));
    params = good;
    params.start_time = 1e17;
    CHECK(says(params).starts_with("GridFluid.start_time must be from -1e9 to 1e9, got 1e+17 s"));
    params = good;
    params.water = [](const Point<2>& x) { return std::sqrt(0.6 - x[1]); };
    CHECK(says(params).starts_with("GridFluid.water at x = "));
    params = good;
    params.wall = [](const Point<2>& x) { return std::sqrt(x[1] - 0.1); };
    CHECK(says(params).starts_with("GridFluid.wall at x = "));
    params.wall = [](const Point<2>& x) -> Real {
        if (x[1] < 0.1) throw std::domain_error("below the map");
        return x[1] - 0.1;
    };
    CHECK_THROWS_WITH_AS(GridFluid<2>{params}, "below the map", std::domain_error);
    params = good;
    params.inflow_water = good.water;
    CHECK(says(params).starts_with("GridFluid.inflow_water must be left out where no side is an inflow"));
    params.boundaries[0] = {Boundary::inflow, Boundary::outflow};
    params.boundary_velocity = [](const Point<2>& x, Real) { return Point<2>(x[1] > 0.5 ? inf : 1, 0); };
    CHECK(
        says(params).starts_with("GridFluid.boundary_velocity.x at x = 0 m, z = 0.5625 m, t = 0 s must be "
                                 "finite, got inf m/s"));
    params.boundary_velocity = [](const Point<2>&, Real) { return Point<2>(1, 0); };
    CHECK(says(params) == "");
    params.outflow_water = [](const Point<2>& x) { return x[1] > 0.5 ? nan : 0; };
    CHECK(says(params).starts_with("GridFluid.outflow_water at x = 1 m, z = 0.5625 m must be finite, got"));
    params.outflow_water = {};
    params.wall = [](const Point<2>& x) { return x[0] - 0.2; };
    CHECK(
        says(params).starts_with("GridFluid.wall must be open somewhere at the inflow (lower side along "
                                 "x), got 0 of 8 faces; move the wall"));
    params.wall = [](const Point<2>& x) { return x[1] - 0.6; };
    CHECK(says(params).starts_with("GridFluid.inflow_water must be > 0 somewhere at the inflow"));
    GridFluid<2> flow(good);
    CHECK_THROWS_WITH_AS(flow.advance(nan), doctest::Contains("GridFluid.advance: to_time"), InputError);
}

TEST_CASE(
    "what is given later and is no number, and functions that throw: named, and the flow is as it was") {
    auto params = basin(16, [](const Point<2>& x) { return 0.5 - x[1]; });
    params.boundaries[0] = {Boundary::inflow, Boundary::outflow};
    params.inflow_water = params.water;
    params.steady_boundaries = false;
    params.boundary_velocity = [](const Point<2>&, Real t) { return Point<2>(std::sqrt(0.1 - t), 0); };
    GridFluid<2> flow(params);
    std::string message;
    try {
        flow.advance(1);
    } catch (const FluidError& error) {
        message = error.what();
    }
    MESSAGE(message);
    CHECK(message.find("GridFluid.boundary_velocity.x at x = 0 m") != std::string::npos);
    CHECK(flow.time() < 0.1);
    flow.advance(0.099);
    CHECK(flow.time() == 0.099);
    CHECK(std::isfinite(flow.kinetic_energy()));
    params.boundary_velocity = [](const Point<2>&, Real t) {
        if (t > 0.05) throw std::runtime_error("no record of the river");
        return Point<2>(0.5, 0);
    };
    GridFluid<2> ends(params);
    CHECK_THROWS_WITH_AS(ends.advance(1), doctest::Contains("no record of the river"), FluidError);
    ends.advance(0.0499);
    CHECK(ends.time() == 0.0499);
}

TEST_CASE("an inflow that begins later enters a dry box") {
    auto params = basin(16, {});
    params.boundaries[0] = {Boundary::inflow, Boundary::outflow};
    params.inflow_water = [](const Point<2>& x) { return 0.25 - x[1]; };
    params.steady_boundaries = false;
    params.boundary_velocity = [](const Point<2>&, Real t) { return Point<2>(std::min(10 * t, 1.0), 0); };
    params.largest_step = 1e-3;
    GridFluid<2> flow(params);
    flow.advance(0.2);
    // 0.05 m come in until 0.1 s and 0.1 m after, up to a step.
    CHECK(flow.liquid().volume() == doctest::Approx(0.15 * 0.25).epsilon(0.02));
}

TEST_CASE("a box that fills: refused as soon as nothing is left that could rise") {
    auto params = basin(16, [](const Point<2>& x) { return 0.5 - x[1]; });
    params.boundaries[0][0] = Boundary::inflow;
    params.boundary_velocity = [](const Point<2>& x, Real) { return Point<2>(x[1] < 0.25 ? 1 : 0, 0); };
    params.inflow_water = [](const Point<2>&) { return 1.0; };
    GridFluid<2> flow(params);
    CHECK_THROWS_WITH_AS(flow.advance(4), doctest::Contains("ask for another volume of water"), FluidError);
    MESSAGE("until " << flow.time() << " s; " << flow.liquid().volume() << " of 1 m2");
    CHECK(flow.liquid().volume() < 1.02);
    CHECK(flow.liquid().volume() > 0.95);
}
