#pragma once
// Everything that moves, and the two halves of a step that move it.

#include <abrade/bond/network.hpp>
#include <abrade/coupling/drag.hpp>
#include <abrade/dem/contacts.hpp>
#include <abrade/dem/rotation.hpp>
#include <abrade/sim/ledger.hpp>
#include <abrade/sim/scene.hpp>
#include <abrade/wear/concrete.hpp>
#include <abrade/wear/wear_law.hpp>

namespace abrade {

/// The four policies, and the drag law that goes with the fluid.
template <ContactLaw C, BondLaw B, WearLaw W, FluidModel F, DragLaw D>
struct Policies {
    static constexpr bool has_bonds = !std::same_as<B, NoBond>;
    static constexpr bool has_wear = !std::same_as<W, NoWear>;
    static constexpr bool has_fluid = !std::same_as<F, NoFluid>;

    C contact;
    [[no_unique_address]] B bond;
    [[no_unique_address]] W wear;
    [[no_unique_address]] F fluid;
    [[no_unique_address]] D drag;
};

/// What the engine finds wrong with a step.
struct Trouble {
    enum class Cause : std::uint8_t { none, not_finite, lost, overlap } cause = Cause::none;
    Index body = -1, other = -1;  ///< bodies; `other` is negative for a boundary
    Real measure = 0;             ///< overlap over the smaller radius [-]
};

/// State and forces: a MechanicalState for the steppers of dem/stepper.hpp.
template <class P>
class World {
public:
    World(Scene scene, P policies) : policies_(std::move(policies)), scene_(std::move(scene)) {
        scene_.validate();
        if (scene_.concrete) add_concrete(*scene_.concrete);
        for (const Scene::Stone& stone : scene_.stones) particles_.add(stone.clump, stone.density, stone.state, Kind::stone);
        admit_new_bodies();
    }

    // --- MechanicalState -----------------------------------------------------------------------

    /// v += dt F/m, L += dt tau; books the works of this half kick.
    friend void kick(World& w, Real dt) { w.kick(dt); }
    /// x += dt v, orientations likewise; predicts the velocities for the force pass.
    friend void drift(World& w, Real dt) { w.drift(dt); }

    /// The force pass at time t: every law once, memory committed, losses booked, concrete worn.
    void evaluate(Real t, Real dt) {
        const ContactSums contacts = contacts_.respond(policies_.contact, policies_.wear, particles_, scene_.walls, dt);
        ledger_.lost_normal += contacts.lost_normal;
        ledger_.lost_sliding += contacts.lost_tangential;
        ledger_.concrete_lost_normal += contacts.concrete_lost_normal;
        ledger_.concrete_lost_sliding += contacts.concrete_lost_tangential;
        if (!(contacts.deepest <= overlap_limit)) report_overlap(contacts);
        if constexpr (P::has_bonds) {
            const BondSums bonds = network_.respond(policies_.bond, policies_.wear, particles_, strength_left(), dt);
            ledger_.lost_bond += bonds.lost_bond;
            ledger_.lost_normal += bonds.lost_normal;
            ledger_.lost_sliding += bonds.lost_tangential;
            ledger_.concrete_lost_normal += bonds.concrete_lost_normal;
            ledger_.concrete_lost_sliding += bonds.concrete_lost_tangential;
            broken_tension_ += bonds.broken_tension;
            broken_shear_ += bonds.broken_shear;
            pattern_changed_ |= bonds.broken_tension + bonds.broken_shear > 0;
        }
        gather(t);
    }

    // --- between steps -------------------------------------------------------------------------

    /// Whether the list of near pairs may miss a contact, or the set of bodies should change.
    bool list_is_stale() const noexcept { return furthest2_ > square(0.5 * skin_) || pattern_changed_; }

