#pragma once
// Faces between wet cells and air, at which the pressure is known to be 0.

#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>
#include <abrade/fluid/mesh/water_cells.hpp>

#include <span>
#include <vector>

namespace abrade::detail {

/// Found anew for each surface.
template <int Dim>
class OpenFaces {
    static constexpr int inner = Layout<Dim>::inner, outer = Layout<Dim>::outer,
                         vertical = Grid<Dim>::vertical;
    /// Nearer to a cell's centre than this share of the way to the next one the surface is taken to be here:
    /// conductances grow as its inverse.
    static constexpr Real least_share = 1e-8;

public:
    OpenFaces(const Grid<Dim>& grid, const EmbeddedBoundary<Dim>* walls)
        : grid_(&grid), walls_(walls), of_plane_(static_cast<std::size_t>(grid.layout().planes())) {}

    /// Below the surface of `liquid`; `outflows`: those where water leaves the box.
    void find(const auto& liquid, const Field<std::uint8_t>& wet, const WetRows<Dim>& rows,
              std::vector<OpenFace> outflows) {
        const Layout<Dim>& layout = grid_->layout();
        rows.for_each_plane([&](int plane) {
            auto& open = of_plane_[static_cast<std::size_t>(plane)];
            open.clear();
            for (int row = 0; row < layout.rows_per_plane(); ++row) {
                const Offset start = layout.row_start(plane, row);
                for_edge_cells(wet, layout, start, rows.row(plane, row), [&](int i) {
                    if (!walls_ || walls_->open_fraction()[start + i] > 0)
                        add(open, liquid, wet, start + i, {plane, row, i});
                });
            }
        });
        open_ = std::move(outflows);
        still_.clear();
        for (const auto& found : of_plane_)
            for (const OpenFace& open : found)
                if (open.slope != 0)
                    open_.push_back(open);
                else
                    still_.push_back({open.face, open.axis});
    }

    std::span<const OpenFace> open() const noexcept { return open_; }
    /// Faces of wet cells to cells that are dry for their wall alone: they move as what is beside them did.
    std::span<const WaterFace> still() const noexcept { return still_; }

    static void fields(auto&& field) {
        field.bytes("open", &OpenFaces::open_), field.bytes("still", &OpenFaces::still_);
    }

private:
    struct Place {
        int plane, row, i;
    };
    /// The faces between a dry cell and its wet neighbours.
    void add(std::vector<OpenFace>& open, const auto& liquid, const Field<std::uint8_t>& wet_cells, Offset c,
             const Place& place) const {
        const auto add_along = [&](int a, int number) {
            const Offset s = grid_->layout().stride[a];
            const int level = Dim == 3 ? place.row : place.i, up = a == vertical;
            // `above`: 1 where the wet cell is the upper one, -1 where it is the lower.
            const auto add = [&](Offset face, int above) {
                Offset wet = above > 0 ? c + s : c - s;
                if (wet_cells[wet] == 0 || (walls_ && walls_->aperture()[a][face] == 0)) return;
                const Real plain = above / grid_->gap(a, above > 0 ? number + 1 : number);
                const Real share = liquid.surface_share(wet, level + above * up, a, -above, least_share);
                // Across a periodic side: what is meant stands at the other end.
                const int end = number + above;
                const Offset around = (end < 0 ? 1 : end < grid_->cells(a) ? 0 : -1) * grid_->cells(a) * s;
                wet += around, face += above > 0 ? around : 0;
                if (walls_ && liquid.is_wall_dry(c))
                    open.push_back({face, wet, a});
                else
                    open.push_back(with_inertia({face, wet, a, plain / share, plain}, share, liquid));
            };
            add(c + s, 1);
            add(c, -1);
        };
        add_along(outer, place.plane);
        add_along(inner, place.i);
        if constexpr (Dim == 3) add_along(Dim - 1, place.row);
    }

    /// A cell's pressure that is 0 at its surface pushes all that enters the cell through that face. Where
    /// walls leave less of the face than of another one of the cell, or solids take some of either, it would
    /// shoot out: so the face has the inertia of half the way to the next centre at least, of which only what
    /// lies below the surface has weight. At rest that is the same.
    OpenFace with_inertia(OpenFace open, Real share, const auto& liquid) const {
        constexpr Real least_way = 0.5;
        if (share >= least_way) return open;
        bool shoots = liquid.has_solid(open.cell);
        const CellNumber<Dim> cell = grid_->layout().number(open.cell);
        const auto area = [&](int a, Offset face) {
            return walls_->aperture()[a][face] / grid_->size(a, cell[a]);
        };
        const Real own = walls_ ? area(open.axis, open.face) : 0;
        for (int a = 0; a < Dim && walls_; ++a)
            for (const Offset face : {open.cell, open.cell + grid_->layout().stride[a]})
                shoots |= area(a, face) > own;
        if (shoots) open.slope = open.plain / least_way, open.weight = share / least_way;
        return open;
    }

    const Grid<Dim>* grid_;
    const EmbeddedBoundary<Dim>* walls_;
    std::vector<OpenFace> open_;
    std::vector<WaterFace> still_;
    std::vector<std::vector<OpenFace>> of_plane_;  ///< [plane]
};

}  // namespace abrade::detail
