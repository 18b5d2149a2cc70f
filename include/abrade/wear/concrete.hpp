#pragma once
// The concrete's record of what was worn off it, site by site, and the abrasion depth that follows.

#include <abrade/geometry/lattice.hpp>
#include <abrade/wear/overflow.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace abrade {

/// The volume V_omega that is fully fractured at gamma_f = 1. The paper does not say which it means: with the
/// lattice's cell the summed worn volume is the concrete removed; with the sphere the gaps wear for nothing.
enum class FractureVolume { cell, sphere };

namespace detail {

/// Sites that wait for something, each at most once. Threads may add different sites at the same time.
struct WaitingSites {
    std::vector<Index> sites{};  ///< room for each site of the lattice
    Index count = 0;

    static void fields(auto&& field) {
        field("sites", &WaitingSites::sites), field("count", &WaitingSites::count);
    }

    /// True for the first.
    bool add(Index site) noexcept {
        const Index place = std::atomic_ref(count).fetch_add(1, std::memory_order_relaxed);
        sites[static_cast<std::size_t>(place)] = site;
        return place == 0;
    }
    /// Empties the list. Ascending, so that nothing depends on which thread came first.
    std::vector<Index> take() {
        std::vector<Index> taken(sites.begin(), sites.begin() + std::exchange(count, 0));
        std::sort(taken.begin(), taken.end());
        return taken;
    }
};

}  // namespace detail

/// One entry per lattice site, for as long as the simulation runs; the sphere may be long gone.
/// Fracture rate gamma_f = min(fractured / V_omega, 1); only with `WornOut::recorded` the fractured volume
/// may exceed V_omega.
///
/// Volume is conserved to round-off: all that `wear` was told is in `worn_volume`, `overflow_volume` or
/// `waiting_volume`. A site that is gone is a grain on its way: it wears what it still has, the excess is
/// overflow, since the block that it came from is elsewhere.
class Concrete {
public:
    /// What one collision may wear of its site's V_omega while the result does not depend on the time
    /// acceleration [-]: less than 2 % goes to overflow in the scenes of docs/verification/convergence.md.
    static constexpr Real safe_collision_share = 0.5;

    Concrete() = default;
    /// Throws InputError for what `Lattice::validate` and `validate(overflow)` refuse.
    explicit Concrete(Lattice lattice, FractureVolume kind = FractureVolume::cell,
                      Overflow overflow = FillCrater{}, WornOut worn_out = WornOut::fines)
        : lattice_(std::move(lattice)), kind_(kind), overflow_(overflow), worn_out_(worn_out),
          worn_(lattice_.sites.size()), gone_(lattice_.sites.size(), 0),
          wears_(lattice_.sites.size() / sites_per_part + 1, 0), left_(sites()) {
        lattice_.validate();
        validate(overflow_);
        if (worn_out_ == WornOut::recorded) return;
        newly_worn_out_.sites.resize(lattice_.sites.size());
        by_place_ = detail::SitesByPlace(lattice_);
        if (std::holds_alternative<DropOverflow>(overflow_)) return;
        waiting_.sites.resize(lattice_.sites.size());
        if (std::holds_alternative<FillCrater>(overflow_)) return;
        by_column_ = detail::SitesByColumn(lattice_);
        if (const auto* epoch = std::get_if<SpreadByEpoch>(&overflow_))
            groups_ = detail::ColumnGroups(lattice_, epoch->length);
    }

    /// Takes worn volume [m3] off a site; excess waits for `settle`, as does all volume with `SpreadByEpoch`.
    /// Wear in consecutive steps, of length `step` and up to `time` [s], is one collision's; without them
    /// each call is one. Calls for different sites may run at the same time, in any order.
    void wear(Index site, Real volume, Real time = 0, Real step = 0) noexcept {
        Worn& worn = worn_[at(site)];
        worn.collision = volume + (time - worn.last < 1.5 * step ? worn.collision : 0);
        worn.largest = std::max(worn.largest, worn.collision);
        worn.last = time;
        const bool collects =
            std::holds_alternative<SpreadByEpoch>(overflow_) && !gone(site) && worn_out_ != WornOut::recorded;
        const Real excess = collects ? volume : take(site, volume);
        if (!(excess > 0)) return;
        if (gone(site) || std::holds_alternative<DropOverflow>(overflow_)) {
            worn.overflow += excess;
        } else {
            if (worn.waiting == 0 && waiting_.add(site)) waits_since_ = time;
            worn.waiting += excess;
        }
    }
    /// The sphere has left its place.
    void set_gone(Index site) noexcept {
        if (has_some(site)) --left_;
        gone_[at(site)] = 1;
    }

