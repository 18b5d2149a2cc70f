// Grid water in a box that moves: a body force that changes in time, in a full box and below a surface.
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

#include <stdexcept>

#include "../message_of.hpp"

using namespace abrade;

namespace {

constexpr Real g = 9.81;

GridFluid<2>::Params basin(PlaceFunction<2> water) {
    return {.grid = {.cells = {16, 16}, .spacing = Point<2>::Constant(1.0 / 16)},
            .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
            .water = std::move(water),
            .gravity = {0, -g},
            .tolerance = 1e-10};
}

}  // namespace

TEST_CASE("a full box without ends moves as its force tells, to second order in the step") {
    const auto error_of = [](int pairs) {
        GridFluid<2, FullBox> flow({.grid = {.cells = {8, 8}, .spacing = Point<2>::Constant(0.125)},
                                    .boundaries = BoundaryConditions<2>::all(Boundary::periodic),
                                    .body_force = [](Real t) { return Point<2>(3 * std::cos(2 * t), 0); },
                                    .courant = 1});
        for (int k = 0; k < pairs; ++k) flow.step(0.4 / pairs), flow.step(0.6 / pairs);
        return std::abs(flow.velocity()[0][flow.grid().layout().at({3, 3})] - 1.5 * std::sin(2.0));
    };
    const Real coarse = error_of(15), fine = error_of(30);
    MESSAGE("errors " << coarse << ", " << fine << " m/s");
    CHECK(fine < 2e-3);
    CHECK(std::log2(coarse / fine) > 1.9);
}

TEST_CASE("a lift: water rests, its pressure is what it weighs at that time, from the start") {
    auto params = basin([](const Point<2>& x) { return 0.53 - x[1]; });
    const auto lift = [](Real t) { return Point<2>(0, -2 - 3 * std::sin(5 * t)); };
    params.body_force = lift;
    params.start_time = 0.1;
    params.largest_step = 0.01;  // what the pressure errs by is of fourth order: 1e-4 of it at 0.05 s
    GridFluid<2> flow(params);
    const Offset c = flow.grid().layout().at({5, 2});
    const auto weighs = [&] { return (g - lift(flow.time())[1]) * (0.53 - 2.5 / 16); };
    CHECK(flow.pressure()[c] == doctest::Approx(weighs()).epsilon(1e-6).scale(0));
    for (int k = 0; k < 100; ++k) {
        flow.step(flow.stable_step().seconds);
        REQUIRE(flow.pressure()[c] == doctest::Approx(weighs()).epsilon(1e-5).scale(0));
    }
    for (const auto& u : flow.velocity())
        flow.grid().for_each([&](const auto&, Offset cell) { REQUIRE(std::abs(u[cell]) < 1e-6); });
}

TEST_CASE("a steady body force is gravity, bit by bit") {
    auto params = basin([](const Point<2>& x) { return std::min(0.4 - x[0], 0.6 - x[1]); });
    params.gravity = {1, -g};
    GridFluid<2> flow(params);
    params.gravity = {0, -g};
    params.body_force = [](Real) { return Point<2>(1, 0); };
    GridFluid<2> same(params);
    flow.advance(0.2), same.advance(0.2);
    CHECK(flow.steps() == same.steps());
    flow.grid().for_each([&](const auto&, Offset c) {
        REQUIRE(flow.velocity()[0][c] == same.velocity()[0][c]);
        REQUIRE(flow.pressure()[c] == same.pressure()[c]);
    });
}

TEST_CASE("a force that is no number is refused") {
    auto params = basin([](const Point<2>& x) { return 0.5 - x[1]; });
    params.body_force = [](Real t) { return Point<2>(0, 1 / t); };
    CHECK(message_of([&] {
              GridFluid<2> flow(params);
          }).starts_with("GridFluid.body_force.z must be finite, got inf m/s2"));
    params.start_time = 1;
    params.body_force = [](Real t) { return Point<2>(t > 1.1 ? std::nan("") : 0, 0); };
    GridFluid<2> flow(params);
    const std::string message = message_of<FluidError>([&] { flow.advance(2); });
    MESSAGE(message);
    CHECK(message.find("GridFluid.body_force.x at t = 1.1") != std::string::npos);
    CHECK(message.find("must be finite, got nan m/s2") != std::string::npos);
    flow.step(1.09 - flow.time());  // as it was: it goes on from there
    CHECK(flow.time() == doctest::Approx(1.09));
}

TEST_CASE("after a step that went wrong it goes on as if that had not been") {
    auto params = basin([](const Point<2>& x) { return 0.5 + 0.1 * x[0] - x[1]; });
    Real fails_after = 1e9;
    params.body_force = [&fails_after](Real t) {
        if (t > fails_after) throw std::runtime_error("no force");
        return Point<2>(5 * std::sin(3 * t), 0);
    };
    GridFluid<2> flow(params), other(params);
    for (int again = 0; again < 3; ++again) {
        CHECK_THROWS_AS(flow.step(100), FluidError);
        fails_after = flow.time();  // once the liquid has moved
        CHECK_THROWS_AS(flow.step(0.005), FluidError);
        fails_after = 1e9;
        for (const Real dt : {0.005, 0.008, 0.006}) flow.step(dt), other.step(dt);
    }
    // What is put back is put together anew: the same but for single precision.
    flow.grid().for_each([&](const auto&, Offset c) {
        REQUIRE(std::abs(flow.liquid().fraction()[c] - other.liquid().fraction()[c]) < 1e-7);
        REQUIRE(std::abs(flow.pressure()[c] - other.pressure()[c]) < 1e-6 * g);
    });
}
