#pragma once
// How near spheres are found: cell lists for spheres of several sizes, and their brute-force twin.

#include <abrade/core/parallel.hpp>
#include <abrade/core/simd.hpp>
#include <abrade/dem/store/neighbours.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

// Nothing where abrade::compiled holds them, which compiles them by src/functions.cpp.
#if !defined(ABRADE_COMPILED) || defined(ABRADE_COMPILES_FUNCTIONS)

namespace abrade {

namespace detail {

/// Spheres of one size class and one kind, and images of theirs, sorted into cells.
class CellGrid {
public:
    struct Member {
        Index sphere;
        ImageShift shift;
        Vec3 at;  ///< [m]
    };

    CellGrid(const NeighbourQuery& q, std::span<const Member> members, std::size_t level_, bool passive_)
        : level(level_), passive(passive_) {
        low_ = Vec3::Constant(std::numeric_limits<Real>::infinity());
        Vec3 high = -low_;
        for (const Member& m : members) {
            low_ = low_.cwiseMin(m.at), high = high.cwiseMax(m.at);
            largest_radius = std::max(largest_radius, q.radius[static_cast<std::size_t>(m.sphere)]);
        }
        // Cells as wide as the reach of a sphere, up to twice as wide where spheres are so scarce that rows
        // of cells would not fill a pack.
        const Vec3 size = high - low_;
        const Real reach = 2 * largest_radius + q.skin;
        const Real third_of_pack =
            std::cbrt(size.prod() / static_cast<Real>(members.size()) * pack_lanes / 3);
        Real cell = std::clamp(third_of_pack, reach, 2 * reach);
        // Far-flung spheres must not blow the grid up: coarser cells are slower, never wrong.
        const Real most_cells = 4.0 * static_cast<Real>(members.size()) + 1000;
        while ((size / cell + Vec3::Ones()).prod() > most_cells) cell *= 1.25;
        per_cell_ = 1 / cell;
        for (int a = 0; a < 3; ++a)
            count_[static_cast<std::size_t>(a)] = static_cast<Index>(size[a] * per_cell_) + 1;
        start_.assign(static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]) *
                              static_cast<std::size_t>(count_[2]) +
                          1,
                      0);
        std::vector<std::size_t> cell_of(members.size());
        for (std::size_t k = 0; k < members.size(); ++k) {
            const Vec3 at = in_cells(members[k].at);
            cell_of[k] = index(clamp(at.x(), 0), clamp(at.y(), 1), clamp(at.z(), 2));
            ++start_[cell_of[k] + 1];
        }
        for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
        std::vector<Index> fill(start_.begin(), start_.end() - 1);
        members_.resize(members.size());
        // A whole pack may be loaded from any place: what lies beyond the end is never near.
        for (auto& column : columns_) column.assign(members.size() + pack_lanes, 1e100);
        for (std::size_t k = 0; k < members.size(); ++k) {
            const auto to = static_cast<std::size_t>(fill[cell_of[k]]++);
            const auto s = static_cast<std::size_t>(members[k].sphere);
            members_[to] = members[k];
            for (int a = 0; a < 3; ++a) columns_[static_cast<std::size_t>(a)][to] = members[k].at[a];
            columns_[3][to] = q.radius[s];
        }
    }

    Index size() const noexcept { return static_cast<Index>(members_.size()); }
    const Member& member(Index m) const noexcept { return members_[static_cast<std::size_t>(m)]; }

