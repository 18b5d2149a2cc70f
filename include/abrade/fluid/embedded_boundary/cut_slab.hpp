#pragma once
// What a wall leaves open of a grid, slab by slab, and the wall in the cells that it cuts.

#include <abrade/core/parallel.hpp>
#include <abrade/fluid/embedded_boundary/cut_block.hpp>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abrade {

/// The wall in one cell.
template <int Dim>
struct CutCell {
    Offset cell = 0;
    Real area = 0;                           ///< [m2]; in two dimensions [m]
    Point<Dim> normal = Point<Dim>::Zero();  ///< into the water, of unit length
    Point<Dim> point = Point<Dim>::Zero();   ///< on the wall [m]
};

namespace detail {

/// Open shares of cells and of their lower faces.
template <int Dim>
struct WallShares {
    Field<Real> volume;
    FaceField<Dim> area;
    Field<std::uint8_t> too_small;  ///< no more than `closed_below` is open
};

/// Blocks of one number along the outer axis: the work of one thread.
template <int Dim>
struct CutSlab {
    /// A point of the wall, until areas are known.
    struct Seed {
        Offset cell;
        Point<Dim> point;
    };
    std::vector<CellRange<Dim>> near;  ///< blocks that the wall may pass through
    std::vector<Seed> seeds;           ///< in the order in which their cells are visited
    std::vector<CutCell<Dim>> cut_cells;
    Index opened = 0;  ///< cells, less those closed
    std::optional<ShapeFailure<Dim>> failure;
    std::vector<Answer<Dim>> centres;  ///< of blocks, in the order in which they are visited
    bool steep = false;                ///< distances grow faster than the way, within a cell
};

/// Cells of a block, ghosts of the grid included.
template <int Dim>
CellRange<Dim> cells_of_block(const Grid<Dim>& grid, const CellNumber<Dim>& block) noexcept {
    constexpr int side = CutBlock<Dim>::side, ghosts = Layout<Dim>::ghosts;
    CellRange<Dim> range;
    for (int a = 0; a < Dim; ++a) {
        range.low[a] = block[a] * side - ghosts;
        range.high[a] = std::min(range.low[a] + side, grid.cells(a) + ghosts);
    }
    return range;
}

/// Whether distances at places of one order change faster than the way from each to its neighbour.
template <int Dim>
bool is_steep(std::span<const Answer<Dim>> from, std::span<const Answer<Dim>> to) noexcept {
    return !std::ranges::equal(from, to, [](const auto& a, const auto& b) { return !is_steep(a, b); });
}

/// Renews the shares of a range of blocks.
template <int Dim>
struct WallRenewal {
    using Cell = CellNumber<Dim>;
    using Range = CellRange<Dim>;
    using Slab = CutSlab<Dim>;
    static constexpr int ghosts = Layout<Dim>::ghosts;
    static constexpr std::size_t outer = Layout<Dim>::outer;

    const Grid<Dim>& grid;
    WallShares<Dim>& shares;
    Real closed_below;  ///< [-]
    Subdivision rule;
    Real cell_diagonal;  ///< of the largest cell [m]
    std::string_view called;

    /// Cells of blocks `from` to `to`: shares as the wall cuts them, then faces that are closed, then cells,
    /// then what wall is left. Each step reads what its neighbours left in the one before.
    /// Returns by how many more cells of the box are open; none, with nothing but rubbish left, where
    /// distances turn out to grow faster than the way and the rule counts on it that they do not. Throws
    /// InputError where the distance is NaN, and what the shape throws.
    template <class Shape>
    std::optional<Index> run(const Shape& wall, const Cell& from, const Cell& to,
                             std::span<Slab> slabs) const {
        const auto each_slab = [&](auto&& work) {
            parallel_tasks(static_cast<Index>(slabs.size()),
                           [&](Index n) { work(slabs[static_cast<std::size_t>(n)], from[outer] + n); });
        };
        each_slab([&](Slab& slab, int number) {
            slab.near.clear(), slab.seeds.clear(), slab.cut_cells.clear(), slab.centres.clear();
            slab.opened = 0, slab.failure.reset(), slab.steep = false;
            Range blocks{from, to};
            blocks.low[outer] = blocks.high[outer] = number;
            for (int& end : blocks.high) ++end;
            each_cell<Dim>(blocks,
                           [&](const Cell& block) { cut(slab, cells_of_block<Dim>(grid, block), wall); });
        });
        for (const Slab& slab : slabs)
            if (slab.failure) raise(*slab.failure);
        if (rule.bounded_slope && any_steep(slabs, to[Layout<Dim>::inner] - from[Layout<Dim>::inner] + 1))
            return std::nullopt;
        each_slab([&](Slab& slab, int) {
            for (const Range& cells : slab.near) close_faces(cells);
        });
        each_slab([&](Slab& slab, int) {
            for (const Range& cells : slab.near) close_cells(slab, cells);
        });
        each_slab([&](Slab& slab, int) { find_wall_cells(slab); });
        Index opened = 0;
        for (const Slab& slab : slabs) opened += slab.opened;
        return opened;
    }

private:
    bool inside(const Cell& cell) const noexcept {
        for (int a = 0; a < Dim; ++a)
            if (cell[a] < 0 || cell[a] >= grid.cells(a)) return false;
        return true;
    }

    [[noreturn]] void raise(const ShapeFailure<Dim>& failure) const {
        if (failure.thrown) std::rethrow_exception(failure.thrown);
        fail({std::string(called) + " at " + place_text<Dim>(failure.where), "a number", "m",
              "look for a division by 0 or the root of a negative number in the shape"},
             "nan");
    }

