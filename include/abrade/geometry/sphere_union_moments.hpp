#pragma once
// How the moments of a union of spheres are found, and the principal frame of a clump.

#include <abrade/core/require.hpp>
#include <abrade/geometry/sphere_slices.hpp>
#include <abrade/geometry/sphere_union.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace abrade {

namespace detail {

/// Adds the part of a ball between the planes `from` and `to` (signed distances from its centre along
/// `axis`). The integrands are polynomials of degree 4 at most, so three Gauss points are exact.
inline void add_ball_slice(RawMoments& sum, const Sphere& ball, const Vec3& axis, Real from, Real to) {
    if (to <= from) return;
    static constexpr std::array<std::pair<Real, Real>, 3> gauss{
        {{-0.7745966692414834, 5.0 / 9}, {0.0, 8.0 / 9}, {0.7745966692414834, 5.0 / 9}}};
    const Mat3 along = axis * axis.transpose();
    const Mat3 across = Mat3::Identity() - along;
    for (const auto& [node, weight] : gauss) {
        const Real s = 0.5 * (from + to) + 0.5 * (to - from) * node;
        const Real rho2 = std::max(0.0, square(ball.radius) - s * s);
        const Real area = 0.5 * (to - from) * weight * pi * rho2;
        const Vec3 centre = ball.centre + s * axis;
        sum.volume += area;
        sum.first += area * centre;
        sum.second += area * (centre * centre.transpose() + 0.25 * rho2 * across);
    }
}

/// Exact moments of one sphere or of the union of two.
inline RawMoments exact_moments(std::span<const Sphere> spheres) {
    RawMoments sum;
    if (spheres.size() == 1) {
        add_ball_slice(sum, spheres[0], Vec3::UnitX(), -spheres[0].radius, spheres[0].radius);
        return sum;
    }
    const Sphere &a = spheres[0], &b = spheres[1];
    const Real distance = (b.centre - a.centre).norm();
    if (distance <= std::abs(a.radius - b.radius)) return exact_moments({a.radius > b.radius ? &a : &b, 1});
    const Vec3 axis = (b.centre - a.centre) / distance;
    // The plane of the common circle, seen from a; beyond the touching distance each ball is whole.
    const Real plane = (square(distance) + square(a.radius) - square(b.radius)) / (2 * distance);
    add_ball_slice(sum, a, axis, -a.radius, std::min(plane, a.radius));
    add_ball_slice(sum, b, axis, std::max(plane - distance, -b.radius), b.radius);
    return sum;
}

}  // namespace detail

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
