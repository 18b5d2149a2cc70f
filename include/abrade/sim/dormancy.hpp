#pragma once
// Concrete that no load reaches: which of its spheres are bodies at all, and what wakes the others.

#include <abrade/bond/ties.hpp>
#include <abrade/dem/sphere_lines.hpp>
#include <abrade/geometry/point_grid.hpp>
#include <abrade/geometry/sphere_union.hpp>
#include <abrade/sim/gear_trains.hpp>

#include <cstdint>

namespace abrade {

/// A sphere of concrete is awake, a body that moves; or an anchor, a body that stands still, for it is bonded
/// to one that is awake or near a body that rests; or dormant, no body at all. What is near a body that may
/// touch it is awake, with those up to `wake_radius` bonds around it. So is, with its own neighbours, an
/// anchor on which the load of its bonds has changed by more than `wake_force`. One that moves no more, and
/// on which nothing acts by more than that, goes to sleep. It may go on turning there, as a gear does.
struct Dormancy {
    /// Looks at which a sphere must have been quiet before it sleeps.
    static constexpr std::uint8_t quiet_looks = 3;

    /// A sphere that stands still, and what its bonds have come to since it does.
    struct Anchor {
        Index site = 0;
        Vec3 force = Vec3::Zero(),
             lever = Vec3::Zero();  ///< as it fell asleep [N], of its active bonds and contacts
        Vec3 change = Vec3::Zero(), turning = Vec3::Zero();  ///< since then [N]
        Index bonds = 0;                                     ///< active ones
        std::int64_t numbers = 0;                            ///< their sum, to tell whether they are the same
        bool fresh = true;  ///< its bonds are others than before: the next load begins anew

        /// Takes in the loads of a step; true where they have changed by more than `limit` [N].
        bool note(const SphereLoad& load, Real limit) noexcept {
            if (std::exchange(fresh, false)) force = load.force - change, lever = load.lever - turning;
            change = load.force - force, turning = load.lever - lever;
            return stirred(limit);
        }
        /// That acts on it now [N].
        Vec3 lever_now() const noexcept { return lever + turning; }
        bool stirred(Real limit) const noexcept {
            return change.squaredNorm() > square(limit) || turning.squaredNorm() > square(limit);
        }
    };

    Real wake_force = 0;    ///< [N]; 0: everybody is awake
    Index wake_radius = 0;  ///< [bonds]
    Real quiet_speed = 0;   ///< that a swing of this force reaches on a sphere's own bond [m/s]
    Clump sphere{};         ///< what each site is made of
    Real inverse_mass = 0;  ///< of one that moves [1/kg]
    Vec3 inverse_inertia = Vec3::Zero();

    std::vector<Index> body_of;       ///< [site] -1: dormant, or gone
    std::vector<Vec3> place;          ///< [site] where it stands while it is no body [m]
    std::vector<std::uint8_t> quiet;  ///< [site] looks that it has been quiet for
    std::vector<char> marks;          ///< [site] all 0 between uses
    std::vector<char> held;           ///< [site] part of the ground, which never moves
    PointGrid sites;                  ///< as built
    Real furthest = 0;                ///< from where it was built that any sphere fell asleep [m]
    std::vector<Anchor> anchors;      ///< sorted by site
    std::vector<Index> anchor_at;     ///< [slot] -1: none
    GearTrains gears;                 ///< how what does not move turns
    std::vector<Index> loosened;      ///< sites that are to be let go
    Index ahead = 0;                  ///< bonds that are woken beyond a stirred anchor, as a wave runs on
    Real potential = 0;               ///< of what is asleep [J]
    Index awake = 0, may_wake = 0;    ///< spheres; of those that stand
    bool begun = false;               ///< the first of them have been put to sleep
    bool due = false;                 ///< bodies are to be taken out
    bool stirred = false;             ///< anchors are to be woken

    /// A wave stirs one anchor after the other: rather than renew lists at each, wake what it comes to next.
    void look_ahead(Index steps_since_renewal) noexcept {
        constexpr Index soon = 32, furthest_ahead = 15;
        if (stirred) ahead = steps_since_renewal < soon ? std::min(2 * ahead + 1, furthest_ahead) : 0;
    }

    bool on() const noexcept { return wake_force > 0; }
    /// Kinetic energy of spheres with this sum of rim squared [J].
    Real turning(Real rims_squared) const noexcept {
        return rims_squared > 0 ? 0.2 / inverse_mass * rims_squared : 0;
    }
    bool may_move(Index site) const noexcept { return held[static_cast<std::size_t>(site)] == 0; }
    /// Whether lists must be renewed for it.
    bool calls() const noexcept { return due || stirred || !loosened.empty() || (begun && !on()); }
};

}  // namespace abrade
