// Uniform flow is let into the invert channel and should stay: depth, speed and profile by what eddies do.
#include <abrade/fluid/grid_fluid.hpp>
#include <abrade/fluid/inflow.hpp>
#include <abrade/fluid/uniform_flow.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace abrade;

namespace {

/// Means over the last 0.6 m, and Manning's.
struct Flow {
    Real depth = 0, speed = 0, low = 0, high = 0;  ///< [m], [m/s]; 0.03 and 0.16 m above the centre line
};

Flow uniform_flow(Real length) {
    Invert invert;
    invert.length = length;
    const UniformFlow flow{{.section = invert, .discharge = 0.5, .manning = 0.015}};
    const auto at = [&](Real z) { return flow.sample({0, 0, z}, 0).velocity.x(); };
    return {flow.depth(), flow.mean_velocity(), at(0.03), at(0.16)};
}

/// Dry at first, in cells of 0.02 m.
template <class Turbulence>
Flow channel_flow(Real length, Turbulence turbulence) {
    constexpr Real spacing = 0.02, mean_over = 0.6;
    Invert invert;
    invert.length = length;
    const Flow wanted = uniform_flow(length);
    const Real rough = std::pow(26 * 0.015, 6);
    const auto cells = [](Real l) { return static_cast<int>(std::lround(l / spacing)); };
    GridFluidParams<3> params{.grid = {.cells = {cells(length), cells(invert.width), 19},
                                       .low = {0, -0.5 * invert.width, 0},
                                       .spacing = Vec3::Constant(spacing)},
                              .sides = Sides<3>::all(Side::slip),
                              .wall = InvertWall(invert),
                              .wall_law = {WallLaw::Kind::logarithmic, rough},
                              .gravity = invert.gravity(),
                              .tolerance = 1e-5};
    params.sides[0][1] = Side::outflow;
    Inflow<3>({.discharge = 0.5,
               .depth = wanted.depth,
               .section = invert,
               .profile = InflowProfile::logarithmic,
               .roughness = rough})
        .give_to(params);
    GridFluid<3, FreeSurface, Limited, Real, Turbulence> flow(params, turbulence);
    flow.advance(1 + 2 * length / wanted.speed);

    const Grid<3>& grid = flow.grid();
    Flow mean;
    int sections = 0;
    for (int i = cells(length - mean_over); i < grid.cells(0); ++i, ++sections) {
        Real area = 0, discharge = 0;
        for (int j = 0; j < grid.cells(1); ++j)
            for (int k = 0; k < grid.cells(2); ++k) {
                const Offset c = grid.layout().at({i, j, k}), next = c + grid.layout().stride[0];
                const Real wet = flow.liquid().fraction()[c] * flow.walls()->open_volume()[c];
                area += wet;
                discharge += wet * 0.5 * (flow.velocity()[0][c] + flow.velocity()[0][next]);
            }
        const Real x = grid.centre(0, i);
        mean.depth += flow.surface_at({x, 0, 0}), mean.speed += discharge / area;
        mean.low += flow.sample({x, 0, 0.03}, 0).velocity.x();
        mean.high += flow.sample({x, 0, 0.16}, 0).velocity.x();
    }
    for (Real* value : {&mean.depth, &mean.speed, &mean.low, &mean.high}) *value /= sections;
    MESSAGE(length << " m, " << Turbulence::name << ": " << mean.depth << " m, " << mean.speed << " m/s; "
                   << mean.low << ", " << mean.high << " m/s; wanted " << wanted.depth << ", " << wanted.speed
                   << "; " << wanted.low << ", " << wanted.high << "; " << flow.steps() << " steps");
    return mean;
}

}  // namespace

TEST_CASE("uniform flow in the invert channel stays with the mixing length") {
    for (const Real length : {1.0, 4.0}) {
        const Flow wanted = uniform_flow(length);
        const Flow mixing = channel_flow(length, MixingLength{.depth = wanted.depth});
        CHECK(mixing.depth == doctest::Approx(wanted.depth).epsilon(0.02));
        CHECK(mixing.speed == doctest::Approx(wanted.speed).epsilon(0.02));
        const Flow none = channel_flow(length, NoTurbulence{});
        const Flow eddies = channel_flow(length, Smagorinsky{.constant = 0.1});
        if (length < 2) continue;
        // Why the main job takes the mixing length.
        CHECK(none.speed > mixing.speed);
        CHECK(none.speed > eddies.speed);
        CHECK(eddies.speed > mixing.speed);
    }
}
