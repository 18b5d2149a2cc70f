#pragma once
// Which part of each row of a grid is wet: what keeps dry cells from costing anything.

#include <abrade/core/fields.hpp>
#include <abrade/fluid/mesh/plane_runs.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <utility>
#include <vector>

namespace abrade {

/// Part of a row: cells begin to end - 1.
struct RowRange {
    int begin = 0, end = 0;

    bool empty() const noexcept { return begin >= end; }
    int length() const noexcept { return std::max(0, end - begin); }
    /// The smallest range that holds both.
    friend RowRange hull(const RowRange& a, const RowRange& b) noexcept {
        if (a.empty()) return b;
        if (b.empty()) return a;
        return {std::min(a.begin, b.begin), std::max(a.end, b.end)};
    }
    bool operator==(const RowRange&) const = default;
};

/// For each row of the box (without ghosts) the hull of its wet cells. Rows are numbered plane by plane.
template <int Dim>
class WetRows {
public:
    WetRows() = default;
    explicit WetRows(const Layout<Dim>& layout)
        : layout_(layout), rows_(static_cast<std::size_t>(layout.planes()) *
                                 static_cast<std::size_t>(layout.rows_per_plane())) {
        share_out();
    }

    /// All cells of the box.
    static WetRows whole(const Layout<Dim>& layout) {
        WetRows rows(layout);
        rows.rows_.assign(rows.rows_.size(), {0, layout.row_length()});
        rows.share_out();
        return rows;
    }

    const Layout<Dim>& layout() const noexcept { return layout_; }
    const RowRange& row(int plane, int row) const noexcept { return rows_[index(plane, row)]; }
    RowRange& row(int plane, int row) noexcept { return rows_[index(plane, row)]; }
    /// Empty for rows above the last one or plane.
    RowRange range(int plane, int r) const noexcept {
        return plane < layout_.planes() && r < layout_.rows_per_plane() ? row(plane, r) : RowRange{};
    }

    /// Sets each range to the hull of cells above `dry`, looking through whole rows.
    void find(const Field<Real>& fraction, Real dry = 0) {
        for_each_plane([&](int plane) {
            for (int r = 0; r < layout_.rows_per_plane(); ++r)
                row(plane, r) = wet_part(fraction, plane, r, {0, layout_.row_length()}, dry);
        });
        share_out();
    }

    /// The same, where nothing outside of `within` can be wet: only the ends of ranges are looked at.
    void find_within(const WetRows& within, const Field<Real>& fraction, Real dry = 0) {
        for_each_plane([&](int plane) {
            for (int r = 0; r < layout_.rows_per_plane(); ++r)
                row(plane, r) = wet_part(fraction, plane, r, within.row(plane, r), dry);
        });
        share_out();
    }

    /// Grown by `cells` along every axis, diagonals included; across those ends where the box is periodic.
    WetRows dilated(int cells, const PerAxis<bool, Dim>& periodic = {}) const {
        const int n = layout_.row_length(), rows = layout_.rows_per_plane(), planes = layout_.planes();
        // A dry row begins behind all others and ends before them, so that hulls are minima and maxima.
        constexpr int far = 1 << 30;
        std::vector<int> begin(rows_.size()), end(rows_.size());
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            const bool dry = rows_[i].empty();
            begin[i] = dry ? far : rows_[i].begin - cells;
            end[i] = dry ? -far : rows_[i].end + cells;
            // What crosses one end comes in at the other: the hull is then the whole row.
            if (periodic[1] && !dry && (begin[i] < 0 || end[i] > n)) begin[i] = 0, end[i] = n;
        }
        // From one row to the next of a plane, then from one plane to the next, all of its rows at once.
        if constexpr (Dim == 3)
            for (int p = 0; p < planes; ++p) spread(begin, end, p * rows, rows, 1, cells, periodic[2]);
        spread(begin, end, 0, planes, rows, cells, periodic[0]);
        WetRows grown(layout_);
        for (std::size_t i = 0; i < rows_.size(); ++i)
            if (begin[i] < end[i]) grown.rows_[i] = {std::max(0, begin[i]), std::min(n, end[i])};
        grown.share_out();
        return grown;
    }

