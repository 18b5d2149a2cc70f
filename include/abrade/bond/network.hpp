#pragma once
// The bonds of a body of concrete: who holds whom, what breaks, and what is still tied to the ground.

#include <abrade/bond/bond_law.hpp>
#include <abrade/dem/contact_kernel.hpp>
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

/// How the two of a bond moved when last seen, the first relative to the second.
template <class Law>
struct SeenEnds {
    Vec3 velocity = Vec3::Zero();  ///< halfway between them [m/s]
};
template <CarriesMoments Law>
struct SeenEnds<Law> {
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
    Vec3 spin = Vec3::Zero();      ///< [rad/s]
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
        Real stored = 0;             ///< when last evaluated [J]
        SeenEnds<Law> before{};
        typename Law::Memory memory{};
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
    /// Calls `visit(bond, slab)` for each bond, which may set its slots.
    template <class Visit>
    void each_bond(Visit&& visit) {
        for (std::size_t slab = 0; slab + 1 < first_bond_.size(); ++slab)
            for (Index b = first_bond_[slab]; b < first_bond_[slab + 1]; ++b)
                visit(bonds_[at(b)], static_cast<Index>(slab));
    }

    /// Evaluates the law once for each bond of a slab, commits its memory and adds its answer to the loads.
    /// `strength_left(body)` is what is left of that body's strength, `wear` is asked for the losses of
    /// broken bonds.
    template <class Wear, class StrengthLeft>
    BondSums respond(Index slab, const Law& law, const Wear& wear, SphereLines& lines,
                     const StrengthLeft& strength_left, const ContactStep& step) noexcept {
        BondSums sums;
        for (Index b = first_bond_[at(slab)]; b < first_bond_[at(slab) + 1]; ++b)
            respond_one(b, law, wear, lines, strength_left, step, sums);
        return sums;
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
        Real gone = 0;
        const auto dropped = [&](Bond& bond) {
            const BondedPair now{moved[at(bond.spheres.first)], moved[at(bond.spheres.second)]};
            if (now.first < 0 || now.second < 0) return gone += bond.stored, true;
            const auto i = at(now.first), j = at(now.second);
            bond.spheres = now;
            bond.bodies = {particles.body[i], particles.body[j]};
            if (!bond.memory.broken) return false;
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

    template <class Wear, class StrengthLeft>
    void respond_one(Index index, const Law& law, const Wear& wear, SphereLines& lines,
                     const StrengthLeft& strength_left, const ContactStep& step, BondSums& sums) noexcept {
        Bond& held = bonds_[at(index)];
        const auto i = at(held.slots.first), j = at(held.slots.second);
        const Vec3 apart = lines.place[i].centre - lines.place[j].centre;
        const Real length = apart.norm(), lambda = length / (lines.place[i].radius + lines.place[j].radius);
        BondKinematics bond;
        bond.normal = apart / length;
        bond.compression = held.rest_length - length;
        const Vec3 velocity = lines.motion[i].velocity - lines.motion[j].velocity -
                              (lambda * (lines.motion[i].rim + lines.motion[j].rim)).cross(bond.normal);
        bond.velocity = velocity + step.ahead * (velocity - held.before.velocity);
        bond.travel = step.time_step * velocity;
        if constexpr (CarriesMoments<Law>) {
            const Vec3 spin = lines.motion[i].curvature * lines.motion[i].rim -
                              lines.motion[j].curvature * lines.motion[j].rim;
            bond.spin = spin + step.ahead * (spin - held.before.spin);
            bond.turn = step.time_step * spin;
            bond.effective_inertia = held.effective_inertia;
            held.before.spin = spin;
        }
        bond.radius = held.radius, bond.length = held.rest_length;
        bond.effective_mass = held.effective_mass;
        bond.time_step = step.time_step;
        held.before.velocity = velocity;

        const auto [answer, memory, fate] = law.respond(
            bond, law.strength(strength_left(held.bodies.first), strength_left(held.bodies.second)),
            held.memory);
        held.memory = memory;
        held.stored = answer.stored;
        const Vec3 lever = lambda * answer.force.cross(bond.normal);
        Real worn_off = 0;
        sums.lost_bond += answer.lost_bond;
        sums.lost_normal += answer.lost_normal, sums.lost_tangential += answer.lost_tangential;
        sums.stored += answer.stored;
        sums.broken_tension += fate == Fate::tension, sums.broken_shear += fate == Fate::shear;
        if (const Real depth = bond.compression / bond.radius; depth > sums.deepest)
            sums.deepest = depth, sums.deepest_bond = index;
        if (memory.broken) {
            const ContactKinematics<Real> contact{.normal = bond.normal,
                                                  .overlap = bond.compression,
                                                  .velocity = bond.velocity,
                                                  .inverse_mass = 1 / bond.effective_mass,
                                                  .curvature = 2 / bond.radius,
                                                  .time_step = step.time_step,
                                                  .travel = bond.travel};
            const auto worn = wear.increment(
                contact,
                ContactLoad<Real>{answer.force, answer.stored, answer.lost_normal, answer.lost_tangential});
            worn_off = worn.normal + worn.tangential;
            sums.concrete_lost_normal += 2 * answer.lost_normal;
            sums.concrete_lost_tangential += 2 * answer.lost_tangential;
        }
        SphereLoad &first = lines.load[i], &second = lines.load[j];
        first.force += answer.force, first.worn += worn_off, first.lever += lever;
        second.force -= answer.force, second.worn += worn_off, second.lever += lever;
        if constexpr (CarriesMoments<Law>) {
            first.lever += lines.motion[i].curvature * answer.couple;  // a torque over the radius
            second.lever -= lines.motion[j].curvature * answer.couple;
        }
    }

    /// Bodies at the other ends of a body's sound bonds, one after the other.
    std::pair<std::vector<Index>, std::vector<Index>> sound_neighbours(Index bodies) const {
        std::vector<Index> start(at(bodies) + 1, 0);
        const auto each_end = [&](auto&& visit) {
            for (const Bond& bond : bonds_)
                if (!bond.memory.broken)
                    visit(bond.bodies.first, bond.bodies.second),
                        visit(bond.bodies.second, bond.bodies.first);
        };
        each_end([&](Index body, Index) { ++start[at(body) + 1]; });
        for (std::size_t b = 1; b < start.size(); ++b) start[b] += start[b - 1];
        std::vector<Index> neighbour(at(start.back())), fill(start.begin(), start.end() - 1);
        each_end([&](Index body, Index other) { neighbour[at(fill[at(body)]++)] = other; });
        return {std::move(start), std::move(neighbour)};
    }

    std::vector<Bond> bonds_;              ///< slab by slab
    std::vector<BondedPair> held_;         ///< spheres, sorted
    std::vector<Index> first_bond_{0, 0};  ///< [slab]
};

}  // namespace abrade