    /// Whether `settle` has something to do: volume waits, or sites are newly worn out. Not while `wear`
    /// runs.
    bool unsettled() const noexcept { return waiting_.count > 0 || newly_worn_out_.count > 0; }

    /// Places the volume that waits; with `SpreadByEpoch` where the epoch in which it began to wait has ended
    /// by `time` [s]: infinity places it in any case. Returns the sites that were fully fractured since the
    /// last call, ascending.
    std::vector<Index> settle(Real time) {
        taken_from_.clear();
        if (const auto* epoch = std::get_if<SpreadByEpoch>(&overflow_)) {
            if (waiting_.count > 0 && time >= (std::floor(waits_since_ / epoch->every) + 1) * epoch->every)
                average_along_strips(waiting_.take());
        } else {
            for (const Index site : waiting_.take()) spread(site, std::exchange(worn_[at(site)].waiting, 0));
        }
        return newly_worn_out_.take();
    }

    /// The sites that the last `settle` placed volume on, some more than once.
    std::span<const Index> taken_from() const noexcept { return taken_from_; }

    /// Whether the concrete ends here: a held site is fully fractured, or a collision wore more than all
    /// sites had left. Never for `WornOut::recorded`.
    bool worn_through() const noexcept { return held_worn_out_ != 0 || exhausted_; }

    /// gamma_f; of `WornOut::recorded` what was worn over V_omega, at most 1.
    Real fracture(Index site) const noexcept {
        return std::min(worn_[at(site)].fractured / capacity(site), 1.0);
    }
    /// V_omega [m3].
    Real capacity(Index site) const noexcept {
        return kind_ == FractureVolume::cell ? lattice_.sites[at(site)].cell_volume
                                             : 4.0 / 3 * pi * cube(lattice_.radius);
    }
    /// Brings `rates` [site] up to date. `seen` is handed in as it came out last time, and empty at first:
    /// parts of the concrete that have not worn since then are not looked at.
    void renew_fracture_rates(std::vector<Real>& rates, std::vector<std::uint32_t>& seen) const {
        if (seen.empty()) rates.assign(worn_.size(), 0), seen.assign(wears_.size(), 0);
        for (std::size_t part = 0; part < wears_.size(); ++part) {
            if (std::exchange(seen[part], wears_[part]) == wears_[part]) continue;
            const std::size_t last = std::min((part + 1) * sites_per_part, worn_.size());
            for (std::size_t s = part * sites_per_part; s < last; ++s)
                rates[s] = fracture(static_cast<Index>(s));
        }
    }
    bool gone(Index site) const noexcept { return gone_[at(site)] != 0; }

    /// Volume fractured inside all spheres, standing or gone [m3].
    Real worn_volume() const noexcept { return sum(&Worn::fractured); }
    /// Volume told to wear that no site had [m3].
    Real overflow_volume() const noexcept { return sum(&Worn::overflow); }
    /// Volume told to wear that `settle` has still to place [m3].
    Real waiting_volume() const noexcept { return sum(&Worn::waiting); }
    /// The largest share of its site's V_omega that one collision wore, overflow included [-]. It is
    /// proportional to the time acceleration beta: above 1 one collision wears more than there is.
    Real largest_collision_share() const noexcept {
        Real largest = 0;
        for (Index s = 0; s < sites(); ++s) largest = std::max(largest, worn_[at(s)].largest / capacity(s));
        return largest;
    }
    /// Sound concrete that went with spheres that left their place [m3].
    Real detached_volume() const noexcept {
        Real volume = 0;
        for (std::size_t s = 0; s < gone_.size(); ++s)
            if (gone_[s]) volume += std::max(lattice_.sites[s].cell_volume - worn_[s].fractured, 0.0);
        return volume;
    }

