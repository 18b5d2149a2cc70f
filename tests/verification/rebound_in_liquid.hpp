#pragma once
// A sphere falls onto a floor in a liquid and comes back, through the whole engine.

#include <abrade/coupling/exchange/monolithic.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/dem/laws/lubrication.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/sim/simulation.hpp>

#include <algorithm>
#include <cmath>

namespace rebound_in_liquid {

using namespace abrade;

/// Restitution in the liquid over that without it, St = 1/9 rho_s / rho_f Re: fit to experiments with spheres
/// and drops, D. Legendre, C. Daniel & P. Guiraud 2005, Phys. Fluids 17, 097105; solid spheres of P. Gondret,
/// M. Lance & L. Petit 2002, doi:10.1063/1.1427920, come back from St = 10 on.
inline Real legendre(Real stokes) { return std::exp(-35 / stokes); }

struct Fall {
    Real stokes = 100;   ///< at the speed of the fall
    Real cells = 4;      ///< to the diameter
    Real ratio = 7.8;    ///< of densities
    Real step = 0;       ///< the water's longest over the contact's duration [-]; 0: what is stable
    Real roughness = 0;  ///< over the radius, of a film from a cell on [-]; 0: no film below the grid
    Vec3 off{0, 0, 0};   ///< of the centre from a corner of cells, and of the floor [cell]
};

/// Speeds are those a fifth of a diameter above the floor: there the water has had its exchange after the
/// contact, whether its steps are longer than that or not.
struct Rebound {
    Real stokes = 0;    ///< as it comes
    Real wet = 0;       ///< speed after the contact over that before it, over the same without liquid [-]
    Index steps = 0;    ///< of the water, until it comes [-]
    Real residual = 0;  ///< of the ledger [-]
    Real film = 0;      ///< lost below the grid [J]
};

/// From 3 diameters above the floor, at the speed at which its weight and its drag are equal, in a box 5
/// diameters wide whose sides let the liquid glide. The contact gives way by a hundredth of a diameter.
inline Rebound rebound(const Fall& fall) {
    using Flow = GridFluid<3, Among<MonolithicSolids<>, FullBox>>;
    constexpr Real diameter = 0.01, rho = 1000, g = 9.81, dry = 0.97, above = 0.7 * diameter;
    const Real reynolds = 9 * fall.stokes / fall.ratio;
    const Real drag = reynolds > 1000 ? 0.44 : 24 / reynolds * (1 + 0.15 * std::pow(reynolds, 0.687));
    const Real speed = std::sqrt(4.0 / 3 * (fall.ratio - 1) * g * diameter / drag);
    const Real h = diameter / fall.cells, mass = fall.ratio * rho * pi / 6 * cube(diameter);
    const Real stiffness = mass * square(speed / (0.01 * diameter));
    const int n = static_cast<int>(std::round(5 * fall.cells)),
              up = static_cast<int>(std::round(6 * fall.cells));
    auto boundaries = BoundaryConditions<3>::all(Boundary::free_slip);
    boundaries[2][0] = Boundary::wall;
    const Flow liquid({.grid = {.cells = {n, n, up}, .spacing = Vec3::Constant(h)},
                       .boundaries = boundaries,
                       .gravity = {0, 0, -g},
                       .density = rho,
                       .viscosity = rho * speed * diameter / reynolds,
                       .largest_step = fall.step * pi * std::sqrt(mass / stiffness)},
                      {}, MonolithicSolids<>({.resolved_from = 0}));
    Scene scene;
    scene.gravity = {0, 0, -g};
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    const Vec3 place = Vec3(2.5, 2.5, 3.5) * diameter + h * fall.off;
    scene.add_sphere(0.5 * diameter, {.position = place, .velocity = {0, 0, -speed}}, fall.ratio * rho);
    Rebound found;
    Real comes = 0, goes = 0;
    bool touched = false;
    const RunOptions options{.end_time = 8 * diameter / speed,
                             .observe_every = 0.004 * diameter / speed,
                             .stop = [&] { return goes > 0; }};
    const auto run = [&](const auto& law) {
        auto sim = simulate(scene).contact(law).fluid(liquid);
        sim.run(options, [&](const auto& now) {
            const Real v = now.particles().velocity[0].z(), z = now.particles().position[0].z();
            touched |= z < 0.5 * diameter;
            if (!touched && z >= above) comes = -v, found.steps = now.fluid_model().steps();
            if (touched && v > 0 && z >= above && goes == 0) goes = v;
        });
        found.residual = sim.ledger().residual_relative(), found.film = sim.ledger().lost_film;
    };
    const LinearSpring::Params spring{.stiffness = stiffness, .restitution = dry};
    if (fall.roughness > 0)
        run(Lubricated<LinearSpring>{{.contact = spring,
                                      .viscosity = rho * speed * diameter / reynolds,
                                      .range = h,
                                      .roughness = 0.5 * fall.roughness * diameter}});
    else
        run(LinearSpring{spring});
    found.stokes = fall.stokes * comes / speed, found.wet = goes / comes / dry;
    return found;
}

}  // namespace rebound_in_liquid
