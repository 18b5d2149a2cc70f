#pragma once
// What a simulation consists of: policies, scene, bodies, contacts, bonds, concrete, supply, accounts.

#include <abrade/bond/network.hpp>
#include <abrade/bond/standing_bonds.hpp>
#include <abrade/dem/contacts/contact_list.hpp>
#include <abrade/sim/scene/materials.hpp>
#include <abrade/sim/scene/policies.hpp>
#include <abrade/sim/scene/scene.hpp>
#include <abrade/sim/scene/scene_outline.hpp>
#include <abrade/sim/scene/site_bodies.hpp>
#include <abrade/sim/state/bodies_in_fluid.hpp>
#include <abrade/sim/state/events.hpp>
#include <abrade/sim/state/flow_counter.hpp>
#include <abrade/sim/state/integration_mode.hpp>
#include <abrade/sim/state/ledger.hpp>

namespace abrade {

/// Everything that lasts from step to step. `particles` is as of the last publication; what moves is in
/// `store`.
template <class P>
struct State {
    State(Scene from, P chosen)
        : policies(std::move(chosen)), scene((from.validate(), std::move(from))),
          counter(scene.flow_counter) {
        outline = SceneOutline(scene, policies);
        if (scene.feed) feed.emplace(*scene.feed);
        if (scene.concrete) add_concrete(*scene.concrete);
        for (const Scene::Stone& stone : scene.stones) {
            BodyState at = stone.state;
            at.position += scene.periodic().way_back(at.position);
            const Index body =
                particles.add(stone.clump, stone.density, at, stone.fixed ? Kind::fixed : Kind::stone);
            stone_id.push_back(particles.id[static_cast<std::size_t>(body)]);
        }
        if constexpr (P::has_materials)
            require_laws_for(policies.contact, particles, scene);
        else
            require_one_material(scene);
    }

    P policies;
    Scene scene;  ///< its lattice has moved into `concrete`
    SceneOutline outline;
    Particles particles;
    SphereStore store;
    std::vector<IntegrationMode> mode;           ///< [slot]; of a clump its first one's counts
    std::vector<IntegrationMode> mode_if_alone;  ///< [slot] where nothing is near
    FreeFlight flight;
    Sleep sleep;
    ContactList<PairLaw<decltype(P::contact)>> contacts;
    Network<decltype(P::bond)> network;
    Concrete concrete;
    SiteBodies sites;
    std::optional<StandingBonds<decltype(P::bond)>> standing;  ///< of quasi-static concrete
    std::vector<Index> stone_id;                               ///< of each stone of the scene
    Index let_go_count = 0;  ///< spheres of standing concrete that came loose
    Events events;
    std::optional<Feed> feed;
    Accounts accounts;  ///< works and losses up to the velocities that the lines hold
    BodiesInFluid<P> in_fluid;
    FlowCounter counter;
    Index broken_tension = 0, broken_shear = 0;
    Real smallest_radius = 0;  ///< of a sphere [m]
    Real size_ratio = 1;       ///< smallest radius over largest [-]

    static void fields(auto&& field) {
        field("scene", &State::outline), field("policies", &State::policies),
            field("particles", &State::particles), field("store", &State::store), field("mode", &State::mode),
            field("mode_if_alone", &State::mode_if_alone), field("flight", &State::flight),
            field("sleep", &State::sleep), field("contacts", &State::contacts),
            field("network", &State::network), field("concrete", &State::concrete),
            field("sites", &State::sites), field("standing", &State::standing),
            field("let_go_count", &State::let_go_count), field("events", &State::events),
            field("feed", &State::feed), field("accounts", &State::accounts),
            field("in_fluid", &State::in_fluid), field("counter", &State::counter),
            field("broken_tension", &State::broken_tension), field("broken_shear", &State::broken_shear),
            field("smallest_radius", "m", &State::smallest_radius), field("size_ratio", &State::size_ratio);
    }

    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }

    /// Of gravity, from the origin [J]; 0 for what is fixed.
    Real potential_energy(Index body, const Vec3& position) const noexcept {
        return particles.inverse_mass[at(body)] == 0
                   ? 0
                   : -particles.mass[at(body)] * scene.gravity.dot(position);
    }

