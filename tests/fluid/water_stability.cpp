// Where water on a grid fails, and how: steps that are too long, too much speed, deep tolerance, and water
// that has next to nothing of what methods ask for.
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

constexpr Real g = 9.81;

/// A basin of 32 x 32 cells of 1 m in all.
GridFluid<2>::Params basin(PlaceFunction<2> water) {
    return {.grid = {.cells = {32, 32}, .spacing = Point<2>::Constant(1.0 / 32)},
            .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
            .water = std::move(water),
            .gravity = {0, -g}};
}
Real column(const Point<2>& x) { return std::min(0.4 - x[0], 0.6 - x[1]); }

/// What a step changes: pressures, fractions, and velocities on faces of cells that hold liquid.
struct State {
    Real time = 0;
    std::vector<Real> velocity{}, pressure{}, fraction{};
    bool operator==(const State&) const = default;
};
State state_of(const GridFluid<2>& flow) {
    State state{.time = flow.time()};
    const Field<Real>& f = flow.liquid().fraction();
    flow.grid().for_each([&](const auto&, Offset c) {
        for (int a = 0; a < 2; ++a)
            if (f[c] > 0 || f[c - flow.grid().layout().stride[a]] > 0)
                state.velocity.push_back(flow.velocity()[a][c]);
        state.pressure.push_back(flow.pressure()[c]);
        state.fraction.push_back(f[c]);
    });
    return state;
}

Real fastest(const GridFluid<2>& flow) {
    Real most = 0;
    flow.grid().for_each([&](const auto&, Offset c) {
        if (flow.liquid().fraction()[c] > 0)
            for (const auto& u : flow.velocity()) most = std::max(most, std::abs(u[c]));
    });
    return most;
}

/// Steps of a length times the stable one, at most `most` of them; what the error says that ends them, or
/// nothing. What was before the step that went wrong must be there after it, and the flow must go on from
/// there.
std::string push(GridFluid<2>& flow, Real times, int most) {
    State before;
    Real volume = 0;
    try {
        for (int k = 0; k < most; ++k) {
            before = state_of(flow), volume = flow.liquid().volume();
            flow.step(times * flow.stable_step().seconds);
        }
    } catch (const std::exception& error) {
        CHECK(state_of(flow) == before);
        CHECK(flow.liquid().volume() == doctest::Approx(volume).epsilon(1e-12).scale(0));
        return error.what();
    }
    return "";
}

/// Goes on for a while in stable steps. What must hold of any water: numbers, fractions within bounds,
/// volume.
void run(GridFluid<2>& flow, Real seconds) {
    const Real volume = flow.liquid().volume();
    flow.advance(flow.time() + seconds);
    const State state = state_of(flow);
    CHECK(std::all_of(state.velocity.begin(), state.velocity.end(), [](Real u) { return std::isfinite(u); }));
    CHECK(std::all_of(state.pressure.begin(), state.pressure.end(), [](Real p) { return std::isfinite(p); }));
    CHECK(std::all_of(state.fraction.begin(), state.fraction.end(), [](Real f) { return f >= 0 && f <= 1; }));
    CHECK(flow.liquid().volume() == doctest::Approx(volume).epsilon(1e-12).scale(0));
}

bool names(const std::string& message, std::initializer_list<std::string_view> words) {
    MESSAGE(message);
    return std::all_of(words.begin(), words.end(),
                       [&](std::string_view word) { return message.find(word) != std::string::npos; });
}

}  // namespace

TEST_CASE("steps beyond the stable one are refused with the limit that they break") {
    GridFluid<2> flow(basin(column));
    flow.advance(0.2);
    for (const Real times : {1.01, 4.0, 100.0}) {
        CHECK(names(push(flow, times, 1), {"dt", "beyond stable_step(), which "}));
        run(flow, 0.05);
    }
}

TEST_CASE("a second of free fall in one step from rest is refused") {
    GridFluid<2> flow(basin(column));
    CHECK(names(push(flow, 1 / flow.stable_step().seconds, 1), {"dt", "stable_step()"}));
    CHECK_THROWS_WITH_AS(flow.step(0), doctest::Contains("GridFluid.step: dt"), InputError);
}

TEST_CASE("within the viscous limit velocities decay, beyond it a step is refused") {
    auto params = basin([](const Point<2>& x) { return 0.77 - x[1]; });
    params.viscosity = 1000;  // the limit is 0.2 ms
    params.velocity = [](const Point<2>& x) {
        return Point<2>(std::sin(pi * x[0]) * std::cos(4 * pi * x[1]), 0);
    };
    GridFluid<2> within(params), beyond(params);
    CHECK(within.stable_step().limit == "viscosity");
    const Real energy = within.kinetic_energy();
    run(within, 0.008);
    CHECK(within.kinetic_energy() < 0.1 * energy);
    CHECK(names(push(beyond, 40, 30), {"dt", "viscosity"}));
}

