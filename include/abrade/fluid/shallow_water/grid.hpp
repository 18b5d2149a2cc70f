#pragma once
// Depth-averaged water, where its numbers stand: a grid of cells with ghosts around it, the bed in them and
// at their faces, and tiles of it.

#include <abrade/core/fields.hpp>
#include <abrade/core/require.hpp>
#include <abrade/fluid/shallow_water/kernel.hpp>

#include <array>
#include <new>
#include <string>
#include <vector>

namespace abrade {

namespace detail {

/// Memory that begins where a cache line does: packs that cross lines cost twice.
template <class T>
struct LineAllocator {
    using value_type = T;
    static constexpr std::align_val_t line{64};
    LineAllocator() = default;
    template <class U>
    LineAllocator(const LineAllocator<U>&) noexcept {}
    T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), line)); }
    void deallocate(T* at, std::size_t) noexcept { ::operator delete(at, line); }
    friend bool operator==(const LineAllocator&, const LineAllocator&) = default;
};

}  // namespace detail

/// A number for each cell, ghosts among them.
using CellColumn = std::vector<Real, detail::LineAllocator<Real>>;

/// Cells [first.x, last.x) x [first.y, last.y); empty where there are none.
struct CellBox {
    std::array<Index, 2> first{0, 0}, last{0, 0};

    bool empty() const noexcept { return first[0] >= last[0] || first[1] >= last[1]; }
    CellBox grown(Index by) const noexcept {
        return {{first[0] - by, first[1] - by}, {last[0] + by, last[1] + by}};
    }
    CellBox within(const CellBox& o) const noexcept {
        return {{std::max(first[0], o.first[0]), std::max(first[1], o.first[1])},
                {std::min(last[0], o.last[0]), std::min(last[1], o.last[1])}};
    }
    CellBox with(const CellBox& o) const noexcept {
        if (empty()) return o;
        if (o.empty()) return *this;
        return {{std::min(first[0], o.first[0]), std::min(first[1], o.first[1])},
                {std::max(last[0], o.last[0]), std::max(last[1], o.last[1])}};
    }
    CellBox moved(Index x, Index y) const noexcept {
        return {{first[0] + x, first[1] + y}, {last[0] + x, last[1] + y}};
    }
    Index cells() const noexcept { return empty() ? 0 : (last[0] - first[0]) * (last[1] - first[1]); }
};

/// Uniform cells in one or two dimensions. Rows run along x; two ghost cells stand beyond each end, and more,
/// unused, so that packs may read and write beyond a row.
template <int Dim>
class ShallowGrid {
    static_assert(Dim == 1 || Dim == 2, "water is averaged over its depth: one or two dimensions are left");

public:
    static constexpr Index ghosts = 2;
    static constexpr Index margin = 16;  ///< numbers before a row's first cell, and behind its last
    static constexpr Index rows_beyond = Dim == 2 ? ghosts : 0;
    static constexpr Index block =
        8;  ///< cells that are worked on together, at least; a multiple of every pack

    ShallowGrid() = default;
    ShallowGrid(const std::array<Real, Dim>& low, const std::array<Real, Dim>& high,
                const std::array<Index, Dim>& cells) {
        for (std::size_t a = 0; a < Dim; ++a) {
            count_[a] = cells[a], low_[a] = low[a];
            spacing_[a] = (high[a] - low[a]) / static_cast<Real>(cells[a]);
        }
        stride_ = 2 * margin + (count_[0] + block - 1) / block * block;
        size_ = static_cast<std::size_t>(stride_) * static_cast<std::size_t>(count_[1] + 2 * rows_beyond);
    }

