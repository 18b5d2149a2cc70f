#pragma once
// Which spheres are near each other: a cell list for spheres of several sizes, and its brute-force twin.

#include <abrade/core/types.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <span>
#include <vector>

namespace abrade {

/// Two spheres, first < second.
struct Pair {
    Index first = 0, second = 0;
    auto operator<=>(const Pair&) const = default;
};

/// The spheres to search. `passive` spheres do not look for each other (bonded concrete, a fixed bed).
struct NeighbourQuery {
    std::span<const Vec3> centre;  ///< [m]
    std::span<const Real> radius;  ///< [m]
    std::span<const Index> body;   ///< spheres of one body are never a pair
    std::span<const char> passive;
    Real skin = 0;  ///< pairs whose surfaces are nearer than this [m]
};

namespace detail {

inline bool is_candidate(const NeighbourQuery& q, std::size_t i, std::size_t j) noexcept {
    return q.body[i] != q.body[j] && !(q.passive[i] && q.passive[j]);
}

inline bool is_near(const NeighbourQuery& q, std::size_t i, std::size_t j) noexcept {
    return (q.centre[i] - q.centre[j]).squaredNorm() < square(q.radius[i] + q.radius[j] + q.skin);
}

inline Pair ordered(std::size_t i, std::size_t j) noexcept {
    return {static_cast<Index>(std::min(i, j)), static_cast<Index>(std::max(i, j))};
}

/// Spheres of one size class, sorted into cells.
class CellGrid {
public:
    CellGrid(const NeighbourQuery& q, std::span<const Index> members, Real largest_radius)
        : largest_radius_(largest_radius) {
        Vec3 low = q.centre[static_cast<std::size_t>(members[0])], high = low;
        for (const Index m : members) {
            low = low.cwiseMin(q.centre[static_cast<std::size_t>(m)]);
            high = high.cwiseMax(q.centre[static_cast<std::size_t>(m)]);
        }
        low_ = low;
        cell_ = 2 * largest_radius + q.skin;
        // Far-flung spheres must not blow the grid up: coarser cells are slower, never wrong.
        const Real most_cells = 4.0 * static_cast<Real>(members.size()) + 1e5;
        const Vec3 size = high - low;
        while ((size / cell_ + Vec3::Ones()).prod() > most_cells) cell_ *= 1.5;
        for (int a = 0; a < 3; ++a)
            count_[static_cast<std::size_t>(a)] = static_cast<Index>(size[a] / cell_) + 1;
        start_.assign(static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]) *
                              static_cast<std::size_t>(count_[2]) +
                          1,
                      0);
        std::vector<std::size_t> cell_of(members.size());
        for (std::size_t k = 0; k < members.size(); ++k) {
            const Vec3 at = (q.centre[static_cast<std::size_t>(members[k])] - low_) / cell_;
            cell_of[k] = index(clamp(at.x(), 0), clamp(at.y(), 1), clamp(at.z(), 2));
            ++start_[cell_of[k] + 1];
        }
        for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
        std::vector<Index> fill(start_.begin(), start_.end() - 1);
        members_.resize(members.size());
        for (std::size_t k = 0; k < members.size(); ++k)
            members_[static_cast<std::size_t>(fill[cell_of[k]]++)] = members[k];
    }

    /// Calls `visit(j)` for every member that a sphere of `radius` at x may be near to.
    template <class Visit>
    void around(const Vec3& x, Real radius, Real skin, Visit&& visit) const {
        const Real reach = radius + largest_radius_ + skin;
        const Vec3 from = ((x.array() - reach).matrix() - low_) / cell_,
                   to = ((x.array() + reach).matrix() - low_) / cell_;
        for (int a = 0; a < 3; ++a)
            if (to[a] < 0 || from[a] >= static_cast<Real>(count_[static_cast<std::size_t>(a)])) return;
        for (Index i = clamp(from.x(), 0); i <= clamp(to.x(), 0); ++i)
            for (Index j = clamp(from.y(), 1); j <= clamp(to.y(), 1); ++j) {
                // Cells of one row along z are contiguous.
                const Index first = start_[index(i, j, clamp(from.z(), 2))],
                            last = start_[index(i, j, clamp(to.z(), 2)) + 1];
                for (Index m = first; m < last; ++m)
                    visit(static_cast<std::size_t>(members_[static_cast<std::size_t>(m)]));
            }
    }

private:
    Index clamp(Real at, std::size_t axis) const noexcept {
        return static_cast<Index>(std::clamp(std::floor(at), 0.0, static_cast<Real>(count_[axis] - 1)));
    }
    std::size_t index(Index i, Index j, Index k) const noexcept {
        return (static_cast<std::size_t>(i) * static_cast<std::size_t>(count_[1]) +
                static_cast<std::size_t>(j)) *
                   static_cast<std::size_t>(count_[2]) +
               static_cast<std::size_t>(k);
    }

    Vec3 low_ = Vec3::Zero();
    Real cell_ = 0, largest_radius_ = 0;
    std::array<Index, 3> count_{};
    std::vector<Index> start_, members_;
};

}  // namespace detail

/// All pairs nearer than the skin, sorted. Tests every pair: the twin that `near_pairs` is held against.
inline std::vector<Pair> near_pairs_brute_force(const NeighbourQuery& q) {
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < q.centre.size(); ++i)
        for (std::size_t j = i + 1; j < q.centre.size(); ++j)
            if (detail::is_candidate(q, i, j) && detail::is_near(q, i, j))
                pairs.push_back(detail::ordered(i, j));
    return pairs;
}

/// All pairs nearer than the skin, sorted. Spheres are put into one grid per power of two in radius, so
/// that a boulder among sand costs no more than the sand that it covers.
inline std::vector<Pair> near_pairs(const NeighbourQuery& q) {
    std::vector<Pair> pairs;
    if (q.centre.empty()) return pairs;
    const Real smallest = *std::min_element(q.radius.begin(), q.radius.end());
    const auto level_of = [&](Real radius) { return static_cast<std::size_t>(std::log2(radius / smallest)); };

    std::vector<std::vector<Index>> members;
    std::vector<Real> largest;
    for (std::size_t i = 0; i < q.centre.size(); ++i) {
        const std::size_t level = level_of(q.radius[i]);
        if (level >= members.size()) members.resize(level + 1), largest.resize(level + 1, 0);
        members[level].push_back(static_cast<Index>(i));
        largest[level] = std::max(largest[level], q.radius[i]);
    }
    std::vector<detail::CellGrid> grids;
    std::vector<std::size_t> grid_level;
    for (std::size_t level = 0; level < members.size(); ++level)
        if (!members[level].empty())
            grids.emplace_back(q, members[level], largest[level]), grid_level.push_back(level);

    for (std::size_t i = 0; i < q.centre.size(); ++i) {
        if (q.passive[i]) continue;
        const std::size_t own = level_of(q.radius[i]);
        for (std::size_t g = 0; g < grids.size(); ++g)
            grids[g].around(q.centre[i], q.radius[i], q.skin, [&](std::size_t j) {
                // Two searchers find each other twice: the larger level, then the larger index, reports.
                const bool mine = q.passive[j] || grid_level[g] < own || (grid_level[g] == own && j < i);
                if (mine && detail::is_candidate(q, i, j) && detail::is_near(q, i, j))
                    pairs.push_back(detail::ordered(i, j));
            });
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

}  // namespace abrade
