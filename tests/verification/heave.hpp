#pragma once
// A sphere of half the water's density that heaves at the surface of a pool.

#include "../coupling/resolved_bodies.hpp"
#include "reference_table.hpp"

namespace heave {

using namespace resolved;

using Pool = GridFluid<3, Among<MonolithicSolids<>, HeightSurface>>;

/// Added mass of a floating hemisphere as it heaves, over the water in its place: 0.83 for long waves, 0.5
/// for short ones, some 0.42 at its own frequency (A. Hulme 1982, doi:10.1017/S0022112082001980).
constexpr Real added_mass = 0.5;

/// Of a floating sphere's damped motion [sqrt(R / g)].
inline Real period_of(const ReferenceRow& row) {
    return 2 * pi / row.at("omega_sqrt(R/g)_no_added_mass") * std::sqrt(1 + added_mass);
}

struct Heave {
    Real period = 0;  ///< of the motion about its draft at rest [sqrt(R / g)]
    Real decay = 0;   ///< of an amplitude, within half a period [-]
};
/// Let go a fifth of its radius above its place at rest, in a pool 12 radii wide and 6 deep: its waves take
/// more than a period to the sides and back. The surface lies `off` cells above a face, and steps are
/// `step_of` sqrt(R / g): the water alone allows 0.4, too long for a body that swings.
inline Heave heave_of(Real ratio, Real cells, Real off, Real step_of = 0.025) {
    constexpr Real radius = 0.1, g = 9.81;
    const Real h = 2 * radius / cells, level = 6 * radius + off * h;
    const int n = static_cast<int>(std::round(6 * cells)), up = static_cast<int>(std::round(4.5 * cells));
    Pool water({.grid = {.cells = {n, n, up}, .spacing = Vec3::Constant(h)},
                .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                .water = [level](const Vec3& x) { return level - x.z(); },
                .gravity = {0, 0, -g},
                .density = 1000,
                .viscosity = 1e-3,
                .largest_step = step_of * std::sqrt(radius / g),
                .tolerance = 1e-8},
               {}, MonolithicSolids<>({.resolved_from = 0}));
    const Vec3 middle(0.5 * n * h + 0.3 * h, 0.5 * n * h + 0.1 * h, level);
    std::vector<Ball> balls{{middle + Vec3(0, 0, 0.2 * radius), radius, 1000 * ratio}};
    const Real rests = level;  // the draft of half the water's density
    Real before = balls[0].body.position.z() - rests, low = 0, high = 0;
    std::vector<Real> crosses;
    while (crosses.size() < 3 && water.time() < 20 * std::sqrt(radius / g)) {
        FlowBody& body = balls[0].body;
        body.velocity.head<2>().setZero(), body.load.force.head<2>().setZero();
        const Real dt = water.stable_step().seconds;
        step(water, balls, dt);
        const Real now = balls[0].body.position.z() - rests;
        if (now * before < 0) crosses.push_back(water.time() - dt * now / (now - before));
        low = std::min(low, now);
        if (crosses.size() == 2) high = std::max(high, now);
        before = now;
    }
    if (crosses.size() < 3) return {};
    return {(crosses[2] - crosses[0]) * std::sqrt(g / radius), -high / low};
}

}  // namespace heave
