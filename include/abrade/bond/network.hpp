#pragma once
// The bonds of a body of concrete: what they answer, what breaks, and what comes loose.

#include <abrade/bond/bond_graph.hpp>
#include <abrade/bond/bond_pack.hpp>
#include <abrade/dem/contacts/contact_observer.hpp>
#include <abrade/dem/store/sphere_store.hpp>

#include <span>

namespace abrade {

/// Sums over the bonds of one evaluation.
struct BondSums {
    Real lost_bond = 0, lost_normal = 0, lost_tangential = 0, stored = 0;  ///< [J]
    Real watched_lost_normal = 0,
         watched_lost_tangential = 0;            ///< both sides of a broken bond are watched [J]
    Index broken_tension = 0, broken_shear = 0;  ///< bonds that broke in this step
    Real deepest = 0;                            ///< compression over the smaller radius [-]
    Index deepest_bond = -1;

    BondSums& operator+=(const BondSums& other) noexcept {
        lost_bond += other.lost_bond;
        lost_normal += other.lost_normal;
        lost_tangential += other.lost_tangential;
        stored += other.stored;
        watched_lost_normal += other.watched_lost_normal;
        watched_lost_tangential += other.watched_lost_tangential;
        broken_tension += other.broken_tension;
        broken_shear += other.broken_shear;
        if (other.deepest > deepest) deepest = other.deepest, deepest_bond = other.deepest_bond;
        return *this;
    }
};

/// Nothing has worn: what `Network::respond` need not ask for.
struct Unworn {
    Real operator()(Index /*body*/) const noexcept { return 1; }
};

/// Bonds between single-sphere bodies. A broken bond stays in the network as a frictional contact until it is
/// open and one of its spheres has come loose (`prune`), or one is gone: a pressed one with a loose end
/// stays.
template <BondLaw Law>
class Network {
public:
    struct Bond {
        BondedPair members;  ///< as built, for good
        BondedPair spheres;  ///< lasting indices
        BondedPair bodies;
        SlotPair slots;
        Real rest_length = 0;        ///< [m]
        Real radius = 0;             ///< the smaller [m]
        Real effective_mass = 0;     ///< [kg]
        Real effective_inertia = 0;  ///< [kg m2]
        Real stored = 0;             ///< when last evaluated [J]; in packs until `unpack`
        SeenEnds<Law, Real> before{};
        typename Law::Memory memory{};
        bool dropped = false;  ///< the contact law has taken over, or a body is gone

        bool broken() const noexcept { return static_cast<bool>(memory.broken); }
    };

    /// Bonds the given pairs of spheres, each of them a body, as they stand: rest lengths are the present
    /// distances. Spheres as they are numbered now are the members of `ties`.
    void build(const Particles& particles, std::vector<BondedPair> bonded) {
        std::sort(bonded.begin(), bonded.end());
        std::vector<char> held(at(particles.spheres()));
        for (std::size_t s = 0; s < held.size(); ++s)
            held[s] = particles.kind[at(particles.body[s])] == Kind::fixed;
        graph_.build(bonded, std::move(held));
        bonds_.clear(), active_.clear();
        for (const BondedPair& pair : bonded) {
            const auto i = at(pair.first), j = at(pair.second);
            active_.push_back(static_cast<Index>(bonds_.size()));
            Bond& bond = bonds_.emplace_back();
            bond.members = bond.spheres = pair;
            bond.bodies = {particles.body[i], particles.body[j]};
            bond.rest_length = (particles.centre[i] - particles.centre[j]).norm();
            bond.radius = std::min(particles.radius[i], particles.radius[j]);
            const auto a = at(bond.bodies.first), b = at(bond.bodies.second);
            bond.effective_mass = 1 / (particles.inverse_mass[a] + particles.inverse_mass[b]);
            bond.effective_inertia =
                1 / (particles.inverse_inertia[a].maxCoeff() + particles.inverse_inertia[b].maxCoeff());
        }
        changed_ = true;
        first_bond_.assign({0, size()}), breaks_.assign(1, {});
    }

