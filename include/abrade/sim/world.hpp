#pragma once
// Everything that moves, and the two halves of a step that move it.

#include <abrade/bond/network.hpp>
#include <abrade/dem/contacts.hpp>
#include <abrade/sim/ledger.hpp>
#include <abrade/sim/motion.hpp>
#include <abrade/sim/policies.hpp>
#include <abrade/sim/scene.hpp>
#include <abrade/wear/concrete.hpp>

namespace abrade {

/// State and forces: a MechanicalState for the steppers of dem/stepper.hpp.
template <class P>
class World {
public:
    World(Scene scene, P policies) : policies_(std::move(policies)), scene_(std::move(scene)) {
        scene_.validate();
        if (scene_.concrete) add_concrete(*scene_.concrete);
        for (const Scene::Stone& stone : scene_.stones)
            particles_.add(stone.clump, stone.density, stone.state, Kind::stone);
    }

    // --- MechanicalState -----------------------------------------------------------------------

    /// v += dt F/m, L += dt tau; books the works of this half kick.
    friend void kick(World& w, Real dt) { w.kick(dt); }
    /// x += dt v, orientations likewise; predicts the velocities for the force pass.
    friend void drift(World& w, Real dt) {
        w.move([&](Index b) { return w.drift_one(b, dt); });
    }
    /// Both in one pass over the bodies.
    friend void kick_and_drift(World& w, Real kick_dt, Real drift_dt) {
        w.move([&](Index b) {
            MoveSums sums{w.kick_one(b, kick_dt), {}};
            sums += w.drift_one(b, drift_dt);
            return sums;
        });
    }

    /// The force pass at time t: every law once, memory committed, losses booked. Bodies gather their loads,
    /// and concrete wears, in the kick that follows: one pass over the bodies serves both.
    void evaluate(Real t, Real dt) {
        const ContactSums contacts =
            contacts_.respond(policies_.contact, policies_.wear, particles_, scene_.walls, dt);
        ledger_.lost_normal += contacts.lost_normal;
        ledger_.lost_sliding += contacts.lost_tangential;
        ledger_.concrete_lost_normal += contacts.concrete_lost_normal;
        ledger_.concrete_lost_sliding += contacts.concrete_lost_tangential;
        if (!(contacts.deepest <= overlap_limit))
            report_overlap(contacts_.pairs()[at(contacts.deepest_pair)], contacts.deepest);
        if constexpr (P::has_bonds) {
            const BondSums bonds =
                network_.respond(policies_.bond, policies_.wear, particles_, strength_left(), dt);
            ledger_.lost_bond += bonds.lost_bond;
            ledger_.lost_normal += bonds.lost_normal;
            ledger_.lost_sliding += bonds.lost_tangential;
            ledger_.concrete_lost_normal += bonds.concrete_lost_normal;
            ledger_.concrete_lost_sliding += bonds.concrete_lost_tangential;
            broken_tension_ += bonds.broken_tension;
            broken_shear_ += bonds.broken_shear;
            pattern_changed_ |= bonds.broken_tension + bonds.broken_shear > 0;
            if (!(bonds.deepest <= overlap_limit))
                report_overlap(network_.pairs()[at(bonds.deepest_bond)], bonds.deepest);
        }
        loads_time_ = t;
        loads_waiting_ = true;
    }

    // --- between steps -------------------------------------------------------------------------

    /// Lets concrete go whose last bond to the ground broke in the step before.
    void free_loose_concrete() {
        if constexpr (P::has_bonds) {
            if (!std::exchange(pattern_changed_, false)) return;
            const std::vector<char> tied = network_.tied_to_ground(particles_);
            for (Index b = 0; b < particles_.bodies(); ++b)
                if (particles_.kind[at(b)] == Kind::concrete && !tied[at(b)]) {
                    particles_.kind[at(b)] = Kind::grain;
                    concrete_.set_gone(particles_.site[at(b)]);
                    loosened_ = true;
                }
        }
    }

    /// Whether the list of near pairs may miss a contact in the step to come.
    bool list_is_stale(Real dt) const noexcept {
        return std::sqrt(furthest2_) + dt * std::sqrt(fastest2_) > 0.5 * list_skin_ || loosened_;
    }

