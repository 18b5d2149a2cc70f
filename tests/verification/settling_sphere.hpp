#pragma once
// A sphere settles in a closed box of oil, through the whole engine: A. ten Cate et al. 2002,
// doi:10.1063/1.1512918.

#include "reference_table.hpp"

#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/sim/simulation.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace settling_sphere {

using namespace abrade;

constexpr Real diameter = 0.015;  // [m]

/// At rest; `cells`: to the sphere's diameter.
template <class Solids>
auto oil(const ReferenceRow& row, Real cells, Solids solids) {
    using Oil = GridFluid<3, Among<Solids, FullBox>>;
    const Real h = diameter / cells;
    const int across = static_cast<int>(std::ceil(0.1 / h)), up = static_cast<int>(std::ceil(0.16 / h));
    return Oil(
        {.grid = {.cells = {across, across, up}, .spacing = Vec3(0.1 / across, 0.1 / across, 0.16 / up)},
         .boundaries = BoundaryConditions<3>::all(Boundary::wall),
         .gravity = {0, 0, -9.81},
         .density = row.at("rho_f"),
         .viscosity = row.at("mu_f")},
        {}, std::move(solids));
}

struct Peak {
    Real speed = 0;     ///< the fastest [m/s]
    Real residual = 0;  ///< the ledger's largest [-]
};
inline const Vec3 middle(0.05, 0.05, 0.1275);  // [m]
/// From a place; `fluid`: and a drag law where it needs one; `ended(sim)`.
Peak settle_from(const Vec3& place, Real end, auto&& ended, auto... fluid) {
    Scene scene;
    scene.gravity = {0, 0, -9.81};
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    scene.add_sphere(0.5 * diameter, {.position = place}, 1120);
    auto sim = simulate(scene)
                   .contact(LinearSpring{{.stiffness = 1000, .restitution = 0.5}})
                   .fluid(std::move(fluid)...);
    Peak peak;
    sim.run({.end_time = end, .observe_every = 0.02}, [&](const auto& now) {
        peak.speed = std::max(peak.speed, -now.particles().velocity[0].z());
        peak.residual = std::max(peak.residual, now.ledger().residual_relative());
    });
    ended(sim);
    return peak;
}
Peak settle(Real end, auto&& ended, auto... fluid) {
    return settle_from(middle, end, ended, std::move(fluid)...);
}

}  // namespace settling_sphere
