#pragma once
// Space cut into slabs along one axis: what lies in one slab stays in cache while it is worked on, and
// chunks of slabs are what threads share out.

#include <abrade/core/fields.hpp>
#include <abrade/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace abrade {

/// Slabs at least as thick as any two bodies that may be near each other reach, so that a slab's bodies meet
/// those of the next slab and no others. The first slab also holds what lies before it, the last what lies
/// behind. Chunks are runs of slabs; their number depends on the scene, never on threads.
class Slabs {
public:
    struct Fit {
        Vec3 low, high;      ///< of the bodies' positions [m]
        Real thickness = 0;  ///< at least [m]
        Index spheres = 0;   ///< to be shared out
    };

    /// Cuts anew where bodies have outgrown the present slabs, or the slabs are too thin or far too many.
    /// Returns whether it did.
    bool fit(const Fit& to) {
        const Vec3 size = to.high - to.low;
        const Real extent = size.maxCoeff();
        const bool spread = axis_ < 0 || extent > 1.2 * extent_ || extent < 0.5 * extent_ ||
                            size[axis_] < 0.7 * extent || to.low[axis_] < low_ - 0.2 * extent_ ||
                            to.high[axis_] > low_ + 1.2 * extent_;
        const bool grown = to.spheres > 2 * spheres_ || 2 * to.spheres < spheres_;
        if (!spread && !grown && thickness_ >= to.thickness && thickness_ < 2 * to.thickness) return false;
        size.maxCoeff(&axis_);
        low_ = to.low[axis_], extent_ = extent, spheres_ = to.spheres;
        // Fewer than some hundred spheres a slab leave packs of contacts half empty.
        constexpr Real most = 4096, fewest_spheres = 200;
        const Real slabs = std::clamp(
            std::floor(std::min(extent / to.thickness, static_cast<Real>(to.spheres) / fewest_spheres)), 1.0,
            most);
        count_ = static_cast<Index>(slabs);
        thickness_ = std::max(to.thickness, extent / slabs);
        return true;
    }

    Index count() const noexcept { return count_; }
    int axis() const noexcept { return std::max(axis_, 0); }
    Index of(const Vec3& x) const noexcept {
        const Real at = std::floor((x[axis()] - low_) / thickness_);
        return static_cast<Index>(std::clamp(at, 0.0, static_cast<Real>(count_ - 1)));
    }

    /// Cuts the slabs into chunks of about equal numbers of spheres; `first_sphere` [slab + 1].
    void share_out(std::span<const Index> first_sphere) {
        // A chunk pays for its border: eight slabs repay that, three where there would be one chunk alone.
        Index chunks = count_ >= 6 ? 2 : 1;
        while (2 * chunks <= count_ / 8 && chunks < 64) chunks *= 2;
        first_slab_.assign(1, 0);
        const Real total = first_sphere.back();
        for (Index s = 1; s < count_; ++s) {
            const Real before = first_sphere[static_cast<std::size_t>(s)];
            const auto begun = static_cast<Real>(first_slab_.size());
            const Real border = total * begun / chunks;
            const Real half_a_slab = 0.5 * (first_sphere[static_cast<std::size_t>(s) + 1] - before);
            if (begun < chunks && s - first_slab_.back() >= 2 && before + half_a_slab > border)
                first_slab_.push_back(s);
        }
        first_slab_.push_back(count_);
        chunk_of_.assign(static_cast<std::size_t>(count_), 0);
        for (Index c = 0; c < chunks_(); ++c)
            for (Index s = first_slab(c); s < first_slab(c + 1); ++s)
                chunk_of_[static_cast<std::size_t>(s)] = c;
    }
    Index chunks() const noexcept { return chunks_(); }
    Index first_slab(Index chunk) const noexcept { return first_slab_[static_cast<std::size_t>(chunk)]; }
    Index chunk_of(Index slab) const noexcept { return chunk_of_[static_cast<std::size_t>(slab)]; }

    static void fields(auto&& field) {
        field("axis", &Slabs::axis_), field("low", "m", &Slabs::low_), field("extent", "m", &Slabs::extent_),
            field("thickness", "m", &Slabs::thickness_), field("count", &Slabs::count_),
            field("spheres", &Slabs::spheres_), field("first_slab", &Slabs::first_slab_),
            field("chunk_of", &Slabs::chunk_of_);
    }

private:
    Index chunks_() const noexcept { return static_cast<Index>(first_slab_.size()) - 1; }

    int axis_ = -1;
    Real low_ = 0, extent_ = 0, thickness_ = 1;
    Index count_ = 1, spheres_ = 0;
    std::vector<Index> first_slab_{0, 1};  ///< [chunk + 1]
    std::vector<Index> chunk_of_{0};       ///< [slab]
};

}  // namespace abrade