    /// Sorts the bonds by the slab that is in charge of them.
    void arrange(const SphereStore& store) {
        unpack();
        const auto slab_of = [&](Index number) {
            const Bond& bond = bonds_[at(number)];
            return std::min(store.slab_of_slot(store.slot_of(bond.spheres.first)),
                            store.slab_of_slot(store.slot_of(bond.spheres.second)));
        };
        const auto in_order = [&](Index a, Index b) { return slab_of(a) < slab_of(b); };
        if (!std::is_sorted(active_.begin(), active_.end(), in_order))
            std::stable_sort(active_.begin(), active_.end(), in_order);
        first_bond_.assign(at(store.slabs.count()) + 1, 0);
        for (const Index number : active_) ++first_bond_[at(slab_of(number)) + 1];
        for (std::size_t s = 1; s < first_bond_.size(); ++s) first_bond_[s] += first_bond_[s - 1];
        if (breaks_.size() < at(store.slabs.count())) breaks_.resize(at(store.slabs.count()));
        if (!std::exchange(changed_, false)) return;
        looked_after_.clear();
        each_bond([&](const Bond& bond) { looked_after_.push_back(in_order_of(bond.spheres)); });
        std::sort(looked_after_.begin(), looked_after_.end());
    }
    /// Calls `visit(bond)` for each bond.
    void each_bond(auto&& visit) const {
        for (const Index number : active_) visit(bonds_[at(number)]);
    }
    /// Calls `visit(bond, slab)` for each of them, slab by slab.
    void each_bond_by_slab(auto&& visit) {
        for (std::size_t slab = 0; slab + 1 < first_bond_.size(); ++slab)
            for (Index n = first_bond_[slab]; n < first_bond_[slab + 1]; ++n)
                visit(bonds_[at(active_[at(n)])], static_cast<Index>(slab));
    }
    /// Puts the bonds into packs, slab by slab; `slots_of(bond, slab)` says where their spheres are.
    template <class SlotsOf>
    void pack(Index phantom, SlotsOf&& slots_of) {
        each_bond_by_slab([&](Bond& bond, Index slab) { bond.slots = slots_of(bond, slab); });
        packs_.clear();
        first_pack_.assign(first_bond_.size(), 0);
        for (std::size_t slab = 0; slab + 1 < first_bond_.size(); ++slab) {
            for (Index n = first_bond_[slab]; n < first_bond_[slab + 1]; ++n)
                put(active_[at(n)], (n - first_bond_[slab]) % pack_lanes, phantom);
            first_pack_[slab + 1] = static_cast<Index>(packs_.size());
        }
    }
    /// Brings back from the packs what bonds remember.
    void unpack() {
        for (const BondPack<Law>& pack : packs_)
            for (int k = 0; k < pack_lanes; ++k) {
                if (pack.bond[static_cast<std::size_t>(k)] < 0) continue;
                Bond& bond = bonds_[at(pack.bond[static_cast<std::size_t>(k)])];
                bond.memory = detail::memory_of_lane<typename Law::Memory>(pack.memory, k);
                bond.before = detail::memory_of_lane<SeenEnds<Law, Real>>(pack.before, k);
                bond.stored = pack.stored[k];
            }
        packs_.clear(), first_pack_.assign(first_pack_.size(), 0);
    }

    /// Evaluates the law once for each bond of a slab, commits its memory and adds its answer to the loads.
    /// `strength_left(body)` is what is left of that body's strength, `observer` sees broken bonds,
    /// which are contacts.
    template <ContactObserver Observer, class StrengthLeft>
    BondSums respond(Index slab, const Law& law, const Observer& observer, HotArrays& lines,
                     const StrengthLeft& strength_left, const ContactStep& step) noexcept {
        BondSums sums;
        PackBondSums all;
        const LineReader reader(lines);
        for (Index p = first_pack_[at(slab)]; p < first_pack_[at(slab) + 1]; ++p) {
            BondPack<Law>& pack = packs_[at(p)];
            Vec3Of<Pack> arm;
            const BondKinematicsOf<Pack> bond = bonds_between(reader, pack, step, arm);
            const auto [load, failure] = answer(law, bond, strengths(law, pack, strength_left), pack);
            pack.stored = load.stored;
            all.add(load);
            if (any(bond.compression > Pack(sums.deepest) * bond.radius)) look_deeper(bond, pack, sums);
            if (any(failure.tension | failure.shear)) note_fates(failure, pack, sums, breaks_[at(slab)]);
            add_loads(reader, pack, load, arm, observed(observer, bond, load, pack, sums));
        }
        return all.into(sums);
    }

    /// Cuts the ties that broke since the last call, in the order of slabs, and finds what that leaves
    /// loose. Piece by piece members in ascending order.
    std::vector<BondGraph::Component> take_loose() {
        for (std::vector<Index>& broken : breaks_) {
            for (const Index number : broken) graph_.cut(number, bonds_[at(number)].members);
            broken.clear();
        }
        return graph_.take_loose();
    }

