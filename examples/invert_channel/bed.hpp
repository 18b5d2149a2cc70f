#pragma once
// What has passed along the channel, where stones run across it and how those of each size do, and the bed as
// it was when enough had passed.

#include "config.hpp"
#include "results.hpp"
#include "travel.hpp"

#include <abrade/dem/store/particles.hpp>
#include <abrade/wear/concrete.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

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
            Stone& stone = with_id(p.id[b]);
            stone.volume = p.volume[b], stone.farthest = std::max(stone.farthest, p.position[b].x());
            stone.seen = round_;
        }
        for (Stone& stone : stones_)
            if (stone.seen != round_) stone.farthest = std::max(stone.farthest, length_);
    }
    Real past(Real x) const noexcept {  ///< [m3]
        Real volume = 0;
        for (const Stone& stone : stones_)
            if (stone.farthest >= x) volume += stone.volume;
        return volume;
    }
    /// At each of the given places, which ascend.
    std::vector<Real> past(std::span<const Real> x) const {
        std::vector<std::pair<Real, Real>> all;
        for (const Stone& stone : stones_) all.emplace_back(stone.farthest, stone.volume);
        std::sort(all.begin(), all.end());
        std::vector<Real> volume(x.size(), 0);
        Real sum = 0;
        for (std::size_t n = x.size(); n-- > 0;) {
            for (; !all.empty() && all.back().first >= x[n]; all.pop_back()) sum += all.back().second;
            volume[n] = sum;
        }
        return volume;
    }

    static void fields(auto&& field) {
        field("stones", &PassedVolume::stones_), field("round", &PassedVolume::round_);
    }

private:
    struct Stone {
        Index id = 0;
        Real volume = 0, farthest = -std::numeric_limits<Real>::infinity();  ///< [m3], [m]
        Index seen = 0;

        static void fields(auto&& field) {
            field("id", &Stone::id), field("volume", "m3", &Stone::volume),
                field("farthest", "m", &Stone::farthest), field("seen", &Stone::seen);
        }
    };
    /// Stones are numbered as they are fed: a new one comes last.
    Stone& with_id(Index id) {
        const auto place = std::ranges::lower_bound(stones_, id, {}, &Stone::id);
        return place != stones_.end() && place->id == id ? *place : *stones_.insert(place, {.id = id});
    }

    Real length_;
    std::vector<Stone> stones_;  ///< by id
    Index round_ = 0;
};

/// Depth along the centre line and across the compared section, per converted volume that has passed. Means
/// over the section are all depth over all that passed: one stone far downstream must not count as much as
/// the many upstream.
inline BedDepth measure_depth(const ChannelConfig& c, const Concrete& concrete, const PassedVolume& passed) {
    constexpr Real unknown = std::numeric_limits<Real>::quiet_NaN();
    const Lattice& lattice = concrete.lattice();
    const Index along = lattice.count_along, across = lattice.count_across;
    const auto place = [&](Index i, Index j) -> const Vec3& {
        return lattice.sites[static_cast<std::size_t>(lattice.site(i, j, 0))].centre;
    };
    BedDepth bed;
    bed.depth_m = concrete.depth();
    for (Index i = 0; i < along; ++i) bed.x_m.push_back(place(i, 0).x());
    for (Index j = 0; j < across; ++j) bed.y_m.push_back(place(0, j).y());
    std::vector<Real> sum_across(static_cast<std::size_t>(across), 0);
    const std::vector<Real> volume = passed.past(bed.x_m);
    Real sum_centre = 0, sum_converted = 0, rows = 0;
    for (Index i = 0; i < along; ++i) {
        const Real x = bed.x_m[static_cast<std::size_t>(i)];
        const Real converted = c.wear.params().acceleration * volume[static_cast<std::size_t>(i)];
        const bool compared = x >= c.comparison.from && x <= c.comparison.to;
        Real centre = 0, columns = 0;
        for (Index j = 0; j < across; ++j) {
            const Real d = bed.depth_m[static_cast<std::size_t>(i * across + j)];
            bed.max_depth_m = std::max(bed.max_depth_m, d);
            if (std::abs(place(i, j).y()) <= c.comparison.half_width) centre += d, ++columns;
            if (compared) sum_across[static_cast<std::size_t>(j)] += d;
        }
        centre /= std::max(columns, 1.0);
        bed.centre_depth_per_m3.push_back(converted > 0 ? 1e3 * centre / converted : unknown);
        if (compared) sum_centre += centre, sum_converted += converted, ++rows;
    }
    const Real per_m3 = sum_converted > 0 ? 1e3 / sum_converted : unknown;
    bed.centre_mean_per_m3 = sum_centre * per_m3;
    for (const Real d : sum_across) {
        bed.across_depth_m.push_back(d / std::max(rows, 1.0));
        bed.across_depth_per_m3.push_back(d * per_m3);
    }
    // The band that holds 90 % of the worn volume, from the most worn column down.
    const Real worn = std::accumulate(sum_across.begin(), sum_across.end(), Real{0});
    std::sort(sum_across.rbegin(), sum_across.rend());
    Real held = 0;
    std::size_t band = 0;
    while (band < sum_across.size() && held < 0.9 * worn) held += sum_across[band++];
    bed.band_width_m = static_cast<Real>(band) * c.invert.width / across;
    return bed;
}

