#pragma once
// What a wall leaves open of the cells and faces of one block of a grid.

#include <abrade/fluid/embedded_boundary/cut_cell.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace abrade::detail {

/// Cells from `low` up to, not including, `high`.
template <int Dim>
struct CellRange {
    CellNumber<Dim> low, high;
};

/// Axes from the one across planes to the one along rows.
template <int Dim>
constexpr int axis_in_memory(int n) noexcept {
    const int middle = 2;
    return n == 0 ? Layout<Dim>::outer : n == Dim - 1 ? Layout<Dim>::inner : middle;
}

/// Calls body(cell) for each, in the order of memory.
template <int Dim, int Level = 0>
void each_cell(const CellRange<Dim>& range, auto&& body, CellNumber<Dim> cell = {}) {
    if constexpr (Level == Dim) {
        body(std::as_const(cell));
    } else {
        constexpr int a = axis_in_memory<Dim>(Level);
        for (cell[a] = range.low[a]; cell[a] < range.high[a]; ++cell[a])
            each_cell<Dim, Level + 1>(range, body, cell);
    }
}

/// A block of up to 4 cells along each axis. Shares depend on a cell or face alone, never on its block, so a
/// face between two blocks is the same for both.
template <int Dim>
class CutBlock {
public:
    static constexpr int side = 4;

    /// Looks at the wall. Where it is far from all cells nothing but `content` and `centre` is set.
    template <class Shape>
    CutBlock(const Grid<Dim>& grid, const CellRange<Dim>& cells, Probe<Dim, Shape>& wall,
             const Subdivision& rule, Real cell_diagonal)
        : grid_(grid), cells_(cells),
          far_(rule.bounded_slope ? cell_diagonal : std::numeric_limits<Real>::infinity()) {
        if (rule.bounded_slope) {
            const Point<Dim> low = corner(cells.low), high = corner(cells.high);
            centre_.where = 0.5 * (low + high);
            const Real distance = centre_.distance = wall(centre_.where);
            content_ = distance > 0 ? Content::open : Content::closed;
            // A little further: a neighbouring cell that is closed for being small closes faces of this
            // block.
            if (std::abs(distance) > 0.5 * (high - low).norm() + 0.1 * cell_diagonal) return;
        }
        content_ = Content::cut;
        each_cell<Dim>(with_upper_end(-1), [&](const Cell& c) { distance_[at(c)] = wall(corner(c)); });
        for (int a = 0; a < Dim; ++a)
            each_cell<Dim>(with_upper_end(a), [&](const Cell& c) { cut_face(a, c, wall, rule); });
        each_cell<Dim>(cells_, [&](const Cell& c) { cut_cell(c, wall, rule); });
    }

    /// Closed or open as a whole, or to be looked at cell by cell.
    Content content() const noexcept { return content_; }
    /// Of the block, where slopes are bounded.
    const Answer<Dim>& centre() const noexcept { return centre_; }
    /// Whether distances at corners of one cell change by more than the way.
    bool steep() const noexcept { return steep_; }
    Real volume(const CellNumber<Dim>& cell) const noexcept { return volume_[at(cell)]; }
    Real area(int axis, const CellNumber<Dim>& cell) const noexcept { return face(axis, cell).share; }
    bool is_cut(const CellNumber<Dim>& cell) const noexcept { return is_cut_[at(cell)]; }
    /// On the wall, in a cell that is cut [m].
    const Point<Dim>& point(const CellNumber<Dim>& cell) const noexcept { return point_[at(cell)]; }

private:
    using Cell = CellNumber<Dim>;
    struct Face {
        Real share;
        bool halved;
    };
    static constexpr std::size_t corners_along = side + 1;
    static constexpr std::size_t corners = corners_along * corners_along * (Dim == 3 ? corners_along : 1);

    std::size_t at(const Cell& cell) const noexcept {
        std::size_t place = 0;
        for (int a = 0; a < Dim; ++a)
            place = place * corners_along + static_cast<std::size_t>(cell[a] - cells_.low[a]);
        return place;
    }
    const Face& face(int axis, const Cell& cell) const noexcept { return face_[axis][at(cell)]; }
    /// With the upper end along `axis`, or along all of them (-1).
    CellRange<Dim> with_upper_end(int axis) const noexcept {
        CellRange<Dim> range = cells_;
        for (int a = 0; a < Dim; ++a)
            if (axis < 0 || a == axis) ++range.high[a];
        return range;
    }
    Point<Dim> corner(const Cell& cell) const noexcept {
        Point<Dim> x;
        for (int a = 0; a < Dim; ++a) x[a] = grid_.face(a, cell[a]);
        return x;
    }
    /// Along the given axes, from a cell's lower corner.
    template <int Size>
    Piece<Dim, Size> piece(const Cell& cell, const std::array<int, Size>& axes) const noexcept {
        Piece<Dim, Size> box{corner(cell), Point<Dim>::Zero(), axes};
        for (const int a : axes) box.size[a] = grid_.size(a, cell[a]);
        return box;
    }
    template <int Size>
    Corners<Size> distances(const Cell& cell, const std::array<int, Size>& axes) const noexcept {
        Corners<Size> d;
        for (std::size_t k = 0; k < d.size(); ++k) {
            Cell c = cell;
            for (std::size_t s = 0; s < Size; ++s) c[axes[s]] += static_cast<int>((k >> s) & 1);
            d[k] = distance_[at(c)];
        }
        return d;
    }

