// 4.5 m of the channel of the validation below a surface that is a height, beside volume of fluid: depth,
// speed and what a step costs. Begun with uniform flow, 3 s.
#include <abrade/fluid/momentum/turbulence.hpp>

#include <doctest/doctest.h>

#include "channel_water.hpp"

#include <chrono>

using namespace channel_water;

namespace {

struct Ran {
    Means means;
    Real discharge = 0;  ///< that leaves [m3/s]
    Index steps = 0;
    Real per_step = 0;  ///< [s]
};

template <class Surface>
Ran run(Real courant) {
    constexpr Real length = 4.5;
    GridFluidParams<3> params = channel(length, true);
    params.courant = courant;
    GridFluid<3, Turbulent<MixingLength, Surface>> flow(params,
                                                        MixingLength{{.depth = uniform_flow().depth()}});
    const auto begin = std::chrono::steady_clock::now();
    flow.advance(3);
    const std::chrono::duration<Real> took = std::chrono::steady_clock::now() - begin;
    return {means(flow, length - 0.8, length - 0.2), section(flow, flow.grid().cells(0) - 3).discharge,
            flow.steps(), took.count() / static_cast<Real>(flow.steps())};
}

}  // namespace

TEST_CASE("the channel below a surface that is a height runs as below volume of fluid") {
    const Ran planes = run<FreeSurface>(0.5), height = run<HeightSurface>(0.5),
              longer = run<HeightSurface>(0.8);
    const auto tell = [](const std::string& name, const Ran& r) {
        MESSAGE(name << ": depth " << r.means.depth << " m, speed " << r.means.speed << " m/s, "
                     << r.means.low << " and " << r.means.high << " m/s at 0.03 and 0.16 m, " << r.discharge
                     << " m3/s leave; " << r.steps << " steps of " << 1000 * r.per_step << " ms");
    };
    tell("FreeSurface", planes), tell("HeightSurface", height), tell("HeightSurface, courant 0.8", longer);
    for (const Ran* r : {&height, &longer}) {
        // The bed is the same, the surface nearly level: what differs is the last cell below it.
        CHECK(r->means.depth == doctest::Approx(planes.means.depth).epsilon(0.002));
        CHECK(r->means.speed == doctest::Approx(planes.means.speed).epsilon(0.002));
        CHECK(r->discharge == doctest::Approx(discharge).epsilon(0.002));
    }
    CHECK(longer.steps < 0.7 * planes.steps);
}
