#pragma once
// How the moments of a union of spheres are found, and the principal frame of a clump.

#include <abrade/core/require.hpp>
#include <abrade/geometry/sphere_slices.hpp>
#include <abrade/geometry/sphere_union.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

// Nothing where abrade::compiled holds them, which compiles them by src/functions.cpp.
#if !defined(ABRADE_COMPILED) || defined(ABRADE_COMPILES_FUNCTIONS)

namespace abrade {

ABRADE_INLINE SolidMoments union_moments(std::span<const Sphere> spheres, std::string_view field) {
    require(!spheres.empty(), {field, "at least 1 sphere", "", "give each its centre and its radius"}, 0);
    for (std::size_t n = 0; n < spheres.size(); ++n) {
        const auto& [centre, radius] = spheres[n];
        if (centre.allFinite() && radius > 0 && std::isfinite(radius)) continue;
        const std::string name = std::string{field} + "[" + std::to_string(n) + "]";
        require_finite(centre, name + ".centre", "m");
        require_positive(radius, name + ".radius", "m");
    }
    return spheres.size() <= 2 ? detail::exact_moments(spheres).about_centroid()
                               : detail::slice_moments(spheres);
}

namespace detail {

/// Throws InputError where spheres hang together in no one piece: by the first that touches none of the
/// first's.
inline void require_joined(std::span<const Sphere> members, const std::string& field) {
    constexpr Real touching = 1 + 1e-9;  // of the sum of two radii
    std::vector<char> joined(members.size(), 0);
    std::vector<std::size_t> open{0};
    joined[0] = 1;
    while (!open.empty()) {
        const Sphere one = members[open.back()];
        open.pop_back();
        for (std::size_t n = 0; n < members.size(); ++n)
            if (!joined[n] &&
                (members[n].centre - one.centre).norm() <= touching * (members[n].radius + one.radius))
                joined[n] = 1, open.push_back(n);
    }
    for (std::size_t n = 0; n < members.size(); ++n) {
        if (joined[n]) continue;
        Real gap = std::numeric_limits<Real>::infinity();
        for (std::size_t k = 0; k < members.size(); ++k)
            if (joined[k])
                gap = std::min(gap, (members[n].centre - members[k].centre).norm() - members[n].radius -
                                        members[k].radius);
        fail({field + "[" + std::to_string(n) + "]: gap to those before it",
              "0, so that they touch or overlap", "m",
              "move it nearer; ClumpParts::apart is for bodies of several pieces"},
             short_text(gap));
    }
}

}  // namespace detail

ABRADE_INLINE PrincipalFrame principal_frame(const Mat3& inertia) {
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(inertia);
    Mat3 axes = solver.eigenvectors();
    if (axes.determinant() < 0) axes.col(0) = -axes.col(0).eval();  // a rotation, not a mirror
    return {axes, solver.eigenvalues()};
}

ABRADE_INLINE Clump make_clump(std::string name, std::vector<Sphere> members, ClumpParts parts) {
    const std::string field = "Clump '" + name + "'.members";
    const SolidMoments moments = union_moments(members, field);
    if (parts == ClumpParts::joined) detail::require_joined(members, field);
    Clump clump{std::move(name), std::move(members), moments.volume, Vec3::Zero(), 0};
    if (clump.members.size() == 1) {
        const Real r = clump.members[0].radius;
        clump.members[0].centre.setZero();
        clump.volume = 4.0 / 3 * pi * cube(r);
        clump.principal_moments.setConstant(0.4 * clump.volume * r * r);
        clump.bounding_radius = r;
        return clump;
    }
    const auto [axes, principal_moments] = principal_frame(moments.inertia);
    clump.principal_moments = principal_moments;
    for (Sphere& s : clump.members) {
        s.centre = (axes.transpose() * (s.centre - moments.centroid)).eval();
        clump.bounding_radius = std::max(clump.bounding_radius, s.centre.norm() + s.radius);
    }
    return clump;
}

}  // namespace abrade

#endif