    /// Calls `visit(member)` for the members that are nearer than `skin` to a sphere of `radius` at x: all of
    /// them where `after` is -1, or those that follow in the grid's order where it is the sphere's own place.
    template <class Visit>
    void visit_near(const Vec3& x, Real radius, Real skin, Index after, Visit&& visit) const {
        const Real reach = radius + largest_radius + skin;
        const Vec3 from = in_cells((x.array() - reach).matrix()), to = in_cells((x.array() + reach).matrix());
        for (int a = 0; a < 3; ++a)
            if (to[a] < 0 || from[a] >= static_cast<Real>(count_[static_cast<std::size_t>(a)])) return;
        const Index j_first = clamp(from.y(), 1), j_last = clamp(to.y(), 1);
        const Index k_first = clamp(from.z(), 2), k_last = clamp(to.z(), 2);
        const Index i_last = clamp(to.x(), 0);
        Index i = clamp(from.x(), 0), j = j_first;
        if (after >= 0) {  // rows before its own hold earlier members only
            const Vec3 own = in_cells(x);
            i = clamp(own.x(), 0), j = clamp(own.y(), 1);
        }
        for (; i <= i_last; ++i, j = j_first)
            for (; j <= j_last; ++j) {
                // Cells of one row along z are contiguous.
                const Index last = start_[index(i, j, k_last) + 1];
                for (Index m = std::max(start_[index(i, j, k_first)], after + 1); m < last; m += pack_lanes) {
                    const auto load = [&](std::size_t c) {
                        return Pack::load_from_anywhere(columns_[c].data() + m);
                    };
                    const Pack dx = load(0) - Pack(x.x()), dy = load(1) - Pack(x.y()),
                               dz = load(2) - Pack(x.z()), near = load(3) + Pack(radius + skin);
                    unsigned lanes = lanes_of(dx * dx + dy * dy + dz * dz < near * near);
                    if (last - m < pack_lanes) lanes &= (1u << (last - m)) - 1;
                    for (; lanes != 0; lanes &= lanes - 1)
                        visit(members_[static_cast<std::size_t>(m + std::countr_zero(lanes))]);
                }
            }
    }

    std::size_t level;
    bool passive;
    Real largest_radius = 0;

private:
    Vec3 in_cells(const Vec3& x) const noexcept { return per_cell_ * (x - low_); }
    Index clamp(Real at, std::size_t axis) const noexcept {
        return static_cast<Index>(std::clamp(at, 0.0, static_cast<Real>(count_[axis] - 1)));
    }
    std::size_t index(Index i, Index j, Index k) const noexcept {
        return (static_cast<std::size_t>(i) * static_cast<std::size_t>(count_[1]) +
                static_cast<std::size_t>(j)) *
                   static_cast<std::size_t>(count_[2]) +
               static_cast<std::size_t>(k);
    }

    Vec3 low_;
    Real per_cell_ = 0;  ///< 1 / edge of a cell [1/m]
    std::array<Index, 3> count_{};
    std::vector<Index> start_;
    std::vector<Member> members_;
    std::array<std::vector<Real>, 4> columns_;  ///< x, y, z, radius of the members [m]
};

/// One grid for each power of two in radius, for active and for passive spheres apart, so that a boulder
/// among sand costs no more than the sand that it covers.
inline std::vector<CellGrid> cell_grids(const NeighbourQuery& q, std::span<const std::size_t> level) {
    const std::size_t levels = *std::max_element(level.begin(), level.end()) + 1;
    const Real largest = *std::max_element(q.radius.begin(), q.radius.end());
    Vec3 low = q.centre[0], high = low;
    for (const Vec3& x : q.centre) low = low.cwiseMin(x), high = high.cwiseMax(x);
    std::vector<std::vector<CellGrid::Member>> members(2 * levels);
    const auto grid_of = [&](std::size_t s) {
        return 2 * level[s] + (q.role[s] == SearchRole::passive ? 1 : 0);
    };
    const auto of = [&](std::size_t s) -> auto& { return members[grid_of(s)]; };
    std::vector<std::size_t> count(members.size(), 0);
    for (std::size_t s = 0; s < q.centre.size(); ++s)
        if (q.role[s] != SearchRole::left_out) ++count[grid_of(s)];
    for (std::size_t m = 0; m < members.size(); ++m) members[m].reserve(count[m] + count[m] / 4);
    for (std::size_t s = 0; s < q.centre.size(); ++s) {
        if (q.role[s] == SearchRole::left_out) continue;
        const Vec3& x = q.centre[s];
        of(s).push_back({static_cast<Index>(s), {}, x});
        const Real reach = q.radius[s] + largest + q.skin;
        const auto wanted = [&](int a, int shift) {
            const Real there = x[a] + shift * q.period[a];
            return there > low[a] - reach && there < high[a] + reach;
        };
        each_shift(q.period, wanted, [&](const ImageShift& shift) {
            of(s).push_back({static_cast<Index>(s), shift, q.image(s, shift)});
        });
    }
    std::vector<CellGrid> grids;
    for (std::size_t m = 0; m < members.size(); ++m)
        if (!members[m].empty()) grids.emplace_back(q, members[m], m / 2, m % 2 == 1);
    return grids;
}

}  // namespace detail