    /// Renews what changes seldom: bodies that left, supply, near pairs.
    void renew(Real t, Real dt, Feed* feed) {
        const std::vector<Index> moved = remove_departed();
        if constexpr (P::has_bonds)
            if (broken_tension_ + broken_shear_ > 0) ledger_.left_stored += network_.prune(particles_, moved);
        if (feed)
            feed->supply(particles_, t, [&](Index body) {
                ledger_.fed_kinetic += particles_.kinetic_energy(body);
                ledger_.fed_potential += potential_energy(body);
            });
        const bool admitted = admit_new_bodies();
        furthest2_ = fastest2_ = 0;
        for (const Vec3& v : particles_.centre_velocity) fastest2_ = std::max(fastest2_, v.squaredNorm());
        list_skin_ = std::max(skin_, 3 * dt * std::sqrt(fastest2_));  // lasts for one step at least
        ledger_.left_stored += contacts_.rebuild(find_pairs(), particles_.spheres(), moved);
        built_at_ = particles_.centre;
        loosened_ = false;
        if (admitted) {
            // Their first half kick needs forces of now; over no time dashpots lose nothing.
            const Real stored_before = contacts_.stored() + network_.stored();
            evaluate(t, 0);
            kick(0);
            ledger_.fed_stored += contacts_.stored() + network_.stored() - stored_before;
        }
    }

    /// Brings the ledger's state functions up to the present.
    const Ledger& balance() {
        const auto energy = parallel_sum<Energies>(particles_.bodies(), [&](Index b) {
            return Energies{particles_.kinetic_energy(b), potential_energy(b)};
        });
        ledger_.kinetic = energy.kinetic;
        ledger_.potential = energy.potential;
        ledger_.stored_contacts = contacts_.stored();
        ledger_.stored_bonds = network_.stored();
        return ledger_;
    }

    /// Takes the present state as the ledger's start.
    void open_ledger() {
        ledger_ = {};
        balance();
        ledger_.kinetic_start = ledger_.kinetic;
        ledger_.potential_start = ledger_.potential;
        ledger_.stored_start = ledger_.stored_contacts + ledger_.stored_bonds;
    }

    void set_skin(Real skin) noexcept { skin_ = skin; }
    Trouble take_trouble() noexcept { return std::exchange(trouble_, {}); }

    const Scene& scene() const noexcept { return scene_; }
    const Particles& particles() const noexcept { return particles_; }
    const Contacts<decltype(P::contact)>& contacts() const noexcept { return contacts_; }
    const Network<decltype(P::bond)>& network() const noexcept { return network_; }
    const Concrete& concrete() const noexcept { return concrete_; }
    Index broken_tension() const noexcept { return broken_tension_; }
    Index broken_shear() const noexcept { return broken_shear_; }
    Real gauge_volume() const noexcept { return gauge_volume_; }  ///< solid, net downstream [m3]

    /// Overlap over the smaller radius beyond which a run is wrong, whatever it computes.
    static constexpr Real overlap_limit = 0.2;

private:
    struct Energies {
        Real kinetic = 0, potential = 0;
        Energies& operator+=(const Energies& o) noexcept {
            return kinetic += o.kinetic, potential += o.potential, *this;
        }
    };
    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }

    Real potential_energy(Index b) const noexcept {
        return particles_.inverse_mass[at(b)] == 0
                   ? 0
                   : -particles_.mass[at(b)] * scene_.gravity.dot(particles_.position[at(b)]);
    }

    auto strength_left() const noexcept {
        if constexpr (P::has_wear)
            return [this](Index body) {
                return policies_.wear.strength_left(concrete_.fracture(particles_.site[at(body)]));
            };
        else
            return [](Index) { return 1.0; };
    }

    void add_concrete(ConcreteBlock& block) {
        const Lattice& lattice = block.lattice;
        const Clump sphere = make_clump("concrete", {{Vec3::Zero(), lattice.radius}});
        for (Index s = 0; s < static_cast<Index>(lattice.sites.size()); ++s) {
            const LatticeSite& site = lattice.sites[at(s)];
            // What a wall passes through stands in that wall: set free, it would be shot out of it.
            const bool in_wall = std::any_of(
                scene_.walls.begin(), scene_.walls.end(),
                [&](const Plane& wall) { return wall.distance(site.centre) < (1 - 1e-6) * lattice.radius; });
            const bool base = in_wall || site.layer + 1 == lattice.count_layers;
            const Index body = particles_.add(sphere, block.density, {.position = site.centre},
                                              base ? Kind::fixed : Kind::concrete);
            particles_.site[at(body)] = s;
        }
        if constexpr (P::has_bonds) {
            std::vector<Pair> bonded;
            for (const auto& [i, j] : lattice.neighbours())
                if (particles_.inverse_mass[at(i)] + particles_.inverse_mass[at(j)] > 0)
                    bonded.push_back({i, j});
            network_.build(particles_, std::move(bonded));
        } else {
            // Without bonds there is nothing to hold the spheres together: they stand as a rigid bed.
            for (Index b = 0; b < particles_.bodies(); ++b) hold(b);
        }
        concrete_ = Concrete(std::move(block.lattice), block.fracture_volume);
    }

