#pragma once
// How stones of each size travel along the compared section.

#include "config.hpp"
#include "results.hpp"

#include "../common/saltation.hpp"

#include <abrade/dem/store/particles.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace abrade::examples {

/// Which bodies touch concrete now.
template <class Sim>
std::vector<bool> on_concrete(const Sim& sim) {
    const Particles& p = sim.particles();
    std::vector<bool> touches(p.position.size(), false);
    sim.world().each_contact([&](Index first, Index second, const auto&, const auto&) {
        for (const Index body : {first, second})
            if (const Index other = first + second - body;
                body >= 0 && other >= 0 && p.site[static_cast<std::size_t>(body)] >= 0)
                touches[static_cast<std::size_t>(other)] = true;
    });
    return touches;
}

class TravelRecord {
public:
    explicit TravelRecord(const ChannelConfig& c) : config_(c), sums_(c.feed.classes.size()) {}

    /// A stone of the compared section.
    void note(const Particles& p, std::size_t b, bool on_bed) {
        const std::size_t of = class_of(p.volume[b]);
        Sums& sum = sums_[of];
        sum.looks += 1, sum.speed += p.velocity[b].norm(), sum.off_bed += on_bed ? 0 : 1;
        Real gap = std::numeric_limits<Real>::infinity();
        for (Index s = p.first_sphere[b]; s < p.first_sphere[b] + p.sphere_count[b]; ++s)
            gap = std::min(
                gap, height(p.centre[static_cast<std::size_t>(s)]) - p.radius[static_cast<std::size_t>(s)]);
        sum.clear += gap > clear_from(of) ? 1 : 0;
    }

    /// All stones, often: touches are short.
    void see_hops(const Particles& p, const std::vector<bool>& on_bed) {
        for (std::size_t b = 0; b < p.position.size(); ++b) {
            if (p.kind[b] != Kind::stone) continue;
            const Vec3& x = p.position[b];
            const auto hop = flights_.look(p.id[b], x.x(), height(x), on_bed[b]);
            if (!hop || x.x() < config_.comparison.from || x.x() > config_.comparison.to) continue;
            const std::size_t of = class_of(p.volume[b]);
            if (hop->height < clear_from(of)) continue;
            sums_[of].hops += 1, sums_[of].height += hop->height, sums_[of].length += hop->length;
        }
    }

    std::vector<TravelOfSize> results() const {
        std::vector<TravelOfSize> travel;
        for (std::size_t of = 0; of < sums_.size(); ++of) {
            const Sums& sum = sums_[of];
            travel.push_back({.size_m = size_of(of),
                              .looks = static_cast<Index>(sum.looks),
                              .speed_m_per_s = sum.speed / sum.looks,
                              .off_bed_share = sum.off_bed / sum.looks,
                              .clear_share = sum.clear / sum.looks,
                              .hops = static_cast<Index>(sum.hops),
                              .hop_height_m = sum.height / sum.hops,
                              .hop_length_m = sum.length / sum.hops});
        }
        return travel;
    }

    static void fields(auto&& field) {
        field("sums", &TravelRecord::sums_), field("flights", &TravelRecord::flights_);
    }

private:
    struct Sums {
        Real looks = 0, speed = 0, off_bed = 0, clear = 0;  ///< number, [m/s], number, number
        Real hops = 0, height = 0, length = 0;              ///< number, [m], [m]

        static void fields(auto&& field) {
            field("looks", &Sums::looks), field("speed", "m/s", &Sums::speed),
                field("off_bed", &Sums::off_bed), field("clear", &Sums::clear), field("hops", &Sums::hops),
                field("height", "m", &Sums::height), field("length", "m", &Sums::length);
        }
    };

    Real size_of(std::size_t of) const { return config_.feed.classes[of].size; }
    /// What a stone rolls over is no hop.
    Real clear_from(std::size_t of) const { return 0.1 * size_of(of); }
    std::size_t class_of(Real volume) const {
        const Real size = std::cbrt(6 / pi * volume);
        std::size_t nearest = 0;
        for (std::size_t of = 1; of < sums_.size(); ++of)
            if (std::abs(size_of(of) - size) < std::abs(size_of(nearest) - size)) nearest = of;
        return nearest;
    }
    /// Over the invert as it was built, along its normal [m].
    Real height(const Vec3& x) const {
        const Real radius = config_.invert.arc_radius;
        return radius - std::hypot(x.y(), radius - x.z());
    }

    const ChannelConfig& config_;
    std::vector<Sums> sums_;  ///< [class of stones]
    Flights flights_;
};

}  // namespace abrade::examples
