#pragma once
// Solid walls of any shape on a grid: how much of each cell and of each face they leave open.

#include <abrade/core/parallel.hpp>
#include <abrade/fluid/embedded_boundary/cut_slab.hpp>
#include <abrade/fluid/embedded_boundary/shapes.hpp>
#include <abrade/fluid/mesh/ghost_cells.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace abrade {

/// Open shares of the cells and faces of a grid.
///
/// A face is open where linear interpolation of the distance between its corners is above 0; a cell holds
/// what the divergence theorem says of its faces and a point of the wall. Both are exact for planes and of
/// second order for curved walls. Where the distance at the centre of a cell or face tells that its corners
/// miss something (an edge between two spheres), it is halved, `levels` times at most.
///
/// Of each cell that a wall passes through, the wall's area vector is what closes its surface,
///   area n_a = A(upper face a) - A(lower face a),
/// so a uniform pressure pushes no cell, to round-off; walls that face each other in one cell cancel. Its
/// point is where the divergence theorem gives the cell's volume.
///
/// Cells of which no more than `closed_below` is open, and faces likewise, are closed: they would be slow to
/// drain and rule the time step. The faces of a closed cell are closed; a cell without an open face is.
/// Ghost cells are treated as all others.
template <int Dim>
class EmbeddedBoundary {
public:
    struct Params {
        Real closed_below = 1e-3;  ///< open share up to which a cell or face is closed [-]
        int levels = 1;            ///< how often cells and faces are halved where the wall is not flat
        Real flatness = 0.02;      ///< not flat: the distance at the centre is off by that share of the size
        bool may_close_all = false;  ///< that no cell is open is no error
        /// |w(x) - w(y)| <= |x - y|: cells far from the wall need no look inside. Where answers show that it
        /// does not hold, all are looked at, and `params()` says false. A steep function that levels off near
        /// the wall may hide what is smaller than four cells: for such, say false.
        bool bounded_slope = true;
        std::string called = "EmbeddedBoundary: distance";  ///< in messages about its answers

        void validate() const {
            require(closed_below >= 0 && closed_below <= 0.1,
                    {"EmbeddedBoundary.closed_below", "from 0 to 0.1", "",
                     "1e-3 costs no accuracy: few cells are that small"},
                    closed_below);
            require(levels >= 0 && levels <= 6,
                    {"EmbeddedBoundary.levels", "from 0 to 6", "",
                     "each level looks at 2^Dim times as many parts"},
                    levels);
            require_positive(flatness, "EmbeddedBoundary.flatness");
        }
    };

    /// No walls: all is open.
    explicit EmbeddedBoundary(const Grid<Dim>& grid)
        : grid_(grid), shares_{Field<Real>(grid.layout().total), face_field<Dim>(grid.layout()), {}} {
        const auto open = [&](const CellNumber<Dim>&, Offset at) {
            shares_.volume[at] = 1;
            for (auto& axis : shares_.area) axis[at] = 1;
        };
        grid_.for_each(open, ghosts);
        open_cells_ = grid_.layout().cell_count();
    }

    /// Throws InputError where the distance is NaN, and when no cell is open; and what the shape throws.
    template <WallShape<Dim> Shape>
    EmbeddedBoundary(const Grid<Dim>& grid, const Shape& wall) : EmbeddedBoundary(grid, wall, Params()) {}
    template <WallShape<Dim> Shape>
    EmbeddedBoundary(const Grid<Dim>& grid, const Shape& wall, Params params)
        : params_((params.validate(), params)),
          grid_(grid), shares_{Field<Real>(grid.layout().total), face_field<Dim>(grid.layout()),
                               Field<std::uint8_t>(grid.layout().total, 1)} {
        for (int a = 0; a < Dim; ++a) {
            Real largest = 0;
            for (int i = -ghosts; i < grid_.cells(a) + ghosts; ++i)
                largest = std::max(largest, grid_.size(a, i));
            cell_diagonal_ += square(largest);
        }
        cell_diagonal_ = std::sqrt(cell_diagonal_);
        slabs_.resize(static_cast<std::size_t>(last_block()[outer]) + 1);
        renew(wall, {}, last_block());
    }