    Index bonds_broken() const noexcept {
        const Index standing_ones = standing ? standing->broken_tension() + standing->broken_shear() : 0;
        return broken_tension + broken_shear + standing_ones;
    }
    bool has_grains() const noexcept {
        return std::find(particles.kind.begin(), particles.kind.end(), Kind::grain) != particles.kind.end();
    }
    bool nobody_moves() const noexcept {
        return std::all_of(particles.inverse_mass.begin(), particles.inverse_mass.end(),
                           [](Real inverse_mass) { return inverse_mass == 0; });
    }
    Index body_in(Index slot) const noexcept {
        return particles.body[at(store.sphere_of(store.owner_of(slot)))];
    }
    Index first_slot_of(Index body) const noexcept { return store.slot_of(particles.first_sphere[at(body)]); }
    /// Of two of which one is asleep, the other; else -1.
    Index awake_beside_sleeper(const SlotPair& pair) const noexcept {
        if (sleep.count == 0 || pair.second < 0) return -1;
        const Index first = body_in(pair.first), second = body_in(pair.second);
        if (sleep.asleep(first) == sleep.asleep(second)) return -1;
        return sleep.asleep(first) ? second : first;
    }

    /// Whether wear is written down and changes nothing.
    bool is_frozen() const noexcept {
        return scene.concrete && scene.concrete->worn_out == WornOut::recorded;
    }
    /// What is left of the strength of a site's sphere.
    auto strength_of_site() const noexcept {
        if constexpr (P::has_wear)
            return [this, frozen = is_frozen()](Index site) -> Real {
                return policies.wear.strength_left(frozen ? 0 : concrete.fracture(site));
            };
        else
            return [](Index) -> Real { return 1; };
    }
    /// The same of a body of concrete, for bonds.
    auto strength_left() const noexcept {
        if constexpr (P::has_wear)
            return [this, of_site = strength_of_site()](Index body) {
                return of_site(particles.site[at(body)]);
            };
        else
            return Unworn{};
    }

    bool feels_fluid(Index body) const noexcept {
        const Kind kind = particles.kind[at(body)];
        return P::has_fluid && (kind == Kind::stone || kind == Kind::grain);
    }
    /// All that acts on a body at time t beside contacts, bonds and weight; `ahead` as in ContactStep.
    typename P::OnBody acting_on(Index body, [[maybe_unused]] const Vec3& position,
                                 [[maybe_unused]] const Vec3& velocity, [[maybe_unused]] const Vec3& spin,
                                 [[maybe_unused]] Real t, [[maybe_unused]] Real ahead) const noexcept {
        typename P::OnBody load{};
        if constexpr (P::has_fluid)
            if (feels_fluid(body))
                static_cast<typename P::FromFluid&>(load) = fluid_on(body, position, velocity, t, ahead);
        if constexpr (P::has_force) {
            const Vec3 now = velocity + ahead * (velocity - in_fluid.velocity[at(body)]);
            load.given =
                policies.force(BodyView{particles.id[at(body)], particles.kind[at(body)], position, now, spin,
                                        particles.mass[at(body)], particles.volume[at(body)]},
                               t);
        }
        return load;
    }
    /// What the fluid does to a body at time t; `ahead` as in ContactStep.
    auto fluid_on(Index body, [[maybe_unused]] const Vec3& position, [[maybe_unused]] const Vec3& velocity,
                  [[maybe_unused]] Real t, [[maybe_unused]] Real ahead) const noexcept {
        if constexpr (P::fluid_resolves) {
            return in_fluid.load[at(body)];
        } else {
            const Vec3 now = velocity + ahead * (velocity - in_fluid.velocity[at(body)]);
            const FluidSample sample = policies.fluid.sample(position, t);
            const Immersed immersed{position, now, particles.volume[at(body)]};
            if constexpr (FeelsInertia<decltype(policies.drag)>)
                return fluid_load(policies.drag, sample, change_of(policies.fluid, position, t), immersed,
                                  scene.gravity);
            else
                return fluid_load(policies.drag, sample, immersed, scene.gravity);
        }
    }

    /// Lets concrete go whose last bond to the ground broke.
    void free_loose_concrete() {
        if constexpr (P::has_bonds) {
            if (!std::exchange(events.bond_broke, false)) return;
            for (const BondGraph::Component& component : network.take_loose()) {
                if (component.size() > 1 && scene.concrete->fragments == Fragments::clumps)
                    events.components.push_back(component);
                for (const Index site : component) {
                    if (concrete.gone(site)) continue;  // worn away
                    concrete.set_gone(site);
                    if (const Index body = sites.body_of[at(site)]; body >= 0)
                        particles.kind[at(body)] = Kind::grain;
                    events.lists_due = true;
                }
            }
        }
    }

