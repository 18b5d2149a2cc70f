#pragma once
// How much of what a wall leaves open of a cell lies in the water.

#include <abrade/fluid/mesh/grid.hpp>
#include <abrade/fluid/vof/plic.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace abrade::detail {

/// Of what lies of a cell in the open, the share in the water. The cell's wall is the plane that its open
/// faces and its open volume tell: so the surface of water at rest, which is found by the same rule, stays
/// where it began.
///
/// The cell is cut into simplices, one for each order of the axes (H. Freudenthal 1942); in a simplex both
/// functions are linear. Of two planes that cross in one cell the share is exact, which that of the lesser
/// function is not: between two corners this has a kink.
template <int Dim>
class WaterAmongWalls {
public:
    /// `apertures`, `open_fraction`: what is open of the cell `c` [-]. `water` answers at places in it, 0 to
    /// 1 along each axis: above 0 in the water.
    static Real share(const FaceField<Dim>& apertures, const PerAxis<Offset, Dim>& stride, Offset c,
                      Real open_fraction, const auto& water) {
        std::array<Real, Dim> wall;  // its area, into the open
        Real size = 0;
        for (int a = 0; a < Dim; ++a) {
            wall[at(a)] = apertures[a][c + stride[at(a)]] - apertures[a][c];
            size += std::abs(wall[at(a)]);
        }
        const Real solid = size > 0 ? plane_distance<Dim>(wall, 1 - open_fraction) : -1;
        constexpr int corners = 1 << Dim;
        std::array<Both, corners> value;
        for (int n = 0; n < corners; ++n) {
            Point<Dim> x;
            Real in_the_open = -solid;
            for (int a = 0; a < Dim; ++a) {
                x[a] = n >> a & 1;
                in_the_open += wall[at(a)] * (x[a] - 0.5);
            }
            value[at(n)] = {in_the_open, water(x)};
        }
        Real open = 0, wet = 0;
        std::array<int, Dim> order{};
        for (int a = 0; a < Dim; ++a) order[at(a)] = a;
        do {
            Simplex corner{value[0]};
            for (int n = 0, k = 0; k < Dim; ++k) corner[at(k + 1)] = value[at(n |= 1 << order[at(k)])];
            open += positive(corner, 0, 1), wet += positive(corner, 0, 2);
        } while (std::next_permutation(order.begin(), order.end()));
        return open > 0 ? wet / open : 0;
    }

private:
    using Both = std::array<Real, 2>;  ///< wall, water: above 0 in the open, in the water
    using Simplex = std::array<Both, Dim + 1>;
    static std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

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