    /// After the solid has changed between the corners `low` and `high` of a box [m], nowhere else: renews
    /// the cells there, to the same bits as built anew, unless only that finds the function steeper than a
    /// distance. Throws as the constructor does; then build anew.
    template <WallShape<Dim> Shape>
    void update(const Shape& wall, const Point<Dim>& low, const Point<Dim>& high) {
        require(!slabs_.empty(),
                {"EmbeddedBoundary.update", "called on walls", "", "give the constructor a shape"}, 0);
        CellNumber<Dim> from, to;
        for (int a = 0; a < Dim; ++a) {
            require(low[a] <= high[a],
                    {std::string("EmbeddedBoundary.update: high.") + Grid<Dim>::axis_name(a),
                     "at least low (" + to_text(low[a]) + " m)", "m", "give lower corner, then upper"},
                    high[a]);
            // Distances change a little further off, so cuts of cells about the solid do as well; and one
            // more layer of cells, which may have lost or won an open face.
            const Real margin = 2 * cell_diagonal_;
            const int first = cell_at(a, low[a] - margin) - 1, last = cell_at(a, high[a] + margin) + 1;
            if (last < -ghosts || first >= grid_.cells(a) + ghosts) return;
            from[at(a)] = (std::max(first, -ghosts) + ghosts) / side;
            to[at(a)] = (std::min(last, grid_.cells(a) + ghosts - 1) + ghosts) / side;
        }
        renew(wall, from, to);
    }

    /// Beyond periodic sides stands what stands inside. Until the next `update`. Throws InputError where the
    /// wall is not the same at both ends.
    template <WallShape<Dim> Shape>
    void repeat(const BoundaryConditions<Dim>& boundaries, const Shape& wall) {
        for (int a = 0; a < Dim; ++a) {
            if (!boundaries.periodic(a)) continue;
            const Offset around = grid_.cells(a) * grid_.layout().stride[a];
            grid_.for_each_beside(a, false, [&](const Cell& cell, Offset face) {
                // Shares, not distances: what stands beyond no face of an end need not be given twice.
                constexpr Real round_off = 0.05;
                const Real* const open = shares_.area[a].data() + face;
                if (std::abs(open[0] - open[around]) < round_off) return;
                const Point<Dim> low = grid_.face_centre(a, cell);
                Point<Dim> high = low;
                high[a] = grid_.high(a);
                fail({params_.called + " at " + place_text<Dim>(low),
                      "as far away as at the other, periodic end (" + short_text(wall(high)) + " m)", "m",
                      "give a wall that repeats itself, tilt gravity instead of a bed, or open the ends"},
                     short_text(wall(low)));
            });
        }
        fill_periodic(shares_.volume, grid_.layout(), boundaries);
        fill_periodic(shares_.area, grid_.layout(), boundaries);
    }

    const Params& params() const noexcept { return params_; }
    const Grid<Dim>& grid() const noexcept { return grid_; }
    /// Of each cell, ghosts included [-].
    const Field<Real>& open_fraction() const noexcept { return shares_.volume; }
    /// Of each lower face [-].
    const FaceField<Dim>& aperture() const noexcept { return shares_.area; }
    /// Inside the box, in the order of memory.
    std::span<const CutCell<Dim>> cut_cells() const noexcept { return cut_cells_; }
    /// Those of `count` cells from `first` on, a row for instance.
    std::span<const CutCell<Dim>> cut_cells(Offset first, Offset count) const noexcept {
        const auto before = [](const CutCell<Dim>& c, Offset cell) { return c.cell < cell; };
        const auto begin = std::lower_bound(cut_cells_.begin(), cut_cells_.end(), first, before);
        return {begin, std::lower_bound(begin, cut_cells_.end(), first + count, before)};
    }
    /// Cells of the box that are not closed.
    Index open_cells() const noexcept { return open_cells_; }
    /// What water can fill [m3].
    Real total_volume() const {
        const Layout<Dim>& layout = grid_.layout();
        const Index rows = layout.rows_per_plane();
        constexpr std::size_t inner = Layout<Dim>::inner;
        return parallel_sum<Real>(layout.planes() * rows, [&](Index n) {
            CellNumber<Dim> cell{};
            cell[outer] = n / rows;
            if constexpr (Dim == 3) cell[2] = n % rows;
            Real sum = 0;
            for (cell[inner] = 0; cell[inner] < layout.row_length(); ++cell[inner])
                sum += shares_.volume[layout.at(cell)] * grid_.volume(cell);
            return sum;
        });
    }

private:
    using Cell = CellNumber<Dim>;
    using Slab = detail::CutSlab<Dim>;
    static constexpr int side = detail::CutBlock<Dim>::side;
    static constexpr int ghosts = Layout<Dim>::ghosts;
    static constexpr std::size_t outer = Layout<Dim>::outer;

