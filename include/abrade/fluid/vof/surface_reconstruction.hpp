#pragma once
// Where the surface of a VolumeOfFluid is: rows with water, the band around the surface, planes in its cells.

#include <abrade/fluid/mesh/water_cells.hpp>
#include <abrade/fluid/vof/band.hpp>
#include <abrade/fluid/vof/liquid_cells.hpp>
#include <abrade/fluid/vof/normals.hpp>
#include <abrade/fluid/vof/normals_at_walls.hpp>

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

namespace abrade::detail {

/// Neighbouring cells of a row, as many as a pack has lanes, of which some are in the band.
struct BandPack {
    int plane;
    std::size_t number;  ///< of its plane's packs
    Offset first;        ///< cell
    Index level;         ///< of the first cell
    PackMask in_band;
    Index level_of(int lane, int dim) const noexcept { return dim == 3 ? level : level + lane; }
};

/// The surface of some liquid: `locate` finds it anew once the liquid has moved, `reconstruct` within a step.
template <int Dim>
class SurfaceReconstruction {
    static constexpr int inner = Layout<Dim>::inner;

public:
    /// Air of less than `smallest_void` of a cell [-] makes no surface; amid other water ten times as much:
    /// residues of some steps come together.
    SurfaceReconstruction(const LiquidCells<Dim>& liquid, Real smallest_void)
        : layout_(liquid.layout), smallest_void_(smallest_void), normals_(layout_, liquid.sizes),
          at_walls_(layout_, liquid.sizes, smallest_void), plane_of_(layout_.total, -1),
          band_(layout_, void_inside_water()), wet_(layout_), active_(layout_), touched_(layout_) {}

    void set_walls(const LiquidCells<Dim>& liquid) {
        at_walls_.set_walls(liquid.apertures, liquid.open_fractions);
    }

    Real smallest_void() const noexcept { return smallest_void_; }
    Real full() const noexcept { return 1 - smallest_void_; }
    Real void_inside_water() const noexcept { return 10 * smallest_void_; }

    const WetRows<Dim>& wet() const noexcept { return wet_; }
    const WetRows<Dim>& active() const noexcept { return active_; }    ///< that the surface may reach
    const WetRows<Dim>& touched() const noexcept { return touched_; }  ///< active now or in the step before
    const SurfaceBand<Dim>& band() const noexcept { return band_; }
    const SurfacePlanes<Dim>& planes() const noexcept { return planes_; }
    Index plane_of(Offset cell) const noexcept { return plane_of_[cell]; }  ///< its number, or -1

    /// Of liquid that was set from outside.
    void begin(LiquidCells<Dim>& liquid) {
        liquid.grid.for_each([&](const CellNumber<Dim>&, Offset c) {
            if (liquid.fraction[c] >= 1 - void_inside_water() && liquid.fraction[c] < 1) look_again_at(c);
        });
        wet_.find(liquid.fraction);
        locate(liquid);
    }
    /// After a step, in which it has moved by less than a cell; what is redistributed goes one cell further.
    void follow(LiquidCells<Dim>& liquid) {
        wet_.find_within(active_, liquid.fraction);
        locate(liquid);
    }
    /// A cell outside of the last band that may have to be closed: it was given redistributed liquid.
    void look_again_at(Offset cell) { to_close_.push_back(static_cast<Index>(cell)); }

    /// Planes of all cells of the band that are neither full nor dry; `keep`: with the normals that they
    /// have.
    void reconstruct(const LiquidCells<Dim>& liquid, bool keep);

    /// Calls body(BandPack) for the packs that hold cells of the band; planes in parallel.
    void for_band_packs(auto&& body) const {
        Pack lane;
        for (int l = 0; l < pack_lanes; ++l) lane.set(l, l);
        active_.for_each_plane([&](int p) {
            std::size_t number = 0;
            for (int r = 0; r < layout_.rows_per_plane(); ++r) {
                const RowRange range = active_.row(p, r);
                if (range.empty()) continue;
                const Offset start = layout_.row_start(p, r);
                for (int i = range.begin / pack_lanes * pack_lanes; i < range.end; i += pack_lanes) {
                    PackMask band = flags_at(band_.data() + start + i);
                    if (!any(band)) continue;
                    if (i < range.begin || i + pack_lanes > range.end)
                        band = band & (lane >= Pack(range.begin - i)) & (lane < Pack(range.end - i));
                    body(BandPack{p, number++, start + i, Dim == 3 ? Index{r} : Index{i}, band});
                }
            }
        });
    }

    static void fields(auto&& field) {
        field("plane_of", &SurfaceReconstruction::plane_of_),
            field("planes", &SurfaceReconstruction::planes_),
            field("planes_before", &SurfaceReconstruction::planes_before_),
            field("band", &SurfaceReconstruction::band_),
            field("at_walls", &SurfaceReconstruction::at_walls_), field("wet", &SurfaceReconstruction::wet_),
            field("active", &SurfaceReconstruction::active_),
            field("touched", &SurfaceReconstruction::touched_),
            field("to_close", &SurfaceReconstruction::to_close_);
    }

private:
    void locate(LiquidCells<Dim>& liquid);
    void include_inflows(const LiquidCells<Dim>& liquid);