    void hold(Index b) {
        particles_.kind[at(b)] = Kind::fixed;
        particles_.inverse_mass[at(b)] = 0;
        particles_.inverse_inertia[at(b)].setZero();
    }

    /// Makes room for the loads of new bodies; whether there are any.
    bool admit_new_bodies() {
        const bool any = at(particles_.bodies()) > interaction_.size();
        interaction_.resize(at(particles_.bodies()), Vec3::Zero());
        if constexpr (P::has_fluid) fluid_.resize(at(particles_.bodies()));
        return any;
    }

    /// Sums the pair loads of a body's spheres, adds weight and water, and wears the concrete.
    void gather_one(Index b) noexcept {
        Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
        Real worn = 0;
        const Index first = particles_.first_sphere[at(b)];
        for (Index s = first; s < first + particles_.sphere_count[at(b)]; ++s) {
            Vec3 sphere_force = Vec3::Zero();
            const auto collect = [&](const auto& source) {
                for (const auto side : source.incidence().of(s)) {
                    const PairLoad& load = source.loads()[at(side.pair)];
                    // A contact that has just opened pushes no more but may still have lost something.
                    if constexpr (P::has_wear) worn += source.worn(side.pair);
                    if (!load.active) continue;
                    sphere_force += side.first ? load.force : Vec3(-load.force);
                    torque += (side.first ? load.arm_first : load.arm_second) * load.twist;
                }
            };
            collect(contacts_);
            if constexpr (P::has_bonds) collect(network_);
            torque += (particles_.centre[at(s)] - particles_.position[at(b)]).cross(sphere_force);
            force += sphere_force;
        }
        if constexpr (P::has_wear)
            if (worn > 0 && particles_.site[at(b)] >= 0) concrete_.wear(particles_.site[at(b)], worn);
        interaction_[at(b)] = force;
        particles_.torque[at(b)] = torque;
        force += particles_.mass[at(b)] * scene_.gravity;
        if constexpr (P::has_fluid) {
            fluid_[at(b)] = {};
            if (particles_.kind[at(b)] == Kind::stone || particles_.kind[at(b)] == Kind::grain) {
                const Vec3& x = particles_.position[at(b)];
                fluid_[at(b)] =
                    fluid_load(policies_.drag, policies_.fluid.sample(x, loads_time_),
                               {x, predicted_velocity(b), particles_.volume[at(b)]}, scene_.gravity);
                force += fluid_[at(b)].drag + fluid_[at(b)].buoyancy;
            }
        }
        particles_.force[at(b)] = force;
    }

    /// For a body of one sphere that of the sphere; clumps keep theirs beside it.
    Vec3 predicted_velocity(Index b) const noexcept {
        const auto s = at(particles_.first_sphere[at(b)]);
        const Vec3 arm = particles_.centre[s] - particles_.position[at(b)];
        return particles_.centre_velocity[s] - particles_.spin[s].cross(arm);
    }

    KickSums kick_one(Index b, Real dt) noexcept {
        const FluidLoad* fluid = nullptr;
        if constexpr (P::has_fluid) fluid = &fluid_[at(b)];
        return kick_body(particles_, b, interaction_[at(b)], fluid, scene_.gravity, dt);
    }

    MoveSums drift_one(Index b, Real dt) noexcept {
        MoveSums sums;
        if (particles_.inverse_mass[at(b)] == 0) return sums;
        const Real x_before = particles_.position[at(b)].x();
        drift_body(particles_, b, dt);
        const Index first = particles_.first_sphere[at(b)];
        for (Index s = first; s < first + particles_.sphere_count[at(b)]; ++s) {
            sums.drift.furthest2 =
                std::max(sums.drift.furthest2, (particles_.centre[at(s)] - built_at_[at(s)]).squaredNorm());
            sums.drift.fastest2 =
                std::max(sums.drift.fastest2, particles_.centre_velocity[at(s)].squaredNorm());
        }
        const Vec3& x = particles_.position[at(b)];
        if (scene_.gauge && particles_.kind[at(b)] == Kind::stone)
            sums.drift.gauge =
                particles_.volume[at(b)] * ((x.x() >= *scene_.gauge) - (x_before >= *scene_.gauge));
        if (!scene_.bounds.contains(x)) sums.drift.lost = b;
        return sums;
    }

    void kick(Real dt) {
        const bool gather = std::exchange(loads_waiting_, false);
        move([&](Index b) {
            if (gather) gather_one(b);
            return MoveSums{kick_one(b, dt), {}};
        });
    }

