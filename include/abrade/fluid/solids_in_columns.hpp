#pragma once
// Solids that stand and move in columns of liquid.

#include <abrade/fluid/height_columns.hpp>
#include <abrade/fluid/solids_in_flow.hpp>

#include <algorithm>
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
        std::vector<Part> found(parts.size());
        parallel_for(static_cast<Index>(parts.size()), [&](Index i) {
            const SolidPart& part = parts[static_cast<std::size_t>(i)];
            const CellNumber<Dim> number = grid.layout().number(part.cell);
            found[static_cast<std::size_t>(i)] = {columns.column(number), number[vertical], part.volume};
        });
        Index last = -1;
        for (const Part& part : found) last = std::max(last, part.column);
        start_.assign(static_cast<std::size_t>(last + 2), 0);
        for (const Part& part : found) ++start_[static_cast<std::size_t>(part.column + 1)];
        std::partial_sum(start_.begin(), start_.end(), start_.begin());
        parts_.resize(found.size());
        std::vector<std::size_t> end(start_.begin(), start_.end());
        for (const Part& part : found) {  // what is in the same cell is one part
            const auto column = static_cast<std::size_t>(part.column);
            std::size_t at = start_[column];
            while (at < end[column] && parts_[at].level != part.level) ++at;
            if (at < end[column])
                parts_[at].volume += part.volume;
            else
                parts_[end[column]++] = part;
        }
        std::size_t kept = 0;
        for (std::size_t column = 0; column + 1 < start_.size(); ++column) {
            const std::size_t first = std::exchange(start_[column], kept);
            for (std::size_t at = first; at < end[column]; ++at) parts_[kept++] = parts_[at];
        }
        start_.back() = kept;
        parts_.resize(kept);
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
        field.bytes("parts", &SolidsInColumns::parts_), field.bytes("start", &SolidsInColumns::start_);
    }

private:
    struct Part {
        Index column = 0;
        int level = 0;
        Real volume = 0;
    };
    std::span<const Part> of(Index column) const noexcept {
        const auto at = static_cast<std::size_t>(column);
        if (column < 0 || at + 1 >= start_.size()) return {};
        return std::span(parts_).subspan(start_[at], start_[at + 1] - start_[at]);
    }

    std::vector<Part> parts_;         ///< by column
    std::vector<std::size_t> start_;  ///< [column] in `parts_`
};

}  // namespace abrade::detail
