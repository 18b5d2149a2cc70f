#pragma once
// The cells at the surface: all that the surface can cut before the end of a step.

#include <abrade/fluid/mesh/ghost_cells.hpp>
#include <abrade/fluid/mesh/wet_rows.hpp>
#include <abrade/fluid/vof/planes.hpp>

#include <cstring>
#include <span>

namespace abrade {

/// Cells that hold liquid and have air in them or at one of their faces, and all cells around them (diagonals
/// too, because a step sweeps along one axis after the other). The others are full, and stay so, or dry.
template <int Dim>
class SurfaceBand {
public:
    SurfaceBand() = default;
    /// `smallest_void`: air of less than this share of a cell [-] is none.
    SurfaceBand(const Layout<Dim>& layout, Real smallest_void)
        : layout_(layout), smallest_void_(smallest_void), air_(layout.total, 0), edge_(layout.total, 0),
          near_(layout.total, 0), band_(layout.total, 0), searched_(layout) {}

    /// Finds the band within `rows`, which hold everything wet and one cell around it at least.
    void find(const Field<Real>& fraction, const Field<std::uint8_t>& marks, const WetRows<Dim>& rows,
              const BoundaryConditions<Dim>& boundaries) {
        searched_.for_each_row([&](int plane, int r, const RowRange& range) {
            const Offset start = layout_.row_start(plane, r) + range.begin;
            std::memset(edge_.data() + start, 0, static_cast<std::size_t>(range.length()));
            std::memset(band_.data() + start, 0, static_cast<std::size_t>(range.length()));
        });
        for_each_row_and_beyond(searched_, [&](Offset start, const RowRange& range) {
            std::memset(near_.data() + start + range.begin, 0, static_cast<std::size_t>(range.length()));
        });
        searched_ = rows;
        rows.for_each_row([&](int plane, int r, const RowRange& range) {
            const Offset start = layout_.row_start(plane, r);
            const Real* f = fraction.data() + start;
            const std::uint8_t* mark = marks.data() + start;
            std::uint8_t* air = air_.data() + start;
            const Real full = 1 - smallest_void_;
#pragma omp simd
            for (int i = range.begin; i < range.end; ++i)
                air[i] = static_cast<std::uint8_t>((f[i] < full) & ((mark[i] & cell_mark::open) != 0));
        });
        fill_periodic(air_, layout_, boundaries);
        for_each_inflow_cell(boundaries, [&](Offset ghost, Offset) {
            // Cells beyond the band take what flows in for all liquid.
            air_[ghost] = static_cast<std::uint8_t>(fraction[ghost] < 1);
        });
        rows.for_each_row([&](int plane, int r, const RowRange& range) {
            const Offset start = layout_.row_start(plane, r);
            const Real* f = fraction.data() + start;
            const std::uint8_t* mark = marks.data() + start;
            const std::uint8_t* air = air_.data() + start;
            std::uint8_t* edge = edge_.data() + start;
            const PerAxis<Offset, Dim> s = layout_.stride;
#pragma omp simd
            for (int i = range.begin; i < range.end; ++i) {
                int near = air[i] | air[i - s[0]] | air[i + s[0]] | air[i - s[1]] | air[i + s[1]];
                if constexpr (Dim == 3) near |= air[i - s[2]] | air[i + s[2]];
                edge[i] = static_cast<std::uint8_t>(near & (f[i] > 0) & ((mark[i] & cell_mark::open) != 0));
            }
        });
        fill_periodic(edge_, layout_, boundaries);
        for_each_inflow_cell(boundaries, [&](Offset ghost, Offset inside) {
            edge_[ghost] = static_cast<std::uint8_t>((air_[ghost] | air_[inside]) & (fraction[ghost] > 0));
        });
        spread(marks, rows);
        list(rows);
    }

    bool holds(Offset cell) const noexcept { return band_[cell] != 0; }
    const std::uint8_t* data() const noexcept { return band_.data(); }
    /// Offsets of its cells, in order, and their numbers along the vertical axis.
    std::span<const Index> cells() const noexcept { return cell_; }
    std::span<const Index> levels() const noexcept { return level_; }
    /// Whether air is in the cell.
    bool has_air(Offset cell) const noexcept { return air_[cell] != 0; }

    static void fields(auto&& field) {
        field("air", &SurfaceBand::air_), field("edge", &SurfaceBand::edge_),
            field("near", &SurfaceBand::near_), field("band", &SurfaceBand::band_),
            field("searched", &SurfaceBand::searched_), field("cell", &SurfaceBand::cell_),
            field("level", &SurfaceBand::level_);
    }

private:
    void for_each_inflow_cell(const BoundaryConditions<Dim>& boundaries, auto&& body) const {
        for (int a = 0; a < Dim; ++a)
            for (const int end : {0, 1}) {
                if (boundaries[a][end] != Boundary::inflow) continue;
                CellNumber<Dim> cell{};
                const int n = layout_.cells[a];
                walk<0>(cell, a, end == 0 ? -1 : n, end == 0 ? 0 : n - 1, body);
            }
    }
    template <int Axis>
    void walk(CellNumber<Dim>& cell, int axis, int ghost, int inside, auto& body) const {
        if constexpr (Axis == Dim) {
            cell[axis] = ghost;
            const Offset beyond = layout_.at(cell);
            cell[axis] = inside;
            body(beyond, layout_.at(cell));
        } else if (Axis == axis) {
            walk<Axis + 1>(cell, axis, ghost, inside, body);
        } else {
            for (int i = 0; i < layout_.cells[Axis]; ++i) {
                cell[Axis] = i;
                walk<Axis + 1>(cell, axis, ghost, inside, body);
            }
        }
    }

