#pragma once
// How walls that cut cells change the friction between neighbouring water.

#include <abrade/fluid/embedded_boundary/cut_faces.hpp>

#include <algorithm>
#include <array>
#include <cstdint>

namespace abrade::detail {

/// [a][b]: for the sides along b of the control volumes of velocity component a, what walls leave open of
/// them over the distance of the centroids of both faces (open_over_distance) [1/cell]. 0 beside a closed
/// face: WallFriction gives its wall to the faces around.
template <int Dim>
PerAxis<FaceField<Dim, float>, Dim> open_friction_of(const EmbeddedBoundary<Dim>& walls,
                                                     const BoundaryConditions<Dim>& boundaries) {
    const Grid<Dim>& grid = walls.grid();
    const Layout<Dim>& layout = grid.layout();
    Field<std::int32_t> wall_in(layout.total, -1);
    const auto cut_cells = walls.cut_cells();
    for (std::size_t n = 0; n < cut_cells.size(); ++n)
        wall_in[cut_cells[n].cell] = static_cast<std::int32_t>(n);
    fill_periodic(wall_in, layout, boundaries);
    const auto wall_about = [&](Offset face, Offset back) {
        Point<Dim> area = Point<Dim>::Zero();
        for (const Offset c : {face, face - back})
            if (const auto n = wall_in[c]; n >= 0) {
                const auto& wall = cut_cells[static_cast<std::size_t>(n)];
                area += wall.area * wall.normal;
            }
        return area;
    };
    PerAxis<FaceField<Dim, float>, Dim> friction;
    for (int a = 0; a < Dim; ++a)
        for (int b = 0; b < Dim; ++b) {
            friction[a][b] = Field<float>(layout.total, 1);
            const Field<Real>&area = walls.aperture()[b], &face = walls.aperture()[a];
            const Offset back = layout.stride[a], across = layout.stride[b];
            const auto at_side = [&](const CellNumber<Dim>& cell, Offset c) {
                if (std::ranges::any_of(cell, [](int i) { return i < 0; })) return;  // no side of the box
                const std::array<Real, 2> faces{face[c - across], face[c]};
                Real open = 0.5 * (area[c] + area[c - back]);
                if (open == 1 && faces[0] == 1 && faces[1] == 1) return;
                const int first = a == b ? 2 : 1;
                const bool inside = boundaries.periodic(b) || (cell[b] >= first && cell[b] < grid.cells(b));
                if (inside && (faces[0] == 0 || faces[1] == 0)) open = 0;
                if (open > 0 && (faces[0] < 1 || faces[1] < 1)) {
                    Point<Dim> size;
                    for (int t = 0; t < Dim; ++t) size[t] = grid.size(t, cell[t]);
                    open = open_over_distance<Dim>(
                        size, {a, b}, {wall_about(c - across, back), wall_about(c, back)}, faces, open);
                }
                friction[a][b][c] = static_cast<float>(open);
            };
            grid.for_each(at_side, 1);
        }
    return friction;
}

}  // namespace abrade::detail