    /// One pass over the bodies, and what it adds to the ledger.
    template <class Each>
    void move(Each&& each) {
        const auto sums = parallel_sum<MoveSums>(particles_.bodies(), each);
        ledger_.interaction_work += sums.kick.interaction;
        ledger_.gravity_work += sums.kick.gravity;
        ledger_.drag_work += sums.kick.drag;
        ledger_.drag_input += sums.kick.drag_input;
        ledger_.buoyancy_work += sums.kick.buoyancy;
        furthest2_ = std::max(furthest2_, sums.drift.furthest2);
        fastest2_ = std::max(fastest2_, sums.drift.fastest2);
        gauge_volume_ += sums.drift.gauge;
        if (trouble_.cause != Trouble::Cause::none) return;
        if (sums.kick.bad >= 0)
            trouble_ = {Trouble::Cause::not_finite, sums.kick.bad, -1, 0};
        else if (sums.drift.lost >= 0)
            trouble_ = {Trouble::Cause::lost, sums.drift.lost, -1, 0};
    }

    void report_overlap(const Pair& pair, Real overlap) {
        trouble_ = {Trouble::Cause::overlap, particles_.body[at(pair.first)],
                    pair.second < 0 ? -1 : particles_.body[at(pair.second)], overlap};
    }

    std::vector<Index> remove_departed() {
        std::vector<char> gone(at(particles_.bodies()), 0);
        bool any = false;
        if (scene_.outlet)
            for (Index b = 0; b < particles_.bodies(); ++b) {
                if (particles_.inverse_mass[at(b)] == 0 || particles_.position[at(b)].x() <= *scene_.outlet)
                    continue;
                if (particles_.kind[at(b)] == Kind::concrete) continue;
                gone[at(b)] = 1;
                any = true;
                ledger_.left_kinetic += particles_.kinetic_energy(b);
                ledger_.left_potential += potential_energy(b);
            }
        if (any) {
            std::size_t to = 0;
            for (std::size_t from = 0; from < gone.size(); ++from)
                if (!gone[from]) {
                    interaction_[to] = interaction_[from];
                    if constexpr (P::has_fluid) fluid_[to] = fluid_[from];
                    ++to;
                }
            interaction_.resize(to);
            if constexpr (P::has_fluid) fluid_.resize(to);
            return particles_.remove(gone);
        }
        std::vector<Index> same(at(particles_.spheres()));
        for (std::size_t s = 0; s < same.size(); ++s) same[s] = static_cast<Index>(s);
        return same;
    }

    std::vector<Pair> find_pairs() const {
        std::vector<char> passive(at(particles_.spheres()));
        for (Index s = 0; s < particles_.spheres(); ++s) {
            const Kind kind = particles_.kind[at(particles_.body[at(s)])];
            passive[at(s)] = kind == Kind::concrete || kind == Kind::fixed;
        }
        std::vector<Pair> pairs =
            near_pairs({particles_.centre, particles_.radius, particles_.body, passive, list_skin_});
        if constexpr (P::has_bonds)
            std::erase_if(pairs, [&](const Pair& pair) { return network_.holds(pair); });
        for (Index s = 0; s < particles_.spheres(); ++s)
            for (Index w = 0; w < static_cast<Index>(scene_.walls.size()); ++w)
                if (!passive[at(s)] && scene_.walls[at(w)].distance(particles_.centre[at(s)]) <
                                           particles_.radius[at(s)] + list_skin_)
                    pairs.push_back({s, -1 - w});
        std::sort(pairs.begin(), pairs.end());
        return pairs;
    }

    P policies_;
    Scene scene_;  ///< its lattice has moved into concrete_
    Particles particles_;
    Contacts<decltype(P::contact)> contacts_;
    Network<decltype(P::bond)> network_;
    Concrete concrete_;
    Ledger ledger_;
    std::vector<Vec3> interaction_;  ///< [body] force of contacts and bonds [N]
    std::vector<FluidLoad> fluid_;   ///< [body]; empty without a fluid
    std::vector<Vec3> built_at_;     ///< [sphere] where the list of pairs was made [m]
    Real skin_ = 0, list_skin_ = 0, furthest2_ = 0, fastest2_ = 0, gauge_volume_ = 0;
    Index broken_tension_ = 0, broken_shear_ = 0;
    Real loads_time_ = 0;
    bool loads_waiting_ = false;    ///< between the force pass and the kick that gathers its loads
    bool pattern_changed_ = false;  ///< a bond broke
    bool loosened_ = false;         ///< concrete came loose
    Trouble trouble_;
};

}  // namespace abrade
