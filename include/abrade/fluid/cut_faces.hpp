#pragma once
// Where the velocity of a face stands that a wall cuts, and how far that is from the next one.

#include <abrade/fluid/cut_cell.hpp>
#include <abrade/fluid/walls.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace abrade::detail {

/// The middle of what a plane leaves of a unit square or a unit line, from its centre [-]. The open part is
/// on the side that the normal points to; any scale of the normal will do.
template <int Size>
std::array<Real, Size> open_middle(const std::array<Real, Size>& normal, Real open) noexcept {
    std::array<Real, Size> middle{};
    if (!(open > 0 && open < 1)) return middle;
    if constexpr (Size == 1) {
        middle[0] = normal[0] > 0 ? 0.5 * (1 - open) : normal[0] < 0 ? -0.5 * (1 - open) : 0;
    } else {
        const Real x = std::abs(normal[0]), y = std::abs(normal[1]);
        if (!(x + y > 0)) return middle;
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
        middle = {first_is_least ? along : across, first_is_least ? across : along};
        for (std::size_t k = 0; k < 2; ++k)
            if (normal[k] < 0) middle[k] = -middle[k];
    }
    return middle;
}

/// The velocity of a face is the mean over its open part, which is what flows through it: it stands at the
/// middle of that part. Of a face along `axis` that is open by a share and cut by a wall of a given normal,
/// from the face's centre [cell].
template <int Dim>
Point<Dim> middle_of_face(const Point<Dim>& normal, const Point<Dim>& size, int axis, Real open) noexcept {
    std::array<Real, Dim - 1> across;
    for (int b = 0, k = 0; b < Dim; ++b)
        if (b != axis) across[static_cast<std::size_t>(k++)] = normal[b] * size[b];
    const auto middle = open_middle<Dim - 1>(across, open);
    Point<Dim> from_centre = Point<Dim>::Zero();
    for (int b = 0, k = 0; b < Dim; ++b)
        if (b != axis) from_centre[b] = middle[static_cast<std::size_t>(k++)];
    return from_centre;
}

/// Of two faces next to each other along an axis, the upper one.
struct FacePair {
    int component = 0, along = 0;
};

/// In a uniform shear along a plane wall the velocity grows as the distance d from it. Between the centres of
/// two faces that changes by n_b h, between the middles of their open parts by
///   n_b h r,   r = 1 + n . (m_upper - m_lower) / (n_b h),   1/3 <= r <= 1 (1/2 in two dimensions),
/// so the shear stress is nu (u_upper - u_lower) / (h r), exactly: r, the share of the gap. `walls[0, 1]` are
/// the area vectors of the walls about the lower and the upper face, `open` their open shares.
template <int Dim>
Real share_of_gap(const Point<Dim>& size, FacePair pair, const std::array<Point<Dim>, 2>& walls,
                  const std::array<Real, 2>& open) noexcept {
    const auto [a, b] = pair;
    const Point<Dim> apart =
        middle_of_face<Dim>(walls[1], size, a, open[1]) - middle_of_face<Dim>(walls[0], size, a, open[0]);
    const Point<Dim> normal = walls[0] + walls[1];
    const Real straight = 1 + apart[b];
    Real skew = 0;  // they do not lie one straight behind the other
    if (std::abs(normal[b]) > 1e-3 * normal.norm())
        for (int t = 0; t < Dim; ++t)
            if (t != b) skew += normal[t] * size[t] * apart[t] / (normal[b] * size[b]);
    return std::clamp(straight + skew, Real(0.25), std::max(straight, Real(1)));
}

}  // namespace abrade::detail