    Index count(int axis) const noexcept { return count_[static_cast<std::size_t>(axis)]; }
    Index cells() const noexcept { return count_[0] * count_[1]; }
    Real spacing(int axis) const noexcept { return spacing_[static_cast<std::size_t>(axis)]; }  ///< [m]
    Real low(int axis) const noexcept { return low_[static_cast<std::size_t>(axis)]; }          ///< [m]
    Real cell_size() const noexcept { return spacing_[0] * spacing_[1]; }  ///< [m2], of one dimension [m]
    Index stride() const noexcept { return stride_; }
    std::size_t size() const noexcept { return size_; }  ///< of a column
    CellBox all() const noexcept { return {{0, 0}, count_}; }

    std::size_t at(Index i, Index j = 0) const noexcept {
        return static_cast<std::size_t>(j + rows_beyond) * static_cast<std::size_t>(stride_) +
               static_cast<std::size_t>(i + margin);
    }
    Real centre(int axis, Index i) const noexcept { return low(axis) + (i + 0.5) * spacing(axis); }
    /// "cell (3, 4) at (0.35, 0.45) m".
    std::string name_of(Index i, Index j) const {
        std::string cell = "cell (" + std::to_string(i), place = ") at (" + short_text(centre(0, i));
        if constexpr (Dim == 2) cell += ", " + std::to_string(j), place += ", " + short_text(centre(1, j));
        return cell + place + ") m";
    }

private:
    std::array<Index, 2> count_{1, 1};
    std::array<Real, 2> low_{0, 0}, spacing_{1, 1};
    Index stride_ = 0;
    std::size_t size_ = 0;
};

/// Depth and velocity of all cells: what changes.
template <int Dim>
struct ShallowState {
    CellColumn depth;                   ///< [m]
    std::array<CellColumn, Dim> speed;  ///< along x, y [m/s]

    static void fields(auto&& field) {
        field("depth", "m", &ShallowState::depth), field("speed", "m/s", &ShallowState::speed);
    }

    ShallowState() = default;
    explicit ShallowState(std::size_t size) : depth(size, 0.0) {
        for (auto& column : speed) column.assign(size, 0.0);
    }
};

/// The bed: in cells, and what stands at each face, the higher one of both cells' limited linear profiles.
/// Water shows a face its depth above that (hydrostatic reconstruction: E. Audusse et al., SIAM J. Sci.
/// Comput. 25 (2004) 2050, doi:10.1137/S1064827503431090), with profiles that do not change in time.
template <int Dim>
struct ShallowBed {
    CellColumn cell;                          ///< [m]
    std::array<CellColumn, Dim> half_change;  ///< across a cell along that axis, limited [m]
    std::array<CellColumn, Dim> face;         ///< between a cell and the one before it along that axis [m]

    /// Of cells, ghosts among them.
    void find_faces(const ShallowGrid<Dim>& grid) {
        for (std::size_t a = 0; a < Dim; ++a) {
            half_change[a].assign(grid.size(), 0.0), face[a].assign(grid.size(), 0.0);
            const std::size_t step = a == 0 ? 1 : static_cast<std::size_t>(grid.stride());
            const Index x = a == 0, y = a == 1,
                        beyond = Dim == 2;  // one row of ghosts along the axis, and beside it
            for (Index j = -beyond; j < grid.count(1) + beyond; ++j)
                for (Index i = -1; i <= grid.count(0); ++i) {
                    const std::size_t k = grid.at(i, j);
                    half_change[a][k] =
                        limited_half_change(cell[k] - cell[k - step], cell[k + step] - cell[k]);
                }
            for (Index j = 0; j < grid.count(1) + y; ++j)
                for (Index i = 0; i < grid.count(0) + x; ++i) {
                    const std::size_t k = grid.at(i, j), before = k - step;
                    face[a][k] = std::max(cell[before] + half_change[a][before], cell[k] - half_change[a][k]);
                }
        }
    }
};

/// A part of the grid that is worked on by itself, where and while there is water in it.
struct ShallowTile {
    CellBox cells;
    CellBox wet;            ///< that hold water, as of the last step; whole blocks of a row
    CellBox reached;        ///< that a step may wet
    CellBox before;         ///< those of the step before
    Real largest_rate = 0;  ///< sum over axes of (|u| + sqrt(g h)) / spacing, the largest [1/s]
    bool unsound = false;