    /// Blocks are compared by their centres along each axis: those passed over for being far have nothing
    /// else.
    static bool any_steep(std::span<const Slab> slabs, int row_length) {
        const auto row = static_cast<std::size_t>(row_length);
        std::span<const Answer<Dim>> before;
        for (const Slab& slab : slabs) {
            const std::span<const Answer<Dim>> here = slab.centres;
            if (slab.steep || is_steep<Dim>(here.first(here.size() - 1), here.subspan(1)) ||
                is_steep<Dim>(here.first(here.size() - row), here.subspan(row)) ||
                (!before.empty() && is_steep<Dim>(before, here)))
                return true;
            before = here;
        }
        return false;
    }

    template <class Shape>
    void cut(Slab& slab, const Range& cells, const Shape& wall) const {
        if (slab.failure) return;
        Probe<Dim, Shape> distance(wall);
        const CutBlock<Dim> block(grid, cells, distance, rule, cell_diagonal);
        const auto put = [&](const Cell& c, Real volume, auto&& area) {
            const Offset cell = grid.layout().at(c);
            if (inside(c)) slab.opened -= shares.volume[cell] > 0;
            shares.volume[cell] = volume;
            shares.too_small[cell] = volume <= closed_below;
            for (int a = 0; a < Dim; ++a) shares.area[a][cell] = area(a);
            return cell;
        };
        if (block.content() == Content::cut) {
            slab.near.push_back(cells);
            each_cell<Dim>(cells, [&](const Cell& c) {
                const Offset cell = put(c, block.volume(c), [&](int a) { return block.area(a, c); });
                if (block.is_cut(c)) slab.seeds.push_back({cell, block.point(c)});
            });
        } else {
            const bool open = block.content() == Content::open;
            const Real all = open ? 1 : 0;
            each_cell<Dim>(cells, [&](const Cell& c) {
                put(c, all, [&](int) { return all; });
                if (open && inside(c)) ++slab.opened;
            });
        }
        slab.failure = distance.failure();
        if (rule.bounded_slope) slab.centres.push_back(block.centre()), slab.steep |= block.steep();
    }

    void close_faces(const Range& cells) const noexcept {
        const Layout<Dim>& layout = grid.layout();
        each_cell<Dim>(cells, [&](const Cell& c) {
            const Offset cell = layout.at(c);
            for (int a = 0; a < Dim; ++a) {
                Real& share = shares.area[a][cell];
                const bool neighbour_closed = c[a] > -ghosts && shares.too_small[cell - layout.stride[a]];
                if (share <= closed_below || shares.too_small[cell] || neighbour_closed) share = 0;
            }
        });
    }

    void close_cells(Slab& slab, const Range& cells) const noexcept {
        const Layout<Dim>& layout = grid.layout();
        each_cell<Dim>(cells, [&](const Cell& c) {
            const Offset cell = layout.at(c);
            bool open = false;
            for (int a = 0; a < Dim; ++a) {
                // Faces beyond the last ghosts are not stored, and count as open.
                const bool has_upper = c[a] + 1 < grid.cells(a) + ghosts;
                open = open || shares.area[a][cell] > 0 || !has_upper ||
                       shares.area[a][cell + layout.stride[a]] > 0;
            }
            if (shares.too_small[cell] || !open) shares.volume[cell] = 0;
            if (inside(c)) slab.opened += shares.volume[cell] > 0;
        });
    }

    void find_wall_cells(Slab& slab) const {
        auto seed = slab.seeds.cbegin();
        for (const Range& cells : slab.near)
            each_cell<Dim>(cells, [&](const Cell& c) {
                const Offset cell = grid.layout().at(c);
                const bool seeded = seed != slab.seeds.cend() && seed->cell == cell;
                if (inside(c) && shares.volume[cell] > 0)
                    add_wall_cell(slab, c, cell, seeded ? seed->point : grid.centre(c));
                seed += seeded;
            });
        std::sort(slab.cut_cells.begin(), slab.cut_cells.end(),
                  [](const auto& a, const auto& b) { return a.cell < b.cell; });
    }

    /// `near` is on the wall, or at least in the cell.
    void add_wall_cell(Slab& slab, const Cell& c, Offset cell, const Point<Dim>& near) const {
        const Point<Dim> centre = grid.centre(c);
        const Real whole = grid.volume(c);
        Point<Dim> area;  // of the wall, by its components [m2]
        Real moment = -Dim * shares.volume[cell] * whole,
             faces = 0;  // of faces about the centre, less Dim V [m3]
        for (int a = 0; a < Dim; ++a) {
            const Real size = grid.size(a, c[a]), face = whole / size;
            const Real lower = shares.area[a][cell], upper = shares.area[a][cell + grid.layout().stride[a]];
            area[a] = face * (upper - lower);
            moment += 0.5 * size * face * (upper + lower);
            faces = std::max(faces, face);
        }
        const Real total = area.norm();
        if (total < 1e-15 * faces) return;
        const Point<Dim> normal = area / total;
        Point<Dim> point = near + (moment / total - normal.dot(near - centre)) * normal;
        for (int a = 0; a < Dim; ++a)  // walls that turn within the cell
            point[a] = std::clamp(point[a], grid.face(a, c[a]), grid.face(a, c[a] + 1));
        slab.cut_cells.push_back({cell, total, normal, point});
    }
};

}  // namespace detail
}  // namespace abrade
