#pragma once
// The contacts of a step: near pairs, the memory of those that touch, and the loads they answer with.

#include <abrade/core/parallel.hpp>
#include <abrade/dem/contact_law.hpp>
#include <abrade/dem/neighbours.hpp>
#include <abrade/dem/particles.hpp>
#include <abrade/geometry/surfaces.hpp>

#include <span>

namespace abrade {

/// What one pair does to its two spheres. With the contact point on the line of centres at `arm` from
/// each, both spheres feel the torque arm (f x n) about their centres.
struct PairLoad {
    Vec3 force = Vec3::Zero();           ///< on the first; the second feels the opposite [N]
    Vec3 twist = Vec3::Zero();           ///< f x n [N]
    Real arm_first = 0, arm_second = 0;  ///< [m]
    Real stored = 0;                     ///< [J]
    bool active = false;
};

/// Which loads act on which sphere: for each sphere a run of (pair, side). Sums over it have a fixed order,
/// so threads cannot change them.
class Incidence {
public:
    struct Side {
        Index pair;
        bool first;
    };

    /// `pair_at(p)` gives a Pair of spheres; a negative second is a boundary and has no side.
    template <class PairAt>
    void build(Index spheres, Index pairs, PairAt&& pair_at) {
        start_.assign(static_cast<std::size_t>(spheres) + 1, 0);
        const auto each_side = [&](auto&& visit) {
            for (Index p = 0; p < pairs; ++p) {
                const Pair pair = pair_at(p);
                visit(pair.first, Side{p, true});
                if (pair.second >= 0) visit(pair.second, Side{p, false});
            }
        };
        each_side([&](Index sphere, Side) { ++start_[static_cast<std::size_t>(sphere) + 1]; });
        for (std::size_t s = 1; s < start_.size(); ++s) start_[s] += start_[s - 1];
        sides_.resize(static_cast<std::size_t>(start_.back()));
        std::vector<Index> fill(start_.begin(), start_.end() - 1);
        each_side([&](Index sphere, Side side) {
            sides_[static_cast<std::size_t>(fill[static_cast<std::size_t>(sphere)]++)] = side;
        });
    }

    std::span<const Side> of(Index sphere) const noexcept {
        const auto s = static_cast<std::size_t>(sphere);
        if (s + 1 >= start_.size()) return {};  // spheres added since have no side yet
        return {sides_.data() + start_[s], static_cast<std::size_t>(start_[s + 1] - start_[s])};
    }

private:
    std::vector<Index> start_;
    std::vector<Side> sides_;
};

/// Sums over the contacts of one step, and the deepest of them. `concrete_*` count a loss once for each
/// of the two bodies that is concrete.
struct ContactSums {
    Real lost_normal = 0, lost_tangential = 0;                    ///< [J]
    Real concrete_lost_normal = 0, concrete_lost_tangential = 0;  ///< [J]
    Real deepest = 0;                                             ///< overlap over the smaller radius [-]
    Index deepest_pair = -1;                                      ///< into the list of pairs

    ContactSums& operator+=(const ContactSums& other) noexcept {
        lost_normal += other.lost_normal;
        lost_tangential += other.lost_tangential;
        concrete_lost_normal += other.concrete_lost_normal;
        concrete_lost_tangential += other.concrete_lost_tangential;
        if (other.deepest > deepest || !(other.deepest == other.deepest)) {
            deepest = other.deepest;
            deepest_pair = other.deepest_pair;
        }
        return *this;
    }
};

/// Contacts of spheres with each other and with planes. A pair's `second` is a sphere, or -1 - p for plane p.
template <ContactLaw Law>
class Contacts {
public:
    using Memory = typename Law::template Memory<Real>;

    /// Takes a new sorted list of pairs. Memory of pairs that touch is carried over; `moved` says where the
    /// spheres of the old list are now (-1: gone). Returns the elastic energy of pairs that went with them or
    /// are no longer in the list [J].
    Real rebuild(std::vector<Pair> pairs, Index spheres, std::span<const Index> moved) {
        struct Kept {
            Pair pair;
            Memory memory;
            PairLoad load;
        };
        std::vector<Kept> kept;
        Real gone = 0;
        for (std::size_t p = 0; p < pairs_.size(); ++p) {
            if (!loads_[p].active) continue;
            const Index first = moved[static_cast<std::size_t>(pairs_[p].first)];
            const Index second =
                pairs_[p].second < 0 ? pairs_[p].second : moved[static_cast<std::size_t>(pairs_[p].second)];
            const bool second_gone = pairs_[p].second >= 0 && second < 0;
            if (first < 0 || second_gone)
                gone += loads_[p].stored;
            else
                kept.push_back({{first, second}, memory_[p], loads_[p]});
        }
        std::sort(kept.begin(), kept.end(), [](const Kept& a, const Kept& b) { return a.pair < b.pair; });
        pairs_ = std::move(pairs);
        memory_.assign(pairs_.size(), Memory{});
        loads_.assign(pairs_.size(), PairLoad{});
        worn_.assign(pairs_.size(), 0);
        auto next = kept.begin();
        for (std::size_t p = 0; p < pairs_.size(); ++p) {
            for (; next != kept.end() && next->pair < pairs_[p]; ++next) gone += next->load.stored;
            if (next == kept.end() || next->pair != pairs_[p]) continue;
            memory_[p] = next->memory;
            loads_[p] = next->load;
            ++next;
        }
        for (; next != kept.end(); ++next) gone += next->load.stored;
        incidence_.build(spheres, static_cast<Index>(pairs_.size()),
                         [&](Index p) { return pairs_[static_cast<std::size_t>(p)]; });
        return gone;
    }

