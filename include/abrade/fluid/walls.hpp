#pragma once
// Solid walls of any shape on a grid: how much of each cell and of each face they leave open.

#include <abrade/core/parallel.hpp>
#include <abrade/fluid/wall_block.hpp>
#include <abrade/fluid/wall_shapes.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace abrade {

/// The wall in one cell.
template <int Dim>
struct WallCell {
    Offset cell = 0;
    Real area = 0;                           ///< [m2]; in two dimensions [m]
    Point<Dim> normal = Point<Dim>::Zero();  ///< into the water, of unit length
    Point<Dim> point = Point<Dim>::Zero();   ///< on the wall [m]
};

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
class Walls {
public:
    struct Params {
        Real closed_below = 1e-3;   ///< open share up to which a cell or face is closed [-]
        int levels = 1;             ///< how often cells and faces are halved where the wall is not flat
        Real flatness = 0.02;       ///< not flat: the distance at the centre is off by that share of the size
        bool bounded_slope = true;  ///< |w(x) - w(y)| <= |x - y|: cells far from the wall need no look inside

        void validate() const {
            require(closed_below >= 0 && closed_below <= 0.1,
                    {"Walls.closed_below", "from 0 to 0.1", "",
                     "1e-3 costs no accuracy: few cells are that small"},
                    closed_below);
            require(levels >= 0 && levels <= 6,
                    {"Walls.levels", "from 0 to 6", "", "each level looks at 2^Dim times as many parts"},
                    levels);
            require_positive(flatness, "Walls.flatness");
        }
    };

    /// No walls: all is open.
    explicit Walls(const Grid<Dim>& grid)
        : grid_(grid), volume_(grid.layout().total), area_(face_field<Dim>(grid.layout())) {
        const auto open = [&](const CellNumber<Dim>&, Offset at) {
            volume_[at] = 1;
            for (auto& axis : area_) axis[at] = 1;
        };
        grid_.for_each(open, ghosts);
        open_cells_ = grid_.layout().cell_count();
    }

    /// Throws InputError where the distance is NaN, and when no cell is open.
    template <WallShape<Dim> Shape>
    Walls(const Grid<Dim>& grid, const Shape& wall) : Walls(grid, wall, Params()) {}
    template <WallShape<Dim> Shape>
    Walls(const Grid<Dim>& grid, const Shape& wall, Params params)
        : params_((params.validate(), params)), grid_(grid), volume_(grid.layout().total),
          area_(face_field<Dim>(grid.layout())), too_small_(grid.layout().total, 1) {
        for (int a = 0; a < Dim; ++a) {
            blocks_[at(a)] = (grid_.cells(a) + 2 * ghosts + Block::side - 1) / Block::side;
            Real largest = 0;
            for (int i = -ghosts; i < grid_.cells(a) + ghosts; ++i)
                largest = std::max(largest, grid_.size(a, i));
            cell_diagonal_ += square(largest);
        }
        cell_diagonal_ = std::sqrt(cell_diagonal_);
        slabs_.resize(static_cast<std::size_t>(blocks_[outer]));
        CellNumber<Dim> last;
        for (int a = 0; a < Dim; ++a) last[at(a)] = blocks_[at(a)] - 1;
        renew(wall, {}, last);
    }

