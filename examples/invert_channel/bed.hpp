#pragma once
// What has passed along the channel, where stones run across it, and the bed as it was when enough had
// passed.

#include "config.hpp"
#include "results.hpp"

#include <abrade/dem/particles.hpp>
#include <abrade/wear/concrete.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace abrade::examples {

/// The solid volume of stones that have passed a place, at any time: each counts up to its farthest place.
class PassedVolume {
public:
    /// `length` [m]: what leaves has passed all of it.
    explicit PassedVolume(Real length) : length_(length) {}

    void watch(const Particles& p) {
        ++round_;
        for (std::size_t b = 0; b < p.position.size(); ++b) {
            if (p.kind[b] != Kind::stone) continue;
            Stone& stone = stones_[p.id[b]];
            stone.volume = p.volume[b], stone.farthest = std::max(stone.farthest, p.position[b].x());
            stone.seen = round_;
        }
        for (auto& [id, stone] : stones_)
            if (stone.seen != round_) stone.farthest = std::max(stone.farthest, length_);
    }
    Real past(Real x) const noexcept {  ///< [m3]
        Real volume = 0;
        for (const auto& [id, stone] : stones_)
            if (stone.farthest >= x) volume += stone.volume;
        return volume;
    }
    /// At each of the given places, which ascend.
    std::vector<Real> past(std::span<const Real> x) const {
        std::vector<std::pair<Real, Real>> all;
        for (const auto& [id, stone] : stones_) all.emplace_back(stone.farthest, stone.volume);
        std::sort(all.begin(), all.end());
        std::vector<Real> volume(x.size(), 0);
        Real sum = 0;
        for (std::size_t n = x.size(); n-- > 0;) {
            for (; !all.empty() && all.back().first >= x[n]; all.pop_back()) sum += all.back().second;
            volume[n] = sum;
        }
        return volume;
    }

private:
    struct Stone {
        Real volume = 0, farthest = -std::numeric_limits<Real>::infinity();
        Index seen = 0;
    };
    Real length_;
    std::unordered_map<Index, Stone> stones_;  ///< by id
    Index round_ = 0;
};

/// Depth along the centre line and over the compared section, per volume that has passed.
inline void measure_depth(const ChannelConfig& c, const Lattice& lattice, const std::vector<Real>& depth,
                          const PassedVolume& passed, BedDepth& bed) {
    const Index along = lattice.count_along, across = lattice.count_across;
    const auto place = [&](Index i, Index j) -> const Vec3& {
        return lattice.sites[static_cast<std::size_t>(lattice.site(i, j, 0))].centre;
    };
    bed = {};
    bed.depth_m = depth;
    for (Index i = 0; i < along; ++i) bed.x_m.push_back(place(i, 0).x());
    for (Index j = 0; j < across; ++j) bed.y_m.push_back(place(0, j).y());
    bed.across_depth_m.assign(static_cast<std::size_t>(across), 0);
    const std::vector<Real> volume = passed.past(bed.x_m);
    std::vector<Real> worn(static_cast<std::size_t>(across), 0);
    Real sum = 0, all_worn = 0;
    Index counted = 0, compared = 0;
    for (Index i = 0; i < along; ++i) {
        const Real x = bed.x_m[static_cast<std::size_t>(i)];
        const bool inside = x >= c.comparison.from && x <= c.comparison.to;
        compared += inside;
        Real centre = 0;
        Index columns = 0;
        for (Index j = 0; j < across; ++j) {
            const Real d = depth[static_cast<std::size_t>(i * across + j)];
            bed.max_depth_m = std::max(bed.max_depth_m, d);
            if (std::abs(place(i, j).y()) <= c.comparison.half_width) centre += d, ++columns;
            if (inside) bed.across_depth_m[static_cast<std::size_t>(j)] += d, all_worn += d;
        }
        const Real converted = c.wear.params().acceleration * volume[static_cast<std::size_t>(i)];
        const Real per_m3 = converted > 0 && columns > 0
                                ? 1e3 * centre / static_cast<Real>(columns) / converted
                                : std::numeric_limits<Real>::quiet_NaN();
        bed.centre_depth_per_m3.push_back(per_m3);
        if (inside && std::isfinite(per_m3)) sum += per_m3, ++counted;
    }
    bed.centre_mean_per_m3 = counted > 0 ? sum / counted : std::numeric_limits<Real>::quiet_NaN();
    // The band that holds 90 % of the worn volume, from the most worn column down.
    std::vector<Real> sorted = bed.across_depth_m;
    std::sort(sorted.rbegin(), sorted.rend());
    Real held = 0;
    std::size_t columns = 0;
    while (columns < sorted.size() && held < 0.9 * all_worn) held += sorted[columns++];
    bed.band_width_m = static_cast<Real>(columns) * c.invert.width / across;
    for (Real& d : bed.across_depth_m) d /= std::max(compared, 1);
}

