#pragma once
// Which cells of each row are worth a visit.

#include <abrade/core/parallel.hpp>
#include <abrade/fluid/grid.hpp>

#include <algorithm>

namespace abrade {

/// Cells [begin, end) of a row, numbers along the inner axis.
struct RowRange {
    int begin = 0, end = 0;
    constexpr bool empty() const noexcept { return begin >= end; }
};

/// The shortest range that holds both.
constexpr RowRange hull(RowRange a, RowRange b) noexcept {
    if (a.empty()) return b;
    if (b.empty()) return a;
    return {std::min(a.begin, b.begin), std::max(a.end, b.end)};
}

/// One range per row of a grid. The rows that follow the last ones are there and empty.
class WetRows {
public:
    WetRows() = default;
    template <int Dim>
    explicit WetRows(const Layout<Dim>& layout)
        : planes_(layout.planes()), rows_(layout.rows_per_plane()),
          ranges_(static_cast<std::size_t>((planes_ + 1) * (rows_ + 1))) {}

    int planes() const noexcept { return planes_; }
    int rows() const noexcept { return rows_; }
    RowRange range(int plane, int row) const noexcept { return ranges_[index(plane, row)]; }
    RowRange& range(int plane, int row) noexcept { return ranges_[index(plane, row)]; }

private:
    std::size_t index(int plane, int row) const noexcept {
        return static_cast<std::size_t>(plane * (rows_ + 1) + row);
    }
    int planes_ = 0, rows_ = 0;
    std::vector<RowRange> ranges_;
};

}  // namespace abrade