    /// After the solid has changed between the corners `low` and `high` of a box [m], nowhere else: renews
    /// the cells there, to the same bits as built anew. Throws as the constructor does; then build anew.
    template <WallShape<Dim> Shape>
    void update(const Shape& wall, const Point<Dim>& low, const Point<Dim>& high) {
        require(!slabs_.empty(), {"Walls.update", "called on walls", "", "give the constructor a shape"}, 0);
        CellNumber<Dim> from, to;
        for (int a = 0; a < Dim; ++a) {
            require(low[a] <= high[a],
                    {std::string("Walls.update: high.") + Grid<Dim>::axis_name(a),
                     "at least low (" + to_text(low[a]) + " m)", "m", "give lower corner, then upper"},
                    high[a]);
            // Distances change a little further off, so cuts of cells about the solid do as well; and one
            // more layer of cells, which may have lost or won an open face.
            const Real margin = 2 * cell_diagonal_;
            const int first = cell_at(a, low[a] - margin) - 1, last = cell_at(a, high[a] + margin) + 1;
            if (last < -ghosts || first >= grid_.cells(a) + ghosts) return;
            from[at(a)] = (std::max(first, -ghosts) + ghosts) / Block::side;
            to[at(a)] = (std::min(last, grid_.cells(a) + ghosts - 1) + ghosts) / Block::side;
        }
        renew(wall, from, to);
    }

    const Params& params() const noexcept { return params_; }
    const Grid<Dim>& grid() const noexcept { return grid_; }
    /// Of each cell, ghosts included [-].
    const Field<Real>& open_volume() const noexcept { return volume_; }
    /// Of each lower face [-].
    const FaceField<Dim>& open_area() const noexcept { return area_; }
    /// Inside the box, in the order of memory.
    std::span<const WallCell<Dim>> wall_cells() const noexcept { return wall_cells_; }
    /// Those of `count` cells from `first` on, a row for instance.
    std::span<const WallCell<Dim>> wall_cells(Offset first, Offset count) const noexcept {
        const auto before = [](const WallCell<Dim>& c, Offset cell) { return c.cell < cell; };
        const auto begin = std::lower_bound(wall_cells_.begin(), wall_cells_.end(), first, before);
        return {begin, std::lower_bound(begin, wall_cells_.end(), first + count, before)};
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
                sum += volume_[layout.at(cell)] * grid_.volume(cell);
            return sum;
        });
    }

