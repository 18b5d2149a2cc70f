// Steps of any length, one after the other: who asks for a result at a given time ends with a step that may
// be next to nothing, and goes on with a whole one.
#include "../verification/channel_water.hpp"

#include <doctest/doctest.h>

#include <memory>
#include <stdexcept>

using namespace channel_water;

namespace {

Real fastest(const Channel<>& flow) { return detail::FastFace<3>(flow.grid(), flow.velocity()).speed; }

/// As far as possible until each multiple of `every`, and `more` beyond it, if that is stable.
template <class Fluid>
void go(Fluid& flow, Real end, Real every, Real more) {
    for (Real until = every; until < end + 0.5 * every; until += every) {
        while (flow.time() < until) flow.step(std::min(flow.stable_step().seconds, until - flow.time()));
        if (more > 0) flow.step(std::min(more, flow.stable_step().seconds));
    }
}

/// Steps that grow from a share of the stable one to all of it, over and over.
void grow(auto& flow, Real end, Real least, Real by) {
    for (Real share = least; flow.time() < end; share = share >= 1 ? least : std::min(1.0, share * by))
        flow.step(share * flow.stable_step().seconds);
}

}  // namespace

TEST_CASE("a channel that fills takes steps of any length") {
    const auto run = [](Real more) {
        Channel<> flow(channel(0.5), MixingLength{{.depth = wanted().depth}});
        go(flow, 0.1, 0.004, more);
        return flow;
    };
    const Channel<> even = run(0);
    const Means of_even = means(even, 0.1, 0.3);
    for (const Real more : {1e-3, 1e-4, 1e-6, 1e-9, 1e-15}) {
        CAPTURE(more);
        const Channel<> flow = run(more);
        CHECK(fastest(flow) < 1.2 * fastest(even));
        CHECK(flow.liquid().volume() ==
              doctest::Approx(even.liquid().volume() / even.time() * flow.time()).scale(0).epsilon(1e-4));
        if (more < 1e-3)
            CHECK(means(flow, 0.1, 0.3).speed == doctest::Approx(of_even.speed).scale(0).epsilon(0.01));
    }
}

namespace {

/// A block of 0.2 m, 1 m up, that falls.
GridFluidParams<2> block_params(Real speed = 0) {
    return {
        .grid = {.cells = {20, 60}, .spacing = {0.02, 0.02}},
        .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
        .water = [](const Point<2>& x) { return 0.1 - std::max(std::abs(x[0] - 0.2), std::abs(x[1] - 1.0)); },
        .velocity = [speed](const Point<2>&) { return Point<2>(0, -speed); },
        .gravity = {0, -9.81},
        .largest_step = 4e-3};
}

Real fallen(const GridFluid<2>& flow) {
    Real height = 0;
    flow.grid().for_each([&](const CellNumber<2>& cell, Offset c) {
        height += flow.liquid().fraction()[c] * square(0.02) * flow.grid().centre(1, cell[1]);
    });
    return 1.0 - height / flow.liquid().volume();
}

}  // namespace

TEST_CASE("where water has left nothing moves any more") {
    for (const bool around : {false, true}) {
        CAPTURE(around);
        auto params = block_params();
        params.velocity = [](const Point<2>&) { return Point<2>(0.3, -1); };
        if (around) params.boundaries[0] = {Boundary::periodic, Boundary::periodic};
        GridFluid<2> flow(params);
        flow.advance(0.25);
        const Real above = 1.1 - fallen(flow) + 6 * 0.02;  // its upper side, what is carried on outward
        REQUIRE(above < 0.9);
        Real fastest = 0;
        flow.grid().for_each([&](const CellNumber<2>& cell, Offset c) {
            if (flow.grid().centre(1, cell[1]) > above)
                for (const auto& u : flow.velocity()) fastest = std::max(fastest, std::abs(u[c]));
        });
        CHECK(fastest == 0);
    }
}

TEST_CASE("what falls falls as fast, whatever steps it takes") {
    for (const int regular : {0, 1, 2, 5, 10}) {
        CAPTURE(regular);
        GridFluid<2> flow(block_params());
        for (int n = 1; flow.time() < 0.3; ++n) {
            const bool brief = regular > 0 && n % (regular + 1) == 0;
            flow.step(brief ? 1e-9 : std::min(flow.stable_step().seconds, 0.3 - flow.time() + 1e-12));
        }
        CHECK(fallen(flow) == doctest::Approx(0.5 * 9.81 * square(0.3)).scale(0).epsilon(0.015));
    }
}