    /// Evaluates the law once for each pair and commits its memory. `wear` is asked for each pair with
    /// concrete in it.
    template <class Wear>
    ContactSums respond(const Law& law, const Wear& wear, const Particles& particles,
                        std::span<const Plane> planes, Real dt) {
        return parallel_sum<ContactSums>(static_cast<Index>(pairs_.size()), [&](Index p) {
            return respond_one(law, wear, particles, planes, dt, static_cast<std::size_t>(p));
        });
    }

    /// Elastic energy of all contacts [J].
    Real stored() const noexcept {
        Real sum = 0;
        for (const PairLoad& load : loads_) sum += load.stored;
        return sum;
    }

    const std::vector<Pair>& pairs() const noexcept { return pairs_; }
    const std::vector<PairLoad>& loads() const noexcept { return loads_; }
    Real worn(Index pair) const noexcept {
        return worn_[static_cast<std::size_t>(pair)];
    }  ///< off each side, this step [m3]
    const Incidence& incidence() const noexcept { return incidence_; }

private:
    template <class Wear>
    ContactSums respond_one(const Law& law, const Wear& wear, const Particles& a,
                            std::span<const Plane> planes, Real dt, std::size_t p) noexcept {
        PairLoad& load = loads_[p];
        worn_[p] = 0;
        const auto i = static_cast<std::size_t>(pairs_[p].first);
        const auto body_i = static_cast<std::size_t>(a.body[i]);
        ContactKinematics<Real> contact{};
        contact.time_step = dt;
        Real reach = a.radius[i], arm_second = 0, smaller = a.radius[i],
             inverse_mass = a.inverse_mass[body_i];
        int concrete_sides = a.site[body_i] >= 0 ? 1 : 0;

        if (pairs_[p].second < 0) {
            const Plane& plane = planes[static_cast<std::size_t>(-1 - pairs_[p].second)];
            const Real distance = plane.distance(a.centre[i]);
            contact.overlap = reach - distance;
            if (contact.overlap <= 0 && !load.active) return {};
            contact.normal = plane.normal;
            contact.curvature = 1 / a.radius[i];
            load.arm_first = a.radius[i] - 0.5 * contact.overlap;
            contact.velocity = a.centre_velocity[i] - load.arm_first * a.spin[i].cross(contact.normal);
            contact.travel =
                dt * (a.centre_drift[i] - load.arm_first * a.spin_drift[i].cross(contact.normal));
        } else {
            const auto j = static_cast<std::size_t>(pairs_[p].second);
            const auto body_j = static_cast<std::size_t>(a.body[j]);
            reach += a.radius[j];
            const Vec3 apart = a.centre[i] - a.centre[j];
            const Real distance2 = apart.squaredNorm();
            if (distance2 >= square(reach) && !load.active) return {};
            const Real distance = std::sqrt(distance2);
            contact.normal = apart / std::max(distance, 1e-300);
            contact.overlap = reach - distance;
            smaller = std::min(a.radius[i], a.radius[j]);
            contact.curvature = 1 / a.radius[i] + 1 / a.radius[j];
            load.arm_first = a.radius[i] - 0.5 * contact.overlap;
            arm_second = a.radius[j] - 0.5 * contact.overlap;
            contact.velocity = a.centre_velocity[i] - a.centre_velocity[j] -
                               (load.arm_first * a.spin[i] + arm_second * a.spin[j]).cross(contact.normal);
            contact.travel =
                dt *
                (a.centre_drift[i] - a.centre_drift[j] -
                 (load.arm_first * a.spin_drift[i] + arm_second * a.spin_drift[j]).cross(contact.normal));
            inverse_mass += a.inverse_mass[body_j];
            concrete_sides += a.site[body_j] >= 0 ? 1 : 0;
        }
        contact.inverse_mass = inverse_mass;

        const auto [answer, memory] = law.respond(contact, memory_[p]);
        memory_[p] = memory;
        load.force = answer.force;
        load.twist = answer.force.cross(contact.normal);
        load.arm_second = arm_second;
        load.stored = answer.stored;
        load.active = contact.overlap > 0;
        ContactSums sums{answer.lost_normal,        answer.lost_tangential, 0, 0,
                         contact.overlap / smaller, static_cast<Index>(p)};
        if (concrete_sides > 0) {
            const auto worn = wear.increment(contact, answer);
            worn_[p] = worn.normal + worn.tangential;
            sums.concrete_lost_normal = concrete_sides * answer.lost_normal;
            sums.concrete_lost_tangential = concrete_sides * answer.lost_tangential;
        }
        return sums;
    }

    std::vector<Pair> pairs_;
    std::vector<Memory> memory_;
    std::vector<PairLoad> loads_;
    std::vector<Real> worn_;
    Incidence incidence_;
};

}  // namespace abrade
