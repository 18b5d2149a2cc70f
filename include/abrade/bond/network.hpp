#pragma once
// The bonds of a body of concrete: who holds whom, what breaks, and what is still tied to the ground.

#include <abrade/bond/bond_law.hpp>
#include <abrade/dem/contacts.hpp>

namespace abrade {

/// Sums over the bonds of one step.
struct BondSums {
    Real lost_bond = 0, lost_normal = 0, lost_tangential = 0;  ///< [J]
    Real concrete_lost_normal = 0,
         concrete_lost_tangential = 0;           ///< both sides of a broken bond are concrete [J]
    Index broken_tension = 0, broken_shear = 0;  ///< bonds that broke in this step
    Real deepest = 0;                            ///< compression over the smaller radius [-]
    Index deepest_bond = -1;

    BondSums& operator+=(const BondSums& other) noexcept {
        lost_bond += other.lost_bond;
        lost_normal += other.lost_normal;
        lost_tangential += other.lost_tangential;
        concrete_lost_normal += other.concrete_lost_normal;
        concrete_lost_tangential += other.concrete_lost_tangential;
        broken_tension += other.broken_tension;
        broken_shear += other.broken_shear;
        if (other.deepest > deepest || !(other.deepest == other.deepest))
            deepest = other.deepest, deepest_bond = other.deepest_bond;
        return *this;
    }
};

/// Bonds between single-sphere bodies. A broken bond stays in the network as a frictional contact for as
/// long as both of its spheres are part of the standing concrete.
template <BondLaw Law>
class Network {
public:
    /// Bonds the given pairs of spheres, each of them a body, as they stand: rest lengths are the present
    /// distances.
    void build(const Particles& particles, std::vector<Pair> bonded) {
        std::sort(bonded.begin(), bonded.end());
        pairs_ = std::move(bonded);
        rest_length_.clear();
        for (const Pair& pair : pairs_)
            rest_length_.push_back((particles.centre[static_cast<std::size_t>(pair.first)] -
                                    particles.centre[static_cast<std::size_t>(pair.second)])
                                       .norm());
        memory_.assign(pairs_.size(), {});
        loads_.assign(pairs_.size(), {});
        worn_.assign(pairs_.size(), 0);
        index(particles);
    }

    /// Evaluates the law once for each bond and commits its memory. `strength_left(body)` is what is left of
    /// that body's strength, `wear` is asked for the losses of broken bonds.
    template <class Wear, class StrengthLeft>
    BondSums respond(const Law& law, const Wear& wear, const Particles& particles,
                     StrengthLeft&& strength_left, Real dt) {
        return parallel_sum<BondSums>(static_cast<Index>(pairs_.size()), [&](Index b) {
            return respond_one(law, wear, particles, strength_left, dt, static_cast<std::size_t>(b));
        });
    }

    /// Marks [body] what is tied to a fixed body through sound bonds.
    std::vector<char> tied_to_ground(const Particles& particles) const {
        std::vector<char> tied(static_cast<std::size_t>(particles.bodies()), 0);
        std::vector<Index> front;
        for (Index b = 0; b < particles.bodies(); ++b)
            if (particles.kind[static_cast<std::size_t>(b)] == Kind::fixed)
                tied[static_cast<std::size_t>(b)] = 1, front.push_back(b);
        while (!front.empty()) {
            const Index b = front.back();
            front.pop_back();
            for (const auto side : incidence_.of(particles.first_sphere[static_cast<std::size_t>(b)])) {
                const auto p = static_cast<std::size_t>(side.pair);
                const Index other = side.first ? bodies_[p].second : bodies_[p].first;
                if (memory_[p].broken || tied[static_cast<std::size_t>(other)]) continue;
                tied[static_cast<std::size_t>(other)] = 1;
                front.push_back(other);
            }
        }
        return tied;
    }

    /// Drops broken bonds that are open, as contacts too, and have a loose end: the contact law takes over.
    /// Drops bonds whose body is gone. `moved` says where the spheres are now. Returns the elastic energy [J]
    /// of what went with bodies that are gone.
    Real prune(const Particles& particles, std::span<const Index> moved) {
        std::size_t to = 0;
        Real gone = 0;
        for (std::size_t from = 0; from < pairs_.size(); ++from) {
            const Pair pair{moved[static_cast<std::size_t>(pairs_[from].first)],
                            moved[static_cast<std::size_t>(pairs_[from].second)]};
            if (pair.first < 0 || pair.second < 0) {
                gone += loads_[from].stored;
                continue;
            }
            const auto loose = [&](Index sphere) {
                return particles.kind[static_cast<std::size_t>(
                           particles.body[static_cast<std::size_t>(sphere)])] == Kind::grain;
            };
            const auto i = static_cast<std::size_t>(pair.first), j = static_cast<std::size_t>(pair.second);
            const Real apart = (particles.centre[i] - particles.centre[j]).norm();
            const bool open = !loads_[from].active && apart >= particles.radius[i] + particles.radius[j];
            if (memory_[from].broken && open && (loose(pair.first) || loose(pair.second))) continue;
            pairs_[to] = pair;
            rest_length_[to] = rest_length_[from];
            memory_[to] = memory_[from];
            loads_[to] = loads_[from];
            ++to;
        }
        pairs_.resize(to), rest_length_.resize(to), memory_.resize(to), loads_.resize(to);
        worn_.assign(to, 0);
        index(particles);
        return gone;
    }

