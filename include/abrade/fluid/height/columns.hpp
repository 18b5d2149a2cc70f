#pragma once
// Columns of cells above a bed: how much liquid stands in one below a height, and how high a volume stands.

#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>
#include <abrade/fluid/mesh/volume_tolerance.hpp>
#include <abrade/fluid/vof/cell_marks.hpp>
#include <abrade/fluid/vof/plic.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace abrade::detail {

/// The shape of each column: V(z), the volume that walls leave open below a height z, and its inverse.
///
/// In a cell that a wall cuts the wall is a plane (its normal, its volume): V(z) is exact for plane beds and
/// consistent with its own inverse to round-off for all others, so water that is level in it stays level.
/// A column must be open from its bed to the top of the box: what hangs over water is refused.
template <int Dim>
class HeightColumns {
    static constexpr int vertical = Grid<Dim>::vertical, ghosts = Layout<Dim>::ghosts;
    /// The open share of a level face may fall by so much upwards [-]: curved upright walls are cut by
    /// straight lines, and faces that are nearly closed are closed.
    static constexpr Real overhang = 0.05;

public:
    /// Where the surface of a column stands.
    struct Surface {
        int level = 0;    ///< of the cell that holds it
        Real share = 0;   ///< of that cell's open volume below it [-]
        Real height = 0;  ///< [m]
        Real beyond = 0;  ///< what stands above it for want of room, or lacks below [m3]
    };

    HeightColumns() = default;
    explicit HeightColumns(const Grid<Dim>& grid)
        : grid_(grid), across_(Dim == 3 ? grid.cells(1) : 1), pitch_(Dim == 3 ? across_ + 2 * ghosts : 1),
          levels_(grid.cells(vertical)) {
        plan_ = grid.size(0, 0) * (Dim == 3 ? grid.size(1, 0) : 1);
        set_walls(nullptr, nullptr, {});
    }

    /// Throws InputError where a wall hangs over water.
    void set_walls(const FaceField<Dim>* apertures, const Field<Real>* open_fractions,
                   std::span<const CutCell<Dim>> cut_cells) {
        open_ = open_fractions;
        cuts_.clear();
        for (const CutCell<Dim>& w : cut_cells) {
            const CellNumber<Dim> cell = grid_.layout().number(w.cell);
            const Real open = (*open_fractions)[w.cell];
            if (open <= 0 || open >= 1) continue;
            Cut cut{w.cell, {}};
            std::array<Real, Dim> into;
            for (int a = 0; a < Dim; ++a) {
                into[at(a)] = w.normal[a] * grid_.size(a, cell[a]);
                cut.open.normal[at(a)] = -into[at(a)];
            }
            cut.open.distance = plane_distance<Dim>(cut.open.normal, open);
            cuts_.push_back(cut);
        }
        const auto count = static_cast<std::size_t>((grid_.cells(0) + 2 * ghosts) * pitch_);
        first_.assign(count, levels_), whole_from_.assign(count, levels_);
        below_whole_.assign(count, 0), capacity_.assign(count, 0), bed_.assign(count, 0);
        for (int plane = -ghosts; plane < grid_.cells(0) + ghosts; ++plane)
            for (int j = Dim == 3 ? -ghosts : 0; j < across_ + (Dim == 3 ? ghosts : 0); ++j)
                shape(plane, j, apertures);
    }

    /// Calls body(plane, j, column) for the columns of the box.
    void for_each(auto&& body) const { for_planes(0, grid_.cells(0), body); }
    /// The same in parallel: each column writes to what is its own.
    void parallel_for_each(auto&& body) const {
        parallel_blocks(
            grid_.cells(0), [&](Index, Index first, Index last) { for_planes(first, last, body); },
            block_of_planes);
    }
    /// Largest `of(plane, j, column)`, as parallel_max has it.
    Real parallel_max_of(auto&& of) const {
        return parallel_max(
            grid_.cells(0),
            [&](Index plane) {
                Real most = 0;
                for_planes(plane, plane + 1, [&](int i, int j, Index n) {
                    if (const Real value = of(i, j, n); !(value <= most)) most = value;
                });
                return most;
            },
            block_of_planes);
    }

