#pragma once
// The concrete's record of what was worn off it, site by site, and the abrasion depth that follows.

#include <abrade/geometry/lattice.hpp>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace abrade {

/// The volume V_omega that is fully fractured at gamma_f = 1. The paper does not say which it means: with the
/// lattice's cell the summed worn volume is the concrete removed; with the sphere the gaps wear for nothing.
enum class FractureVolume { cell, sphere };

/// One entry per lattice site, for as long as the simulation runs; the sphere may be long gone.
/// Fracture rate gamma_f = fractured / V_omega, in [0, 1].
class Concrete {
public:
    /// What one collision may wear of its site's V_omega while the result does not depend on the time
    /// acceleration [-]: less than 1 % goes to overflow in the scenes of docs/convergence.md.
    static constexpr Real safe_collision_share = 0.5;

    Concrete() = default;
    /// Throws InputError for what `Lattice::validate` refuses.
    explicit Concrete(Lattice lattice, FractureVolume kind = FractureVolume::cell)
        : lattice_(std::move(lattice)), kind_(kind), worn_(lattice_.sites.size()),
          gone_(lattice_.sites.size(), 0), wears_(lattice_.sites.size() / sites_per_part + 1, 0) {
        lattice_.validate();
    }

    /// Takes worn volume [m3] off a site. What a fully fractured site no longer has is booked as overflow.
    /// Wear in consecutive steps, of length `step` and up to `time` [s], is one collision's; without them
    /// each call is one. Calls for different sites may run at the same time.
    void wear(Index site, Real volume, Real time = 0, Real step = 0) noexcept {
        Worn& worn = worn_[static_cast<std::size_t>(site)];
        const Real taken = std::min(volume, capacity(site) - worn.fractured);
        worn.fractured += taken;
        worn.overflow += volume - taken;
        worn.collision = volume + (time - worn.last < 1.5 * step ? worn.collision : 0);
        worn.largest = std::max(worn.largest, worn.collision);
        worn.last = time;
        std::atomic_ref(wears_[static_cast<std::size_t>(site) / sites_per_part])
            .fetch_add(1, std::memory_order_relaxed);
    }
    void set_gone(Index site) noexcept { gone_[static_cast<std::size_t>(site)] = 1; }

    Real fracture(Index site) const noexcept {
        return worn_[static_cast<std::size_t>(site)].fractured / capacity(site);
    }
    /// V_omega [m3].
    Real capacity(Index site) const noexcept {
        return kind_ == FractureVolume::cell ? lattice_.sites[static_cast<std::size_t>(site)].cell_volume
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
    bool gone(Index site) const noexcept { return gone_[static_cast<std::size_t>(site)] != 0; }

    /// Volume fractured inside all spheres, standing or gone [m3].
    Real worn_volume() const noexcept { return sum(&Worn::fractured); }
    /// Worn volume that hit spheres already fully fractured [m3].
    Real overflow_volume() const noexcept { return sum(&Worn::overflow); }
    /// The largest share of its site's V_omega that one collision wore, overflow included [-]. It is
    /// proportional to the time acceleration beta: above 1 one collision wears more than there is.
    Real largest_collision_share() const noexcept {
        Real largest = 0;
        for (Index s = 0; s < sites(); ++s)
            largest = std::max(largest, worn_[static_cast<std::size_t>(s)].largest / capacity(s));
        return largest;
    }
    /// Sound concrete that went with spheres that left their place [m3].
    Real detached_volume() const noexcept {
        Real volume = 0;
        for (std::size_t s = 0; s < gone_.size(); ++s)
            if (gone_[s]) volume += lattice_.sites[s].cell_volume - worn_[s].fractured;
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
                gone_[s] ? lattice_.sites[s].cell_volume : worn_[s].fractured;
        for (std::size_t c = 0; c < depth.size(); ++c) depth[c] /= lattice_.column_area[c];
        return depth;
    }

    const Lattice& lattice() const noexcept { return lattice_; }
    Index sites() const noexcept { return static_cast<Index>(lattice_.sites.size()); }

private:
    static constexpr std::size_t sites_per_part = 1024;

    struct Worn {
        Real fractured = 0, overflow = 0;                    ///< [m3]
        Real collision = 0, largest = 0;                     ///< by the last collision, by any one [m3]
        Real last = -std::numeric_limits<Real>::infinity();  ///< when something was worn [s]
    };

    Real sum(Real Worn::*part) const noexcept {
        Real total = 0;
        for (const Worn& worn : worn_) total += worn.*part;
        return total;
    }

    Lattice lattice_;
    FractureVolume kind_ = FractureVolume::cell;
    std::vector<Worn> worn_;            ///< [site]
    std::vector<char> gone_;            ///< [site]
    std::vector<std::uint32_t> wears_;  ///< [part] how often something wore there
};

}  // namespace abrade