    /// Abrasion depth of each column of the lattice [m], in the order of `column_area` ([along x across] of
    /// regular ones): fractured volume of standing spheres and whole cells of those gone, over the column's
    /// surface. Depth times area sums up to the volume lost. A sphere counts in the column that its centre
    /// stands in, whatever it reaches over: where a packing's columns are as narrow as its spheres, one may
    /// hold none at the surface, and its depth then begins with a deeper sphere. Take means over several
    /// columns.
    std::vector<Real> depth() const {
        std::vector<Real> depth(lattice_.column_area.size(), 0);
        for (std::size_t s = 0; s < lattice_.sites.size(); ++s)
            depth[static_cast<std::size_t>(lattice_.sites[s].column)] +=
                std::max(worn_[s].fractured, gone_[s] ? lattice_.sites[s].cell_volume : 0);
        for (std::size_t c = 0; c < depth.size(); ++c) depth[c] /= lattice_.column_area[c];
        return depth;
    }

    const Lattice& lattice() const noexcept { return lattice_; }
    Index sites() const noexcept { return static_cast<Index>(lattice_.sites.size()); }

    static void fields(auto&& field) {
        field("worn", &Concrete::worn_), field("gone", &Concrete::gone_), field("wears", &Concrete::wears_),
            field("left", &Concrete::left_), field("held_worn_out", &Concrete::held_worn_out_),
            field("exhausted", &Concrete::exhausted_), field("waiting", &Concrete::waiting_),
            field("newly_worn_out", &Concrete::newly_worn_out_),
            field("waits_since", "s", &Concrete::waits_since_), field("by_column", &Concrete::by_column_);
    }

private:
    static constexpr std::size_t sites_per_part = 1024;