    /// Renews what changes seldom: loose concrete, bodies that left, supply, near pairs.
    void renew(Real t, Feed* feed) {
        if constexpr (P::has_bonds)
            if (pattern_changed_) set_loose_concrete_free();
        const Index bodies_before = particles_.bodies();
        const std::vector<Index> moved = remove_departed();
        if constexpr (P::has_bonds)
            if (pattern_changed_ || particles_.bodies() != bodies_before) ledger_.left_stored += network_.prune(particles_, moved);
        if (feed)
            feed->supply(particles_, t, [&](Index body) {
                ledger_.fed_kinetic += particles_.kinetic_energy(body);
                ledger_.fed_potential += potential_energy(body);
            });
        admit_new_bodies();
        ledger_.left_stored += contacts_.rebuild(find_pairs(), particles_.spheres(), moved);
        built_at_ = particles_.centre;
        furthest2_ = 0;
        pattern_changed_ = false;
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

    P& policies() noexcept { return policies_; }
    const P& policies() const noexcept { return policies_; }
    const Scene& scene() const noexcept { return scene_; }
    const Particles& particles() const noexcept { return particles_; }
    const Contacts<decltype(P::contact)>& contacts() const noexcept { return contacts_; }
    const Network<decltype(P::bond)>& network() const noexcept { return network_; }
    const Concrete& concrete() const noexcept { return concrete_; }
    Index broken_tension() const noexcept { return broken_tension_; }
    Index broken_shear() const noexcept { return broken_shear_; }
    Real gauge_volume() const noexcept { return gauge_volume_; }  ///< solid, net downstream [m3]
    Real skin() const noexcept { return skin_; }

    /// Overlap over the smaller radius beyond which a run is wrong, whatever it computes.
    static constexpr Real overlap_limit = 0.2;

private:
    struct Energies {
        Real kinetic = 0, potential = 0;
        Energies& operator+=(const Energies& o) noexcept { return kinetic += o.kinetic, potential += o.potential, *this; }
    };
    struct KickSums {
        Real interaction = 0, gravity = 0, drag = 0, drag_input = 0, buoyancy = 0;
        Index bad = -1;
        KickSums& operator+=(const KickSums& o) noexcept {
            interaction += o.interaction, gravity += o.gravity, drag += o.drag, drag_input += o.drag_input, buoyancy += o.buoyancy;
            if (bad < 0) bad = o.bad;
            return *this;
        }
    };
    struct DriftSums {
        Real furthest2 = 0, gauge = 0;
        Index lost = -1;
        DriftSums& operator+=(const DriftSums& o) noexcept {
            furthest2 = std::max(furthest2, o.furthest2), gauge += o.gauge;
            if (lost < 0) lost = o.lost;
            return *this;
        }
    };

    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }

    Real potential_energy(Index b) const noexcept {
        return particles_.inverse_mass[at(b)] == 0 ? 0 : -particles_.mass[at(b)] * scene_.gravity.dot(particles_.position[at(b)]);
    }

    auto strength_left() const noexcept {
        return [this](Index body) {
            if constexpr (P::has_wear) return policies_.wear.strength_left(concrete_.fracture(particles_.site[at(body)]));
            return 1.0;
        };
    }

    void add_concrete(ConcreteBlock& block) {
        const Lattice& lattice = block.lattice;
        const Clump sphere = make_clump("concrete", {{Vec3::Zero(), lattice.radius}});
        for (Index s = 0; s < static_cast<Index>(lattice.sites.size()); ++s) {
            const LatticeSite& site = lattice.sites[at(s)];
            const bool base = site.layer + 1 == lattice.count_layers;
            const Index body = particles_.add(sphere, block.density, {.position = site.centre}, base ? Kind::fixed : Kind::concrete);
            particles_.site[at(body)] = s;
        }
        if constexpr (P::has_bonds) {
            std::vector<Pair> bonded;
            for (const auto& [i, j] : lattice.neighbours())
                if (particles_.inverse_mass[at(i)] + particles_.inverse_mass[at(j)] > 0) bonded.push_back({i, j});
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

    /// New bodies feel their weight from their first half kick on; contacts and water follow at its end.
    void admit_new_bodies() {
        for (Index b = static_cast<Index>(interaction_.size()); b < particles_.bodies(); ++b)
            particles_.force[at(b)] = particles_.mass[at(b)] * scene_.gravity;
        interaction_.resize(at(particles_.bodies()), Vec3::Zero());
        if constexpr (P::has_fluid) fluid_.resize(at(particles_.bodies()));
    }

    /// Sums the pair loads of each body's spheres, adds weight and water, and wears the concrete.
    void gather(Real t) {
        parallel_for(particles_.bodies(), [&](Index b) {
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
                    fluid_[at(b)] = fluid_load(policies_.drag, policies_.fluid.sample(x, t),
                                               {x, predicted_velocity(b), particles_.volume[at(b)]}, scene_.gravity);
                    force += fluid_[at(b)].drag + fluid_[at(b)].buoyancy;
                }
            }
            particles_.force[at(b)] = force;
        });
    }

    /// For a body of one sphere that of the sphere; clumps keep theirs beside it.
    Vec3 predicted_velocity(Index b) const noexcept {
        const auto s = at(particles_.first_sphere[at(b)]);
        const Vec3 arm = particles_.centre[s] - particles_.position[at(b)];
        return particles_.centre_velocity[s] - particles_.spin[s].cross(arm);
    }

