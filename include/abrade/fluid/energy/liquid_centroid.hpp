#pragma once
// Where the liquid of a cell has its centre of mass: below the reconstructed surface, on the open side of a
// wall.

#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>
#include <abrade/fluid/height/height_of_fluid.hpp>
#include <abrade/fluid/mesh/volume_tolerance.hpp>
#include <abrade/fluid/vof/volume_of_fluid.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace abrade::detail {

/// A half of space in units of a cell whose centre is the origin: constant + slope . xi > 0.
template <int Dim>
struct HalfSpace {
    Real constant = 0;
    Point<Dim> slope = Point<Dim>::Zero();

    Real at(const Point<Dim>& x) const noexcept { return constant + slope.dot(x); }
};

/// Volume of a part of the unit cell and its first moment about the cell's centre.
template <int Dim>
struct PartOfCell {
    Real volume = 0;
    Point<Dim> moment = Point<Dim>::Zero();
};

template <int Dim>
using Simplex = std::array<Point<Dim>, static_cast<std::size_t>(Dim) + 1>;

/// Adds what lies in all half-spaces of a simplex of volume `share`. Cut where a function is 0 on the edge
/// from its highest to its lowest corner, both parts are simplices again: exact for planes, and no difference
/// of large numbers for any normal.
template <int Dim>
void add_part(PartOfCell<Dim>& sum, const Simplex<Dim>& corner, Real share,
              std::span<const HalfSpace<Dim>> halves) noexcept {
    if (share == 0) return;
    if (halves.empty()) {
        Point<Dim> middle = corner[0];
        for (std::size_t k = 1; k < corner.size(); ++k) middle += corner[k];
        sum.volume += share;
        sum.moment += share / (Dim + 1) * middle;
        return;
    }
    std::array<Real, static_cast<std::size_t>(Dim) + 1> value;
    for (std::size_t k = 0; k < corner.size(); ++k) value[k] = halves[0].at(corner[k]);
    const auto least = static_cast<std::size_t>(std::min_element(value.begin(), value.end()) - value.begin());
    const auto most = static_cast<std::size_t>(std::max_element(value.begin(), value.end()) - value.begin());
    // The corner that a cut made is off 0 by round-off: without a margin it would be cut again, for ever.
    const Real none = 1e-14 * (std::abs(halves[0].constant) + halves[0].slope.template lpNorm<1>());
    if (!(value[most] > none)) return;
    if (!(value[least] < -none)) return add_part(sum, corner, share, halves.subspan(1));
    const Real t = value[most] / (value[most] - value[least]);
    const Point<Dim> cut = (1 - t) * corner[most] + t * corner[least];
    Simplex<Dim> upper = corner, lower = corner;
    upper[least] = lower[most] = cut;
    add_part(sum, upper, t * share, halves);
    add_part(sum, lower, (1 - t) * share, halves);
}

/// The part of the unit cell that lies in all half-spaces, by the simplices of its Dim! orders of axes
/// (H. Freudenthal 1942).
template <int Dim>
PartOfCell<Dim> part_of_cell(std::span<const HalfSpace<Dim>> halves) noexcept {
    PartOfCell<Dim> sum;
    std::array<int, static_cast<std::size_t>(Dim)> order{};
    for (int a = 0; a < Dim; ++a) order[static_cast<std::size_t>(a)] = a;
    do {
        Simplex<Dim> corner;
        corner[0] = Point<Dim>::Constant(-0.5);
        for (std::size_t k = 0; k < order.size(); ++k) {
            corner[k + 1] = corner[k];
            corner[k + 1][order[k]] += 1;
        }
        add_part(sum, corner, Dim == 3 ? 1.0 / 6 : 0.5, halves);
    } while (std::next_permutation(order.begin(), order.end()));
    return sum;
}

/// Of the plane of a wall, in units of the cell that it cuts.
template <int Dim>
HalfSpace<Dim> above_wall(const Grid<Dim>& grid, const CutCell<Dim>& wall) noexcept {
    const CellNumber<Dim> cell = grid.layout().number(wall.cell);
    HalfSpace<Dim> open{wall.normal.dot(grid.centre(cell) - wall.point)};
    for (int a = 0; a < Dim; ++a) open.slope[a] = wall.normal[a] * grid.size(a, cell[a]);
    return open;
}

/// Centre of the part of a cell below a plane along an axis, from the cell's centre [cell].
///
/// Sections across the axis hold a share that is a polynomial of degree Dim - 1 between the corners that the
/// plane meets, so two points of Gauss between each two of them are exact, and nothing cancels.
template <int Dim>
Real centroid_along(const CellPlane<Dim>& plane, int axis) noexcept {
    const auto a = static_cast<std::size_t>(axis), b = (a + 1) % Dim, c = (a + Dim - 1) % Dim;
    const Real slope = plane.normal[a];
    if (slope == 0) return 0;
    const auto section = [&](Real at) {
        const Real distance = plane.distance - slope * at;
        if constexpr (Dim == 2) {
            const Real across = std::max(std::abs(plane.normal[b]), Real(tiny<Real>));
            return std::clamp(0.5 + distance / across, Real(0), Real(1));
        } else {
            return fraction_below<2, Real>({plane.normal[b], plane.normal[c]}, distance);
        }
    };
    constexpr std::size_t corners = Dim == 2 ? 2 : 4;
    std::array<Real, corners + 2> end;
    for (std::size_t k = 0; k < corners; ++k) {
        Real reach = k % 2 == 0 ? 0.5 * plane.normal[b] : -0.5 * plane.normal[b];
        if constexpr (Dim == 3) reach += k < 2 ? 0.5 * plane.normal[c] : -0.5 * plane.normal[c];
        end[k] = std::clamp((plane.distance - reach) / slope, Real(-0.5), Real(0.5));
    }
    end[corners] = -0.5, end[corners + 1] = 0.5;
    std::sort(end.begin(), end.end());
    Real volume = 0, moment = 0;
    for (std::size_t k = 0; k + 1 < end.size(); ++k) {
        const Real half = 0.5 * (end[k + 1] - end[k]), middle = 0.5 * (end[k + 1] + end[k]);
        if (half == 0) continue;
        for (const Real node : {-0.57735026918962576, 0.57735026918962576}) {
            const Real at = middle + node * half, share = half * section(at);
            volume += share, moment += share * at;
        }
    }
    return volume > 0 ? moment / volume : 0;
}

