#pragma once
// A sphere that settles in wide still water: N. Mordant & J.-F. Pinton 2000, doi:10.1007/PL00011074.

#include "../coupling/resolved_bodies.hpp"
#include "reference_table.hpp"

#include <limits>

namespace settling_in_water {

using namespace resolved;

struct Settled {
    Real speed = 0;  ///< the fastest [m/s]
    Real tau95 = 0;  ///< of the fit v = V (1 - exp(-3 t / tau95)) to the whole way, as the source has it [s]
    Real at_95 = 0;  ///< when the sphere has 95 % of its fastest [s]
};
/// From rest through 15 diameters, in a box 8 wide whose sides let the water glide.
inline Settled settle(const ReferenceRow& row, Real cells) {
    const Real diameter = row.at("d_m"), h = diameter / cells;
    const int n = static_cast<int>(std::round(8 * cells)), up = static_cast<int>(std::round(20 * cells));
    Water water({.grid = {.cells = {n, n, up}, .spacing = Vec3::Constant(h)},
                 .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                 .gravity = {0, 0, -9.81},
                 .density = 1000,
                 .viscosity = 1000 * row.at("nu_m2s")},
                {}, MonolithicSolids<>({.resolved_from = 0}));
    std::vector<Ball> balls{
        {Vec3(4, 4, 17.5) * diameter + h * Vec3(0.3, 0.1, 0), 0.5 * diameter, row.at("rho_p")}};
    std::vector<std::pair<Real, Real>> speeds;
    while (balls[0].body.position.z() > 2.5 * diameter) {
        step(water, balls, water.stable_step().seconds);
        speeds.push_back({water.time(), -balls[0].body.velocity.z()});
    }
    Settled settled;
    for (const auto& [time, speed] : speeds) settled.speed = std::max(settled.speed, speed);
    Real least = std::numeric_limits<Real>::infinity();
    for (Real tau = 0.5 * row.at("tau95_s"); tau < 2 * row.at("tau95_s"); tau *= 1.002) {
        Real sum = 0, before = 0;
        for (const auto& [time, speed] : speeds)
            sum += (time - before) * square(speed - settled.speed * (1 - std::exp(-3 * time / tau))),
                before = time;
        if (sum < least) least = sum, settled.tau95 = tau;
    }
    for (const auto& [time, speed] : speeds)
        if (settled.at_95 == 0 && speed > 0.95 * settled.speed) settled.at_95 = time;
    return settled;
}

}  // namespace settling_in_water