    /// The sphere of a site is worn out and vanishes.
    void wear_away(Index site) {
        if constexpr (P::has_bonds)
            if (!sites.stand) network.sever(site), events.bond_broke = true;
        leave_place(site);
        if (sites.body_of[at(site)] >= 0) events.worn_away.push_back(site);
        events.lists_due = true;
    }

    /// The sphere of a site that stands is free from now on: a grain. One that has sunk into another, or that
    /// another has sunk into, would be shot out as such: it crumbles and vanishes.
    void let_go(Index site) {
        if (concrete.gone(site)) return;
        ++let_go_count;
        if (sites.recede() && overlaps_standing(site)) return wear_away(site);
        const Index body = body_at(site);
        const Real mass = particles.mass[at(body)],
                   inertia = 0.4 * mass * square(particles.radius[at(particles.first_sphere[at(body)])]);
        particles.kind[at(body)] = Kind::grain;
        particles.inverse_mass[at(body)] = 1 / mass;
        particles.inverse_inertia[at(body)].setConstant(1 / inertia);
        if (const Index sphere = particles.first_sphere[at(body)]; sphere < store.spheres())
            store.lines.motion[at(store.slot_of(sphere))].inverse_mass = 1 / mass;
        accounts.sum.fed_potential += potential_energy(body, particles.position[at(body)]);
        leave_place(site);
        events.lists_due = true;
    }

    /// Concrete that is where it was built touches nobody but those it is bonded to. Bonds that hold are no
    /// reason to stay: they let spheres roll about each other, as far as into others that they do not touch
    /// as built.
    bool keeps_its_place(Index body) const noexcept {
        const Kind kind = particles.kind[at(body)];
        if (kind == Kind::fixed || (kind == Kind::concrete && sites.stand)) return true;
        if (kind != Kind::concrete) return false;
        constexpr Real share = 0.05;  // of the radius; two of them have come as near as `lattice_of` bonds
        const Vec3& now = store.lines.place[at(first_slot_of(body))].centre;
        const Vec3& built = concrete.lattice().sites[at(particles.site[at(body)])].centre;
        return (now - built).squaredNorm() < square(share * concrete.lattice().radius);
    }

    /// Where a site's sphere stands, a body or not; where it was built if it is gone and no body [m]. A worn
    /// one that recedes and that nobody is near stands where it will once somebody is.
    Vec3 place_of(Index site) const noexcept {
        const Index body = sites.body_of[at(site)];
        if (body >= 0) return particles.position[at(body)];
        return sites.recede() && !concrete.gone(site) ? place_once_sunk(site)
                                                      : concrete.lattice().sites[at(site)].centre;
    }

    /// Where a standing sphere will be once it has sunk as far as its wear has it [m].
    Vec3 place_once_sunk(Index site) const noexcept {
        return concrete.lattice().sites[at(site)].centre + concrete.fracture(site) * sites.way[at(site)];
    }
    /// Lets a standing sphere sink that far; nothing may touch it before or then.
    void sink(Index site) {
        sites.worn[at(site)] = 0;
        const Vec3& there = sites.place[at(site)] = place_once_sunk(site);
        const Index body = sites.body_of[at(site)];
        if (body < 0) return;
        const Index sphere = particles.first_sphere[at(body)];
        particles.position[at(body)] = particles.centre[at(sphere)] = there;
        if (sphere < store.spheres()) store.lines.place[at(store.slot_of(sphere))].centre = there;
    }

    /// The body of a site that stands, made where there is none: where it stands now, though it may be worn
    /// and wait to sink.
    Index body_at(Index site) {
        if (sites.body_of[at(site)] < 0) {
            const Index next_id = particles.next_id;
            sites.body_of[at(site)] = particles.add(
                sites.sphere, scene.concrete->density,
                {.position = sites.place[at(site)], .material = scene.concrete->material}, Kind::fixed);
            particles.kind.back() = Kind::concrete;
            particles.site.back() = particles.id.back() =
                site;  // as if it had been built: concrete comes first
            particles.next_id = next_id;
        }
        return sites.body_of[at(site)];
    }