    struct Worn {
        Real fractured = 0, overflow = 0, waiting = 0;       ///< [m3]
        Real collision = 0, largest = 0;                     ///< by the last collision, by any one [m3]
        Real last = -std::numeric_limits<Real>::infinity();  ///< when something was worn [s]
        static void fields(auto&& field) {
            field("fractured", "m3", &Worn::fractured), field("overflow", "m3", &Worn::overflow),
                field("waiting", "m3", &Worn::waiting), field("collision", "m3", &Worn::collision),
                field("largest", "m3", &Worn::largest), field("last", "s", &Worn::last);
        }
    };

    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }

    /// Whether a site can still be worn where it stands.
    bool has_some(Index site) const noexcept {
        return !gone(site) && worn_[at(site)].fractured < capacity(site);
    }

    /// Wears a site; returns the volume that it no longer has [m3].
    Real take(Index site, Real volume) noexcept {
        Worn& worn = worn_[at(site)];
        const Real whole = capacity(site), left = whole - worn.fractured;
        if (worn_out_ == WornOut::recorded) {
            worn.fractured += volume;
            note_wear(site);
            return 0;
        }
        if (!(left > 0)) return volume;
        worn.fractured = volume < left ? std::min(worn.fractured + volume, whole) : whole;
        note_wear(site);
        if (worn.fractured == whole) note_worn_out(site);
        return std::max(volume - left, 0.0);
    }
    void note_wear(Index site) noexcept {
        std::atomic_ref(wears_[at(site) / sites_per_part]).fetch_add(1, std::memory_order_relaxed);
    }
    void note_worn_out(Index site) noexcept {
        newly_worn_out_.add(site);
        if (gone(site)) return;
        std::atomic_ref(left_).fetch_sub(1, std::memory_order_relaxed);
        if (lattice_.sites[at(site)].held)
            std::atomic_ref(held_worn_out_).store(1, std::memory_order_relaxed);
    }

    Real place(Index site, Real volume) {
        taken_from_.push_back(site);
        return take(site, volume);
    }

    /// Places the excess of one site.
    void spread(Index struck, Real volume) {
        if (const auto* patch = std::get_if<SpreadOverPatch>(&overflow_)) {
            columns_.clear();
            by_place_.each_in(*patch, lattice_, struck, [&](Index site) {
                const Index column = lattice_.sites[at(site)].column;
                if (top(column) == site) columns_.push_back(column);
            });
            std::sort(columns_.begin(), columns_.end());
            volume = wear_evenly(volume);
        }
        fill_crater(struck, volume);
    }

    void fill_crater(Index struck, Real volume) {
        if (!(volume > 0)) return;
        // A little more than the half ball of that volume.
        const Real reach = 2 * lattice_.radius + 0.8 * std::cbrt(volume);
        const auto has = [&](Index site) { return has_some(site); };
        if (left_ > 0)
            by_place_.nearest_first(lattice_, struck, reach, has, [&](Index site) {
                volume = place(site, volume);
                worn_[at(site)].collision = std::max(worn_[at(site)].collision, worn_[at(struck)].collision);
                return volume > 0;
            });
        worn_[at(struck)].overflow += volume;
        exhausted_ |= volume > 0;
    }

    /// Places all that waits at `struck`, ascending, averaged over each group of columns.
    void average_along_strips(const std::vector<Index>& struck) {
        std::vector<Real> volume(groups_.count(), 0);
        std::vector<Index> about(groups_.count(), -1);
        for (const Index site : struck) {
            const std::size_t group = groups_.group_of(lattice_.sites[at(site)].column);
            volume[group] += std::exchange(worn_[at(site)].waiting, 0);
            about[group] = site;
        }
        for (std::size_t group = 0; group < volume.size(); ++group) {
            if (!(volume[group] > 0)) continue;
            const auto columns = groups_.columns(group);
            columns_.assign(columns.begin(), columns.end());
            volume[group] = wear_evenly(volume[group]);
        }
        // Craters come last: until now each group has worn its own columns alone.
        for (std::size_t group = 0; group < volume.size(); ++group) fill_crater(about[group], volume[group]);
    }

    /// Wears `columns_` from their tops down, all by the same depth; returns the volume that they no longer
    /// have [m3].
    Real wear_evenly(Real volume) {
        while (volume > 0) {
            std::erase_if(columns_, [&](Index column) { return top(column) < 0; });
            if (columns_.empty()) break;
            Real area = 0;
            for (const Index column : columns_) area += lattice_.column_area[at(column)];
            const Real depth = volume / area;
            volume = 0;  // where it is above 0 again, a column has ended
            for (const Index column : columns_) volume += wear_down(column, depth);
        }
        return volume;
    }
    Real wear_down(Index column, Real depth) {
        Real volume = depth * lattice_.column_area[at(column)];
        for (Index site = top(column); site >= 0 && volume > 0; site = top(column))
            volume = place(site, volume);
        return volume;
    }
    Index top(Index column) {
        return by_column_.top(column, [&](Index site) { return has_some(site); });
    }

    Real sum(Real Worn::*part) const noexcept {
        Real total = 0;
        for (const Worn& worn : worn_) total += worn.*part;
        return total;
    }

    Lattice lattice_;
    FractureVolume kind_ = FractureVolume::cell;
    Overflow overflow_;
    WornOut worn_out_ = WornOut::fines;
    std::vector<Worn> worn_;               ///< [site]
    std::vector<char> gone_;               ///< [site]
    std::vector<std::uint32_t> wears_;     ///< [part] how often something wore there
    Index left_ = 0;                       ///< sites that stand and are not fully fractured
    Index held_worn_out_ = 0;              ///< whether any held site is
    bool exhausted_ = false;               ///< volume was left over when nothing was left to wear
    detail::WaitingSites waiting_;         ///< with volume to be placed
    detail::WaitingSites newly_worn_out_;  ///< since `settle` told of them
    Real waits_since_ = 0;                 ///< when the first of `waiting_` was worn [s]
    detail::SitesByPlace by_place_;
    detail::SitesByColumn by_column_;
    detail::ColumnGroups groups_;
    std::vector<Index> columns_;     ///< that `wear_evenly` wears
    std::vector<Index> taken_from_;  ///< sites
};

}  // namespace abrade