    int pitch() const noexcept { return pitch_; }    ///< from a plane's columns to the next plane's
    int across() const noexcept { return across_; }  ///< columns of a plane
    int levels() const noexcept { return levels_; }
    std::size_t count() const noexcept { return first_.size(); }
    Real plan() const noexcept { return plan_; }  ///< area of a column [m2]; in two dimensions a width [m]
    Index column(int plane, int j) const noexcept {
        return Index{plane + ghosts} * pitch_ + (Dim == 3 ? j + ghosts : 0);
    }
    Index column(const CellNumber<Dim>& cell) const noexcept {
        return column(cell[0], Dim == 3 ? cell[1] : 0);
    }
    /// From a column to the next one along an axis.
    Index step(int axis) const noexcept { return axis == 0 ? pitch_ : 1; }
    Offset cell(int plane, int j, int level) const noexcept {
        return Dim == 3 ? grid_.layout().row_start(plane, level) + j
                        : grid_.layout().row_start(plane, 0) + level;
    }
    int first(Index column) const noexcept { return first_[at(column)]; }  ///< lowest open level
    /// From here up cells are whole; the number of levels where a wall goes on to the top.
    int whole_from(Index column) const noexcept { return whole_from_[at(column)]; }
    bool closed(Index column) const noexcept { return capacity_[at(column)] == 0; }
    Real capacity(Index column) const noexcept { return capacity_[at(column)]; }  ///< [m3]
    Real bed(Index column) const noexcept { return bed_[at(column)]; }            ///< lowest open point [m]
    Real open(Offset cell) const noexcept { return open_ ? (*open_)[cell] : 1; }
    Real volume(int level) const noexcept { return plan_ * grid_.size(vertical, level); }

    /// Of a cell's open volume the share below a height [m].
    Real share_below(Offset cell, int level, Real height) const noexcept {
        const Real t = std::clamp((height - grid_.face(vertical, level)) / grid_.size(vertical, level),
                                  Real(0), Real(1));
        if (t == 0 || t == 1 || open(cell) >= 1) return t;
        const Cut* const cut = find(cell);
        return cut ? lower_part(*cut, open(cell), t) : t;
    }

    /// Its inverse [m].
    Real height_in(Offset cell, int level, Real share) const noexcept {
        return grid_.face(vertical, level) + rise(cell, share) * grid_.size(vertical, level);
    }

    /// V(z) of a column of the box [m3].
    Real volume_below(int plane, int j, Real height) const noexcept {
        Real sum = 0;
        for (int k = first(column(plane, j)); k < levels_ && grid_.face(vertical, k) < height; ++k) {
            const Offset c = cell(plane, j, k);
            sum += share_below(c, k, height) * open(c) * volume(k);
        }
        return sum;
    }

    /// How high a volume stands [m3]; `near`: a level to look from. Beyond the capacity: the top of the box.
    Surface surface(int plane, int j, Real liquid, int near) const noexcept {
        const Index n = column(plane, j);
        const int whole = whole_from(n);
        if (!(liquid > 0)) return {std::min(first(n), levels_ - 1), 0, bed(n)};
        if (liquid >= capacity(n)) return {levels_ - 1, 1, grid_.high(vertical)};
        if (liquid >= below_whole_[at(n)] && whole < levels_) {
            const Real height = grid_.face(vertical, whole) + (liquid - below_whole_[at(n)]) / plan_;
            int k = std::clamp(near, whole, levels_ - 1);
            while (k > whole && grid_.face(vertical, k) >= height) --k;
            while (k < levels_ - 1 && grid_.face(vertical, k + 1) < height) ++k;
            return {
                k, std::clamp((height - grid_.face(vertical, k)) / grid_.size(vertical, k), Real(0), Real(1)),
                height};
        }
        int k = first(n);
        for (Real left = liquid; k < levels_; ++k) {
            const Offset c = cell(plane, j, k);
            const Real room = open(c) * volume(k);
            if (left <= room && room > 0) {
                const Real share = std::min(left / room, Real(1));
                return {k, share, height_in(c, k, share)};
            }
            left -= room;
        }
        return {levels_ - 1, 1, grid_.high(vertical)};
    }

private:
    void for_planes(Index first, Index last, auto&& body) const {
        for (int plane = static_cast<int>(first); plane < static_cast<int>(last); ++plane)
            for (int j = 0; j < across_; ++j) body(plane, j, column(plane, j));
    }

    struct Cut {
        Offset cell = 0;
        CellPlane<Dim> open;  ///< below it, in its sense, lies the water's side
    };
    static std::size_t at(auto i) noexcept { return static_cast<std::size_t>(i); }