private:
    using Cell = CellNumber<Dim>;
    using Block = detail::WallBlock<Dim>;
    using Range = detail::CellRange<Dim>;
    static constexpr int ghosts = Layout<Dim>::ghosts;
    static constexpr std::size_t outer = Layout<Dim>::outer;

    /// A point of the wall, until areas are known.
    struct Seed {
        Offset cell;
        Point<Dim> point;
    };
    /// Blocks of one number along the outer axis: the work of one thread.
    struct Slab {
        std::vector<Range> near;  ///< blocks that the wall may pass through
        std::vector<Seed> seeds;  ///< in the order in which their cells are visited
        std::vector<WallCell<Dim>> wall_cells;
        Index opened = 0;  ///< cells, less those closed
        bool failed = false;
        Point<Dim> where;  ///< [m]
    };

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

    Range cells_of(const Cell& block) const noexcept {
        Range range;
        for (int a = 0; a < Dim; ++a) {
            range.low[at(a)] = block[at(a)] * Block::side - ghosts;
            range.high[at(a)] = std::min(range.low[at(a)] + Block::side, grid_.cells(a) + ghosts);
        }
        return range;
    }
    bool inside(const Cell& cell) const noexcept {
        for (int a = 0; a < Dim; ++a)
            if (cell[at(a)] < 0 || cell[at(a)] >= grid_.cells(a)) return false;
        return true;
    }

    /// Cells of blocks `from` to `to`: shares as the wall cuts them, then faces that are closed, then cells,
    /// then what wall is left. Each step reads what its neighbours left in the one before.
    template <class Shape>
    void renew(const Shape& wall, const Cell& from, const Cell& to) {
        const std::span<Slab> slabs(slabs_.data() + from[outer],
                                    static_cast<std::size_t>(to[outer] - from[outer] + 1));
        const auto each_slab = [&](auto&& work) {
            parallel_tasks(static_cast<Index>(slabs.size()),
                           [&](Index n) { work(slabs[static_cast<std::size_t>(n)], from[outer] + n); });
        };
        each_slab([&](Slab& slab, int number) {
            slab.near.clear(), slab.seeds.clear(), slab.wall_cells.clear();
            slab.opened = 0, slab.failed = false;
            Range blocks{from, to};
            blocks.low[outer] = blocks.high[outer] = number;
            for (int& end : blocks.high) ++end;
            detail::each_cell<Dim>(blocks, [&](const Cell& block) { cut(slab, cells_of(block), wall); });
        });
        for (const Slab& slab : slabs)
            if (slab.failed) fail_at(slab.where);
        each_slab([&](Slab& slab, int) {
            for (const Range& cells : slab.near) close_faces(cells);
        });
        each_slab([&](Slab& slab, int) {
            for (const Range& cells : slab.near) close_cells(slab, cells);
        });
        for (const Slab& slab : slabs) open_cells_ += slab.opened;
        require(open_cells_ > 0,
                {"Walls: open cells of the grid", "at least 1", "",
                 "is the distance above 0 in the water, and does the grid cover some of it?"},
                open_cells_);
        each_slab([&](Slab& slab, int) { find_wall_cells(slab); });
        merge(from, to, slabs);
    }

    [[noreturn]] static void fail_at(const Point<Dim>& x) {
        std::string place;
        for (int a = 0; a < Dim; ++a)
            place +=
                std::string(a > 0 ? ", " : "") + Grid<Dim>::axis_name(a) + " = " + short_text(x[a]) + " m";
        fail({"Walls: distance at " + place, "a number", "m",
              "look for a division by 0 or the root of a negative number in the shape"},
             "nan");
    }

    template <class Shape>
    void cut(Slab& slab, const Range& cells, const Shape& wall) {
        detail::Probe<Dim, Shape> distance(wall);
        const Block block(grid_, cells, distance, {params_.levels, params_.flatness, params_.bounded_slope},
                          cell_diagonal_);
        const auto put = [&](const Cell& c, Real volume, auto&& area) {
            const Offset cell = grid_.layout().at(c);
            if (inside(c)) slab.opened -= volume_[cell] > 0;
            volume_[cell] = volume;
            too_small_[cell] = volume <= params_.closed_below;
            for (int a = 0; a < Dim; ++a) area_[at(a)][cell] = area(a);
            return cell;
        };
        if (block.content() == detail::Content::cut) {
            slab.near.push_back(cells);
            detail::each_cell<Dim>(cells, [&](const Cell& c) {
                const Offset cell = put(c, block.volume(c), [&](int a) { return block.area(a, c); });
                if (block.is_cut(c)) slab.seeds.push_back({cell, block.point(c)});
            });
        } else {
            const bool open = block.content() == detail::Content::open;
            const Real all = open ? 1 : 0;
            detail::each_cell<Dim>(cells, [&](const Cell& c) {
                put(c, all, [&](int) { return all; });
                if (open && inside(c)) ++slab.opened;
            });
        }
        if (distance.failed() && !slab.failed) slab.failed = true, slab.where = distance.where();
    }

    void close_faces(const Range& cells) noexcept {
        const Layout<Dim>& layout = grid_.layout();
        detail::each_cell<Dim>(cells, [&](const Cell& c) {
            const Offset cell = layout.at(c);
            for (int a = 0; a < Dim; ++a) {
                Real& share = area_[at(a)][cell];
                const bool neighbour_closed = c[at(a)] > -ghosts && too_small_[cell - layout.stride[at(a)]];
                if (share <= params_.closed_below || too_small_[cell] || neighbour_closed) share = 0;
            }
        });
    }

    void close_cells(Slab& slab, const Range& cells) noexcept {
        const Layout<Dim>& layout = grid_.layout();
        detail::each_cell<Dim>(cells, [&](const Cell& c) {
            const Offset cell = layout.at(c);
            bool open = false;
            for (int a = 0; a < Dim; ++a) {
                // Faces beyond the last ghosts are not stored, and count as open.
                const bool has_upper = c[at(a)] + 1 < grid_.cells(a) + ghosts;
                open = open || area_[at(a)][cell] > 0 || !has_upper ||
                       area_[at(a)][cell + layout.stride[at(a)]] > 0;
            }
            if (too_small_[cell] || !open) volume_[cell] = 0;
            if (inside(c)) slab.opened += volume_[cell] > 0;
        });
    }

    void find_wall_cells(Slab& slab) {
        auto seed = slab.seeds.cbegin();
        for (const Range& cells : slab.near)
            detail::each_cell<Dim>(cells, [&](const Cell& c) {
                const Offset cell = grid_.layout().at(c);
                const bool seeded = seed != slab.seeds.cend() && seed->cell == cell;
                if (inside(c) && volume_[cell] > 0)
                    add_wall_cell(slab, c, cell, seeded ? seed->point : grid_.centre(c));
                seed += seeded;
            });
        std::sort(slab.wall_cells.begin(), slab.wall_cells.end(),
                  [](const auto& a, const auto& b) { return a.cell < b.cell; });
    }

    /// `near` is on the wall, or at least in the cell.
    void add_wall_cell(Slab& slab, const Cell& c, Offset cell, const Point<Dim>& near) {
        const Point<Dim> centre = grid_.centre(c);
        const Real whole = grid_.volume(c);
        Point<Dim> area;                                        // of the wall, by its components [m2]
        Real moment = -Dim * volume_[cell] * whole, faces = 0;  // of faces about the centre, less Dim V [m3]
        for (int a = 0; a < Dim; ++a) {
            const Real size = grid_.size(a, c[at(a)]), face = whole / size;
            const Real lower = area_[at(a)][cell], upper = area_[at(a)][cell + grid_.layout().stride[at(a)]];
            area[a] = face * (upper - lower);
            moment += 0.5 * size * face * (upper + lower);
            faces = std::max(faces, face);
        }
        const Real total = area.norm();
        if (total < 1e-15 * faces) return;
        const Point<Dim> normal = area / total;
        Point<Dim> point = near + (moment / total - normal.dot(near - centre)) * normal;
        for (int a = 0; a < Dim; ++a)  // walls that turn within the cell
            point[a] = std::clamp(point[a], grid_.face(a, c[at(a)]), grid_.face(a, c[at(a)] + 1));
        slab.wall_cells.push_back({cell, total, normal, point});
    }

    /// Puts the wall cells of slabs in the place of those that stood in blocks `from` to `to`.
    void merge(const Cell& from, const Cell& to, std::span<const Slab> slabs) {
        const Cell low = cells_of(from).low, high = cells_of(to).high;
        const Layout<Dim>& layout = grid_.layout();
        const auto renewed = [&](Offset cell) {
            for (int n = 0; n < Dim; ++n) {
                const std::size_t a = detail::axis_in_memory<Dim>(n);  // by decreasing stride
                const auto number = static_cast<int>(cell / layout.stride[a]) - ghosts;
                if (number < low[a] || number >= high[a]) return false;
                cell %= layout.stride[a];
            }
            return true;
        };
        merged_.clear();
        auto old = wall_cells_.cbegin();
        const auto keep_before = [&](Offset cell) {
            for (; old != wall_cells_.cend() && old->cell < cell; ++old)
                if (!renewed(old->cell)) merged_.push_back(*old);
        };
        for (const Slab& slab : slabs)
            for (const WallCell<Dim>& c : slab.wall_cells) keep_before(c.cell), merged_.push_back(c);
        keep_before(layout.total);
        std::swap(wall_cells_, merged_);
    }

    Params params_;
    Grid<Dim> grid_;
    Field<Real> volume_;
    FaceField<Dim> area_;
    Field<std::uint8_t> too_small_;  ///< no more than `closed_below` is open
    std::vector<WallCell<Dim>> wall_cells_, merged_;
    std::vector<Slab> slabs_;
    Cell blocks_{};           ///< along each axis
    Real cell_diagonal_ = 0;  ///< of the largest cell [m]
    Index open_cells_ = 0;
};

}  // namespace abrade