/// Watches a run: volumes passed over time, stones across the compared section, and the bed at milestones.
class BedRecord {
public:
    explicit BedRecord(const ChannelConfig& c) : config_(c), passed_(c.invert.length) {
        history_.x_m = c.comparison.gauges;
        history_.passed_m3.resize(history_.x_m.size());
        for (const Real volume : c.comparison.converted)
            for (const Real x : {c.comparison.from, c.comparison.to}) wanted_.push_back({volume, x});
        std::stable_sort(wanted_.begin(), wanted_.end(),
                         [](const Wanted& a, const Wanted& b) { return a.past < b.past; });
    }

    template <class Sim>
    void operator()(const Sim& sim) {
        const Particles& p = sim.particles();
        passed_.watch(p);
        history_.time_s.push_back(sim.time());
        for (std::size_t g = 0; g < history_.x_m.size(); ++g)
            history_.passed_m3[g].push_back(passed_.past(history_.x_m[g]));
        note_stones(p, sim.concrete().lattice());
        for (Wanted& one : wanted_) {
            if (one.reached) continue;
            const Real converted = config_.wear.params().acceleration * passed_.past(one.past);
            if (converted < one.converted) continue;
            one.reached = true;
            Milestone& kept = milestones_.emplace_back();
            kept.converted_m3 = one.converted, kept.past_m = one.past, kept.time_s = sim.time();
            measure_depth(config_, sim.concrete().lattice(), sim.concrete().depth(), passed_, kept.bed);
        }
    }
    /// Whether the last milestone has been reached.
    bool done() const {
        return !wanted_.empty() &&
               std::all_of(wanted_.begin(), wanted_.end(), [](const Wanted& one) { return one.reached; });
    }

    template <class Sim>
    void put_into(ChannelResults& r, const Sim& sim) {
        measure_depth(config_, sim.concrete().lattice(), sim.concrete().depth(), passed_, r.bed);
        r.passed = history_, r.milestones = milestones_;
        Real all = 0;
        for (const Real one : stones_) all += one;
        for (Real& one : stones_) one /= std::max(all, 1e-300);
        r.stones_across = stones_;
    }

private:
    struct Wanted {
        Real converted, past;
        bool reached = false;
    };

    void note_stones(const Particles& p, const Lattice& lattice) {
        stones_.resize(static_cast<std::size_t>(lattice.count_across), 0);
        for (std::size_t b = 0; b < p.position.size(); ++b) {
            const Vec3& x = p.position[b];
            if (p.kind[b] != Kind::stone || x.x() < config_.comparison.from || x.x() > config_.comparison.to)
                continue;
            const Real share = x.y() / config_.invert.width + 0.5;
            const auto j = static_cast<std::ptrdiff_t>(share * static_cast<Real>(stones_.size()));
            stones_[static_cast<std::size_t>(std::clamp(
                j, std::ptrdiff_t{0}, static_cast<std::ptrdiff_t>(stones_.size()) - 1))] += p.volume[b];
        }
    }

    const ChannelConfig& config_;
    PassedVolume passed_;
    PassedHistory history_;
    std::vector<Real> stones_;  ///< [across] volume, summed over looks
    std::vector<Wanted> wanted_;
    std::vector<Milestone> milestones_;
};

}  // namespace abrade::examples