/// Watches a run: volumes passed over time, what goes on across the compared section, and the bed at
/// milestones.
class BedRecord {
public:
    explicit BedRecord(const ChannelConfig& c) : config_(c), passed_(c.invert.length), travel_(c) {
        history_.x_m = c.comparison.gauges;
        history_.passed_m3.resize(history_.x_m.size());
        for (const Real x : {c.comparison.from, c.comparison.to})
            for (const Real volume : c.comparison.converted) wanted_.push_back({volume, x});
    }

    /// Between two looks of `operator()`, to see touches that are over by then.
    template <class Sim>
    void see_hops(const Sim& sim) {
        travel_.see_hops(sim.particles(), on_concrete(sim));
    }
    /// Whether a look is due, `every` [s] after the last one.
    bool due(Real time, Real time_step, Real every) {
        if (time < next_look_ - 0.5 * time_step) return false;
        next_look_ += every;
        return true;
    }

    template <class Sim>
    void operator()(const Sim& sim) {
        passed_.watch(sim.particles());
        if (sim.time() >= next_note_ - 0.5 * sim.time_step()) {
            note_passed(sim.time());
            next_note_ += config_.output_every;
        }
        across_ = sim.concrete().lattice().count_across;
        for (auto* values : {&stones_, &impacts_, &sliding_})
            values->resize(static_cast<std::size_t>(across_), 0);
        note_losses(sim);
        note_stones(sim.particles(), on_concrete(sim));
        for (Wanted& one : wanted_) {
            if (one.reached) continue;
            const Real converted = config_.wear.params().acceleration * passed_.past(one.past);
            if (converted < one.converted) continue;
            one.reached = true;
            milestones_.push_back(
                {one.converted, one.past, sim.time(), measure_depth(config_, sim.concrete(), passed_)});
        }
    }
    /// Whether the last milestone has been reached.
    bool done() const {
        return !wanted_.empty() &&
               std::all_of(wanted_.begin(), wanted_.end(), [](const Wanted& one) { return one.reached; });
    }

    template <class Sim>
    void put_into(ChannelResults& r, const Sim& sim) {
        if (history_.time_s.empty() || history_.time_s.back() < sim.time()) note_passed(sim.time());
        r.bed = measure_depth(config_, sim.concrete(), passed_);
        r.passed = history_, r.milestones = milestones_;
        r.stones_across = share_of(stones_, sum(stones_));
        r.sampled_stone_speed_m_per_s = speed_ / seen_, r.stones_off_bed_share = off_bed_ / seen_;
        r.travel = travel_.results();
        const Real losses = sum(impacts_) + sum(sliding_);
        r.impacts_across = share_of(impacts_, losses), r.sliding_across = share_of(sliding_, losses);
    }

