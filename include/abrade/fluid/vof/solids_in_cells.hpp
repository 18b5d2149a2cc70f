#pragma once
// Solids that stand and move in cells of liquid.

#include <abrade/fluid/mesh/boundary_conditions.hpp>
#include <abrade/fluid/mesh/solid_parts.hpp>

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace abrade::detail {

/// Solids among the liquid of a VolumeOfFluid. Liquid fills the share f of the room K that walls and solids
/// leave of a cell; a solid is taken to be spread evenly over the cell, so f is the share of it below the
/// surface.
///
/// In a step what went through faces leaves of the room
///   K* = K - (solid that came in) / V,
/// and as the mixture's velocity has no divergence, a full cell of that room stays full. Where the solid is
/// at the end says something else, for shares of faces are means over a cell: the difference f (K* - K) is a
/// `lag`, liquid that a cell has too much, or lacks. It goes as the solid does. What is left once the solid
/// has gone is handed over bit by bit, to the surface or, below it, to the pressure, which drives it out. So
/// a solid that appears displaces its volume as it leaves its place.
///
/// Where solids leave next to nothing f tells nothing: it is that of the cells around.
template <int Dim>
class SolidsInCells {
    static constexpr Real least = 0.05;    ///< room of a cell [-]
    static constexpr Real covered = 0.25;  ///< less room tells nothing of where the surface is [-]

public:
    SolidsInCells() = default;
    explicit SolidsInCells(Offset total) : total_(total) {}

    /// Shares of cells that walls leave; none: all. They must outlive this.
    void set_walls(const Field<Real>* open) noexcept { open_ = open; }
    bool any() const noexcept { return room_.size() > 0; }
    const Field<Real>& room() const noexcept { return room_; }  ///< K of all cells [-]
    bool has(Offset cell) const noexcept { return any() && marks_[cell] != 0; }
    Real lag(Offset cell) const noexcept { return lag_[cell]; }  ///< in shares of the cell [-]

    /// Solids that liquid has been given around: up to its surface as it stands.
    void stand(const Grid<Dim>& grid, std::span<const SolidPart> parts) {
        set(grid, parts);
        for (const Offset c : cells_) room_[c] = std::max(next_[c], least * open_of(c));
    }
    /// Where they are at the end of the step to come.
    void set(const Grid<Dim>& grid, std::span<const SolidPart> parts) {
        if (!any()) begin();
        before_.clear();
        for (const Offset c : cells_) before_.push_back({c, room_[c], lag_[c]}), next_[c] = open_of(c);
        for (const SolidPart& part : parts) {
            look_at(part.cell);
            next_[part.cell] -= part.volume / grid.volume(grid.layout().number(part.cell));
        }
    }
    /// After a step that went wrong.
    void take_back() {
        if (!any()) return;
        for (const Offset c : cells_) forget(c);
        cells_.clear();
        put_back(before_);
    }

    /// Once the liquid has moved: its fractions and volume defects in the room that is left. `moved`: solid
    /// that went through faces in the step; `at_once`: how much of a lag is handed over in it [-]; `full`:
    /// what is more is no surface [-].
    void move(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries, Field<Real>& fraction,
              Field<Real>& volume_defect, std::span<const SolidVolume> moved, Real at_once, Real full) {
        for (const SolidVolume& solid : moved) {
            CellNumber<Dim> number = grid.layout().number(solid.face);
            if (grid.has(number)) came(grid, number, solid.volume);
            --number[solid.axis];
            if (number[solid.axis] < 0 && boundaries.periodic(solid.axis))
                number[solid.axis] += grid.cells(solid.axis);
            if (grid.has(number)) came(grid, number, -solid.volume);
        }
        for (const Offset c : cells_) {
            const Real room = std::max(next_[c], least * open_of(c));
            const Real by_faces = std::max(room_[c] - std::exchange(came_[c], 0), least * open_of(c));
            const Real liquid = (fraction[c] + volume_defect[c]) * room_[c] / by_faces;
            lag_[c] += liquid * (by_faces - room);
            room_[c] = room;
            put(c, liquid, at_once, fraction, volume_defect);
        }
        reconstruct_covered(grid, boundaries, full, fraction, volume_defect);
        std::erase_if(cells_, [&](Offset c) {
            const bool gone = next_[c] == open_of(c) && lag_[c] == 0;
            if (gone) forget(c);
            return gone;
        });
    }

    /// Once it has settled: what full cells hold too much among solids they lag by.
    void keep_volume_defect(const Field<Real>& fraction, Field<Real>& volume_defect) {
        now_.clear();
        for (const Offset c : cells_) {
            if (fraction[c] == 1 && next_[c] != open_of(c))
                lag_[c] += std::exchange(volume_defect[c], 0) * room_[c];
            now_.push_back({c, room_[c], lag_[c]});
        }
    }
    /// Adds to what a cell lags by [-].
    void lag_by(Offset cell, Real more) { look_at(cell), lag_[cell] += more; }

    static void fields(auto&& field) { field.bytes("cells", &SolidsInCells::now_); }
    void restored() {
        if (now_.empty() && !any()) return;
        if (any()) cells_.clear();
        begin();
        put_back(now_);
    }

private:
    struct Kept {
        Offset cell = 0;
        Real room = 1, lag = 0;
    };
    struct CoveredCell {
        Offset cell;
        CellNumber<Dim> number{};
        int beside = 0;
        Real fraction = 0;
    };

    Real open_of(Offset c) const noexcept { return open_ ? (*open_)[c] : 1; }
    void begin() {
        room_ = Field<Real>(total_, 1);
        if (open_) room_ = *open_;
        next_ = room_, lag_ = came_ = Field<Real>(total_, 0), marks_ = Field<std::uint8_t>(total_, 0);
    }
    void put_back(const std::vector<Kept>& cells) {
        for (const Kept& kept : cells)
            look_at(kept.cell), room_[kept.cell] = kept.room, lag_[kept.cell] = kept.lag;
    }
    void look_at(Offset c) {
        if (std::exchange(marks_[c], std::uint8_t{1}) == 0) cells_.push_back(c), next_[c] = open_of(c);
    }
    void forget(Offset c) { marks_[c] = 0, room_[c] = next_[c] = open_of(c), lag_[c] = came_[c] = 0; }
    void came(const Grid<Dim>& grid, const CellNumber<Dim>& number, Real volume) {
        const Offset c = grid.layout().at(number);
        if (open_of(c) == 0) return;
        look_at(c), came_[c] += volume / grid.volume(number);
    }
    /// Liquid, with a part of what it lags by. Full and dry cells stay what they are: the rest is
    /// volume defect.
    void put(Offset c, Real liquid, Real at_once, Field<Real>& fraction, Field<Real>& volume_defect) {
        constexpr Real little = 1e-6;  // of the cell: all at once
        const bool stays = liquid < little || next_[c] != open_of(c);
        const Real part = stays ? 0 : std::abs(lag_[c]) < little ? lag_[c] : at_once * lag_[c];
        lag_[c] -= part;
        if (fraction[c] != 0 && fraction[c] != 1) fraction[c] = liquid;
        volume_defect[c] = liquid - fraction[c] + part / room_[c];
    }
    /// Fractions of covered cells: what those beside them have, layer by layer from outside.
    void reconstruct_covered(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries, Real full,
                             Field<Real>& fraction, Field<Real>& volume_defect) {
        constexpr std::uint8_t known = 1, unknown = 2;
        std::vector<CoveredCell> covered_cells;
        for (const Offset c : cells_) {
            if (!(open_of(c) > 0 && next_[c] < covered * open_of(c))) continue;
            covered_cells.push_back({c, grid.layout().number(c)}), marks_[c] = unknown;
        }
        for (std::size_t left = covered_cells.size(); left > 0;) {
            for (CoveredCell& cell : covered_cells) {
                if (marks_[cell.cell] == known) continue;
                Real sum = 0;
                cell.beside = 0;
                for_each_beside(grid, boundaries, cell.number, [&](Offset b) {
                    if (marks_[b] != unknown && open_of(b) > 0) sum += fraction[b], ++cell.beside;
                });
                if (cell.beside > 0) sum /= cell.beside;
                cell.fraction = sum < 1 - full ? 0 : sum > full ? 1 : sum;
            }
            const std::size_t before = std::exchange(left, 0);
            for (CoveredCell& cell : covered_cells) {
                if (marks_[cell.cell] == known) continue;
                if (cell.beside == 0)
                    ++left;
                else
                    reconstruct(cell, fraction, volume_defect), marks_[cell.cell] = known;
            }
            if (left == before) break;
        }
        for (const CoveredCell& cell : covered_cells) marks_[cell.cell] = known;
    }
    void reconstruct(const CoveredCell& cell, Field<Real>& fraction, Field<Real>& volume_defect) {
        const Offset c = cell.cell;
        lag_[c] += (fraction[c] + volume_defect[c] - cell.fraction) * room_[c];
        fraction[c] = cell.fraction, volume_defect[c] = 0;
    }
    static void for_each_beside(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries,
                                const CellNumber<Dim>& cell, auto&& visit) {
        for (int a = 0; a < Dim; ++a)
            for (const int side : {-1, 1}) {
                if (a == Grid<Dim>::vertical) continue;
                CellNumber<Dim> beside = cell;
                const int n = grid.cells(a);
                beside[a] += side;
                if (boundaries.periodic(a)) beside[a] = (beside[a] + n) % n;
                if (grid.has(beside)) visit(grid.layout().at(beside));
            }
    }

    Offset total_ = 0;
    const Field<Real>* open_ = nullptr;
    Field<Real> room_, next_;  ///< of cells [-]; without the least that a cell keeps, at the end of the step
    Field<Real> lag_, came_;   ///< [-]
    Field<std::uint8_t> marks_;
    std::vector<Offset> cells_;       ///< that solids have some of, or had
    std::vector<Kept> before_, now_;  ///< the last step; after it
};

}  // namespace abrade::detail