    void kick(Real dt) {
        constexpr Real fastest2 = 1e8;  // (10 km/s)^2: no speed of this field; catches infinities, and NaN by the sense of the test
        const auto sums = parallel_sum<KickSums>(particles_.bodies(), [&](Index b) {
            KickSums work;
            if (particles_.inverse_mass[at(b)] == 0) return work;
            Vec3& v = particles_.velocity[at(b)];
            const Vec3 before = v;
            v += dt * particles_.inverse_mass[at(b)] * particles_.force[at(b)];
            const Vec3 path = 0.5 * dt * (before + v);
            const Vec3 spin_before = particles_.angular_velocity(b);
            particles_.angular_momentum[at(b)] += dt * particles_.torque[at(b)];
            const Vec3 turn = 0.5 * dt * (spin_before + particles_.angular_velocity(b));
            work.interaction = interaction_[at(b)].dot(path) + particles_.torque[at(b)].dot(turn);
            work.gravity = particles_.mass[at(b)] * scene_.gravity.dot(path);
            if constexpr (P::has_fluid) {
                work.drag = fluid_[at(b)].drag.dot(path);
                work.drag_input = dt * fluid_[at(b)].drag.dot(fluid_[at(b)].fluid_velocity);
                work.buoyancy = fluid_[at(b)].buoyancy.dot(path);
            }
            if (!(v.squaredNorm() + particles_.angular_momentum[at(b)].squaredNorm() < fastest2)) work.bad = b;
            return work;
        });
        ledger_.interaction_work += sums.interaction;
        ledger_.gravity_work += sums.gravity;
        ledger_.drag_work += sums.drag;
        ledger_.drag_input += sums.drag_input;
        ledger_.buoyancy_work += sums.buoyancy;
        if (sums.bad >= 0 && trouble_.cause == Trouble::Cause::none) trouble_ = {Trouble::Cause::not_finite, sums.bad, -1, 0};
    }

    void drift(Real dt) {
        const Real gauge = scene_.gauge.value_or(std::numeric_limits<Real>::infinity());
        const auto sums = parallel_sum<DriftSums>(particles_.bodies(), [&](Index b) {
            DriftSums sum;
            if (particles_.inverse_mass[at(b)] == 0) return sum;
            Vec3& x = particles_.position[at(b)];
            const Vec3 before = x;
            x += dt * particles_.velocity[at(b)];
            if (!particles_.isotropic(b))
                particles_.orientation[at(b)] = turn_freely(particles_.orientation[at(b)], particles_.angular_momentum[at(b)],
                                                            particles_.inverse_inertia[at(b)], dt);
            const Vec3 velocity = particles_.velocity[at(b)] + 0.5 * dt * particles_.inverse_mass[at(b)] * particles_.force[at(b)];
            const Vec3 momentum = particles_.angular_momentum[at(b)] + 0.5 * dt * particles_.torque[at(b)];
            particles_.place_spheres(b, velocity, particles_.angular_velocity(b, momentum));
            const Index first = particles_.first_sphere[at(b)];
            for (Index s = first; s < first + particles_.sphere_count[at(b)]; ++s)
                sum.furthest2 = std::max(sum.furthest2, (particles_.centre[at(s)] - built_at_[at(s)]).squaredNorm());
            if (particles_.kind[at(b)] == Kind::stone)
                sum.gauge = particles_.volume[at(b)] * ((x.x() >= gauge) - (before.x() >= gauge));
            if (!scene_.bounds.contains(x)) sum.lost = b;
            return sum;
        });
        furthest2_ = std::max(furthest2_, sums.furthest2);
        gauge_volume_ += sums.gauge;
        if (sums.lost >= 0 && trouble_.cause == Trouble::Cause::none) trouble_ = {Trouble::Cause::lost, sums.lost, -1, 0};
    }

    void report_overlap(const ContactSums& contacts) {
        const Pair& pair = contacts_.pairs()[at(contacts.deepest_pair)];
        trouble_ = {Trouble::Cause::overlap, particles_.body[at(pair.first)], pair.second < 0 ? -1 : particles_.body[at(pair.second)], contacts.deepest};
    }

    void set_loose_concrete_free() {
        const std::vector<char> tied = network_.tied_to_ground(particles_);
        for (Index b = 0; b < particles_.bodies(); ++b)
            if (particles_.kind[at(b)] == Kind::concrete && !tied[at(b)]) {
                particles_.kind[at(b)] = Kind::grain;
                concrete_.set_gone(particles_.site[at(b)]);
            }
    }

    std::vector<Index> remove_departed() {
        std::vector<char> gone(at(particles_.bodies()), 0);
        bool any = false;
        if (scene_.outlet)
            for (Index b = 0; b < particles_.bodies(); ++b) {
                if (particles_.inverse_mass[at(b)] == 0 || particles_.position[at(b)].x() <= *scene_.outlet) continue;
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
        std::vector<Pair> pairs = near_pairs({particles_.centre, particles_.radius, particles_.body, passive, skin_});
        if constexpr (P::has_bonds) std::erase_if(pairs, [&](const Pair& pair) { return network_.holds(pair); });
        for (Index s = 0; s < particles_.spheres(); ++s)
            for (Index w = 0; w < static_cast<Index>(scene_.walls.size()); ++w)
                if (!passive[at(s)] && scene_.walls[at(w)].distance(particles_.centre[at(s)]) < particles_.radius[at(s)] + skin_)
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
    Real skin_ = 0, furthest2_ = 0, gauge_volume_ = 0;
    Index broken_tension_ = 0, broken_shear_ = 0;
    bool pattern_changed_ = false;
    Trouble trouble_;
};

}  // namespace abrade
