#pragma once
// Where the velocity of a face stands that a wall cuts, how far that is from the next one, and what that
// makes of the friction between the two.

#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace abrade::detail {

/// The centroid of what a plane leaves open of a unit square or a unit line, from its centre [-]. The open
/// part is on the side that the normal points to; any scale of the normal will do.
template <int Size>
std::array<Real, Size> open_centroid(const std::array<Real, Size>& normal, Real open) noexcept {
    std::array<Real, Size> centroid{};
    if (!(open > 0 && open < 1)) return centroid;
    if constexpr (Size == 1) {
        centroid[0] = normal[0] > 0 ? 0.5 * (1 - open) : normal[0] < 0 ? -0.5 * (1 - open) : 0;
    } else {
        const Real x = std::abs(normal[0]), y = std::abs(normal[1]);
        if (!(x + y > 0)) return centroid;
        // Of the lesser part, from the corner that it holds: a triangle or a trapezium.
        const Real least = std::min(x, y) / (x + y), most = 1 - least, part = std::min(open, 1 - open);
        Real along = 0, across = 0;  // the line that cuts it, and the steeper way
        if (2 * most * part < least) {
            const Real reach = std::sqrt(2 * least * most * part);
            along = reach / (3 * least), across = reach / (3 * most);
        } else {
            const Real slope = least / most, first = part + 0.5 * slope, last = part - 0.5 * slope;
            along = (first + 2 * last) / (6 * part);
            across = (first * first + first * last + last * last) / (6 * part);
        }
        // A solid part pushes the open one away from its corner.
        const Real weight = open < 0.5 ? 1 : (1 - open) / open;
        along = weight * (0.5 - along), across = weight * (0.5 - across);
        const bool first_is_least = x < y;
        centroid = {first_is_least ? along : across, first_is_least ? across : along};
        for (std::size_t k = 0; k < 2; ++k)
            if (normal[k] < 0) centroid[k] = -centroid[k];
    }
    return centroid;
}

/// The velocity of a face is the mean over its open part, which is what flows through it: it stands at the
/// centroid of that part. Of a face along `axis` of which a wall of a given normal leaves the share `open`,
/// from the face's centre [cell].
template <int Dim>
Point<Dim> centroid_of_face(const Point<Dim>& normal, const Point<Dim>& size, int axis, Real open) noexcept {
    std::array<Real, Dim - 1> across;
    for (int b = 0, k = 0; b < Dim; ++b)
        if (b != axis) across[static_cast<std::size_t>(k++)] = normal[b] * size[b];
    const auto centroid = open_centroid<Dim - 1>(across, open);
    Point<Dim> from_centre = Point<Dim>::Zero();
    for (int b = 0, k = 0; b < Dim; ++b)
        if (b != axis) from_centre[b] = centroid[static_cast<std::size_t>(k++)];
    return from_centre;
}

/// Two faces of a velocity component that are neighbours along an axis.
struct FacePair {
    int component = 0, along = 0;
};

/// Of the side between two faces, what walls leave open of it over the distance of the centroids of both
/// faces along the wall's normal n, that between their centres being 1 [-]:
///   open_side / r,   r = 1 + n . (m_upper - m_lower) / (n_b h),   1/4 <= r <= max(1, r_b),
/// r_b = 1 + (m_upper - m_lower)_b / h, m the centroid of a face's open part from its centre [m], h the
/// distance of the centres along b [m]. In a uniform shear along a plane wall the velocity grows as the
/// distance from it, so the shear stress is then nu (u_upper - u_lower) / (h r), exactly, where |n_b| > 1e-3.
/// `walls[0, 1]` are the area vectors of the walls about the lower and the upper face, `open` their open
/// shares; the bounds are for faces that see different planes. Where |n_b| is smaller r is r_b.
template <int Dim>
Real open_over_distance(const Point<Dim>& size, FacePair pair, const std::array<Point<Dim>, 2>& walls,
                        const std::array<Real, 2>& open, Real open_side) noexcept {
    const auto [a, b] = pair;
    const Point<Dim> apart =
        centroid_of_face<Dim>(walls[1], size, a, open[1]) - centroid_of_face<Dim>(walls[0], size, a, open[0]);
    const Point<Dim> normal = walls[0] + walls[1];
    const Real straight = 1 + apart[b];
    Real skew = 0;  // they do not lie one straight behind the other
    if (std::abs(normal[b]) > 1e-3 * normal.norm())
        for (int t = 0; t < Dim; ++t)
            if (t != b) skew += normal[t] * size[t] * apart[t] / (normal[b] * size[b]);
    return open_side / std::clamp(straight + skew, Real(0.25), std::max(straight, Real(1)));
}

}  // namespace abrade::detail
