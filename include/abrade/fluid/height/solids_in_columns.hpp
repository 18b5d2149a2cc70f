#pragma once
// Solids that stand and move in columns of liquid.

#include <abrade/fluid/height/columns.hpp>
#include <abrade/fluid/mesh/solid_parts.hpp>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace abrade::detail {

/// Solids among the water of a HeightOfFluid. A column's volume is its water; its surface stands where that
/// has room beside the solid, which is taken to be spread evenly over each cell.
template <int Dim>
class SolidsInColumns {
    static constexpr int vertical = Grid<Dim>::vertical;

public:
    void set(std::span<const SolidPart> parts, const Grid<Dim>& grid, const HeightColumns<Dim>& columns) {
        const auto pitch = at(columns.pitch()), planes = columns.count() / pitch;
        found_.resize(parts.size()), by_plane_.resize(parts.size()), parts_.resize(parts.size());
        parallel_for(static_cast<Index>(parts.size()), [&](Index i) {
            const CellNumber<Dim> number = grid.layout().number(parts[at(i)].cell);
            found_[at(i)] = {columns.column(number), number[vertical], parts[at(i)].volume};
        });
        std::vector<std::size_t> start(planes + 1, 0);
        for (const Part& part : found_) ++start[at(part.column) / pitch + 1];
        std::partial_sum(start.begin(), start.end(), start.begin());
        std::vector<std::size_t> next = start;
        for (std::size_t i = 0; i < found_.size(); ++i)
            by_plane_[next[at(found_[i].column) / pitch]++] = static_cast<std::uint32_t>(i);
        of_column_.assign(columns.count(), {});
        parallel_blocks(
            static_cast<Index>(planes),
            [&](Index, Index first, Index last) {
                for (std::size_t plane = at(first); plane < at(last); ++plane)
                    merge(std::span(by_plane_).subspan(start[plane], start[plane + 1] - start[plane]),
                          std::span(of_column_).subspan(plane * pitch, pitch), start[plane]);
            },
            block_of_planes);
    }

    bool empty() const noexcept { return parts_.empty(); }
    bool has(Index column) const noexcept { return !of(column).empty(); }
    /// In a cell [m3].
    Real volume(Index column, int level) const noexcept {
        for (const Part& part : of(column))
            if (part.level == level) return part.volume;
        return 0;
    }
    Real volume(Index column) const noexcept {
        Real sum = 0;
        for (const Part& part : of(column)) sum += part.volume;
        return sum;
    }

    /// How high a volume of water stands in a column with solids [m3]. Where they cover the most of its area
    /// at the level `around` [m] of the columns beside it, it stands at that level, inside the solid: so the
    /// water below a solid that pierces the surface has the pressure of its depth, and what it has too much
    /// or too little is the pressure's to drive out. So it is with what would rise beside a solid that hangs
    /// over, where it finds little room: a litre would stand metres high there.
    typename HeightColumns<Dim>::Surface surface(const HeightColumns<Dim>& columns, int plane, int j,
                                                 Real liquid, Real around) const noexcept {
        constexpr Real covers = 0.75;
        const Index n = columns.column(plane, j);
        const auto open = [&](int k) { return columns.open(columns.cell(plane, j, k)) * columns.volume(k); };
        const auto room = [&](int k) { return std::max(open(k) - volume(n, k), Real(0)); };
        const auto share_below = [&](int k) {
            return columns.share_below(columns.cell(plane, j, k), k, around);
        };
        const auto covered = [&](int k) { return k < columns.levels() && volume(n, k) > covers * open(k); };
        const auto hangs_over = [&](int k) { return covered(k) && share_below(k) == 0; };
        int k = columns.first(n);
        Real left = liquid;
        for (; k < columns.levels() && share_below(k) == 1; ++k) left -= room(k);
        if (covered(k)) {
            const Real share = share_below(k);
            const Real height = columns.height_in(columns.cell(plane, j, k), k, share);
            return {k, share, height, left - share * room(k)};
        }
        left = liquid;
        for (k = columns.first(n); k < columns.levels(); left -= room(k++)) {
            const bool holds = left <= room(k) && room(k) > 0;
            if (!holds && !hangs_over(k + 1)) continue;
            const Real share = holds ? left / room(k) : 1;
            return {k, share, columns.height_in(columns.cell(plane, j, k), k, share),
                    holds ? 0 : left - room(k)};
        }
        return columns.surface(plane, j, columns.capacity(n), 0);
    }

    static void fields(auto&& field) {
        field.bytes("parts", &SolidsInColumns::parts_),
            field.bytes("of_column", &SolidsInColumns::of_column_);
    }

private:
    struct Part {
        Index column = 0;
        int level = 0;
        Real volume = 0;
    };
    struct Range {
        std::size_t first = 0, count = 0;  ///< in `parts_`
    };
    static std::size_t at(std::integral auto i) noexcept { return static_cast<std::size_t>(i); }

    /// Parts of a plane to its columns; what is in the same cell is one.
    void merge(std::span<const std::uint32_t> which, std::span<Range> columns, std::size_t first) {
        const auto range_of = [&](std::uint32_t i) -> Range& {
            return columns[at(found_[i].column) % columns.size()];
        };
        for (const std::uint32_t i : which) ++range_of(i).count;
        for (Range& range : columns)
            range.first = std::exchange(first, first + std::exchange(range.count, 0));
        for (const std::uint32_t i : which) {
            Range& range = range_of(i);
            const auto own = std::span(parts_).subspan(range.first, range.count);
            const auto same = std::ranges::find(own, found_[i].level, &Part::level);
            if (same != own.end())
                same->volume += found_[i].volume;
            else
                parts_[range.first + range.count++] = found_[i];
        }
    }
    std::span<const Part> of(Index column) const noexcept {
        if (parts_.empty()) return {};
        const Range& range = of_column_[at(column)];
        return std::span(parts_).subspan(range.first, range.count);
    }

    std::vector<Part> parts_;       ///< by column, with gaps
    std::vector<Range> of_column_;  ///< [column]
    // While they are set:
    std::vector<Part> found_;
    std::vector<std::uint32_t> by_plane_;  ///< in `found_`
};

}  // namespace abrade::detail