    /// Cuts the ties of a member that is to go.
    void sever(Index member) {
        for (const BondGraph::End& end : graph_.of(member)) graph_.cut(end.tie, bonds_[at(end.tie)].members);
    }

    /// Drops broken bonds that are open, as contacts too, and have a loose end: the contact law takes over.
    /// Drops bonds whose body is gone. `moved` says where the spheres are now, `centre` where they stand.
    /// Returns the elastic energy [J] of what went with bodies that are gone.
    Real prune(const Particles& particles, std::span<const Index> moved, std::span<const Vec3> centre) {
        unpack();
        Real gone = 0;
        const auto dropped = [&](Index number) {
            Bond& bond = bonds_[at(number)];
            const BondedPair now{moved[at(bond.spheres.first)], moved[at(bond.spheres.second)]};
            bond.dropped = true;
            if (now.first < 0 || now.second < 0) return gone += bond.stored, true;
            const auto i = at(now.first), j = at(now.second);
            bond.spheres = now;
            bond.bodies = {particles.body[i], particles.body[j]};
            const Real apart = (centre[i] - centre[j]).norm();
            const bool open = apart >= std::max(bond.rest_length, particles.radius[i] + particles.radius[j]);
            const auto loose = [&](Index body) { return particles.kind[at(body)] == Kind::grain; };
            return bond.dropped =
                       bond.broken() && open && (loose(bond.bodies.first) || loose(bond.bodies.second));
        };
        std::erase_if(active_, dropped);
        changed_ = true;
        return gone;
    }

    /// Drops the bonds whose two bodies are `joined`. Returns the elastic energy that they held [J].
    Real drop(auto&& joined) {
        unpack();
        Real held = 0;
        changed_ |= std::erase_if(active_, [&](Index number) {
                        Bond& bond = bonds_[at(number)];
                        if (!joined(bond.bodies.first) || !joined(bond.bodies.second)) return false;
                        bond.dropped = true, held += bond.stored;
                        return true;
                    }) > 0;
        return held;
    }

    /// Whether two spheres are looked after here and must not be contacts as well.
    bool holds(const BondedPair& pair) const noexcept {
        return std::binary_search(looked_after_.begin(), looked_after_.end(), in_order_of(pair));
    }

    Index size() const noexcept { return static_cast<Index>(active_.size()); }
    std::span<const Index> active() const noexcept { return active_; }  ///< their numbers
    std::span<const Bond> bonds() const noexcept { return bonds_; }     ///< [number] all, dropped ones too
    const Bond& bond(Index number) const noexcept { return bonds_[at(number)]; }
    const BondGraph& graph() const noexcept { return graph_; }

    static void fields(auto&& field) {
        field.bytes("bonds", &Network::bonds_), field("active", &Network::active_),
            field("graph", &Network::graph_), field("breaks", &Network::breaks_),
            field.bytes("packs", &Network::packs_), field("first_pack", &Network::first_pack_),
            field.bytes("looked_after", &Network::looked_after_), field("first_bond", &Network::first_bond_),
            field("changed", &Network::changed_);
    }

private:
    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }
    /// Pairs are found whichever way round they are given.
    static BondedPair in_order_of(const BondedPair& pair) noexcept {
        return {std::min(pair.first, pair.second), std::max(pair.first, pair.second)};
    }

    struct PackBondSums {
        Pack lost_bond = 0, lost_normal = 0, lost_tangential = 0, stored = 0;
        void add(const BondLoadOf<Pack>& load) noexcept {
            lost_bond += load.lost_bond, lost_normal += load.lost_normal;
            lost_tangential += load.lost_tangential, stored += load.stored;
        }
        BondSums into(BondSums sums) const noexcept {
            sums.lost_bond = sum(lost_bond), sums.stored = sum(stored);
            sums.lost_normal = sum(lost_normal), sums.lost_tangential = sum(lost_tangential);
            return sums;
        }
    };