    Layout<Dim> layout_;
    Real smallest_void_;
    SurfaceNormals<Dim> normals_;
    SurfaceAtWalls<Dim> at_walls_;
    Field<Index> plane_of_;
    SurfacePlanes<Dim> planes_, planes_before_;
    SurfaceBand<Dim> band_;
    WetRows<Dim> wet_, active_, touched_;
    std::vector<Index> to_close_;
};

template <int Dim>
void SurfaceReconstruction<Dim>::locate(LiquidCells<Dim>& liquid) {
    touched_ = active_;
    active_ = wet_.dilated(2, liquid.boundaries.periodic_axes());
    include_inflows(liquid);
    touched_.include(active_);
    fill_ghosts(liquid.fraction, touched_, liquid.boundaries);
    const std::vector<Index> band_before(band_.cells().begin(), band_.cells().end());
    band_.find(liquid.fraction, liquid.marks, active_, liquid.boundaries);
    // What has left the band with less air than makes a surface is full from now on; the rest is its volume
    // defect.
    const auto close = [&](Index c) {
        if (liquid.fraction[c] < 1 - void_inside_water() || band_.holds(c)) return;
        liquid.volume_defect[c] += liquid.fraction[c] - 1;
        liquid.fraction[c] = 1;
    };
    parallel_for(static_cast<Index>(band_before.size()),
                 [&](Index i) { close(band_before[static_cast<std::size_t>(i)]); });
    for (const Index c : to_close_) close(c);
    to_close_.clear();
    reconstruct(liquid, false);
}

/// Rows at an inflow count as active where water stands beyond.
template <int Dim>
void SurfaceReconstruction<Dim>::include_inflows(const LiquidCells<Dim>& liquid) {
    const int planes = layout_.planes(), rows = layout_.rows_per_plane(), n = layout_.row_length();
    for (int a = 0; a < Dim; ++a)
        for (const int end : {0, 1}) {
            if (liquid.boundaries[a][end] != Boundary::inflow) continue;
            for (int p = 0; p < planes; ++p)
                for (int r = 0; r < rows; ++r) {
                    if (a == Layout<Dim>::outer && p != (end == 0 ? 0 : planes - 1)) continue;
                    if (Dim == 3 && a == Dim - 1 && r != (end == 0 ? 0 : rows - 1)) continue;
                    const Real* own = liquid.fraction.data() + layout_.row_start(p, r);
                    RowRange wet{};
                    if (a == inner) {
                        if (own[end == 0 ? -1 : n] > 0) wet = end == 0 ? RowRange{0, 2} : RowRange{n - 2, n};
                    } else {
                        const Real* given = own + (end == 0 ? -1 : 1) * layout_.stride[a];
                        for (int i = 0; i < n; ++i)
                            if (given[i] > 0) wet = hull(wet, {i - 1, i + 2});
                    }
                    wet = {std::max(wet.begin, 0), std::min(wet.end, n)};
                    active_.row(p, r) = hull(active_.row(p, r), wet);
                }
        }
}

template <int Dim>
void SurfaceReconstruction<Dim>::reconstruct(const LiquidCells<Dim>& liquid, bool keep) {
    const auto at = [](auto i) { return static_cast<std::size_t>(i); };
    const Real* const fraction = liquid.fraction.data();
    const std::uint8_t* const marks = liquid.marks.data();
    const bool walls = liquid.open_fractions && !keep;
    // Lanes of a pack that get a plane, and those of them that hold liquid and air.
    const auto cut = [&](const BandPack& pack) {
        const Pack f = Pack::load(fraction + pack.first);
        const unsigned partly = lanes_of(pack.in_band & (f > Pack(volume_tolerance::round_off)) &
                                         (f < Pack(1 - volume_tolerance::round_off)));
        unsigned all = partly;
        if (walls)
            for (unsigned dry = lanes_of(pack.in_band & !(f > Pack(0))); dry != 0; dry &= dry - 1) {
                const int lane = std::countr_zero(dry);
                const auto cell = static_cast<Index>(pack.first + lane);
                if (at_walls_.is_dry_beside_water(cell, fraction, marks)) all |= 1u << lane;
            }
        return std::pair(all, partly);
    };
    std::vector<Index> first(at(layout_.planes()) + 1, 0);
    for_band_packs(
        [&](const BandPack& pack) { first[at(pack.plane) + 1] += std::popcount(cut(pack).first); });
    for (std::size_t p = 1; p < first.size(); ++p) first[p] += first[p - 1];
    std::swap(planes_, planes_before_);
    planes_.resize(at(first.back()));
    for_band_packs([&](const BandPack& pack) {
        const auto [all, partly] = cut(pack);
        for (unsigned left = all; left != 0; left &= left - 1) {
            const int lane = std::countr_zero(left);
            const std::size_t next = at(first[at(pack.plane)]++);
            const bool holds = (partly >> lane & 1) != 0;
            const Index before = keep ? plane_of_[pack.first + lane] : -1;
            planes_.cell[next] = static_cast<Index>(pack.first + lane);
            planes_.level[next] = pack.level_of(lane, Dim);
            planes_.has_normal[next] = before >= 0 || !holds;
            planes_.reconstructed[next] = before >= 0 ? planes_before_.reconstructed[at(before)] : 0;
            if (planes_.has_normal[next])
                for (std::size_t a = 0; a < Dim; ++a)
                    planes_.normal[a][next] = before >= 0 ? planes_before_.normal[a][at(before)] : 0;
        }
    });
    for (const Index c : planes_before_.cell) plane_of_[c] = -1;
    for (Index i = 0; i < planes_.count(); ++i) plane_of_[planes_.cell[at(i)]] = i;
    fill_periodic(plane_of_, layout_, liquid.boundaries);
    normals_.find(planes_, fraction, marks, !keep);
    if (walls) at_walls_.find(planes_, fraction, marks, plane_of_.data());
}

}  // namespace abrade::detail