/// Projection of the way from a cell's centre to that of what a wall leaves open of it; `along` in units of
/// the cell.
template <int Dim>
Real offset_above_wall(const EmbeddedBoundary<Dim>& walls, const CutCell<Dim>& wall,
                       const Point<Dim>& along) noexcept {
    const HalfSpace<Dim> open = above_wall(walls.grid(), wall);
    const PartOfCell<Dim> part = part_of_cell<Dim>({&open, 1});
    return part.volume > volume_tolerance::round_off ? along.dot(part.moment) / part.volume : 0;
}

/// The same to the centre of mass of a cell's liquid: what lies below the reconstructed plane and, in cells
/// that a wall cuts, above the wall's plane.
template <int Dim>
Real liquid_offset(const VolumeOfFluid<Dim>& liquid, const EmbeddedBoundary<Dim>* walls, Offset c,
                   const Point<Dim>& along) noexcept {
    const CutCell<Dim>* wall = nullptr;
    if (walls && walls->open_fraction()[c] < 1)
        if (const auto here = walls->cut_cells(c, 1); !here.empty()) wall = &here.front();
    const Index i = liquid.plane_of(c);
    if (i < 0) return wall ? offset_above_wall(*walls, *wall, along) : 0;
    const CellPlane<Dim> plane = liquid.planes().plane(i);
    if (!wall) {
        Real sum = 0;
        for (int a = 0; a < Dim; ++a)
            if (along[a] != 0) sum += along[a] * centroid_along(plane, a);
        return sum;
    }
    std::array<HalfSpace<Dim>, 2> halves;
    halves[0].constant = liquid.planes().position[static_cast<std::size_t>(i)];
    for (int a = 0; a < Dim; ++a) halves[0].slope[a] = -plane.normal[static_cast<std::size_t>(a)];
    halves[1] = above_wall(walls->grid(), *wall);
    const PartOfCell<Dim> part = part_of_cell<Dim>(halves);
    return part.volume > volume_tolerance::round_off ? along.dot(part.moment) / part.volume
                                                     : offset_above_wall(*walls, *wall, along);
}

/// The same below a height.
template <int Dim>
Real liquid_offset(const HeightOfFluid<Dim>& liquid, const EmbeddedBoundary<Dim>* walls, Offset c,
                   const Point<Dim>& along) noexcept {
    constexpr int vertical = Grid<Dim>::vertical;
    const CutCell<Dim>* wall = nullptr;
    if (walls && walls->open_fraction()[c] < 1)
        if (const auto here = walls->cut_cells(c, 1); !here.empty()) wall = &here.front();
    const Real f = liquid.fraction()[c];
    if (!(f > 0 && f < 1)) return wall ? offset_above_wall(*walls, *wall, along) : 0;
    if (!wall) return -0.5 * (1 - f) * along[vertical];
    const Grid<Dim>& grid = liquid.grid();
    const int level = grid.layout().number(c)[vertical];
    std::array<HalfSpace<Dim>, 2> halves;
    halves[0].constant =
        (liquid.height(liquid.columns().column(grid.layout().number(c))) - grid.centre(vertical, level)) /
        grid.size(vertical, level);
    halves[0].slope[vertical] = -1;
    halves[1] = above_wall(grid, *wall);
    const PartOfCell<Dim> part = part_of_cell<Dim>(halves);
    return part.volume > volume_tolerance::round_off ? along.dot(part.moment) / part.volume
                                                     : offset_above_wall(*walls, *wall, along);
}

/// Whether the surface decides where in a cell its liquid is, and the cells where it does.
template <int Dim>
bool surface_cuts(const VolumeOfFluid<Dim>& liquid, Offset c) noexcept {
    return liquid.plane_of(c) >= 0;
}
template <int Dim>
bool surface_cuts(const HeightOfFluid<Dim>& liquid, Offset c) noexcept {
    return liquid.fraction()[c] > 0 && liquid.fraction()[c] < 1;
}
template <int Dim>
std::span<const Index> cells_at_surface(const VolumeOfFluid<Dim>& liquid) noexcept {
    return liquid.planes().cell;
}
template <int Dim>
std::vector<Index> cells_at_surface(const HeightOfFluid<Dim>& liquid) {
    std::vector<Index> cells;
    liquid.grid().for_each([&](const CellNumber<Dim>&, Offset c) {
        if (surface_cuts(liquid, c)) cells.push_back(static_cast<Index>(c));
    });
    return cells;
}

}  // namespace abrade::detail