    static void fields(auto&& field) {
        field("passed", &BedRecord::passed_), field("history", &BedRecord::history_),
            field("next_note", "s", &BedRecord::next_note_), field("across", &BedRecord::across_),
            field("stones", &BedRecord::stones_), field("impacts", &BedRecord::impacts_),
            field("sliding", &BedRecord::sliding_), field("wanted", &BedRecord::wanted_),
            field("milestones", &BedRecord::milestones_), field("seen", &BedRecord::seen_);
        field("travel", &BedRecord::travel_), field("next_look", "s", &BedRecord::next_look_);
        field("speed", "m/s", &BedRecord::speed_), field("off_bed", &BedRecord::off_bed_);
    }

private:
    struct Wanted {
        Real converted = 0, past = 0;
        bool reached = false;

        static void fields(auto&& field) {
            field("converted", "m3", &Wanted::converted), field("past", "m", &Wanted::past),
                field("reached", &Wanted::reached);
        }
    };

    static Real sum(const std::vector<Real>& values) {
        return std::accumulate(values.begin(), values.end(), Real{0});
    }
    static std::vector<Real> share_of(std::vector<Real> values, Real all) {
        for (Real& one : values) one /= std::max(all, 1e-300);
        return values;
    }

    void note_passed(Real time) {
        history_.time_s.push_back(time);
        for (std::size_t g = 0; g < history_.x_m.size(); ++g)
            history_.passed_m3[g].push_back(passed_.past(history_.x_m[g]));
    }

    bool compared(const Vec3& x) const {
        return x.x() >= config_.comparison.from && x.x() <= config_.comparison.to;
    }
    /// The row of the lattice below or about a place: rows share the arc evenly.
    Real& across(std::vector<Real>& values, const Vec3& x) const {
        const Real angle = std::asin(std::clamp(x.y() / config_.invert.arc_radius, -1.0, 1.0));
        const Real row = (0.5 * angle / config_.invert.half_angle() + 0.5) * across_;
        return values[static_cast<std::size_t>(std::clamp(row, 0.0, across_ - 1.0))];
    }

    /// `on_bed`: whether a body touches concrete.
    void note_stones(const Particles& p, const std::vector<bool>& on_bed) {
        for (std::size_t b = 0; b < p.position.size(); ++b) {
            if (p.kind[b] != Kind::stone || !compared(p.position[b])) continue;
            across(stones_, p.position[b]) += p.volume[b];
            seen_ += 1, speed_ += p.velocity[b].norm(), off_bed_ += on_bed[b] ? 0 : 1;
            travel_.note(p, b, on_bed[b]);
        }
    }

    /// The power that contacts with concrete take up now. Elastic energy comes back, so over many looks the
    /// mean is what is lost.
    template <class Sim>
    void note_losses(const Sim& sim) {
        const Particles& p = sim.particles();
        sim.world().each_contact([&](Index first, Index second, const auto& contact, const auto& load) {
            const Real all = -load.force.dot(contact.velocity);
            const Real normal = -load.force.dot(contact.normal) * contact.velocity.dot(contact.normal);
            for (const Index body : {first, second}) {
                if (body < 0 || p.site[static_cast<std::size_t>(body)] < 0) continue;
                const Vec3& x = p.position[static_cast<std::size_t>(body)];
                if (compared(x)) across(impacts_, x) += normal, across(sliding_, x) += all - normal;
            }
        });
    }

    const ChannelConfig& config_;
    PassedVolume passed_;
    TravelRecord travel_;
    PassedHistory history_;
    Real next_note_ = 0, next_look_ = 0;  ///< [s]
    Index across_ = 0;
    std::vector<Real> stones_;                 ///< [across] volume, summed over looks
    std::vector<Real> impacts_, sliding_;      ///< [across] power, summed over looks
    Real seen_ = 0, speed_ = 0, off_bed_ = 0;  ///< stones, summed over looks: number, speed [m/s], number
    std::vector<Wanted> wanted_;
    std::vector<Milestone> milestones_;
};

}  // namespace abrade::examples
