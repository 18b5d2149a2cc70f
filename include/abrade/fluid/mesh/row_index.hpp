#pragma once
// Lists of what stands in single cells, looked through where rows are wet only.

#include <abrade/fluid/mesh/wet_rows.hpp>

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace abrade::detail {

/// Where in a list the items of each row begin: a list sorted by the cells that its items stand in.
template <int Dim>
class RowStarts {
public:
    RowStarts() = default;
    /// `cell_of(k)` is the cell, inside the box, of the item number k < `count`; it does not fall with k.
    RowStarts(const Layout<Dim>& layout, std::size_t count, auto&& cell_of)
        : rows_per_plane_(layout.rows_per_plane()),
          first_(static_cast<std::size_t>(layout.planes() * rows_per_plane_) + 1, 0) {
        for (std::size_t k = 0; k < count; ++k) {
            assert(k == 0 || cell_of(k - 1) <= cell_of(k));
            const CellNumber<Dim> cell = layout.number(cell_of(k));
            ++first_[row_of(cell[Layout<Dim>::outer], Dim == 3 ? cell[Dim - 1] : 0) + 1];
        }
        for (std::size_t r = 1; r < first_.size(); ++r) first_[r] += first_[r - 1];
    }

    /// Calls body(k) for the items in rows that are not dry (none given: for all), in parallel.
    void for_each(const WetRows<Dim>* rows, auto&& body) const {
        if (first_.back() == 0) return;
        if (!rows)
            return parallel_for(static_cast<Index>(first_.back()),
                                [&](Index k) { body(static_cast<std::size_t>(k)); });
        rows->for_each_row([&](int plane, int row, const RowRange&) {
            const std::size_t r = row_of(plane, row);
            for (std::uint32_t k = first_[r]; k < first_[r + 1]; ++k) body(std::size_t{k});
        });
    }

private:
    std::size_t row_of(int plane, int row) const noexcept {
        return static_cast<std::size_t>(plane * rows_per_plane_ + row);
    }

    int rows_per_plane_ = 0;
    std::vector<std::uint32_t> first_{0};
};

}  // namespace abrade::detail
