#pragma once
// Water that walls squeeze through what they leave open of a face.

#include <abrade/fluid/walls.hpp>
#include <abrade/fluid/water_cells.hpp>

#include <algorithm>
#include <cmath>
#include <span>

namespace abrade::detail {

/// A wet cell has no divergence though it may not be full yet: what enters it leaves it through its surface.
/// Where walls leave little of that face open, and the surface holds the pressure near 0, all of it would
/// shoot out there, a hundred times as fast as it came. Such a face is no faster than the fastest
/// other one of its cell: the cell fills first. No volume is lost by that, since liquid goes by any velocity.
template <int Dim>
void limit_narrow_faces(FaceField<Dim>& u, const Walls<Dim>& walls, std::span<const OpenFace> open) {
    constexpr Real narrow = 0.5;  // open share of a face
    const Layout<Dim>& layout = walls.grid().layout();
    for (const OpenFace& f : open) {
        if (walls.open_area()[f.axis][f.face] >= narrow) continue;
        Real fastest = 0;
        for (int a = 0; a < Dim; ++a)
            for (const Offset face : {f.cell, f.cell + layout.stride[a]})
                if ((a != f.axis || face != f.face) && walls.open_area()[a][face] > 0)
                    fastest = std::max(fastest, std::abs(u[a][face]));
        Real& speed = u[f.axis][f.face];
        speed = std::clamp(speed, -fastest, fastest);
    }
}

}  // namespace abrade::detail
