#pragma once
// How high the water stands: the floor and what stands on it, column by column.

#include <abrade/core/fields.hpp>
#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>
#include <abrade/fluid/mesh/interpolation.hpp>
#include <abrade/fluid/mesh/wet_rows.hpp>

#include <vector>

namespace abrade::detail {

template <int Dim>
class SurfaceHeights {
    static constexpr int vertical = Grid<Dim>::vertical;

public:
    SurfaceHeights() = default;
    /// `walls` may be none.
    SurfaceHeights(const Grid<Dim>& grid, const PerAxis<bool, Dim>& periodic,
                   const EmbeddedBoundary<Dim>* walls)
        : periodic_(periodic), across_(Dim == 3 ? grid.cells(1) : 1),
          dry_(column(grid.cells(0), 0), grid.low(vertical)) {
        if (walls)
            grid.for_each([&](const CellNumber<Dim>& cell, Offset c) {
                dry_[column(cell[0], Dim == 3 ? cell[1] : 0)] +=
                    grid.size(vertical, cell[vertical]) * (1 - walls->open_fraction()[c]);
            });
    }

    /// `liquid_fraction`: liquid in a cell as a share of the whole cell [-], none outside of `rows`.
    void find(const Grid<Dim>& grid, const WetRows<Dim>& rows, const Field<Real>& liquid_fraction) {
        heights_ = dry_;
        rows.for_each_row([&](int plane, int row, const RowRange& r) {
            const Real* const liquid = liquid_fraction.data() + grid.layout().row_start(plane, row);
            Real* const heights = heights_.data() + column(plane, 0);
            if constexpr (Dim == 3) {
                const Real size = grid.size(vertical, row);
                for (int j = r.begin; j < r.end; ++j) heights[j] += size * liquid[j];
            } else {
                for (int k = r.begin; k < r.end; ++k) heights[0] += grid.size(vertical, k) * liquid[k];
            }
        });
    }

    /// At a place in the plane, linear between the middles of columns [m].
    Real at(const Grid<Dim>& grid, const Point<Dim>& x) const noexcept {
        PerAxis<int, 2> low{}, high{};
        PerAxis<Real, 2> weight{};
        for (int a = 0; a < Dim - 1; ++a) {
            const GridPlace place = place_among_centres(grid, a, x[a], periodic_[a]);
            const int n = grid.cells(a);
            low[a] = (place.low + n) % n, weight[a] = place.weight;
            high[a] = periodic_[a] ? (low[a] + 1) % n : std::min(low[a] + 1, n - 1);
        }
        const auto along = [&](int j) {
            return (1 - weight[0]) * heights_[column(low[0], j)] + weight[0] * heights_[column(high[0], j)];
        };
        if constexpr (Dim == 2) return along(0);
        return (1 - weight[1]) * along(low[1]) + weight[1] * along(high[1]);
    }

    static void fields(auto&& field) { field("heights", "m", &SurfaceHeights::heights_); }

private:
    std::size_t column(int plane, int across) const noexcept {
        return static_cast<std::size_t>(plane) * static_cast<std::size_t>(across_) +
               static_cast<std::size_t>(across);
    }

    PerAxis<bool, Dim> periodic_{};
    int across_ = 1;
    std::vector<Real> dry_, heights_;  ///< of walls alone; of all [m]
};

}  // namespace abrade::detail
