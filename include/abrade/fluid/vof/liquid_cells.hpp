#pragma once
// Liquid in the cells of a grid: what VolumeOfFluid carries along.

#include <abrade/core/parallel.hpp>
#include <abrade/fluid/mesh/cell_sizes.hpp>
#include <abrade/fluid/mesh/water_cells.hpp>
#include <abrade/fluid/vof/cell_marks.hpp>
#include <abrade/fluid/vof/solids_in_cells.hpp>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace abrade::detail {

/// f [-] and volume defect [-] of each cell, in the room that walls and solids leave:
///   liquid volume = sum of (f + volume_defect) open V.
template <int Dim>
struct LiquidCells {
    static constexpr int vertical = Grid<Dim>::vertical;

    LiquidCells(const Grid<Dim>& cells, const BoundaryConditions<Dim>& sides)
        : grid(cells), boundaries((sides.validate(), sides)), layout(cells.layout()), sizes(cells),
          fraction(layout.total, 0), volume_defect(layout.total, 0), solids(layout.total) {
        set_walls(nullptr, nullptr);
    }

    /// Shares of faces and cells that walls leave open [-]; none: all open. They must outlive this.
    void set_walls(const FaceField<Dim>* faces, const Field<Real>* cells) {
        if ((faces == nullptr) != (cells == nullptr))
            fail({"VolumeOfFluid.set_walls", "both open faces and open volumes, or neither", "",
                  "walls close faces and take volume"},
                 "one of them");
        apertures = faces, open_fractions = cells;
        solids.set_walls(cells);
        marks = surface_marks(grid, boundaries, cells);
    }

    /// Takes over fractions that were set from outside. Throws InputError where one is not from 0 to 1.
    void take_over() {
        grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
            const Real f = fraction[c];
            if (!(f >= 0 && f <= 1))
                fail({"VolumeOfFluid.fraction" + text(cell), "from 0 to 1", "",
                      "give the share of the cell's open volume that is liquid"},
                     to_text(f));
            set(c, is_open(c) ? f : 0);
        });
    }

    bool is_open(Offset c) const noexcept { return (marks[c] & cell_mark::open) != 0; }
    bool is_inside(Offset c) const noexcept { return (marks[c] & cell_mark::inside) != 0; }
    /// Share of a face that walls leave open [-].
    Real aperture(int axis, Offset face) const noexcept { return apertures ? (*apertures)[axis][face] : 1; }
    /// Shares of cells that walls and solids leave to the liquid [-]; none: all.
    const Field<Real>* room() const noexcept { return solids.any() ? &solids.room() : open_fractions; }
    Real open_volume(Offset c, Index level) const noexcept {  ///< [m3]
        return sizes.volume(level) * (room() ? (*room())[c] : 1);
    }

    Real held(Offset c) const noexcept { return fraction[c] + volume_defect[c]; }  ///< of its room [-]
    void set(Offset c, Real held) noexcept {
        fraction[c] = held < volume_tolerance::round_off       ? 0
                      : held > 1 - volume_tolerance::round_off ? 1
                                                               : held;
        volume_defect[c] = held - fraction[c];
        // Adding so little to 1 rounds it; what lies between is exact.
        if (fraction[c] == held) volume_defect[c] = 0;
    }

    Real volume() const {  ///< [m3]
        std::vector<Real> plane(static_cast<std::size_t>(layout.planes()), 0);
        parallel_tasks(layout.planes(), [&](Index p) {
            Real sum = 0;
            for (int r = 0; r < layout.rows_per_plane(); ++r) {
                const Offset start = layout.row_start(p, r);
                for (int i = 0; i < layout.row_length(); ++i) {
                    const Offset c = start + i;
                    const int level = Dim == 3 ? r : i;
                    if (is_open(c))
                        sum += held(c) * open_volume(c, level) +
                               (solids.has(c) ? solids.lag(c) * sizes.volume(level) : 0);
                }
            }
            plane[static_cast<std::size_t>(p)] = sum;
        });
        Real total = 0;
        for (const Real sum : plane) total += sum;
        return total;
    }

    /// A cell beside another one.
    struct Beside {
        Offset cell, face, twin;  ///< twin: the same face at the other end of a periodic axis, or -1
        Index level;
        int axis, side;  ///< side: -1 or 1
    };
    /// At `side` (-1 or 1) along an axis, also across a periodic end; none beyond other ends.
    std::optional<Beside> beside(Offset c, Index level, int axis, int side) const noexcept {
        const Offset step = layout.stride[axis];
        Beside b{c + side * step, side > 0 ? c + step : c, -1, level, axis, side};
        if (axis == vertical) b.level += side;
        if (is_inside(b.cell)) return b;
        if (!boundaries.periodic(axis)) return std::nullopt;
        const Offset around = side * layout.cells[axis] * step;
        b.cell -= around, b.twin = b.face - around;
        if (axis == vertical) b.level -= side * layout.cells[axis];
        return b;
    }
    /// Calls visit(Beside) for the cells to which liquid may flow.
    void for_each_beside(Offset c, Index level, auto&& visit) const {
        for (int a = 0; a < Dim; ++a)
            for (const int side : {-1, 1})
                if (const auto b = beside(c, level, a, side);
                    b && is_open(b->cell) && aperture(a, b->face) > 0)
                    visit(*b);
    }

    static std::string text(const CellNumber<Dim>& cell) {
        std::string result = "[";
        for (std::size_t a = 0; a < Dim; ++a) result += (a ? ", " : "") + std::to_string(cell[a]);
        return result + "]";
    }

    Grid<Dim> grid;
    BoundaryConditions<Dim> boundaries;
    Layout<Dim> layout;
    CellSizes<Dim> sizes;
    const FaceField<Dim>* apertures = nullptr;
    const Field<Real>* open_fractions = nullptr;
    Field<std::uint8_t> marks;
    Field<Real> fraction, volume_defect;
    SolidsInCells<Dim> solids;
    Point<Dim> gravity = Point<Dim>::Zero();  ///< what films fall off sides by [m/s2]

    static void fields(auto&& field) {
        field("fraction", &LiquidCells::fraction), field("volume_defect", &LiquidCells::volume_defect),
            field("solids", &LiquidCells::solids);
    }
};

/// A cell and its number along the vertical axis.
struct CellAtLevel {
    Offset cell;
    Index level;
};
using CellsOfPlanes = std::vector<std::vector<CellAtLevel>>;  ///< [plane]

}  // namespace abrade::detail
