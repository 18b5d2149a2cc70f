#pragma once
// How small periodic space may be.

#include <abrade/dem/store/particles.hpp>
#include <abrade/sim/scene/scene.hpp>

#include <limits>
#include <string>

namespace abrade {

/// What bodies ask of the period of space. With r_a and r_b the largest radii of two bodies, R the farthest
/// that a body reaches from its centroid and s the skin of the neighbour list [m], the period must be at
/// least
///   2 (r_a + r_b + s), so that a sphere has one image of another near it, not two: a contact's memory goes
///                      by the spheres, and two images of one pair would share it;
///   2 R + s,           so that no body meets its own image, and a pair is found by its nearest images.
struct PeriodNeed {
    Real two_radii = 0, reach = 0;  ///< r_a + r_b; R [m]

    /// `standing` [m] is the radius of spheres that stand and may be no bodies, 0: there are none.
    PeriodNeed(const Particles& particles, const std::optional<FeedParams>& feed, Real standing = 0) {
        auto add = [this, first = Real(0)](Real radius, Real far) mutable {
            if (first > 0) two_radii = std::max(two_radii, first + radius);
            first = std::max(first, radius), reach = std::max(reach, far);
        };
        for (std::size_t b = 0; b < particles.first_sphere.size(); ++b) {
            Real radius = 0, far = 0;
            const auto from = static_cast<std::size_t>(particles.first_sphere[b]);
            for (std::size_t s = from; s < from + static_cast<std::size_t>(particles.sphere_count[b]); ++s)
                radius = std::max(radius, particles.radius[s]),
                far = std::max(far, particles.offset[s].norm() + particles.radius[s]);
            add(radius, far);
        }
        if (standing > 0) add(standing, standing);
        if (feed)
            for (const StoneClass& stones : feed->classes) {
                const Clump clump = make_stone(stones.shape, stones.size);
                Real radius = 0;
                for (const Sphere& member : clump.members) radius = std::max(radius, member.radius);
                add(radius, clump.bounding_radius), add(radius, clump.bounding_radius);  // two of them
            }
    }

    Real least(Real skin) const noexcept {
        return std::max(two_radii > 0 ? 2 * (two_radii + skin) : 0, 2 * reach + skin);
    }
    /// The widest skin that a period has room for [m].
    Real widest_skin(const Vec3& period) const noexcept {
        Real widest = std::numeric_limits<Real>::infinity();
        for (const Real along : period)
            if (along > 0) {
                widest = std::min(widest, along - 2 * reach);
                if (two_radii > 0) widest = std::min(widest, 0.5 * along - two_radii);
            }
        return widest;
    }

    /// Throws InputError where a periodic axis of the scene is too short for lists with this skin.
    void check(const Scene& scene, Real skin) const {
        const Vec3 period = scene.periodic().period;
        for (int a = 0; a < 3; ++a)
            require(period[a] == 0 || period[a] >= least(skin),
                    {std::string("Scene.bounds along the periodic axis ") + "xyz"[a],
                     "at least " + to_text(least(skin)) +
                         " m apart, that a sphere has one image of another within the skin of " +
                         to_text(skin) + " m",
                     "m", "widen the bounds, or set a smaller RunOptions.skin"},
                    period[a]);
    }
};

}  // namespace abrade