    static std::size_t at(int axis) noexcept { return static_cast<std::size_t>(axis); }

    /// Number of the cell that holds a place along an axis; one beyond the ghosts where none does.
    int cell_at(int axis, Real x) const noexcept {
        int low = -ghosts - 1, high = grid_.cells(axis) + ghosts + 1;
        while (high - low > 1) {
            const int middle = low + (high - low) / 2;
            (grid_.face(axis, middle) <= x ? low : high) = middle;
        }
        return low;
    }

    Cell last_block() const noexcept {
        Cell last;
        for (int a = 0; a < Dim; ++a) last[at(a)] = (grid_.cells(a) + 2 * ghosts - 1) / side;
        return last;
    }

    /// Cells of blocks `from` to `to`.
    template <class Shape>
    void renew(const Shape& wall, const Cell& from, const Cell& to) {
        const std::span<Slab> slabs(slabs_.data() + from[outer],
                                    static_cast<std::size_t>(to[outer] - from[outer] + 1));
        const detail::WallRenewal<Dim> renewal{grid_,
                                               shares_,
                                               params_.closed_below,
                                               {params_.levels, params_.flatness, params_.bounded_slope},
                                               cell_diagonal_,
                                               params_.called};
        const std::optional<Index> opened = renewal.run(wall, from, to, slabs);
        if (!opened) {
            params_.bounded_slope = false;
            shares_.volume.fill(0), open_cells_ = 0;
            return renew(wall, {}, last_block());
        }
        open_cells_ += *opened;
        require(open_cells_ > 0 || params_.may_close_all,
                {params_.called + ", cells of the grid that it leaves open", "at least 1", "cells",
                 "is the distance above 0 in the water, and does the grid cover some of it?"},
                open_cells_);
        merge(from, to, slabs);
    }

    /// Puts the wall cells of slabs in the place of those that stood in blocks `from` to `to`.
    void merge(const Cell& from, const Cell& to, std::span<const Slab> slabs) {
        const Cell low = detail::cells_of_block<Dim>(grid_, from).low,
                   high = detail::cells_of_block<Dim>(grid_, to).high;
        const Layout<Dim>& layout = grid_.layout();
        const auto renewed = [&](Offset cell) {
            const Cell number = layout.number(cell);
            for (int a = 0; a < Dim; ++a)
                if (number[a] < low[a] || number[a] >= high[a]) return false;
            return true;
        };
        merged_.clear();
        auto old = cut_cells_.cbegin();
        const auto keep_before = [&](Offset cell) {
            for (; old != cut_cells_.cend() && old->cell < cell; ++old)
                if (!renewed(old->cell)) merged_.push_back(*old);
        };
        for (const Slab& slab : slabs)
            for (const CutCell<Dim>& c : slab.cut_cells) keep_before(c.cell), merged_.push_back(c);
        keep_before(layout.total);
        std::swap(cut_cells_, merged_);
    }

    Params params_;
    Grid<Dim> grid_;
    detail::WallShares<Dim> shares_;
    std::vector<CutCell<Dim>> cut_cells_, merged_;
    std::vector<Slab> slabs_;
    Real cell_diagonal_ = 0;  ///< of the largest cell [m]
    Index open_cells_ = 0;
};

}  // namespace abrade
