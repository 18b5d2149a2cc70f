#pragma once
// Which spheres are near each other.

#include <abrade/core/compiled_as.hpp>
#include <abrade/core/types.hpp>

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

namespace abrade {

/// How many periods an image is away along each axis: -1, 0 or 1.
struct ImageShift {
    std::int8_t x = 0, y = 0, z = 0;

    bool none() const noexcept { return (x | y | z) == 0; }
    int along(int axis) const noexcept { return axis == 0 ? x : axis == 1 ? y : z; }
    Vec3 times(const Vec3& period) const noexcept { return {x * period.x(), y * period.y(), z * period.z()}; }
    ImageShift operator-() const noexcept {
        return {static_cast<std::int8_t>(-x), static_cast<std::int8_t>(-y), static_cast<std::int8_t>(-z)};
    }
    auto operator<=>(const ImageShift&) const = default;
};

/// Two spheres that are near each other. The second is meant where its image stands: at its centre plus
/// shift times period.
struct VerletPair {
    Index first = 0, second = 0;
    ImageShift shift{};
    auto operator<=>(const VerletPair&) const = default;
};

/// Whom a sphere looks for. `passive` ones do not look for each other (sound concrete, a fixed bed); those
/// left out are found by other means.
enum class SearchRole : char { all, passive, left_out };

/// The spheres to search.
struct NeighbourQuery {
    std::span<const Vec3> centre;      ///< [m], within one period
    std::span<const Real> radius;      ///< [m]
    std::span<const Index> body;       ///< spheres of one body are never a pair
    std::span<const SearchRole> role;  ///< [sphere]
    Real skin = 0;                     ///< pairs whose surfaces are nearer than this [m]
    Vec3 period = Vec3::Zero();        ///< of space along each axis [m]; 0 where it is open

    Vec3 image(std::size_t sphere, const ImageShift& shift) const noexcept {
        return shift.none() ? centre[sphere] : Vec3(centre[sphere] + shift.times(period));
    }
};

namespace detail {

/// Calls `visit(shift)` for each shift along periodic axes that `wanted(axis, -1 or 1)`, none apart.
template <class Wanted, class Visit>
void each_shift(const Vec3& period, Wanted&& wanted, Visit&& visit) {
    std::array<std::array<bool, 3>, 3> has{};
    bool any_shift = false;
    for (int a = 0; a < 3; ++a)
        for (int s = -1; s <= 1; ++s) {
            const bool take = s == 0 || (period[a] > 0 && wanted(a, s));
            has[static_cast<std::size_t>(a)][static_cast<std::size_t>(s + 1)] = take;
            any_shift |= s != 0 && take;
        }
    if (!any_shift) return;
    for (std::int8_t i = -1; i <= 1; ++i)
        for (std::int8_t j = -1; j <= 1; ++j)
            for (std::int8_t k = -1; k <= 1; ++k)
                if (has[0][static_cast<std::size_t>(i + 1)] && has[1][static_cast<std::size_t>(j + 1)] &&
                    has[2][static_cast<std::size_t>(k + 1)] && !ImageShift{i, j, k}.none())
                    visit(ImageShift{i, j, k});
}

/// Every pair once, whichever of the two found it.
inline VerletPair ordered(std::size_t i, std::size_t j, ImageShift shift) noexcept {
    if (i < j) return {static_cast<Index>(i), static_cast<Index>(j), shift};
    return {static_cast<Index>(j), static_cast<Index>(i), -shift};
}

}  // namespace detail

/// All pairs nearer than the skin, first < second. Tests every pair: the twin that `verlet_pairs` is held
/// against.
ABRADE_INLINE std::vector<VerletPair> verlet_pairs_brute_force(const NeighbourQuery& q);

/// The same, by cells (cell_lists.hpp); in an order that depends on the spheres alone.
ABRADE_INLINE std::vector<VerletPair> verlet_pairs(const NeighbourQuery& q);

}  // namespace abrade

#ifndef ABRADE_COMPILED
#include <abrade/dem/store/cell_lists.hpp>
#endif