    /// The ranges that hold those of both.
    void include(const WetRows& other) {
        for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i] = hull(rows_[i], other.rows_[i]);
    }

    /// Copies what lies in the ranges.
    template <class Number>
    void copy(const Field<Number>& from, Field<Number>& to) const {
        for_each_row([&](int plane, int row, const RowRange& r) {
            const Offset start = layout_.row_start(plane, row) + r.begin;
            std::copy_n(from.data() + start, r.length(), to.data() + start);
        });
    }
    template <class Number>
    void copy(const FaceField<Dim, Number>& from, FaceField<Dim, Number>& to) const {
        for (int a = 0; a < Dim; ++a) copy(from[a], to[a]);
    }

    /// Cells in all ranges.
    std::int64_t cells() const noexcept {
        std::int64_t count = 0;
        for (const RowRange& r : rows_) count += r.length();
        return count;
    }

    /// Calls body(plane, row, range) for each row that is not dry; planes in parallel.
    void for_each_row(auto&& body) const {
        for_each_plane([&](int plane) {
            for (int r = 0; r < layout_.rows_per_plane(); ++r)
                if (const RowRange& range = row(plane, r); !range.empty()) body(plane, r, range);
        });
    }

    /// Calls body(plane) for each plane, in parallel.
    void for_each_plane(auto&& body) const { detail::parallel_planes(runs_, body); }
    /// Gives each thread a run of planes with about as many cells in their ranges. Until then, or when ranges
    /// have changed, some have more: nothing else depends on it.
    void share_out() {
        runs_ = detail::plane_runs(layout_, 2, [&](int plane, int r) { return row(plane, r); });
    }
    const detail::PlaneRuns& runs() const noexcept { return runs_; }

    static void fields(auto&& field) { field.bytes("rows", &WetRows::rows_); }
    void restored() { share_out(); }

private:
    std::size_t index(int plane, int row) const noexcept {
        return static_cast<std::size_t>(plane) * static_cast<std::size_t>(layout_.rows_per_plane()) +
               static_cast<std::size_t>(row);
    }
    RowRange wet_part(const Field<Real>& fraction, int plane, int r, RowRange range,
                      Real dry) const noexcept {
        const Real* f = fraction.data() + layout_.row_start(plane, r);
        while (range.begin < range.end && !(f[range.begin] > dry)) ++range.begin;
        while (range.begin < range.end && !(f[range.end - 1] > dry)) --range.end;
        return range.begin < range.end ? range : RowRange{};
    }
    /// `count` groups of `length` ranges each take in those up to `cells` groups away.
    static void spread(std::vector<int>& begin, std::vector<int>& end, int first, int count, int length,
                       int cells, bool wraps) {
        const auto from = begin.begin() + first, to = end.begin() + first;
        const std::vector<int> begin_before(from, from + count * length), end_before(to, to + count * length);
        for (int g = 0; g < count; ++g)
            for (int k = g - cells; k <= g + cells; ++k) {
                if (k == g || (!wraps && (k < 0 || k >= count))) continue;
                const int other = (k < 0 || k >= count ? (k % count + count) % count : k) * length;
                int* b = &*from + g * length;
                int* e = &*to + g * length;
                for (int i = 0; i < length; ++i) {
                    b[i] = std::min(b[i], begin_before[static_cast<std::size_t>(other + i)]);
                    e[i] = std::max(e[i], end_before[static_cast<std::size_t>(other + i)]);
                }
            }
    }

    Layout<Dim> layout_{};
    std::vector<RowRange> rows_;
    detail::PlaneRuns runs_{0};  ///< for threads
};

namespace detail {

/// Whether one byte of a pack is not 0.
template <int lanes>
bool any_byte(const std::uint8_t* pack) noexcept {
    std::uint64_t eights[lanes / 8], all = 0;
    std::memcpy(eights, pack, sizeof eights);
    for (const std::uint64_t eight : eights) all |= eight;
    return all != 0;
}

}  // namespace detail

/// Calls body(i) for those cells i of a row's range whose mark is 0 beside one that is odd, along an axis.
/// Whole packs are looked at, bytes at once.
template <int Dim>
void for_edge_cells(const Field<std::uint8_t>& marks, const Layout<Dim>& layout, Offset row_start,
                    const RowRange& r, auto&& body) {
    constexpr int lanes = Layout<Dim>::lanes;
    const Offset s0 = layout.stride[0], s1 = layout.stride[1], s2 = layout.stride[Dim - 1];
    for (int first = Layout<Dim>::pack(r.begin); first < r.end; first += lanes) {
        const std::uint8_t* const __restrict here = marks.data() + row_start + first;
        alignas(lanes) std::uint8_t edge[lanes];
#pragma omp simd
        for (int k = 0; k < lanes; ++k) {
            const std::uint8_t near =
                here[k - s0] | here[k + s0] | here[k - s1] | here[k + s1] | here[k - s2] | here[k + s2];
            edge[k] = here[k] == 0 ? near & 1 : 0;
        }
        if (!detail::any_byte<lanes>(edge)) continue;
        for (int i = std::max(first, r.begin); i < std::min(first + lanes, r.end); ++i)
            if (edge[i - first] != 0) body(i);
    }
}

}  // namespace abrade