    /// Eight cells at once, whose flags are the bytes of one number.
    static std::uint64_t eight(const std::uint8_t* flags) noexcept {
        std::uint64_t value;
        std::memcpy(&value, flags, sizeof value);
        return value;
    }
    /// Whole eights of a row.
    static RowRange eights(const RowRange& range) noexcept {
        return {range.begin / 8 * 8, (range.end + 7) / 8 * 8};
    }

    /// Calls body(offset of the row's cell 0, whole eights) for each row, and for rows of ghosts beside them.
    void for_each_row_and_beyond(const WetRows<Dim>& rows, auto&& body) const {
        const int planes = layout_.planes(), per_plane = layout_.rows_per_plane();
        rows.for_each_row([&](int plane, int r, const RowRange& range) {
            for (int p = plane == 0 ? -1 : plane; p <= (plane == planes - 1 ? planes : plane); ++p)
                for (int q = Dim == 3 && r == 0 ? -1 : r;
                     q <= (Dim == 3 && r == per_plane - 1 ? per_plane : r); ++q)
                    body(layout_.row_start(p, q), eights(range));
        });
    }

    /// To all cells around: first along rows, then from row to row.
    void spread(const Field<std::uint8_t>& marks, const WetRows<Dim>& rows) {
        constexpr int around = Dim == 3 ? 9 : 3;
        std::array<Offset, around> step;
        for (int k = 0; k < around; ++k)
            step[static_cast<std::size_t>(k)] = (k % 3 - 1) * layout_.stride[Layout<Dim>::outer] +
                                                (Dim == 3 ? (k / 3 - 1) * layout_.stride[Dim - 1] : 0);
        for_each_row_and_beyond(rows, [&](Offset start, const RowRange& range) {
            const std::uint8_t* edge = edge_.data() + start;
            std::uint8_t* near = near_.data() + start;
            for (int i = range.begin; i < range.end; i += 8) {
                const std::uint64_t any = eight(edge + i - 1) | eight(edge + i) | eight(edge + i + 1);
                std::memcpy(near + i, &any, sizeof any);
            }
        });
        rows.for_each_row([&](int plane, int r, const RowRange& range) {
            const Offset start = layout_.row_start(plane, r);
            const std::uint8_t* near = near_.data() + start;
            const std::uint8_t* mark = marks.data() + start;
            std::uint8_t* band = band_.data() + start;
            const auto steps = step;
            const RowRange all = eights(range);
            for (int i = all.begin; i < all.end; i += 8) {
                std::uint64_t any = 0;
                for (std::size_t k = 0; k < around; ++k) any |= eight(near + steps[k] + i);
                static_assert(cell_mark::open == 2 && cell_mark::inside == 4);
                const std::uint64_t here = eight(mark + i);
                any &= here >> 1 & here >> 2 & 0x0101010101010101u;
                std::memcpy(band + i, &any, sizeof any);
            }
        });
    }

    void list(const WetRows<Dim>& rows) {
        std::vector<Index> first(static_cast<std::size_t>(layout_.planes()) + 1, 0);
        rows.for_each_row([&](int plane, int r, const RowRange& range) {
            const std::uint8_t* band = band_.data() + layout_.row_start(plane, r);
            Index count = 0;
            for (int i = range.begin; i < range.end; ++i) count += band[i];
            first[static_cast<std::size_t>(plane) + 1] += count;
        });
        for (std::size_t p = 1; p < first.size(); ++p) first[p] += first[p - 1];
        cell_.resize(static_cast<std::size_t>(first.back()));
        level_.resize(cell_.size());
        rows.for_each_row([&](int plane, int r, const RowRange& range) {
            const Offset start = layout_.row_start(plane, r);
            const std::uint8_t* band = band_.data() + start;
            auto next = static_cast<std::size_t>(first[static_cast<std::size_t>(plane)]);
            for (int i = range.begin; i < range.end; ++i) {
                // Most of a row is not in the band: eight cells at a glance.
                std::uint64_t eight = 0;
                if (i + 8 <= range.end && (std::memcpy(&eight, band + i, 8), eight == 0)) {
                    i += 7;
                    continue;
                }
                if (band[i] == 0) continue;
                cell_[next] = static_cast<Index>(start + i);
                level_[next++] = Dim == 3 ? r : i;
            }
            first[static_cast<std::size_t>(plane)] = static_cast<Index>(next);
        });
    }

    Layout<Dim> layout_{};
    Real smallest_void_ = 0;
    Field<std::uint8_t> air_, edge_, near_, band_;  ///< near: to an edge in the same row
    WetRows<Dim> searched_;
    std::vector<Index> cell_, level_;
};

}  // namespace abrade
