#pragma once
// From a configuration to a simulation, and from a simulation to results.

#include "results.hpp"

#include <abrade/abrade.hpp>

#include <algorithm>
#include <utility>

namespace abrade::examples {

inline Scene make_scene(const ChannelConfig& c) {
    Scene scene;
    scene.gravity = c.invert.gravity();
    scene.concrete =
        ConcreteBlock{invert_lattice(c.invert, c.lattice), c.concrete_density, c.fracture_volume};
    const Real half = 0.5 * c.invert.width;
    scene.add_wall({0, -half, 0}, {0, 1, 0}).add_wall({0, half, 0}, {0, -1, 0});
    scene.feed = c.feed;
    scene.outlet = c.invert.length;
    scene.gauge = c.comparison.gauge;
    // Stones may bounce off the upstream end and high above the water, but not through the concrete.
    const Real floor = -c.lattice.layers * c.lattice.sphere_diameter;
    scene.bounds = {{-1, -1.2 * half, floor}, {c.invert.length + 1, 1.2 * half, 5}};
    return scene;
}

/// One engine is compiled for each fluid.
template <FluidModel Fluid>
auto make_simulation(const ChannelConfig& c, Fluid fluid) {
    auto dry = simulate(make_scene(c))
                   .contact(LinearSpring{c.contact})
                   .bond(MohrCoulomb{c.bond})
                   .wear(SubParticleAbrasion{c.wear});
    if constexpr (std::same_as<Fluid, NoFluid>)
        return dry;
    else
        return std::move(dry).fluid(std::move(fluid), CliftGauvin{c.drag});
}

namespace detail {

/// Depth along the centre line [mm per m3 of converted sediment], and its mean over the compared section.
inline void compare_centre(const ChannelConfig& c, const Lattice& lattice, ChannelResults& r) {
    const Real per_m3 =
        r.converted_sediment_m3 > 0 ? 1e3 / r.converted_sediment_m3 : std::numeric_limits<Real>::quiet_NaN();
    Real sum = 0, worn = 0;
    Index counted = 0;
    std::vector<Real> across(static_cast<std::size_t>(r.across), 0);
    for (Index i = 0; i < r.along; ++i) {
        Real depth = 0;
        Index columns = 0;
        const Real x = lattice.sites[static_cast<std::size_t>(lattice.site(i, 0, 0))].centre.x();
        const bool compared = x >= c.comparison.from && x <= c.comparison.to;
        for (Index j = 0; j < r.across; ++j) {
            const Real y = lattice.sites[static_cast<std::size_t>(lattice.site(i, j, 0))].centre.y();
            const Real d = r.depth_m[static_cast<std::size_t>(i * r.across + j)];
            if (i == 0) r.y_m.push_back(y);
            if (std::abs(y) <= c.comparison.half_width) depth += d, ++columns;
            if (compared) across[static_cast<std::size_t>(j)] += d, worn += d;
        }
        r.x_m.push_back(x);
        r.centre_depth_per_m3.push_back(columns > 0 ? depth / columns * per_m3 : 0);
        if (compared) sum += r.centre_depth_per_m3.back(), ++counted;
    }
    r.centre_depth_mm_per_m3 = counted > 0 ? sum / counted : 0;
    // The band that holds 90 % of the worn volume, from the most worn column down.
    std::sort(across.rbegin(), across.rend());
    Real held = 0;
    std::size_t columns = 0;
    while (columns < across.size() && held < 0.9 * worn) held += across[columns++];
    r.worn_band_width_m = static_cast<Real>(columns) * c.invert.width / r.across;
}

}  // namespace detail

/// The run's figures. `history` is what the observer gathered.
template <class Sim>
ChannelResults make_results(const ChannelConfig& c, const Sim& sim, LedgerHistory history) {
    ChannelResults r;
    const Concrete& concrete = sim.concrete();
    const Ledger& ledger = sim.ledger();
    r.stopped = sim.stopped();
    r.wall_s = sim.wall_seconds();
    r.simulated_s = sim.time();
    r.represented_h = sim.time() * c.wear.acceleration / 3600;
    r.time_step_s = sim.time_step();
    r.stable_time_step_s = sim.stable_time_step().seconds;
    r.steps = sim.steps();
    r.threads = thread_count();
    r.concrete_spheres = concrete.sites();
    r.bonds_broken = sim.bonds_broken();
    r.stones_fed = sim.feed()->supplied_stones();
    r.sediment_fed_m3 = sim.feed()->supplied_volume();
    r.sediment_passed_m3 = sim.sediment_passed();
    r.converted_sediment_m3 = c.wear.acceleration * r.sediment_passed_m3;
    r.worn_volume_m3 = concrete.worn_volume();
    r.overflow_volume_m3 = concrete.overflow_volume();
    r.detached_volume_m3 = concrete.detached_volume();
    r.largest_collision_share = concrete.largest_collision_share();
    r.largest_safe_beta = sim.largest_safe_acceleration();
    // Equation [1] for the whole run: half of what each contact with concrete lost, times Cw and beta.
    r.worn_volume_from_energy_m3 = 0.5 * c.wear.coefficient * c.wear.acceleration *
                                       (c.wear.normal_weight * ledger.concrete_lost_normal +
                                        c.wear.tangential_weight * ledger.concrete_lost_sliding) -
                                   r.overflow_volume_m3;
    r.energy_lost_normal_J = ledger.concrete_lost_normal;
    r.energy_lost_sliding_J = ledger.concrete_lost_sliding;
    r.ledger_residual_relative = ledger.residual_relative();
    r.integration_residue_J = ledger.integration_residue();
    const auto shares = sim.wall_shares();
    r.wall_contacts_s = shares.contacts * r.wall_s, r.wall_bonds_s = shares.bonds * r.wall_s;
    r.wall_motion_s = shares.motion * r.wall_s, r.wall_lists_s = shares.renewal * r.wall_s;
    r.wall_fluid_s = shares.fluid * r.wall_s;
    r.awake_fraction_mean = sim.awake_fraction_mean();
    r.fluid = std::remove_cvref_t<decltype(sim.fluid_model())>::name, r.contact = LinearSpring::name,
    r.bond = MohrCoulomb::name, r.wear = SubParticleAbrasion::name;

    const Lattice& lattice = concrete.lattice();
    r.depth_m = concrete.depth();
    r.along = lattice.count_along, r.across = lattice.count_across;
    Real area = 0, volume = 0;
    for (std::size_t i = 0; i < r.depth_m.size(); ++i) {
        r.max_depth_mm = std::max(r.max_depth_mm, 1e3 * r.depth_m[i]);
        area += lattice.column_area[i], volume += r.depth_m[i] * lattice.column_area[i];
    }
    r.mean_depth_mm = 1e3 * volume / area;
    detail::compare_centre(c, lattice, r);

    const Particles& p = sim.particles();
    Real speed = 0;
    for (Index b = 0; b < p.bodies(); ++b) {
        const auto i = static_cast<std::size_t>(b);
        if (p.kind[i] == Kind::stone) ++r.stones, speed += p.velocity[i].norm();
        if (p.site[i] >= 0 && p.kind[i] != Kind::grain) continue;
        for (Index s = p.first_sphere[i]; s < p.first_sphere[i] + p.sphere_count[i]; ++s)
            r.spheres.push_back({p.centre[static_cast<std::size_t>(s)], p.radius[static_cast<std::size_t>(s)],
                                 p.site[i] >= 0 ? concrete.fracture(p.site[i]) : -1});
    }
    for (Index site = 0; site < concrete.sites(); ++site)  // most of it may sleep, and is no body
        if (!concrete.gone(site) && lattice.sites[static_cast<std::size_t>(site)].layer == 0)
            r.spheres.push_back({sim.concrete_place(site), lattice.radius, concrete.fracture(site)});
    r.mean_stone_speed_m_per_s = r.stones > 0 ? speed / r.stones : 0;
    r.ledger = std::move(history);
    return r;
}

}  // namespace abrade::examples
