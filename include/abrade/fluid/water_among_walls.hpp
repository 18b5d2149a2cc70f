#pragma once
// How much of what walls leave open of a cell lies in the water of the start.

#include <abrade/fluid/grid.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace abrade::detail {

/// Of what lies of a cell in the open, the share in the water; each is where a function is above 0.
///
/// The cell is cut in half `Levels` times along each axis and its parts into simplices, one for each order of
/// the axes (H. Freudenthal 1942); in a simplex both functions are linear. Of two planes that cross in one
/// cell the share is exact, which that of the lesser function is not: between two corners this has a kink.
template <int Dim>
class WaterAmongWalls {
public:
    using Both = std::array<Real, 2>;  ///< wall, water

    /// `both` answers at places in the cell, 0 to 1 along each axis [-]. What is closed holds none.
    template <int Levels>
    static Real share(const auto& both) {
        constexpr int parts = 1 << Levels, points = parts + 1;
        constexpr auto count = [](int along) { return Dim == 3 ? along * along * along : along * along; };
        std::array<Both, static_cast<std::size_t>(count(points))> value;
        for (int n = 0; n < count(points); ++n) {
            Point<Dim> x;
            for (int a = 0, rest = n; a < Dim; ++a, rest /= points)
                x[a] = static_cast<Real>(rest % points) / parts;
            value[static_cast<std::size_t>(n)] = both(x);
        }
        Real open = 0, wet = 0;
        for (int part = 0; part < count(parts); ++part) {
            int lowest = 0;
            for (int a = 0, rest = part, step = 1; a < Dim; ++a, rest /= parts, step *= points)
                lowest += rest % parts * step;
            std::array<int, Dim> order{};
            for (int a = 0; a < Dim; ++a) order[static_cast<std::size_t>(a)] = a;
            do {
                Simplex corner;
                int n = lowest;
                corner[0] = value[static_cast<std::size_t>(n)];
                for (std::size_t k = 0; k < Dim; ++k) {
                    n += order[k] == 0 ? 1 : order[k] == 1 ? points : points * points;
                    corner[k + 1] = value[static_cast<std::size_t>(n)];
                }
                open += positive(corner, 0, 1), wet += positive(corner, 0, 2);
            } while (std::next_permutation(order.begin(), order.end()));
        }
        return open > 0 ? wet / open : 0;
    }
    static Real share(const Grid<Dim>& grid, const CellNumber<Dim>& cell, const auto& wall,
                      const auto& water) {
        return share<1>([&](const Point<Dim>& unit) {
            Point<Dim> x;
            for (int a = 0; a < Dim; ++a) x[a] = grid.face(a, cell[a]) + grid.size(a, cell[a]) * unit[a];
            return Both{wall(x), water(x)};
        });
    }

private:
    using Simplex = std::array<Both, Dim + 1>;

    /// Share of a simplex where functions `which` up to, not including, `end` are above 0.
    static Real positive(const Simplex& corner, std::size_t which, std::size_t end) noexcept {
        if (which == end) return 1;
        std::size_t most = 0, least = 0;
        for (std::size_t k = 1; k <= Dim; ++k) {
            if (corner[k][which] > corner[most][which]) most = k;
            if (corner[k][which] < corner[least][which]) least = k;
        }
        const Real high = corner[most][which], low = corner[least][which];
        if (!(high > 0)) return 0;
        if (!(low < 0)) return positive(corner, which + 1, end);
        // Cut where it is 0 between those two: both parts are simplices again.
        const Real t = high / (high - low);
        Both cut;
        for (std::size_t f = 0; f < 2; ++f) cut[f] = (1 - t) * corner[most][f] + t * corner[least][f];
        cut[which] = 0;
        Simplex upper = corner, lower = corner;
        upper[least] = lower[most] = cut;
        return t * positive(upper, which, end) + (1 - t) * positive(lower, which, end);
    }
};

}  // namespace abrade::detail