    /// Writes down which bodies the sites of the concrete are.
    void note_sites() {
        for (Index b = 0; b < particles.bodies(); ++b)
            if (particles.site[at(b)] >= 0) sites.body_of[at(particles.site[at(b)])] = b;
    }

private:
    void leave_place(Index site) {
        concrete.set_gone(site);
        if (sites.stand) sites.place[at(site)].setConstant(1e100);
    }

    /// Whether a standing sphere overlaps another, because either has sunk.
    bool overlaps_standing(Index site) const {
        const Vec3& own = sites.place[at(site)];
        const Real diameter = 2 * concrete.lattice().radius;
        bool found = false;
        sites.grid.each_about(own, diameter + sites.longest_way, [&](Index other) {
            found |= other != site && (sites.place[at(other)] - own).squaredNorm() < square(0.999 * diameter);
        });
        return found;
    }

    void add_concrete(ConcreteBlock& block) {
        const Lattice& lattice = block.lattice;
        const auto count = static_cast<Index>(lattice.sites.size());
        sites.stand = block.level != ConcreteLevel::dynamic;
        sites.sphere = make_clump("concrete", {{Vec3::Zero(), lattice.radius}});
        sites.body_of.assign(at(count), -1), sites.marks.assign(at(count), 0);
        std::vector<Vec3> centre;
        for (const LatticeSite& site : lattice.sites) {
            centre.push_back(site.centre);
            // What a wall passes through stands in that wall: set free, it would be shot out of it.
            const bool in_wall = std::any_of(scene.walls.begin(), scene.walls.end(), [&](const Plane& wall) {
                return wall.distance(site.centre) < (1 - 1e-6) * lattice.radius;
            });
            sites.held.push_back(in_wall || site.held);
        }
        sites.grid = PointGrid(centre, 2 * lattice.radius);
        if (sites.stand)
            stand(block, centre);
        else
            set_moving(block);
        if (sites.stand && block.worn_out == WornOut::recedes) {
            sites.way = detail::ways_down(lattice);
            sites.worn.assign(at(count), 0);
            for (const Vec3& way : sites.way) sites.longest_way = std::max(sites.longest_way, way.norm());
        }
        if (sites.stand) sites.place = std::move(centre);
        concrete = Concrete(std::move(block.lattice), block.fracture_volume, block.overflow, block.worn_out);
        if (sites.stand) return;
        events.bond_broke = true;  // a packing may have spheres that nothing ties
        free_loose_concrete();
    }

    static std::vector<BondedPair> pairs_of(const Lattice& lattice, auto&& wanted) {
        std::vector<BondedPair> bonded;
        for (const auto& [i, j] : lattice.bonds)
            if (wanted(i, j)) bonded.push_back({i, j});
        return bonded;
    }

    void set_moving(const ConcreteBlock& block) {
        for (Index s = 0; s < static_cast<Index>(block.lattice.sites.size()); ++s) {
            // Without bonds there is nothing to hold the spheres together: they stand as a rigid bed.
            const bool held = !P::has_bonds || sites.held[at(s)];
            const Index body =
                particles.add(sites.sphere, block.density,
                              {.position = block.lattice.sites[at(s)].centre, .material = block.material},
                              held ? Kind::fixed : Kind::concrete);
            particles.site[at(body)] = s, sites.body_of[at(s)] = body;
        }
        if constexpr (P::has_bonds)
            network.build(particles, pairs_of(block.lattice, [&](Index i, Index j) {
                              return particles.inverse_mass[at(i)] + particles.inverse_mass[at(j)] > 0;
                          }));
    }

    void stand(const ConcreteBlock& block, std::span<const Vec3> centre) {
        const Lattice& lattice = block.lattice;
        particles.next_id = static_cast<Index>(centre.size());
        if (block.level == ConcreteLevel::rigid) return;
        require(P::has_bonds,
                {"Scene.concrete.level: quasi_static without a bond law, bonds", "needed", "",
                 "fill the bond slot, or take ConcreteLevel::rigid"},
                0);
        if constexpr (P::has_bonds)
            standing.emplace(policies.bond,
                             typename decltype(standing)::value_type::Setup{
                                 .centre = centre,
                                 .radius = lattice.radius,
                                 .held = sites.held,
                                 .weight = block.density * sites.sphere.volume * scene.gravity,
                                 .cluster = block.cluster},
                             pairs_of(lattice, [&](Index i, Index j) {
                                 return !sites.held[at(i)] || !sites.held[at(j)];
                             }));
    }
};

}  // namespace abrade
