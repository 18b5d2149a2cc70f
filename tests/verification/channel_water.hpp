#pragma once
// Clear water in the channel of the validation: an arc of rough concrete at 1:20 that takes 0.5 m3/s, in
// cells of 0.02 m. Uniform flow by Manning's formula and the logarithmic law is let in, and should stay.

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/setup/inflow.hpp>
#include <abrade/fluid/uniform_flow.hpp>

#include <cmath>

namespace channel_water {

using namespace abrade;

template <class Turbulence = MixingLength>
using Channel = GridFluid<3, Turbulent<Turbulence>>;

constexpr Real spacing = 0.02, discharge = 0.5, manning = 0.015;  ///< [m], [m3/s], [s/m^(1/3)]

inline UniformFlow uniform_flow(Real length = 1) {
    Invert invert;
    invert.length = length;
    return UniformFlow{{.section = invert, .discharge = discharge, .manning = manning}};
}

/// Of eddies, for this depth.
inline MixingLength mixing_length() {
    const UniformFlow uniform = uniform_flow();
    return MixingLength{{.depth = uniform.depth(), .friction_velocity = uniform.friction_velocity()}};
}

/// Begun dry, or full of uniform flow.
inline GridFluidParams<3> channel(Real length, bool full = false) {
    const UniformFlow uniform = uniform_flow(length);
    const Invert& invert = uniform.params().section;
    const Real depth = uniform.depth(), roughness = std::pow(26 * manning, 6);
    const auto cells = [](Real l) { return static_cast<int>(std::lround(l / spacing)); };
    GridFluidParams<3> params{.grid = {.cells = {cells(length), cells(invert.width), 19},
                                       .low = {0, -0.5 * invert.width, 0},
                                       .spacing = Vec3::Constant(spacing)},
                              .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                              .wall = InvertWall(invert),
                              .wall_law = {WallLaw::Kind::logarithmic, roughness},
                              .gravity = invert.gravity(),
                              .tolerance = 1e-5};
    params.boundaries[0][1] = Boundary::outflow;
    Inflow<3>({.discharge = discharge,
               .depth = depth,
               .section = invert,
               .profile = InflowProfile::logarithmic,
               .roughness = roughness})
        .give_to(params);
    if (!full) return params;
    params.water = [depth](const Vec3& x) { return depth - x.z(); };
    params.velocity = [uniform, depth](const Vec3& x) {
        return Vec3(uniform.sample({0, x.y(), std::min(x.z(), depth)}, 0).velocity.x(), 0, 0);
    };
    return params;
}

/// Water that stands in the cells of number i along the channel, and runs through them.
struct Section {
    Real area = 0, discharge = 0;  ///< [m2], [m3/s]
    Real speed() const { return discharge / area; }
};

template <class Fluid>
Section section(const Fluid& flow, int i) {
    const Grid<3>& grid = flow.grid();
    Section s;
    for (int j = 0; j < grid.cells(1); ++j)
        for (int k = 0; k < grid.cells(2); ++k) {
            const Offset c = grid.layout().at({i, j, k}), next = c + grid.layout().stride[0];
            const Real wet = square(spacing) * flow.liquid().fraction()[c] * flow.walls()->open_fraction()[c];
            s.area += wet;
            s.discharge += wet * 0.5 * (flow.velocity()[0][c] + flow.velocity()[0][next]);
        }
    return s;
}

/// Means over part of the channel.
struct Means {
    Real depth = 0, speed = 0;  ///< at the centre line [m], of the sections [m/s]
    Real low = 0, high = 0;     ///< speeds 0.03 and 0.16 m above the centre line [m/s]
};

template <class Fluid>
Means means(const Fluid& flow, Real from, Real to) {
    Means mean;
    int sections = 0;
    for (int i = 0; i < flow.grid().cells(0); ++i) {
        const Real x = flow.grid().centre(0, i);
        if (x < from || x > to) continue;
        mean.depth += flow.surface_at({x, 0, 0}), mean.speed += section(flow, i).speed();
        mean.low += flow.sample({x, 0, 0.03}, 0).velocity.x();
        mean.high += flow.sample({x, 0, 0.16}, 0).velocity.x();
        ++sections;
    }
    for (Real* value : {&mean.depth, &mean.speed, &mean.low, &mean.high}) *value /= sections;
    return mean;
}

/// What Manning's formula and the logarithmic law want.
inline Means wanted() {
    const UniformFlow flow = uniform_flow();
    const auto at = [&](Real z) { return flow.sample({0, 0, z}, 0).velocity.x(); };
    return {flow.depth(), flow.mean_velocity(), at(0.03), at(0.16)};
}

}  // namespace channel_water