TEST_CASE("too fast: the error names step, time, cell, speed and remedy") {
    auto params = basin(column);
    params.velocity_limit = 1.5;
    GridFluid<2> flow(params);
    const std::string message = push(flow, 1, 1000);
    CHECK(names(message, {"step ", "t = ", "dt = ", "beyond GridFluid.velocity_limit", "cell [", "m/s along",
                          "courant"}));
}

TEST_CASE("a tolerance of 1e-12 is reached, in single-precision solves") {
    auto params = basin(column);
    params.tolerance = 1e-12;
    GridFluid<2> flow(params);
    Real worst = 0;
    int most = 0;
    while (flow.time() < 0.5) {
        flow.step(flow.stable_step().seconds);
        worst = std::max(worst, flow.last_projection().after);
        most = std::max(most, flow.last_projection().rounds);
    }
    MESSAGE("left at most " << worst << " after at most " << most << " rounds");
    CHECK(worst < 1e-12);
    CHECK(most <= 4);
}

TEST_CASE("films thinner than a cell: at rest, flowing, running down a slope to a wall") {
    const auto film = [](const Point<2>& x) { return 0.3 / 32 - x[1]; };
    GridFluid<2> rests(basin(film));
    run(rests, 0.5);
    CHECK(rests.wet_cells() == 0);  // it has no pressure of its own: its cells are less than half full
    auto params = basin(film);
    params.velocity = [](const Point<2>&) { return Point<2>(1, 0); };
    GridFluid<2> flows(params);
    run(flows, 1);
    params = basin(film);
    params.gravity = {3, -9};
    GridFluid<2> runs(params);
    run(runs, 2);
    CHECK(fastest(runs) < std::sqrt(2 * 3 * 1.0) * 3);
}

TEST_CASE("films under a lid fall, land and stay") {
    for (const Real width : {0.2, 1.0}) {
        GridFluid<2> flow(basin([width](const Point<2>& x) {
            return std::min(x[1] - (1 - 0.3 / 32), width - std::abs(x[0] - 0.5));
        }));
        Real most = 0;
        while (flow.time() < 0.8) {
            run(flow, 0.02);
            most = std::max(most, fastest(flow));
        }
        MESSAGE("fastest " << most << " m/s, freely " << std::sqrt(2 * g));
        CHECK(most < 1.1 * std::sqrt(2 * g));
        CHECK(fastest(flow) == 0);
        flow.grid().for_each([&](const CellNumber<2>& cell, Offset c) {
            if (cell[1] > 0) CHECK(flow.liquid().fraction()[c] == 0);
        });
    }
}

TEST_CASE("a jet that plunges and traps air: what is trapped is a void, so it fills") {
    auto params = basin([](const Point<2>& x) {
        return std::max(0.3 - x[1], std::min(0.06 - std::abs(x[0] - 0.5), x[1] - 0.3));
    });
    params.velocity = [](const Point<2>& x) { return Point<2>(0, x[1] > 0.35 ? -5 : 0); };
    GridFluid<2> flow(params);
    run(flow, 1);
    const auto hole = [](const Point<2>& x) { return (x - Point<2>(0.5, 0.4)).norm() - 0.1; };
    GridFluid<2> under(basin([&](const Point<2>& x) { return std::min(0.7 - x[1], hole(x)); }));
    run(under, 1);
    // Without a surface elsewhere the hole cannot fill; it stays as large, and rises.
    GridFluid<2> closed(basin(hole));
    run(closed, 1);
    CHECK(fastest(closed) < 5);
}

TEST_CASE("water that lands all at once: its impact's pressure lasts one step, the next is longer") {
    for (const int width : {1, 2}) {
        auto params = basin([](const Point<2>& x) { return std::min(x[1] - 1.5, 2.5 - x[1]); });
        params.grid = {.cells = {width, 64}, .spacing = {0.05, 0.05}};
        GridFluid<2> shaft(params);
        Real most = 0, energy = 0;
        while (shaft.time() < 2) {
            run(shaft, shaft.stable_step().seconds);
            most = std::max(most, fastest(shaft));
            energy = std::max(energy, shaft.kinetic_energy());
        }
        MESSAGE(width << " wide: fastest " << most << " m/s, freely " << std::sqrt(2 * g * 1.5));
        CHECK(energy < 1.05 * 1000 * g * 1.5 * width * 0.05);
    }
}

TEST_CASE("no water, then some: a dry bed that water flows onto") {
    auto params = basin({});
    params.boundaries[0] = {Boundary::inflow, Boundary::outflow};
    params.boundary_velocity = [](const Point<2>&, Real) { return Point<2>(1, 0); };
    GridFluid<2> dry(params);
    dry.advance(0.1);
    CHECK(dry.wet_cells() == 0);
    CHECK(dry.liquid().volume() == 0);
    params.inflow_water = [](const Point<2>& x) { return 0.25 - x[1]; };
    GridFluid<2> fills(params);
    CHECK(fills.wet_cells() == 0);
    fills.advance(0.15);
    CHECK(std::isfinite(fastest(fills)));
    // What has come in has the volume of the stream: none has left yet.
    CHECK(fills.liquid().volume() == doctest::Approx(0.15 * 0.25).epsilon(1e-12));
}

