#pragma once
// Where wear goes that its site no longer has: the options, and the order in which they take from a lattice.

#include <abrade/core/fields.hpp>
#include <abrade/core/require.hpp>
#include <abrade/geometry/lattice.hpp>
#include <abrade/geometry/point_grid.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

namespace abrade {

/// Excess, the volume that a struck site no longer has, wears the sites nearest to it that still have
/// something, each until it is fully fractured before the next. Distances are those of the lattice's centres;
/// of sites at one distance the lower number comes first.
struct FillCrater {};

/// Excess wears the columns of a rectangle about the struck site, each by the same depth: those whose topmost
/// site that still has something is centred in the rectangle, edges included, from that site down. Excess
/// that these columns no longer have fills a crater about the struck site.
struct SpreadOverPatch {
    Real length = 0;  ///< along x [m]
    Real width = 0;   ///< along y [m]
};

/// All wear, not excess alone, is collected over an epoch. Then the volume of each strip along x and each
/// place across is worn off its columns, each by the same depth, from their topmost site down. Volume that
/// these columns no longer have fills a crater about one of the struck sites. Places across are the lattice's
/// rows `across`; where columns do not stand in rows, their mean y in steps of half a sphere radius.
struct SpreadByEpoch {
    Real length = 0;  ///< of a strip along x, from the lattice's low end [m]
    Real every = 0;   ///< duration of an epoch; the first begins at time 0 [s]
};

/// Excess wears nothing; it is booked as `Concrete::overflow_volume`.
struct DropOverflow {};

using Overflow = std::variant<FillCrater, SpreadOverPatch, SpreadByEpoch, DropOverflow>;

/// Throws InputError for a length, width or duration that is not finite and > 0.
inline void validate(const Overflow& overflow) {
    if (const auto* patch = std::get_if<SpreadOverPatch>(&overflow)) {
        require_positive(patch->length, "SpreadOverPatch.length", "m",
                         "give the patch's side along x, or take FillCrater");
        require_positive(patch->width, "SpreadOverPatch.width", "m",
                         "give the patch's side along y, or take FillCrater");
    }
    if (const auto* epoch = std::get_if<SpreadByEpoch>(&overflow)) {
        require_positive(epoch->length, "SpreadByEpoch.length", "m",
                         "give the length along x over which wear is averaged, or take FillCrater");
        require_positive(epoch->every, "SpreadByEpoch.every", "s",
                         "give the time over which wear is collected, or take FillCrater");
    }
}

/// What becomes of a sphere at gamma_f = 1. `fines`: it vanishes, mass and energy are booked. `grain`: it
/// stays as a loose grain; on concrete that moves, once its bonds have broken. `recorded`: wear is written
/// down only, without limit; the bed is frozen, each sphere stays as strong as it was, and nothing overflows.
/// `recedes`: as fines, and until then a sphere of standing concrete sinks towards the next one below, by
/// gamma_f of the way, so that the surface that stones meet is as deep as the record says and no rougher than
/// its spheres.
enum class WornOut { fines, grain, recorded, recedes };

namespace detail {

/// The sites of a lattice by where they are.
class SitesByPlace {
public:
    SitesByPlace() = default;
    explicit SitesByPlace(const Lattice& lattice) {
        if (lattice.sites.empty()) return;
        std::vector<Vec3> centres;
        centres.reserve(lattice.sites.size());
        Vec3 low = lattice.sites.front().centre, high = low;
        for (const LatticeSite& site : lattice.sites) {
            centres.push_back(site.centre);
            low = low.cwiseMin(site.centre), high = high.cwiseMax(site.centre);
        }
        grid_ = PointGrid(centres, 2 * lattice.radius);
        extent2_ = (high - low).squaredNorm();
    }

    /// Calls `take(site)` for the sites that `has(site)` accepts, nearest to `struck` first, until it returns
    /// false. The search begins within `reach` [m] and widens.
    template <class Has, class Take>
    void nearest_first(const Lattice& lattice, Index struck, Real reach, Has&& has, Take&& take) {
        const Vec3& x = lattice.sites[static_cast<std::size_t>(struck)].centre;
        // Round-off would order sites of a lattice that are at one distance.
        const Real step2 = 1e-6 * square(lattice.radius);
        for (Real done = -1;; reach *= 1.5) {
            const Real last = std::floor(square(reach) / step2) - 1;
            found_.clear();
            grid_.each_about(x, reach, [&](Index site) {
                if (!has(site)) return;
                const Real distance2 =
                    (lattice.sites[static_cast<std::size_t>(site)].centre - x).squaredNorm();
                const Real steps = std::round(distance2 / step2);
                if (steps > done && steps <= last) found_.emplace_back(steps, site);
            });
            std::sort(found_.begin(), found_.end());
            for (const auto& [steps, site] : found_)
                if (!take(site)) return;
            if (last * step2 > extent2_) return;
            done = last;
        }
    }

