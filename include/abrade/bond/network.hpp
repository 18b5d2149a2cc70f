#pragma once
// The bonds of a body of concrete: who holds whom, what breaks, and what is still tied to the ground.

#include <abrade/bond/bond_pack.hpp>
#include <abrade/dem/sphere_store.hpp>

#include <span>

namespace abrade {

/// Sums over the bonds of one evaluation.
struct BondSums {
    Real lost_bond = 0, lost_normal = 0, lost_tangential = 0, stored = 0;  ///< [J]
    Real concrete_lost_normal = 0,
         concrete_lost_tangential = 0;           ///< both sides of a broken bond are concrete [J]
    Index broken_tension = 0, broken_shear = 0;  ///< bonds that broke in this step
    Real deepest = 0;                            ///< compression over the smaller radius [-]
    Index deepest_bond = -1;

    BondSums& operator+=(const BondSums& other) noexcept {
        lost_bond += other.lost_bond;
        lost_normal += other.lost_normal;
        lost_tangential += other.lost_tangential;
        stored += other.stored;
        concrete_lost_normal += other.concrete_lost_normal;
        concrete_lost_tangential += other.concrete_lost_tangential;
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

/// Two bodies that are held together.
struct BondedPair {
    Index first = 0, second = 0;
    auto operator<=>(const BondedPair&) const = default;
};

/// Bonds between single-sphere bodies. A broken bond stays in the network as a frictional contact for as
/// long as both of its spheres are part of the standing concrete.
template <BondLaw Law>
class Network {
public:
    struct Bond {
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

        bool broken() const noexcept { return static_cast<bool>(memory.broken); }
    };

    /// Bonds the given pairs of spheres, each of them a body, as they stand: rest lengths are the present
    /// distances.
    void build(const Particles& particles, std::vector<BondedPair> bonded) {
        std::sort(bonded.begin(), bonded.end());
        held_ = bonded;
        bonds_.clear();
        for (const BondedPair& pair : bonded) {
            const auto i = at(pair.first), j = at(pair.second);
            Bond& bond = bonds_.emplace_back();
            bond.spheres = pair;
            bond.bodies = {particles.body[i], particles.body[j]};
            bond.rest_length = (particles.centre[i] - particles.centre[j]).norm();
            bond.radius = std::min(particles.radius[i], particles.radius[j]);
            const auto a = at(bond.bodies.first), b = at(bond.bodies.second);
            bond.effective_mass = 1 / (particles.inverse_mass[a] + particles.inverse_mass[b]);
            bond.effective_inertia =
                1 / (particles.inverse_inertia[a].maxCoeff() + particles.inverse_inertia[b].maxCoeff());
        }
        first_bond_.assign({0, size()});
    }

    /// Sorts the bonds by the slab that is in charge of them.
    void arrange(const SphereStore& store) {
        unpack();
        const auto slab_of = [&](const Bond& bond) {
            return std::min(store.slab_of_slot(store.slot_of(bond.spheres.first)),
                            store.slab_of_slot(store.slot_of(bond.spheres.second)));
        };
        const auto in_order = [&](const Bond& a, const Bond& b) { return slab_of(a) < slab_of(b); };
        if (!std::is_sorted(bonds_.begin(), bonds_.end(), in_order))
            std::stable_sort(bonds_.begin(), bonds_.end(), in_order);
        first_bond_.assign(at(store.slabs.count()) + 1, 0);
        for (const Bond& bond : bonds_) ++first_bond_[at(slab_of(bond)) + 1];
        for (std::size_t s = 1; s < first_bond_.size(); ++s) first_bond_[s] += first_bond_[s - 1];
    }
    /// Calls `visit(bond, slab)` for each bond.
    template <class Visit>
    void each_bond(Visit&& visit) {
        for (std::size_t slab = 0; slab + 1 < first_bond_.size(); ++slab)
            for (Index b = first_bond_[slab]; b < first_bond_[slab + 1]; ++b)
                visit(bonds_[at(b)], static_cast<Index>(slab));
    }
    /// Puts the bonds into packs, slab by slab; `slots_of(bond, slab)` says where their spheres are.
    template <class SlotsOf>
    void pack(Index phantom, SlotsOf&& slots_of) {
        each_bond([&](Bond& bond, Index slab) { bond.slots = slots_of(bond, slab); });
        packs_.clear();
        first_pack_.assign(first_bond_.size(), 0);
        for (std::size_t slab = 0; slab + 1 < first_bond_.size(); ++slab) {
            for (Index b = first_bond_[slab]; b < first_bond_[slab + 1]; ++b)
                put(b, (b - first_bond_[slab]) % pack_lanes, phantom);
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
    /// `strength_left(body)` is what is left of that body's strength, `wear` is asked for the losses of
    /// broken bonds.
    template <class Wear, class StrengthLeft>
    BondSums respond(Index slab, const Law& law, const Wear& wear, SphereLines& lines,
                     const StrengthLeft& strength_left, const ContactStep& step) noexcept {
        BondSums sums;
        PackBondSums all;
        const LineReader reader(lines);
        for (Index p = first_pack_[at(slab)]; p < first_pack_[at(slab) + 1]; ++p) {
            BondPack<Law>& pack = packs_[at(p)];
            Vec3Of<Pack> arm;
            const BondKinematicsOf<Pack> bond = bonds_between(reader, pack, step, arm);
            const auto [load, fate] = answer(law, bond, strengths(law, pack, strength_left), pack);
            pack.stored = load.stored;
            all.add(load);
            if (any(bond.compression > Pack(sums.deepest) * bond.radius)) look_deeper(bond, pack, sums);
            if (any(fate.tension | fate.shear)) note_fates(fate, pack, sums);
            add_loads(reader, pack, load, arm, worn_off(wear, bond, load, pack, sums));
        }
        return all.into(sums);
    }

    /// Marks [body] what is tied to a fixed body through sound bonds.
    std::vector<char> tied_to_ground(const Particles& particles) const {
        std::vector<char> tied(at(particles.bodies()), 0);
        std::vector<Index> front;
        for (Index b = 0; b < particles.bodies(); ++b)
            if (particles.kind[at(b)] == Kind::fixed) tied[at(b)] = 1, front.push_back(b);
        const auto [start, neighbour] = sound_neighbours(particles.bodies());
        while (!front.empty()) {
            const Index b = front.back();
            front.pop_back();
            for (Index n = start[at(b)]; n < start[at(b) + 1]; ++n) {
                const Index other = neighbour[at(n)];
                if (std::exchange(tied[at(other)], 1)) continue;
                front.push_back(other);
            }
        }
        return tied;
    }

    /// Drops broken bonds that are open, as contacts too, and have a loose end: the contact law takes over.
    /// Drops bonds whose body is gone. `moved` says where the spheres are now, `centre` where they stand.
    /// Returns the elastic energy [J] of what went with bodies that are gone.
    Real prune(const Particles& particles, std::span<const Index> moved, std::span<const Vec3> centre) {
        unpack();
        Real gone = 0;
        const auto dropped = [&](Bond& bond) {
            const BondedPair now{moved[at(bond.spheres.first)], moved[at(bond.spheres.second)]};
            if (now.first < 0 || now.second < 0) return gone += bond.stored, true;
            const auto i = at(now.first), j = at(now.second);
            bond.spheres = now;
            bond.bodies = {particles.body[i], particles.body[j]};
            if (!bond.broken()) return false;
            const Real apart = (centre[i] - centre[j]).norm();
            const bool open = apart >= std::max(bond.rest_length, particles.radius[i] + particles.radius[j]);
            const auto loose = [&](Index body) { return particles.kind[at(body)] == Kind::grain; };
            return open && (loose(bond.bodies.first) || loose(bond.bodies.second));
        };
        std::erase_if(bonds_, dropped);
        held_.clear();
        for (const Bond& bond : bonds_) held_.push_back(bond.spheres);
        std::sort(held_.begin(), held_.end());
        return gone;
    }

    /// Whether two spheres are looked after here and must not be contacts as well.
    bool holds(const BondedPair& pair) const noexcept {
        return std::binary_search(held_.begin(), held_.end(), pair);
    }

    Index size() const noexcept { return static_cast<Index>(bonds_.size()); }
    std::span<const Bond> bonds() const noexcept { return bonds_; }

private:
    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }

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
    void note_fates(const PackFate& fate, BondPack<Law>& pack, BondSums& sums) noexcept {
        pack.has_broken = true;
        for (int k = 0; k < pack_lanes; ++k) {
            sums.broken_tension += fate.tension[k], sums.broken_shear += fate.shear[k];
            if (fate.tension[k] || fate.shear[k])
                bonds_[at(pack.bond[static_cast<std::size_t>(k)])].memory.broken = 1;
        }
    }
    /// What broken bonds, which are contacts, wear off either side [m3].
    template <class Wear>
    Pack worn_off(const Wear& wear, const BondKinematicsOf<Pack>& bond, const BondLoadOf<Pack>& load,
                  const BondPack<Law>& pack, BondSums& sums) const noexcept {
        Pack worn = 0;
        if (!pack.has_broken) return worn;
        for (int k = 0; k < pack_lanes; ++k) {
            const Index b = pack.bond[static_cast<std::size_t>(k)];
            if (b < 0 || !bonds_[at(b)].broken() || !(bond.compression[k] > 0)) continue;
            const ContactKinematics<Real> contact{.normal = detail::lane_of(bond.normal, k),
                                                  .overlap = bond.compression[k],
                                                  .velocity = detail::lane_of(bond.velocity, k),
                                                  .inverse_mass = 1 / bond.effective_mass[k],
                                                  .curvature = 2 / bond.radius[k],
                                                  .time_step = bond.time_step,
                                                  .travel = detail::lane_of(bond.travel, k)};
            const auto one =
                wear.increment(contact, ContactLoad<Real>{detail::lane_of(load.force, k), load.stored[k],
                                                          load.lost_normal[k], load.lost_tangential[k]});
            worn.set(k, one.normal + one.tangential);
            sums.concrete_lost_normal += 2 * load.lost_normal[k];
            sums.concrete_lost_tangential += 2 * load.lost_tangential[k];
        }
        return worn;
    }

    /// Bodies at the other ends of a body's sound bonds, one after the other.
    std::pair<std::vector<Index>, std::vector<Index>> sound_neighbours(Index bodies) const {
        std::vector<Index> start(at(bodies) + 1, 0);
        const auto each_end = [&](auto&& visit) {
            for (const Bond& bond : bonds_)
                if (!bond.broken())
                    visit(bond.bodies.first, bond.bodies.second),
                        visit(bond.bodies.second, bond.bodies.first);
        };
        each_end([&](Index body, Index) { ++start[at(body) + 1]; });
        for (std::size_t b = 1; b < start.size(); ++b) start[b] += start[b - 1];
        std::vector<Index> neighbour(at(start.back())), fill(start.begin(), start.end() - 1);
        each_end([&](Index body, Index other) { neighbour[at(fill[at(body)]++)] = other; });
        return {std::move(start), std::move(neighbour)};
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

    std::vector<Bond> bonds_;  ///< slab by slab
    std::vector<BondPack<Law>> packs_;
    std::vector<Index> first_pack_{0, 0};  ///< [slab]
    std::vector<BondedPair> held_;         ///< spheres, sorted
    std::vector<Index> first_bond_{0, 0};  ///< [slab]
};

}  // namespace abrade