    template <class StrengthLeft>
    Pack strengths(const Law& law, const BondPack<Law>& pack, const StrengthLeft& left) const noexcept {
        Pack all(law.strength(1, 1));
        if constexpr (std::same_as<StrengthLeft, Unworn>) return all;
        for (std::size_t k = 0; k < pack.bond.size(); ++k) {
            if (pack.bond[k] < 0) continue;
            const Bond& bond = bonds_[at(pack.bond[k])];
            all.set(static_cast<int>(k), law.strength(left(bond.bodies.first), left(bond.bodies.second)));
        }
        return all;
    }
    void look_deeper(const BondKinematicsOf<Pack>& bond, const BondPack<Law>& pack,
                     BondSums& sums) const noexcept {
        for (int k = 0; k < pack_lanes; ++k)
            if (const Real depth = bond.compression[k] / bond.radius[k]; depth > sums.deepest)
                sums.deepest = depth, sums.deepest_bond = pack.bond[static_cast<std::size_t>(k)];
    }
    void note_fates(const PackFailureMode& failure, BondPack<Law>& pack, BondSums& sums,
                    std::vector<Index>& broken) noexcept {
        pack.has_broken = true;
        for (int k = 0; k < pack_lanes; ++k) {
            sums.broken_tension += failure.tension[k], sums.broken_shear += failure.shear[k];
            if (!failure.tension[k] && !failure.shear[k]) continue;
            broken.push_back(pack.bond[static_cast<std::size_t>(k)]);
            bonds_[at(broken.back())].memory.broken = 1;
        }
    }
    /// What an observer finds of either side of broken bonds, which are contacts.
    template <ContactObserver Observer>
    Pack observed(const Observer& observer, const BondKinematicsOf<Pack>& bond, const BondLoadOf<Pack>& load,
                  const BondPack<Law>& pack, BondSums& sums) const noexcept {
        Pack seen = 0;
        if (!pack.has_broken) return seen;
        for (int k = 0; k < pack_lanes; ++k) {
            const Index b = pack.bond[static_cast<std::size_t>(k)];
            if (b < 0 || !bonds_[at(b)].broken() || !(bond.compression[k] > 0)) continue;
            const ContactKinematics<Real> contact{.normal = detail::lane_of(bond.normal, k),
                                                  .overlap = bond.compression[k],
                                                  .velocity = detail::lane_of(bond.velocity, k),
                                                  .inverse_mass = 1 / bond.effective_mass[k],
                                                  .curvature = 2 / bond.radius[k],
                                                  .time_step = bond.time_step,
                                                  .displacement = detail::lane_of(bond.displacement, k)};
            const ContactLoad<Real> answer{detail::lane_of(load.force, k), load.stored[k],
                                           load.lost_normal[k], load.lost_tangential[k]};
            seen.set(k, observer.observe(contact, answer));
            sums.watched_lost_normal += 2 * load.lost_normal[k];
            sums.watched_lost_tangential += 2 * load.lost_tangential[k];
        }
        return seen;
    }

    void put(Index b, Index lane, Index phantom) {
        if (lane == 0) {
            BondPack<Law>& fresh = packs_.emplace_back();
            fresh.first.fill(line_offset(phantom)), fresh.second.fill(line_offset(phantom + 1));
            fresh.bond.fill(-1);
            typename Law::Memory none{};
            none.broken = 1;
            for (int k = 0; k < pack_lanes; ++k) detail::set_memory_of_lane(fresh.memory, k, none);
        }
        BondPack<Law>& pack = packs_.back();
        const Bond& bond = bonds_[at(b)];
        const auto k = static_cast<std::size_t>(lane);
        pack.first[k] = line_offset(bond.slots.first), pack.second[k] = line_offset(bond.slots.second);
        pack.bond[k] = b;
        pack.rest_length.set(lane, bond.rest_length), pack.radius.set(lane, bond.radius);
        pack.effective_mass.set(lane, bond.effective_mass);
        pack.effective_inertia.set(lane, bond.effective_inertia);
        pack.stored.set(lane, bond.stored);
        detail::set_memory_of_lane(pack.before, lane, bond.before);
        detail::set_memory_of_lane(pack.memory, lane, bond.memory);
        pack.has_broken |= bond.broken();
    }

    std::vector<Bond> bonds_;    ///< [number] all, for good
    std::vector<Index> active_;  ///< numbers of those not dropped, slab by slab
    BondGraph graph_;
    std::vector<std::vector<Index>> breaks_;  ///< [slab] broken since `take_loose`
    std::vector<BondPack<Law>> packs_;
    std::vector<Index> first_pack_{0, 0};   ///< [slab]
    std::vector<BondedPair> looked_after_;  ///< spheres, the smaller first, sorted
    std::vector<Index> first_bond_{0, 0};   ///< [slab] into `active_`
    bool changed_ = false;                  ///< `looked_after_` is not that of the active bonds
};

}  // namespace abrade
