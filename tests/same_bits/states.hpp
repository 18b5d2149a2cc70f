#pragma once
// What there is to see of a simulation and of a water, by their public functions. Names of the library that
// change are changed here, for all scenes.

#include "scene_list.hpp"

#include <cmath>

namespace same_bits {

/// Places, motion and loads of bodies; the ledger; the run.
template <class Sim>
void add_bodies(Numbers& to, const Sim& sim) {
    const auto& p = sim.particles();
    const auto column = [&](const char* name, const auto& vectors) {
        to.kind(name);
        for (const auto& v : vectors) to.add_vector(v);
    };
    column("position", p.position), column("velocity", p.velocity);
    column("angular momentum", p.angular_momentum), column("force", p.force), column("torque", p.torque);
    to.kind("orientation");
    for (std::size_t b = 0; b < p.position.size(); ++b)
        if (p.sphere_count[b] > 1) to.add_vector(p.orientation[b].coeffs());  // a sphere has none
    to.kind("mass");
    for (const Real mass : p.mass) to.add(mass);
    to.kind("who");
    for (std::size_t b = 0; b < p.id.size(); ++b)
        to.add(static_cast<Real>(p.id[b])), to.add(static_cast<Real>(p.kind[b])),
            to.add(static_cast<Real>(p.site[b]));
    to.kind("ledger");
    Real residual = 0;
    sim.ledger().visit([&](std::string_view name, Real value) {
        if (name == "residual") {
            residual = value;  // round-off alone
            return;
        }
        if (name == "force_work" || name == "wall_work")
            return;  // younger than the scenes, which have neither
        to.add(value), to.figure(std::string(name), value);
    });
    to.kind("residual").add(residual);
    to.kind("time").add(sim.time()), to.add(sim.time_step());
    to.kind("counts").add(static_cast<Real>(sim.steps()));
    to.add(static_cast<Real>(sim.times_shortened())), to.add(static_cast<Real>(sim.bonds_broken()));
    to.add(static_cast<Real>(sim.spheres_let_go()));
    to.kind("gauge").add(sim.sediment_passed());
    to.figure("bodies", static_cast<Real>(p.position.size()));
    to.figure("steps", static_cast<Real>(sim.steps()));
    to.figure("shortened", static_cast<Real>(sim.times_shortened()));
    to.figure("bonds broken", static_cast<Real>(sim.bonds_broken()));
    to.figure("let go", static_cast<Real>(sim.spheres_let_go()));
    to.figure("passed", sim.sediment_passed());
    if (const auto* feed = sim.feed()) {
        to.kind("fed").add(feed->supplied_volume()), to.add(static_cast<Real>(feed->supplied_stones()));
        to.figure("fed", feed->supplied_volume());
    }
}

/// Wear, site by site, and where spheres are.
template <class Sim>
void add_concrete(Numbers& to, const Sim& sim) {
    const auto& concrete = sim.concrete();
    if (concrete.sites() == 0) return;
    to.kind("fracture");
    Real gone = 0;
    for (abrade::Index s = 0; s < concrete.sites(); ++s) {
        to.add(concrete.fracture(s)), to.add(concrete.gone(s));
        gone += concrete.gone(s);
    }
    to.kind("place");
    for (abrade::Index s = 0; s < concrete.sites(); ++s) to.add_vector(sim.concrete_place(s));
    to.kind("volume").add(concrete.worn_volume()), to.add(concrete.overflow_volume());
    to.add(concrete.waiting_volume()), to.add(concrete.detached_volume());
    to.kind("collision").add(concrete.largest_collision_share());
    to.figure("worn", concrete.worn_volume()), to.figure("overflow", concrete.overflow_volume());
    to.figure("gone", gone), to.figure("detached", concrete.detached_volume());
}

/// Velocities, pressure, liquid, heights, eddies and energies of water on a grid.
template <class Flow>
void add_grid_water(Numbers& to, const Flow& flow) {
    const auto& grid = flow.grid();
    constexpr int dim = std::decay_t<decltype(grid)>::vertical + 1;
    Real fastest = 0;
    to.kind("water velocity");
    for (int a = 0; a < dim; ++a)
        grid.for_each([&](const auto& cell, auto c) {
            const auto& along = flow.velocity()[a];
            to.add(along[c]);
            if (cell[a] == grid.cells(a) - 1) to.add(along[c + grid.layout().stride[a]]);
            fastest = std::max(fastest, std::abs(Real(along[c])));
        });
    to.kind("pressure");
    grid.for_each([&](const auto&, auto c) { to.add(flow.pressure()[c]); });
    if constexpr (requires { flow.liquid(); }) {
        to.kind("liquid");
        grid.for_each([&](const auto&, auto c) { to.add(flow.liquid().fraction()[c]); });
        to.kind("water volume").add(flow.liquid().volume());
        to.kind("surface");
        grid.for_each([&](const auto& cell, auto) {
            if (cell[dim - 1] == 0) to.add(flow.surface_at(grid.centre(cell)));
        });
        to.figure("water volume", flow.liquid().volume());
    }
    if constexpr (requires { flow.eddy_viscosity(); }) {
        Real most = 0;
        to.kind("eddy viscosity");
        grid.for_each([&](const auto&, auto c) {
            to.add(flow.eddy_viscosity()[c]), most = std::max(most, Real(flow.eddy_viscosity()[c]));
        });
        to.figure("eddies", most);
    }
    to.kind("water energy").add(flow.kinetic_energy());
    if (flow.has_energy_account())
        flow.energy().visit([&](std::string_view name, Real value) {
            if (name == "forcing" || name == "sources")
                return;  // younger than the scenes, which have neither
            to.add(value), to.figure("water " + std::string(name), std::abs(value));
        });
    to.kind("water time").add(flow.time()), to.add(flow.stable_step().seconds);
    to.kind("water counts").add(static_cast<Real>(flow.steps())), to.add(static_cast<Real>(flow.wet_cells()));
    to.figure("water steps", static_cast<Real>(flow.steps())), to.figure("fastest water", fastest);
    if constexpr (requires { flow.solids().averaged(); })
        to.figure("averaged", static_cast<Real>(flow.solids().averaged()));
}

/// Depths, surfaces and speeds of depth-averaged water.
template <class Water>
void add_shallow_water(Numbers& to, const Water& water) {
    const auto columns = water.columns();
    Real fastest = 0;
    for (const auto* column : {&columns.speed_x, &columns.speed_y}) {
        to.kind("water velocity");
        for (const Real u : *column) to.add(u), fastest = std::max(fastest, std::abs(u));
    }
    to.kind("depth");
    Real dry = 0;
    for (const Real h : columns.depth) to.add(h), dry += h == 0;
    to.kind("surface");
    for (const Real z : columns.surface) to.add(z);
    to.kind("water volume").add(water.volume());
    for (const bool high : {false, true}) to.add(water.volume_in(0, high));
    to.kind("water time").add(water.time()), to.add(water.stable_step().seconds);
    to.kind("water counts").add(static_cast<Real>(water.steps())),
        to.add(static_cast<Real>(water.steps_repeated()));
    to.figure("water steps", static_cast<Real>(water.steps())), to.figure("fastest water", fastest);
    to.figure("dry cells", dry);
}

/// Water of any kind; nothing for none.
template <class Fluid>
void add_water(Numbers& to, const Fluid& fluid) {
    if constexpr (requires { fluid.water(); })
        add_shallow_water(to, fluid.water());
    else if constexpr (requires { fluid.columns(); })
        add_shallow_water(to, fluid);
    else if constexpr (requires { fluid.pressure(); })
        add_grid_water(to, fluid);
}

/// All of a simulation that has run.
template <class Sim>
Numbers state_of(const Sim& sim) {
    Numbers numbers;
    add_bodies(numbers, sim);
    add_concrete(numbers, sim);
    add_water(numbers, sim.fluid_model());
    return numbers;
}
/// All of a water.
template <class Fluid>
Numbers state_of_water(const Fluid& fluid) {
    Numbers numbers;
    add_water(numbers, fluid);
    return numbers;
}

}  // namespace same_bits
