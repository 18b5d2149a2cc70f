#pragma once
// What a body covers of a staggered grid, and the numbers of cells beyond that grid's sides.

#include <abrade/fluid/mesh/interpolation.hpp>
#include <abrade/fluid/pressure/solids_in_flow.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace abrade {

/// A face of whose control volume, which lies half in either cell, a body covers some, or whose centre is
/// less than a cell from its surface.
struct SolidFace {
    Offset face = 0;  ///< of the velocity component
    Offset low = 0;   ///< of the cell below it, across a periodic side where there is one
    int axis = 0;
    int plane = 0;            ///< of the face, across the longest axis; the last of the upper side's, too
    Real share = 0;           ///< sigma, of the control volume [-]
    Real core = 0;            ///< share of a body whose surface is retracted [-]
    Real friction = 0;        ///< rate of friction over C nu [1/m2]
    Real area = 0, gap = 0;   ///< of the face [m2]; between the centres of its cells [m]
    Vec3 arm = Vec3::Zero();  ///< from the body's centroid to the face's centre [m]

    Real volume() const noexcept { return area * gap; }
};

/// A cell of which a body covers some. As the body moves by V dt and turns by W dt it gives
/// dt (way . V + turn . W) to the cells around; and, beside a pocket, what comes from there.
struct SolidCell {
    Offset cell = 0;
    Vec3 area = Vec3::Zero();         ///< [m2]
    Vec3 area_moment = Vec3::Zero();  ///< [m3]
    Vec3 arm = Vec3::Zero();          ///< from the body's centroid to the cell's centre [m]
};

/// A body on the grid.
struct SolidCover {
    std::vector<SolidFace> faces;
    std::vector<SolidCell> cells;   ///< of which it covers some; later those of them that have a pressure
    std::vector<SolidCell> inside;  ///< and those that have none (CoveredFaces::find_closed_cells)
    std::vector<SolidPart> parts;   ///< its volume in cells
    bool cut = false;               ///< some of it lies beyond a side where water flows in or out
    bool averaged = false;          ///< too small for its shape to count: it has its part in a cloud

    void clear() noexcept { faces.clear(), cells.clear(), inside.clear(), parts.clear(), cut = false; }
};

namespace detail {

/// Numbers of cells and faces that go on beyond a box.
struct GridNumbers {
    const Grid<3>& grid;
    const BoundaryConditions<3>& boundaries;

    Real size(int a, int i) const noexcept { return grid.size(a, std::clamp(i, 0, grid.cells(a) - 1)); }
    /// Lower face of cell i, which may be one beyond the ghosts.
    Real face(int a, int i) const noexcept {
        const int n = grid.cells(a);
        if (i < 0) return grid.low(a) + i * size(a, 0);
        if (i > n) return grid.high(a) + (i - n) * size(a, n - 1);
        return grid.face(a, i);
    }
    Real centre(int a, int i) const noexcept { return face(a, i) + 0.5 * size(a, i); }
    int cell_at(int a, Real x) const noexcept {
        const int n = grid.cells(a);
        if (x < grid.low(a)) return static_cast<int>(std::floor((x - grid.low(a)) / size(a, 0)));
        if (x >= grid.high(a)) return n + static_cast<int>((x - grid.high(a)) / size(a, n - 1));
        const bool even = a != Grid<3>::vertical || grid.uniform();
        return detail::place_between(x, 0, n, size(a, 0), even, [&](int i) { return grid.face(a, i); }).low;
    }
    int wrapped(int a, int i) const noexcept {
        const int n = grid.cells(a);
        return boundaries.periodic(a) ? (i % n + n) % n : i;
    }
    /// Of a cube as large as the cell about a point [m].
    Real cell_width(const Vec3& x) const noexcept {
        Real volume = 1;
        for (int a = 0; a < 3; ++a) volume *= size(a, cell_at(a, x[a]));
        return std::cbrt(volume);
    }
};

}  // namespace detail

}  // namespace abrade
