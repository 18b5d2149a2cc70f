#pragma once
// Concrete whose spheres can turn against each other as gears do: which of them turn together, and how fast
// those turn that sleep.

#include <abrade/bond/ties.hpp>
#include <abrade/dem/sphere_lines.hpp>
#include <abrade/geometry/lattice.hpp>

namespace abrade {

/// Two spheres of one radius do not slip at their bond, of normal n, where (rim_i + rim_j) x n = 0, with rim
/// = radius times angular velocity. Of a component across the bond that asks rim_i = -rim_j, of the one along
/// it nothing. So, component by component, spheres whose bonds lie along the axes form trains of gears, all
/// at one speed with a sign s_i each. No spring resists that and no dashpot damps it:
///   d rim / dt = 5/2 sum s_i lever_i / (m n)
/// for the n spheres of a train that sleep; the levers [N] are those of bonds to spheres that are awake, for
/// what bonds between sleepers exert cancels. A train that holds on to the ground is stuck, and so is one of
/// which a bond is oblique or that closes with the wrong sign, as three gears in a ring do. It stays as built
/// when bonds break: what they held apart can still turn so. While all that is awake is slow, trains are
/// held.
class GearTrains {
public:
    /// Spheres. A longer one counts as stuck: it would turn as one, however far away the others are, where in
    /// truth a wave runs out and does not come back in time.
    static constexpr std::size_t longest = 1000;

    /// Looks for trains in concrete as it is bonded.
    void build(const Ties& ties, std::span<const LatticeSite> sites) {
        train_of_.assign(3 * sites.size(), 0), trains_.clear();
        std::vector<char> seen(train_of_.size(), 0);
        for (Index site = 0; site < static_cast<Index>(sites.size()); ++site)
            for (int axis = 0; axis < 3; ++axis)
                if (!seen[of(site, axis)]) build_from(site, axis, ties, sites, seen);
    }
    bool built() const noexcept { return !train_of_.empty(); }

    /// Of a sphere that sleeps, radius times angular velocity [m/s].
    Vec3 rim(Index site) const noexcept {
        Vec3 all = Vec3::Zero();
        for (int axis = 0; axis < 3; ++axis)
            if (const Share own = share(site, axis); own.train >= 0)
                all[axis] = own.sign * trains_[at(own.train)].rim;
        return all;
    }
    /// Sum of rim squared over all that sleep [m2/s2].
    Real rims_squared() const noexcept {
        Real all = 0;
        for (const Train& train : trains_) all += train.asleep * square(train.rim);
        return all;
    }

    /// One falls asleep that turned with `rim` [m/s]: it and its trains go on with their mean. Returns the
    /// sum of rim squared that is lost [m2/s2].
    Real add(Index site, const Vec3& rim) noexcept {
        Real lost = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const Share own = share(site, axis);
            if (own.train < 0) {
                lost += square(rim[axis]);
                continue;
            }
            Train& train = trains_[at(own.train)];
            const Real more = own.sign * rim[axis] - train.rim, all = ++train.asleep,
                       shared = held_ ? 0 : 1 / all;
            lost += square(more) * (1 - shared);
            train.rim += more * shared;
        }
        return lost;
    }
    /// One wakes, as fast as it turns.
    void remove(Index site) noexcept {
        for (int axis = 0; axis < 3; ++axis)
            if (const Share own = share(site, axis); own.train >= 0)
                if (Train& train = trains_[at(own.train)]; --train.asleep == 0) train.rim = 0;
    }
    /// Has all trains stand, and the lines of anchors, or lets them turn again. Returns what is lost, as
    /// `add` does.
    Real hold(bool still, SphereLines& lines) noexcept {
        held_ = still;
        if (!still) return 0;
        const Real lost = rims_squared();
        for (Train& train : trains_) train.rim = 0;
        for (const Meshed& one : meshed_) lines.motion[at(one.slot)].rim[one.axis] = 0;
        return lost;
    }

    /// Anchors are found anew; those that turn are to be told one by one, with their slots.
    void unmesh() noexcept { meshed_.clear(); }
    void mesh(Index site, Index slot, Index anchor) {
        for (int axis = 0; axis < 3; ++axis)
            if (const Share own = share(site, axis); own.train >= 0)
                meshed_.push_back({own, axis, slot, anchor});
    }
    bool turn_anchors() const noexcept { return !held_ && !meshed_.empty(); }
    /// Kicks for `dt` [s] the trains of anchors, on which act `lever_on(anchor)` [N], and has the anchors'
    /// lines turn with them; `inverse_mass` [1/kg] is that of a sphere. Returns the work done [J].
    template <class LeverOn>
    Real turn(Real dt, Real inverse_mass, LeverOn&& lever_on, SphereLines& lines) noexcept {
        for (const Meshed& one : meshed_)
            trains_[at(one.own.train)].lever += one.own.sign * lever_on(one.anchor)[one.axis];
        Real work = 0;
        for (const Meshed& one : meshed_) {
            Train& train = trains_[at(one.own.train)];
            const Real lever = std::exchange(train.lever, 0), before = train.rim;
            train.rim += 2.5 * dt * inverse_mass * lever / train.asleep;
            work += 0.5 * dt * lever * (before + train.rim);
            lines.motion[at(one.slot)].rim[one.axis] = one.own.sign * train.rim;
        }
        return work;
    }

private:
    struct Train {
        Index asleep = 0;
        Real rim = 0;    ///< of those [m/s]
        Real lever = 0;  ///< on them, until it is turned [N]
    };
    struct Share {
        Index train = -1;
        Real sign = 1;
    };
    struct Meshed {
        Share own;
        int axis = 0;
        Index slot = 0, anchor = 0;
    };

    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }
    static std::size_t of(Index site, int axis) noexcept {
        return 3 * at(site) + static_cast<std::size_t>(axis);
    }
    Share share(Index site, int axis) const noexcept {
        if (trains_.empty()) return {};
        const Index own = train_of_[of(site, axis)];
        return {std::abs(own) - 1, own < 0 ? -1.0 : 1.0};
    }

    void build_from(Index first, int axis, const Ties& ties, std::span<const LatticeSite> sites,
                    std::vector<char>& seen) {
        constexpr Real straight = 1e-6;
        bool stuck = false;
        std::vector<Index> members{first};
        seen[of(first, axis)] = 1, train_of_[of(first, axis)] = static_cast<Index>(trains_.size()) + 1;
        for (std::size_t n = 0; n < members.size(); ++n) {
            const Index site = members[n], own = train_of_[of(site, axis)];
            stuck |= ties.held(site);
            for (const Ties::End& end : ties.of(site)) {
                const Vec3 way = sites[at(end.other)].centre - sites[at(site)].centre;
                const Real along = std::abs(way[axis]) / way.norm();
                if (along > 1 - straight) continue;
                Index& other = train_of_[of(end.other, axis)];
                if (!std::exchange(seen[of(end.other, axis)], 1)) other = -own, members.push_back(end.other);
                stuck |= along > straight || other != -own;
            }
        }
        if (!stuck && members.size() <= longest)
            trains_.emplace_back();
        else
            for (const Index site : members) train_of_[of(site, axis)] = 0;
    }

    std::vector<Index> train_of_;  ///< [site, axis] number + 1 with its sign; 0: stuck
    std::vector<Train> trains_;
    std::vector<Meshed> meshed_;  ///< anchors that turn
    bool held_ = false;           ///< what falls asleep does not turn on
};

}  // namespace abrade