// The velocity leads by half a step: that must not make of a step in which no cell loses all of its water one
// in which it does.
TEST_CASE("what falls may take short and long steps in turn") {
    const Real speed = 2;
    GridFluid<2> flow(block_params(speed));
    const auto step = [&](Real share) { flow.step(share * flow.stable_step().seconds); };
    while (flow.time() < 0.1) step(0.4), step(1);
    const Real t = flow.time(), expected = speed * t + 0.5 * 9.81 * square(t);
    CHECK(std::abs(fallen(flow) - expected) < 0.5 * 0.02);  // half a cell
}

TEST_CASE("an equal step that goes wrong, then shorter ones: the velocity still leads by half of them") {
    const auto fall = [](bool goes_wrong) {
        auto fails = std::make_shared<bool>(false);
        GridFluidParams<2> params = block_params();
        params.body_force = [fails](Real) {
            if (*fails) throw std::runtime_error("no force");
            return Point<2>(0, 0);
        };
        GridFluid<2> flow(params);
        for (int n = 0; n < 20; ++n) flow.step(4e-3);
        if (*fails = goes_wrong; goes_wrong) CHECK_THROWS(flow.step(4e-3));
        *fails = false;
        for (int n = 0; n < 100; ++n) flow.step(1e-3);
        return fallen(flow);
    };
    CHECK(fall(true) == doctest::Approx(fall(false)).scale(0).epsilon(1e-3));
}

TEST_CASE("steps that grow, over and over: a stream through an outflow") {
    const auto run = [](Real least, Real by) {
        GridFluidParams<2> params{.grid = {.cells = {50, 20}, .spacing = {0.02, 0.02}},
                                  .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                                  .gravity = {0.49, -9.8}};
        params.boundaries[0][1] = Boundary::outflow;
        Inflow<2>({.discharge = 0.6, .depth = 0.18}).give_to(params);
        GridFluid<2> flow(params);
        grow(flow, 0.5, least, by);
        return flow.kinetic_energy();
    };
    const Real regular = run(1, 1);
    for (const Real least : {0.1, 1e-3, 1e-5})
        for (const Real by : {1.5, 2.0, 3.9}) {
            CAPTURE(least);
            CAPTURE(by);
            CHECK(run(least, by) == doctest::Approx(regular).scale(0).epsilon(0.02));
        }
}

TEST_CASE("full boxes: a cavity, a channel with an outflow") {
    const auto cavity = [](Real more) {
        GridFluid<2, FullBox> flow(
            {.grid = {.cells = {32, 32}, .spacing = Point<2>::Constant(1.0 / 32)},
             .boundary_velocity = [](const Point<2>& x,
                                     Real) { return Point<2>(x[1] > 1 - 1e-9 ? 1 : 0, 0); },
             .density = 1,
             .viscosity = 1e-2,
             .tolerance = 1e-6});
        go(flow, 2, 0.05, more);
        return flow.kinetic_energy();
    };
    const auto duct = [](auto&& steps) {
        GridFluidParams<2> params{
            .grid = {.cells = {40, 20}, .spacing = {0.05, 0.05}},
            .boundaries = BoundaryConditions<2>::all(Boundary::wall),
            .boundary_velocity = [](const Point<2>& x, Real) { return Point<2>(x[0] < 1e-9 ? 1 : 0, 0); },
            .density = 1,
            .viscosity = 1e-2,
            .tolerance = 1e-9};
        params.boundaries[0] = {Boundary::inflow, Boundary::outflow};
        GridFluid<2, FullBox> flow(params);
        steps(flow);
        return flow.kinetic_energy();
    };
    const auto and_more = [](Real more) { return [more](auto& flow) { go(flow, 1, 0.02, more); }; };
    const Real in_cavity = cavity(0), in_duct = duct(and_more(0));
    for (const Real more : {1e-3, 1e-5, 1e-9, 1e-15}) {
        CAPTURE(more);
        CHECK(cavity(more) == doctest::Approx(in_cavity).scale(0).epsilon(more > 1e-4 ? 1e-3 : 1e-5));
        CHECK(duct(and_more(more)) == doctest::Approx(in_duct).scale(0).epsilon(1e-4));
    }
    for (const Real least : {0.1, 1e-3, 1e-5})
        for (const Real by : {2.0, 3.9}) {
            CAPTURE(least);
            CAPTURE(by);
            CHECK(duct([&](auto& flow) { grow(flow, 1, least, by); }) ==
                  doctest::Approx(in_duct).scale(0).epsilon(2e-3));
        }
}