ABRADE_INLINE std::vector<VerletPair> verlet_pairs_brute_force(const NeighbourQuery& q) {
    std::vector<VerletPair> pairs;
    for (std::size_t i = 0; i < q.centre.size(); ++i)
        for (std::size_t j = i + 1; j < q.centre.size(); ++j) {
            const auto test = [&](const ImageShift& shift) {
                const bool candidate = q.body[i] != q.body[j] && q.role[i] != SearchRole::left_out &&
                                       q.role[j] != SearchRole::left_out &&
                                       (q.role[i] == SearchRole::all || q.role[j] == SearchRole::all);
                const Real near = q.radius[i] + q.radius[j] + q.skin;
                if (candidate && (q.centre[i] - q.image(j, shift)).squaredNorm() < square(near))
                    pairs.push_back({static_cast<Index>(i), static_cast<Index>(j), shift});
            };
            test({});
            detail::each_shift(
                q.period, [](int, int) { return true; }, test);
        }
    return pairs;
}

ABRADE_INLINE std::vector<VerletPair> verlet_pairs(const NeighbourQuery& q) {
    if (q.centre.empty()) return {};
    const Real smallest = *std::min_element(q.radius.begin(), q.radius.end());
    std::vector<std::size_t> level(q.radius.size());
    for (std::size_t s = 0; s < level.size(); ++s)
        level[s] = static_cast<std::size_t>(std::log2(q.radius[s] / smallest));
    const std::vector<detail::CellGrid> grids = detail::cell_grids(q, level);

    std::vector<VerletPair> pairs;
    std::vector<std::vector<VerletPair>> found;
    for (const detail::CellGrid& own : grids) {
        if (own.passive) continue;
        found.assign(static_cast<std::size_t>(block_count(own.size())), {});
        parallel_blocks(own.size(), [&](Index block, Index first, Index last) {
            std::vector<VerletPair>& here = found[static_cast<std::size_t>(block)];
            for (Index m = first; m < last; ++m) {
                const auto& seeker = own.member(m);
                const auto i = static_cast<std::size_t>(seeker.sphere);
                for (const detail::CellGrid& other : grids) {
                    // Two seekers find each other twice: the larger level, then the earlier member, reports.
                    const bool same = &other == &own;
                    if (!other.passive && other.level > own.level) continue;
                    if (!same && !seeker.shift.none()) continue;
                    const Vec3& x = seeker.at;
                    other.visit_near(x, q.radius[i], q.skin, same ? m : -1, [&](const auto& found_member) {
                        const auto j = static_cast<std::size_t>(found_member.sphere);
                        if (q.body[i] == q.body[j]) return;
                        const bool seeker_is_image = !seeker.shift.none(),
                                   found_is_image = !found_member.shift.none();
                        if (seeker_is_image && found_is_image) return;
                        ImageShift shift = found_member.shift;
                        if (same && (seeker_is_image || found_is_image)) {
                            // First with an image of the second, second with an image of the first: one pair.
                            if ((seeker_is_image ? j : i) > (seeker_is_image ? i : j)) return;
                            if (seeker_is_image) return here.push_back(detail::ordered(j, i, seeker.shift));
                        }
                        here.push_back(detail::ordered(i, j, shift));
                    });
                }
            }
        });
        for (const auto& some : found) pairs.insert(pairs.end(), some.begin(), some.end());
    }
    return pairs;
}

}  // namespace abrade

#endif