    /// Whether two spheres are looked after here and must not be contacts as well.
    bool holds(const Pair& pair) const noexcept {
        return std::binary_search(pairs_.begin(), pairs_.end(), pair);
    }

    Real stored() const noexcept {
        Real sum = 0;
        for (const PairLoad& load : loads_) sum += load.stored;
        return sum;
    }

    const std::vector<Pair>& pairs() const noexcept { return pairs_; }  ///< of spheres
    const std::vector<PairLoad>& loads() const noexcept { return loads_; }
    bool broken(Index bond) const noexcept { return memory_[static_cast<std::size_t>(bond)].broken; }
    Real worn(Index bond) const noexcept {
        return worn_[static_cast<std::size_t>(bond)];
    }  ///< off each side, this step [m3]
    const Incidence& incidence() const noexcept { return incidence_; }

private:
    template <class Wear, class StrengthLeft>
    BondSums respond_one(const Law& law, const Wear& wear, const Particles& a,
                         const StrengthLeft& strength_left, Real dt, std::size_t p) noexcept {
        const auto i = static_cast<std::size_t>(pairs_[p].first),
                   j = static_cast<std::size_t>(pairs_[p].second);
        const Vec3 apart = a.centre[i] - a.centre[j];
        const Real length = apart.norm();
        BondKinematics bond;
        bond.normal = apart / length;
        bond.compression = rest_length_[p] - length;
        const Real arm = 0.5 * length;
        bond.velocity =
            a.centre_velocity[i] - a.centre_velocity[j] - (arm * (a.spin[i] + a.spin[j])).cross(bond.normal);
        bond.travel = dt * (a.centre_drift[i] - a.centre_drift[j] -
                            (arm * (a.spin_drift[i] + a.spin_drift[j])).cross(bond.normal));
        bond.radius = std::min(a.radius[i], a.radius[j]);
        bond.effective_mass = effective_mass_[p];
        bond.time_step = dt;

        const auto [answer, memory, fate] =
            law.respond(bond, law.strength(strength_left(bodies_[p].first), strength_left(bodies_[p].second)),
                        memory_[p]);
        memory_[p] = memory;
        loads_[p] = {answer.force,  answer.force.cross(bond.normal),       arm, arm,
                     answer.stored, !memory.broken || bond.compression > 0};
        BondSums sums{answer.lost_bond,
                      answer.lost_normal,
                      answer.lost_tangential,
                      0,
                      0,
                      fate == Fate::tension,
                      fate == Fate::shear,
                      bond.compression / bond.radius,
                      static_cast<Index>(p)};
        if (memory.broken) {
            const ContactKinematics<Real> contact{.normal = bond.normal,
                                                  .overlap = bond.compression,
                                                  .velocity = bond.velocity,
                                                  .inverse_mass = 1 / bond.effective_mass,
                                                  .curvature = 2 / bond.radius,
                                                  .time_step = dt,
                                                  .travel = bond.travel};
            const auto worn = wear.increment(
                contact, {answer.force, answer.stored, answer.lost_normal, answer.lost_tangential});
            worn_[p] = worn.normal + worn.tangential;
            sums.concrete_lost_normal = 2 * answer.lost_normal;
            sums.concrete_lost_tangential = 2 * answer.lost_tangential;
        }
        return sums;
    }

    void index(const Particles& particles) {
        bodies_.clear();
        effective_mass_.clear();
        for (const Pair& pair : pairs_) {
            const Pair bodies{particles.body[static_cast<std::size_t>(pair.first)],
                              particles.body[static_cast<std::size_t>(pair.second)]};
            bodies_.push_back(bodies);
            effective_mass_.push_back(1 / (particles.inverse_mass[static_cast<std::size_t>(bodies.first)] +
                                           particles.inverse_mass[static_cast<std::size_t>(bodies.second)]));
        }
        incidence_.build(particles.spheres(), static_cast<Index>(pairs_.size()),
                         [&](Index p) { return pairs_[static_cast<std::size_t>(p)]; });
    }

    std::vector<Pair> pairs_, bodies_;  ///< of spheres, and the bodies they belong to
    std::vector<Real> rest_length_;     ///< [m]
    std::vector<Real> effective_mass_;  ///< [kg]
    std::vector<typename Law::Memory> memory_;
    std::vector<PairLoad> loads_;
    std::vector<Real> worn_;
    Incidence incidence_;
};

}  // namespace abrade