    /// Calls `visit(site)` for the sites centred in a rectangle about `struck`, edges included, at any
    /// height.
    template <class Visit>
    void each_in(const SpreadOverPatch& patch, const Lattice& lattice, Index struck, Visit&& visit) const {
        const Vec3& x = lattice.sites[static_cast<std::size_t>(struck)].centre;
        const Real edge = 1e-6 * lattice.radius;
        const Vec3 half(0.5 * patch.length + edge, 0.5 * patch.width + edge,
                        std::numeric_limits<Real>::infinity());
        grid_.each_about(x, half, [&](Index site) {
            const Vec3 apart = lattice.sites[static_cast<std::size_t>(site)].centre - x;
            if (std::abs(apart.x()) <= half.x() && std::abs(apart.y()) <= half.y()) visit(site);
        });
    }

private:
    PointGrid grid_;
    Real extent2_ = 0;                           ///< of the lattice, squared [m2]
    std::vector<std::pair<Real, Index>> found_;  ///< squared distance in steps, site; between calls rubbish
};

/// The sites of each column from the top down.
class SitesByColumn {
public:
    SitesByColumn() = default;
    explicit SitesByColumn(const Lattice& lattice) : sites_(lattice.sites.size()) {
        std::iota(sites_.begin(), sites_.end(), Index{0});
        const auto key = [&](Index n) {
            const LatticeSite& site = lattice.sites[static_cast<std::size_t>(n)];
            return std::tuple(site.column, site.layer, -site.centre.z(), n);
        };
        std::sort(sites_.begin(), sites_.end(), [&](Index a, Index b) { return key(a) < key(b); });
        end_.assign(lattice.column_area.size(), 0);
        for (const LatticeSite& site : lattice.sites) ++end_[static_cast<std::size_t>(site.column)];
        top_.assign(end_.size(), 0);
        for (std::size_t c = 1; c < end_.size(); ++c) top_[c] = end_[c - 1], end_[c] += end_[c - 1];
    }

    /// The topmost site of a column that `has(site)` accepts; -1 for none. A site that it refuses once is
    /// never asked about again.
    template <class Has>
    Index top(Index column, Has&& has) {
        std::size_t& top = top_[static_cast<std::size_t>(column)];
        const std::size_t end = end_[static_cast<std::size_t>(column)];
        while (top < end && !has(sites_[top])) ++top;
        return top < end ? sites_[top] : -1;
    }

    static void fields(auto&& field) { field("top", &SitesByColumn::top_); }

private:
    std::vector<Index> sites_;            ///< column by column, in each from the top down
    std::vector<std::size_t> top_, end_;  ///< [column] in sites_
};

/// The columns of a lattice in groups: those of one strip along x at one place across.
class ColumnGroups {
public:
    ColumnGroups() = default;
    ColumnGroups(const Lattice& lattice, Real strip_length) : group_of_(lattice.column_area.size(), -1) {
        struct Sum {
            Real x = 0, y = 0, sites = 0;
        };
        std::vector<Sum> sums(lattice.column_area.size());
        Real low = std::numeric_limits<Real>::infinity();
        bool in_rows = true;
        for (const LatticeSite& site : lattice.sites) {
            Sum& sum = sums[static_cast<std::size_t>(site.column)];
            sum.x += site.centre.x(), sum.y += site.centre.y(), ++sum.sites;
            low = std::min(low, site.centre.x() - lattice.radius);
            in_rows = in_rows && site.across < lattice.count_across &&
                      site.column == site.along * lattice.count_across + site.across;
        }
        std::vector<std::tuple<Real, Real, Index>> places;  // strip, row, column
        for (std::size_t c = 0; c < sums.size(); ++c) {
            const Sum& sum = sums[c];
            if (sum.sites == 0) continue;
            const auto column = static_cast<Index>(c);
            // A column in the middle of two strips belongs to the second, whatever its round-off.
            const Real strip = std::floor((sum.x / sum.sites - low) / strip_length + 1e-9);
            const Real row = in_rows ? static_cast<Real>(column % lattice.count_across)
                                     : std::round(sum.y / sum.sites / (0.5 * lattice.radius));
            places.emplace_back(strip, row, column);
        }
        std::sort(places.begin(), places.end());
        for (std::size_t n = 0; n < places.size(); ++n) {
            const auto& [strip, row, column] = places[n];
            if (n == 0 || strip != std::get<0>(places[n - 1]) || row != std::get<1>(places[n - 1]))
                start_.push_back(n);
            columns_.push_back(column);
            group_of_[static_cast<std::size_t>(column)] = static_cast<Index>(start_.size() - 1);
        }
        start_.push_back(places.size());
    }

    std::size_t count() const noexcept { return start_.empty() ? 0 : start_.size() - 1; }
    std::size_t group_of(Index column) const noexcept {
        return static_cast<std::size_t>(group_of_[static_cast<std::size_t>(column)]);
    }
    std::span<const Index> columns(std::size_t group) const noexcept {
        return std::span(columns_).subspan(start_[group], start_[group + 1] - start_[group]);
    }

private:
    std::vector<Index> columns_;      ///< group by group
    std::vector<std::size_t> start_;  ///< [group + 1] in columns_
    std::vector<Index> group_of_;     ///< [column]; -1 for one without sites
};

}  // namespace detail

}  // namespace abrade
