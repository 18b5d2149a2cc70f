#pragma once
// Volume, centre and inertia of a union of overlapping spheres: what overlaps counts once.

#include <abrade/core/compiled_as.hpp>
#include <abrade/geometry/solid_moments.hpp>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abrade {

/// Volume, centroid and inertia tensor of the union of `spheres`: what overlaps counts once.
/// One and two spheres: closed form (slices of balls). More: detail::SphereSlices (sphere_slices.hpp), whose
/// error was measured at 1e-12 of each quantity on rows, grids and heaps of spheres. Throws InputError when
/// there is no sphere, a centre that is not finite or a radius that is not > 0; `field` says in messages
/// whose spheres they are.
ABRADE_INLINE SolidMoments union_moments(std::span<const Sphere> spheres,
                                         std::string_view field = "union_moments.spheres");

/// A rigid body made of spheres, described in its principal frame: origin at the centroid, axes along
/// the principal axes of inertia.
struct Clump {
    std::string name{};
    std::vector<Sphere> members{};
    Real volume = 0;                        ///< of the union [m3]
    Vec3 principal_moments = Vec3::Zero();  ///< for unit density [m5]
    Real bounding_radius = 0;               ///< about the centroid [m]
};

/// Whether the spheres of a clump must hang together.
enum class ClumpParts { joined, apart };

/// The principal axes of a tensor of inertia and its moments about them.
struct PrincipalFrame {
    Mat3 axes = Mat3::Identity();  ///< columns: the axes, right-handed; principal frame to world
    Vec3 moments = Vec3::Zero();   ///< ascending, in the unit of the tensor
};
/// Axes and moments of a symmetric tensor of inertia.
ABRADE_INLINE PrincipalFrame principal_frame(const Mat3& inertia);

/// Moves `members` into the principal frame of their union. A single sphere stays where it is, exactly.
/// Throws InputError as `union_moments` does, with the clump's name and the member's number, and where
/// spheres lie apart, unless that is meant.
ABRADE_INLINE Clump make_clump(std::string name, std::vector<Sphere> members,
                               ClumpParts parts = ClumpParts::joined);

}  // namespace abrade

#ifndef ABRADE_COMPILED
#include <abrade/geometry/sphere_union_moments.hpp>
#endif