    const Cut* find(Offset cell) const noexcept {
        const auto i = std::lower_bound(cuts_.begin(), cuts_.end(), cell,
                                        [](const Cut& c, Offset of) { return c.cell < of; });
        return i != cuts_.end() && i->cell == cell ? &*i : nullptr;
    }
    /// Of the open part the share in the lower `t` of the cell.
    static Real lower_part(const Cut& cut, Real open, Real t) noexcept {
        return std::min(t * slab_fraction<Dim>(cut.open, vertical, Real(-1), t) / open, Real(1));
    }
    /// Its inverse: regula falsi with halved ends (Illinois), which never leaves its interval.
    Real rise(Offset cell, Real share) const noexcept {
        if (open(cell) >= 1) return share;
        const Cut* const cut = find(cell);
        if (!cut) return share;
        const Real open = this->open(cell);
        Real low = 0, high = 1, miss_low = -share, miss_high = 1 - share;
        if (!(miss_high > 0)) return 1;
        for (int n = 0, kept = 0; n < 80 && high - low > 1e-15; ++n) {
            Real t = n % 8 == 7 ? 0.5 * (low + high)
                                : (low * miss_high - high * miss_low) / (miss_high - miss_low);
            if (!(t > low && t < high)) t = 0.5 * (low + high);
            const Real miss = lower_part(*cut, open, t) - share;
            if (miss == 0) return t;
            if (miss < 0) {
                low = t, miss_low = miss;
                if (kept < 0) miss_high *= 0.5;
                kept = -1;
            } else {
                high = t, miss_high = miss;
                if (kept > 0) miss_low *= 0.5;
                kept = 1;
            }
            if (std::abs(miss) < 1e-16) return t;
        }
        return 0.5 * (low + high);
    }

    void shape(int plane, int j, const FaceField<Dim>* apertures) {
        const auto n = at(column(plane, j));
        int k = 0;
        while (k < levels_ && !(open(cell(plane, j, k)) > volume_tolerance::open)) ++k;
        first_[n] = k;
        bed_[n] = k < levels_ ? grid_.face(vertical, k) : grid_.high(vertical);
        if (k == levels_) return;
        int whole = levels_;
        while (whole > k && open(cell(plane, j, whole - 1)) >= 1) --whole;
        whole_from_[n] = whole;
        Real widest = 0;
        for (int l = k; l < levels_; ++l) {
            const Offset c = cell(plane, j, l);
            const Real room = open(c) > volume_tolerance::open ? open(c) * volume(l) : 0;
            if (l < whole) below_whole_[n] += room;
            capacity_[n] += room;
            if (!apertures || !grid_.has(grid_.layout().number(c))) continue;
            // Level faces only widen upwards above a bed and beside what stands on it.
            const Real lower = l > k ? (*apertures)[vertical][c] : 0;
            const bool narrows = lower < widest - overhang || (l > k && !(lower > 0)) || room == 0;
            if (narrows) {
                const CellNumber<Dim> number = grid_.layout().number(c);
                fail({"GridFluid.wall at " + place_text<Dim>(grid_.centre(number)),
                      "no lid over open cells where the surface is a HeightSurface", "",
                      "take FreeSurface, or a wall that is a bed and what stands on it"},
                     "a wall above water");
            }
            widest = std::max(widest, lower);
        }
        if (const Cut* const cut = find(cell(plane, j, k))) {
            const auto& normal = cut->open.normal;  // out of the water
            if (normal[at(vertical)] < 0) {
                Real reach = 0;
                for (int a = 0; a < Dim; ++a)
                    if (a != vertical) reach += 0.5 * std::abs(normal[at(a)]);
                // normal . xi <= distance at the corner that lies lowest of the open part.
                const Real low = (cut->open.distance + reach) / normal[at(vertical)] + 0.5;
                bed_[n] += std::clamp(low, Real(0), Real(1)) * grid_.size(vertical, k);
            }
        }
    }

    Grid<Dim> grid_;
    int across_ = 1, pitch_ = 1, levels_ = 0;
    Real plan_ = 0;
    const Field<Real>* open_ = nullptr;
    std::vector<Cut> cuts_;  ///< in the order of memory
    std::vector<int> first_, whole_from_;
    std::vector<Real> below_whole_, capacity_, bed_;
};

}  // namespace abrade::detail