    /// Cells that the next step works on. Those of the step before are among them, so that all copies of what
    /// has come to rest or run dry end up the same.
    CellBox due() const noexcept { return reached.with(before); }
};

/// Cuts the grid into tiles, row by row of tiles.
template <int Dim>
class ShallowTiles {
public:
    static constexpr Index width = 128, height = Dim == 2 ? 32 : 1;

    ShallowTiles() = default;
    explicit ShallowTiles(const ShallowGrid<Dim>& grid) : all_(grid.all()) {
        across_ = (grid.count(0) + width - 1) / width, along_ = (grid.count(1) + height - 1) / height;
        for (Index q = 0; q < along_; ++q)
            for (Index p = 0; p < across_; ++p) {
                ShallowTile tile;
                tile.cells =
                    CellBox{{p * width, q * height}, {(p + 1) * width, (q + 1) * height}}.within(all_);
                list.push_back(tile);
            }
    }

    /// Where water may come in the next step: one cell further. `periodic` says along
    /// which axes the grid meets itself.
    void find_reached(const std::array<bool, 2>& periodic) {
        due.clear();
        for (Index q = 0; q < along_; ++q)
            for (Index p = 0; p < across_; ++p) {
                ShallowTile& tile = list[static_cast<std::size_t>(q * across_ + p)];
                tile.before = tile.reached;
                tile.reached = {};
                for (Index dq = -1; dq <= 1; ++dq)
                    for (Index dp = -1; dp <= 1; ++dp) look_at(tile, p + dp, q + dq, periodic);
                round(tile);
                if (!tile.due().empty()) due.push_back(q * across_ + p);
            }
    }
    /// Water that comes in through a side reaches these cells, whatever is wet.
    void add_reached(const CellBox& cells) {
        for (std::size_t t = 0; t < list.size(); ++t) {
            ShallowTile& tile = list[t];
            const CellBox more = cells.within(tile.cells);
            if (more.empty()) continue;
            if (tile.due().empty()) due.push_back(static_cast<Index>(t));
            tile.reached = tile.reached.with(more);
            round(tile);
        }
    }

    static void fields(auto&& field) {
        field.bytes("list", &ShallowTiles::list), field("due", &ShallowTiles::due);
    }

    std::vector<ShallowTile> list;
    std::vector<Index> due;  ///< that the next step works on

private:
    void look_at(ShallowTile& tile, Index p, Index q, const std::array<bool, 2>& periodic) const noexcept {
        Index x = 0, y = 0;
        if (!wrap(p, x, across_, all_.last[0], periodic[0]) || !wrap(q, y, along_, all_.last[1], periodic[1]))
            return;
        const CellBox& wet = list[static_cast<std::size_t>(q * across_ + p)].wet;
        if (wet.empty()) return;
        const CellBox near = wet.moved(x, y).grown(1).within(tile.cells);
        if (!near.empty()) tile.reached = tile.reached.with(near);
    }
    static bool wrap(Index& tile, Index& shift, Index tiles, Index cells, bool periodic) noexcept {
        if (tile >= 0 && tile < tiles) return true;
        shift = tile < 0 ? -cells : cells;
        tile = tile < 0 ? tiles - 1 : 0;
        return periodic;
    }
    /// To whole blocks of a row.
    static void round(ShallowTile& tile) noexcept {
        constexpr Index block = ShallowGrid<Dim>::block;
        CellBox& box = tile.reached;
        if (box.empty()) return;
        box.first[0] = box.first[0] / block * block;
        box.last[0] = std::min((box.last[0] + block - 1) / block * block, tile.cells.last[0]);
    }

    CellBox all_;
    Index across_ = 0, along_ = 0;
};

}  // namespace abrade
