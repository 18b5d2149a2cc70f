// Uniform flow is let into the invert channel and should stay: depth, speed and profile by what eddies do.
#include "channel_water.hpp"

#include <doctest/doctest.h>

using namespace channel_water;

namespace {

/// Over the last 0.6 m. Dry at first.
template <class Turbulence>
Means channel_flow(Real length, Turbulence turbulence) {
    const Means uniform = wanted();
    Channel<Turbulence> flow(channel(length), turbulence);
    flow.advance(1 + 2 * length / uniform.speed);
    const Means mean = means(flow, length - 0.6, length);
    MESSAGE(length << " m, " << Turbulence::name << ": " << mean.depth << " m, " << mean.speed << " m/s; "
                   << mean.low << ", " << mean.high << " m/s; wanted " << uniform.depth << ", "
                   << uniform.speed << "; " << uniform.low << ", " << uniform.high << "; " << flow.steps()
                   << " steps");
    return mean;
}

}  // namespace

TEST_CASE("uniform flow in the invert channel stays with the mixing length") {
    for (const Real length : {1.0, 4.0}) {
        const Means uniform = wanted();
        const Means mixing = channel_flow(length, MixingLength{{.depth = uniform.depth}});
        CHECK(mixing.depth == doctest::Approx(uniform.depth).epsilon(0.02));
        CHECK(mixing.speed == doctest::Approx(uniform.speed).epsilon(0.02));
        const Means none = channel_flow(length, NoTurbulence{});
        const Means eddies = channel_flow(length, Smagorinsky{{.constant = 0.1}});
        if (length < 2) continue;
        // Why the main job takes the mixing length.
        CHECK(none.speed > mixing.speed);
        CHECK(none.speed > eddies.speed);
        CHECK(eddies.speed > mixing.speed);
    }
}
