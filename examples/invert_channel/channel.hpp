#pragma once
// From a configuration to a simulation, and from a simulation to results.

#include "bed.hpp"

#include <abrade/abrade.hpp>

#include <algorithm>
#include <utility>

namespace abrade::examples {

/// Of contacts that yield; stones and the side walls are material 0.
inline constexpr Index concrete_material = 1;

inline Scene make_scene(const ChannelConfig& c) {
    Scene scene;
    scene.gravity = c.invert.gravity();
    scene.concrete = c.concrete;
    scene.concrete->lattice = invert_lattice(c.invert, c.lattice);
    if (std::holds_alternative<ElasticPlasticHertz::Params>(c.contact))
        scene.concrete->material = concrete_material;
    const Real half = 0.5 * c.invert.width;
    scene.add_wall({0, -half, 0}, {0, 1, 0}).add_wall({0, half, 0}, {0, -1, 0});
    scene.add_wall({0, 0, 0}, {1, 0, 0});  // for stones alone: they pile up there without water
    scene.feed = c.feed;
    scene.outlet = c.invert.length;
    scene.flow_counter = c.comparison.gauge;
    // Stones may bounce high above the water, but not through the concrete.
    const Real floor = -c.lattice.layers * c.lattice.sphere_diameter;
    scene.bounds = {{-1, -1.2 * half, floor}, {c.invert.length + 1, 1.2 * half, ChannelConfig::ceiling}};
    return scene;
}

/// What stands in the contact slot. Concrete that yields counts as flat; small spheres of stones on each
/// other or on a wall must not, so they have a law of their own.
template <ContactLaw Contact>
auto make_contact(const ChannelConfig& c) {
    const auto& params = std::get<typename Contact::Params>(c.contact);
    if constexpr (std::same_as<Contact, ElasticPlasticHertz>) {
        auto curved = params;
        curved.flat_radius = 0;
        return MaterialPairs<Contact>{{.materials = {"stone", "concrete"},
                                       .pairs = {{"stone", "stone", curved},
                                                 {"stone", "concrete", params},
                                                 {"concrete", "concrete", params}}}};
    } else {
        return Contact{params};
    }
}

/// Of a fluid that does not know its forces.
template <class Fluid>
UsualDrag<Fluid> usual_drag(const ChannelConfig& c) {
    if constexpr (std::same_as<UsualDrag<Fluid>, CliftGauvin>)
        return CliftGauvin{c.drag};
    else
        return {};
}

/// One engine is compiled for each line of `channel_engines`.
template <ContactLaw Contact, FluidModel Fluid>
auto make_simulation(const ChannelConfig& c, Fluid fluid) {
    auto dry =
        simulate(make_scene(c)).contact(make_contact<Contact>(c)).bond(MohrCoulomb{c.bond}).wear(c.wear);
    if constexpr (std::same_as<Fluid, NoFluid>)
        return dry;
    else
        return std::move(dry).fluid(std::move(fluid), usual_drag<Fluid>(c));
}

/// Of the middle class of stones on concrete at 1 m/s [-].
template <class Contact>
Real restitution_at_1_m_per_s(const ChannelConfig& c, const Contact& contact) {
    const Real size = c.feed.classes[c.feed.classes.size() / 2].size;
    const auto of = [&](const auto& law) {
        return law.restitution(1, c.feed.density * pi / 6 * cube(size), 0.5 * size);
    };
    if constexpr (requires { typename Contact::OfPair; })
        return of(contact.between({0, concrete_material}));
    else
        return of(contact);
}

/// Whether nothing of its column is left above a site; sites of a column stand together, the upper first.
inline bool is_surface(const Concrete& concrete, Index site) {
    const auto& sites = concrete.lattice().sites;
    const auto s = static_cast<std::size_t>(site);
    return sites[s].layer == 0 || (sites[s - 1].column == sites[s].column && concrete.gone(site - 1));
}

/// The run's figures. `history` is what the observer gathered.
template <class Sim>
ChannelResults make_results(const ChannelConfig& c, const Sim& sim, LedgerHistory history, BedRecord& bed) {
    ChannelResults r;
    const Concrete& concrete = sim.concrete();
    const Ledger& ledger = sim.ledger();
    r.stopped = sim.stopped();
    r.wall_s = sim.wall_seconds();
    r.simulated_s = sim.time();
    r.represented_h = sim.time() * c.wear.params().acceleration / 3600;
    r.time_step_s = sim.time_step();
    r.stable_time_step_s = sim.stable_time_step().seconds;
    r.steps = sim.steps();
    r.threads = thread_count();
    r.concrete_spheres = concrete.sites();
    r.bonds_broken = sim.bonds_broken();
    r.stones_fed = sim.feed()->supplied_stones();
    r.sediment_fed_m3 = sim.feed()->supplied_volume();
    r.sediment_passed_m3 = sim.sediment_passed();
    r.converted_sediment_m3 = c.wear.params().acceleration * r.sediment_passed_m3;
    r.worn_volume_m3 = concrete.worn_volume();
    r.overflow_volume_m3 = concrete.overflow_volume();
    r.detached_volume_m3 = concrete.detached_volume();
    r.largest_collision_share = concrete.largest_collision_share();
    r.largest_safe_beta = sim.largest_safe_acceleration();
    r.waiting_volume_m3 = concrete.waiting_volume();
    r.worn_through = concrete.worn_through();
    r.spheres_let_go = sim.spheres_let_go();
    r.breaks_by_blows = breaks_by_blows(sim);
    r.restitution_at_1_m_per_s = restitution_at_1_m_per_s(c, sim.contact_law());
    for (Index site = 0; site < concrete.sites(); ++site) r.spheres_worn_out += concrete.fracture(site) >= 1;
    // Equation [1] for the whole run: half of what each contact with concrete lost, times Cw and beta.
    if (const auto* law = std::get_if<SubParticleAbrasion>(&c.wear.law)) {
        const SubParticleAbrasion::Params& wear = law->params();
        r.worn_volume_from_energy_m3 = 0.5 * wear.coefficient * wear.acceleration *
                                       (wear.normal_weight * ledger.concrete_lost_normal +
                                        wear.tangential_weight * ledger.concrete_lost_sliding);
    }
    r.energy_lost_normal_J = ledger.concrete_lost_normal;
    r.energy_lost_sliding_J = ledger.concrete_lost_sliding;
    r.ledger_residual_relative = ledger.residual_relative();
    r.integration_residue_J = ledger.integration_residue();
    const auto shares = sim.time_shares();
    r.wall_contacts_s = shares.contacts * r.wall_s, r.wall_bonds_s = shares.bonds * r.wall_s;
    r.wall_motion_s = shares.motion * r.wall_s, r.wall_lists_s = shares.renewal * r.wall_s;
    r.wall_fluid_s = shares.fluid * r.wall_s;
    r.fluid = std::remove_cvref_t<decltype(sim.fluid_model())>::name,
    r.contact = PairLaw<std::remove_cvref_t<decltype(sim.contact_law())>>::name;
    r.bond = MohrCoulomb::name, r.wear = c.wear.chosen();

    const Lattice& lattice = concrete.lattice();
    r.along = lattice.count_along, r.across = lattice.count_across;
    bed.put_into(r, sim);
    Real area = 0, volume = 0;
    for (std::size_t i = 0; i < r.bed.depth_m.size(); ++i)
        area += lattice.column_area[i], volume += r.bed.depth_m[i] * lattice.column_area[i];
    r.mean_depth_mm = 1e3 * volume / area;

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
    for (Index site = 0; site < concrete.sites(); ++site)  // most of it is no body
        if (!concrete.gone(site) && is_surface(concrete, site))
            r.spheres.push_back({sim.concrete_place(site), lattice.radius, concrete.fracture(site)});
    r.mean_stone_speed_m_per_s = r.stones > 0 ? speed / r.stones : 0;
    r.ledger = std::move(history);
    return r;
}

}  // namespace abrade::examples