TEST_CASE("a single wet cell falls, lands and stays") {
    GridFluid<2> flow(
        basin([](const Point<2>& x) { return 0.6 / 32 - (x - Point<2>(16.5 / 32, 16.5 / 32)).norm(); }));
    CHECK(flow.wet_cells() == 1);
    run(flow, 1);
}

TEST_CASE("a closed box full of water keeps its energy, and pressure is known but for a constant") {
    auto params = basin([](const Point<2>&) { return 1.0; });
    params.velocity = [](const Point<2>& x) {
        return Point<2>(std::sin(pi * x[0]) * std::cos(pi * x[1]),
                        -std::cos(pi * x[0]) * std::sin(pi * x[1]));
    };
    GridFluid<2> flow(params);
    const Real energy = flow.kinetic_energy();
    run(flow, 1);
    MESSAGE("energy " << 100 * (flow.kinetic_energy() / energy - 1) << " %");
    CHECK(std::abs(flow.kinetic_energy() / energy - 1) < 0.01);
}

TEST_CASE("a pocket of water without a surface beside one that has one") {
    auto params = basin([](const Point<2>& x) { return x[0] < 0.5 ? 1.0 : 0.51 - x[1]; });
    params.wall = [](const Point<2>& x) { return std::abs(x[0] - 0.5) - 3.0 / 32; };
    GridFluid<2> flow(params);
    int most = 0;
    for (int k = 0; k < 30; ++k) {
        flow.step(flow.stable_step().seconds);
        most = std::max(most, flow.last_projection().iterations);
        REQUIRE(flow.last_projection().after <= params.tolerance);
    }
    MESSAGE("at most " << most << " iterations");
    CHECK(most <= 20);
    run(flow, 0.5);
    const auto p = [&](int k) { return flow.pressure()[flow.grid().layout().at({4, k})]; };
    CHECK(p(4) - p(20) == doctest::Approx(g * 0.5).epsilon(1e-4));
}

TEST_CASE("a film on the floor lies still") {
    auto params = basin([](const Point<2>& x) { return 0.015 - x[1]; });
    GridFluid<2> flow(params);
    flow.advance(2);
    CHECK(flow.kinetic_energy() < 1e-12);
    CHECK(flow.sample({0.5, 0, 0.01}, 0).velocity.norm() < 0.2);  // not g t
}

TEST_CASE("a dam takes its own first step at any Courant number that is allowed") {
    for (const Real courant : {0.5, 0.9, 1.0}) {
        auto params = basin([](const Point<2>& x) { return std::min(0.4 - x[0], 0.6 - x[1]); });
        params.courant = courant;
        GridFluid<2> flow(params);
        const Real volume = flow.liquid().volume();
        CHECK_NOTHROW(flow.advance(0.5));
        CHECK(std::abs(flow.liquid().volume() / volume - 1) < 1e-12);
    }
}

TEST_CASE(
    "a dam among cylinders whose gaps are two cells, and against a single one: no jets out of narrow faces") {
    const PlaceFunction<2> packing = [](const Point<2>& x) {
        Real distance = 1;
        for (int i = 0; i < 4; ++i)
            for (int k = 0; k < 3; ++k)
                distance = std::min(distance, (x - Point<2>(0.45 + 0.15 * i, 0.06 + 0.15 * k)).norm() - 0.05);
        return distance;
    };
    const PlaceFunction<2> cylinder = [](const Point<2>& x) {
        return (x - Point<2>(0.6, 0.1)).norm() - 0.12;
    };
    for (const auto& wall : {packing, cylinder})
        for (int k = 0; k < 8; ++k) {  // round-off decides which face is the fastest
            const Real height = 0.6 + 1e-7 * k;
            GridFluid<2> flow(
                {.grid = {.cells = {40, 40}, .spacing = {0.025, 0.025}},
                 .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                 .wall = wall,
                 .water = [=](const Point<2>& x) { return std::min(0.3 - x[0], height - x[1]); },
                 .gravity = {0, -g}});
            const Real volume = flow.liquid().volume(), energy = flow.params().density * g * 0.3 * 0.6 * 0.3;
            Real most = 0, fastest = 0;
            while (flow.time() < 1) {
                flow.step(flow.stable_step().seconds);
                most = std::max(most, flow.kinetic_energy());
                flow.grid().for_each([&](const CellNumber<2>&, Offset c) {
                    if (flow.liquid().fraction()[c] == 0) return;
                    for (const auto& u : flow.velocity()) fastest = std::max(fastest, std::abs(u[c]));
                });
            }
            MESSAGE("fastest " << fastest << " m/s, kinetic energy at most " << most / energy
                               << " of all of it");
            CHECK(most < 0.5 * energy);
            WARN(fastest < 3 * std::sqrt(2 * g * 0.6));  // single faces; falling makes 3.4 m/s
            CHECK(std::abs(flow.liquid().volume() / volume - 1) < 1e-12);
        }
}