    void cut_face(int axis, const Cell& cell, auto& wall, const Subdivision& rule) noexcept {
        Face& f = face_[axis][at(cell)];
        if (const Real here = distance_[at(cell)]; std::abs(here) > far_) {
            f = {here > 0 ? 1.0 : 0.0, false};
            return;
        }
        std::array<int, Dim - 1> axes{};
        for (int a = 0, s = 0; a < Dim; ++a)
            if (a != axis) axes[static_cast<std::size_t>(s++)] = a;
        const Corners<Dim - 1> d = distances<Dim - 1>(cell, axes);
        const auto box = piece<Dim - 1>(cell, axes);
        f.halved = is_rough(box, d, wall, rule);
        f.share = f.halved ? halved_nearby(box, wall, rule).share : open_share<Dim - 1>(d);
    }

    void cut_cell(const Cell& cell, auto& wall, const Subdivision& rule) noexcept {
        const std::size_t here = at(cell);
        if (std::abs(distance_[here]) > far_) {
            volume_[here] = distance_[here] > 0 ? 1 : 0;
            is_cut_[here] = false;
            return;
        }
        std::array<int, Dim> axes{};
        for (int a = 0; a < Dim; ++a) axes[static_cast<std::size_t>(a)] = a;
        const Corners<Dim> d = distances<Dim>(cell, axes);
        const auto box = piece<Dim>(cell, axes);
        if (rule.bounded_slope) steep_ = steep_ || is_steep_within(box, d);
        FaceShares<Dim> faces;
        bool rough = false;
        for (std::size_t a = 0; a < Dim; ++a) {
            Cell next = cell;
            ++next[a];
            const Face &lower = face_[a][here], &upper = face_[a][at(next)];
            faces[a] = {lower.share, upper.share};
            rough = rough || lower.halved || upper.halved;
        }
        const auto in_box = [&](const Point<Dim>& unit) {
            return Point<Dim>(box.low + unit.cwiseProduct(box.size));
        };
        if (rough || is_rough(box, d, wall, rule)) {
            const Opening<Dim> open = halved_nearby(box, wall, rule);
            volume_[here] = open.share;
            point_[here] = in_box(open.point);
            is_cut_[here] = true;
            return;
        }
        const Content inside = detail::content(d);
        is_cut_[here] = inside == Content::cut;
        if (is_cut_[here]) {
            const Point<Dim> crossing = mean_crossing<Dim>(d);
            volume_[here] = share_within<Dim>(faces, crossing);
            point_[here] = in_box(crossing);
        } else {
            volume_[here] = inside == Content::open ? 1 : 0;
        }
    }

    /// Along its edges and all its diagonals.
    static bool is_steep_within(const Piece<Dim, Dim>& box, const Corners<Dim>& d) noexcept {
        Corners<Dim> way{};  // from the lowest corner, squared; from corner j to corner i that to i ^ j [m2]
        for (std::size_t i = 0; i < d.size(); ++i)
            for (int a = 0; a < Dim; ++a) way[i] += static_cast<Real>((i >> a) & 1) * square(box.size[a]);
        bool steep = false;
        for (std::size_t i = 0; i < d.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) steep |= is_steep(d[i] - d[j], way[i ^ j]);
        return steep;
    }

    const Grid<Dim>& grid_;
    CellRange<Dim> cells_;
    Real far_;  ///< from a corner at that distance a wall cannot reach into the cell [m]
    Content content_ = Content::cut;
    Answer<Dim> centre_;
    bool steep_ = false;
    // Where nothing is cut they are never read, so they are not cleared.
    std::array<Real, corners> distance_;  ///< at lower corners [m]
    PerAxis<std::array<Face, corners>, Dim> face_;
    std::array<Real, corners> volume_;
    std::array<bool, corners> is_cut_;
    std::array<Point<Dim>, corners> point_;
};

}  // namespace abrade::detail
