#pragma once
// How walls that cut cells change the friction between neighbouring water.

#include <abrade/fluid/walls.hpp>

#include <algorithm>

namespace abrade::detail {

/// [a][b]: for the sides along b of the control volumes of velocity component a, the share that walls leave
/// open over the distance between the middles of what they leave open of both volumes [1/cell].
template <int Dim>
PerAxis<FaceField<Dim, float>, Dim> open_friction_of(const Walls<Dim>& walls, const Sides<Dim>& sides) {
    const Grid<Dim>& grid = walls.grid();
    const Layout<Dim>& layout = grid.layout();
    // How far the middle of what is open of a cell lies from the cell's, in cells.
    FaceField<Dim> middle = face_field<Dim>(layout);
    for (const WallCell<Dim>& w : walls.wall_cells())
        for (int b = 0; b < Dim; ++b)
            middle[b][w.cell] = 0.5 * (1 - walls.open_volume()[w.cell]) * w.normal[b];
    fill_periodic(middle, layout, sides);
    PerAxis<FaceField<Dim, float>, Dim> friction;
    for (int a = 0; a < Dim; ++a)
        for (int b = 0; b < Dim; ++b) {
            friction[a][b] = Field<float>(layout.total, 1);
            const Field<Real>& area = walls.open_area()[b];
            const Field<Real>& m = middle[b];
            const Offset back = layout.stride[a], across = layout.stride[b];
            const auto at_side = [&](const CellNumber<Dim>& cell, Offset c) {
                if (std::ranges::any_of(cell, [](int i) { return i < 0; })) return;  // no side of the box
                const Real gap = 1 + 0.5 * (m[c] + m[c - back] - m[c - across] - m[c - back - across]);
                friction[a][b][c] =
                    static_cast<float>(0.5 * (area[c] + area[c - back]) / std::max(gap, 0.25));
            };
            grid.for_each(at_side, 1);
        }
    return friction;
}

}  // namespace abrade::detail
