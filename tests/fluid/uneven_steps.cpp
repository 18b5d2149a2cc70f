// Steps of any length, one after the other: who asks for a result at a given time ends with a step that may
// be next to nothing, and goes on with a whole one.
#include "../verification/channel_water.hpp"

#include <doctest/doctest.h>

using namespace channel_water;

namespace {

Real fastest(const Channel<>& flow) { return detail::FastFace<3>(flow.grid(), flow.velocity()).speed; }

/// As far as possible until each multiple of `every`, and `more` beyond it.
template <class Fluid>
void go(Fluid& flow, Real end, Real every, Real more) {
    for (Real until = every; until < end + 0.5 * every; until += every) {
        while (flow.time() < until) flow.step(std::min(flow.stable_step().seconds, until - flow.time()));
        if (more > 0) flow.step(more);
    }
}

}  // namespace

TEST_CASE("a channel that fills takes steps of any length") {
    const auto run = [](Real more) {
        Channel<> flow(channel(0.5), {.depth = wanted().depth});
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
              doctest::Approx(even.liquid().volume() / even.time() * flow.time()).epsilon(1e-5));
        if (more < 1e-3) CHECK(means(flow, 0.1, 0.3).speed == doctest::Approx(of_even.speed).epsilon(0.01));
    }
}

TEST_CASE("so does a cavity") {
    const auto run = [](Real more) {
        GridFluid<2, FullBox> flow(
            {.grid = {.cells = {32, 32}, .spacing = Point<2>::Constant(1.0 / 32)},
             .side_velocity = [](const Point<2>& x, Real) { return Point<2>(x[1] > 1 - 1e-9 ? 1 : 0, 0); },
             .density = 1,
             .viscosity = 1e-2,
             .tolerance = 1e-6});
        go(flow, 2, 0.05, more);
        return flow.sample({0.5, 0, 0.2}, 0).velocity.x();
    };
    const Real even = run(0);
    for (const Real more : {1e-3, 1e-6, 1e-9, 1e-15}) {
        CAPTURE(more);
        CHECK(run(more) == doctest::Approx(even).epsilon(more > 1e-4 ? 0.02 : 1e-4));
    }
}
