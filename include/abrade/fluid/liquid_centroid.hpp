#pragma once
// Where the liquid of a cell has its centre of mass: below the reconstructed surface, on the open side of a
// wall.

#include <abrade/fluid/volume_of_fluid.hpp>
#include <abrade/fluid/walls.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

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

/// From a cell's centre to the centre of mass of its liquid, in units of the cell. The liquid is what lies
/// below the reconstructed plane and, in cells that a wall cuts, on the open side of the wall's plane.
template <int Dim>
Point<Dim> liquid_centroid(const VolumeOfFluid<Dim>& liquid, const Walls<Dim>* walls, Offset c) noexcept {
    std::array<HalfSpace<Dim>, 2> halves;
    std::size_t count = 0;
    if (walls && walls->open_volume()[c] < 1)
        for (const WallCell<Dim>& w : walls->wall_cells(c, 1)) {
            HalfSpace<Dim>& open = halves[count++];
            const Grid<Dim>& grid = walls->grid();
            const CellNumber<Dim> cell = grid.layout().number(c);
            open.constant = w.normal.dot(grid.centre(cell) - w.point);
            for (int a = 0; a < Dim; ++a) open.slope[a] = w.normal[a] * grid.size(a, cell[a]);
        }
    const std::size_t of_wall = count;
    if (const Index i = liquid.plane_of(c); i >= 0) {
        const auto k = static_cast<std::size_t>(i);
        HalfSpace<Dim>& wet = halves[count++];
        wet.constant = of_wall > 0 ? liquid.planes().position[k] : liquid.planes().distance[k];
        for (int a = 0; a < Dim; ++a) wet.slope[a] = -liquid.planes().normal[static_cast<std::size_t>(a)][k];
    }
    if (count == 0) return Point<Dim>::Zero();
    constexpr Real least = 1e-12;  // of a cell: round-off decides where its centre is
    for (const std::size_t n : {count, of_wall}) {
        const PartOfCell<Dim> part = part_of_cell<Dim>({halves.data(), n});
        if (part.volume > least) return part.moment / part.volume;
    }
    return Point<Dim>::Zero();
}

}  // namespace abrade::detail
