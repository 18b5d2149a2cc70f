#pragma once
// How a step of HeightOfFluid ends: columns filled to their new volumes, and what went up through level faces
// for that.

#include <abrade/fluid/height/water_columns.hpp>
#include <abrade/fluid/mesh/water_cells.hpp>
#include <abrade/fluid/mesh/wet_rows.hpp>

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace abrade::detail {

/// Of columns that hold `next` [m3] from now on, within `rows`; `flux` [m3] holds what went through upright
/// faces, and gets what goes through level ones.
template <int Dim>
class ColumnRenewal {
    static constexpr int vertical = Grid<Dim>::vertical;

public:
    ColumnRenewal(WaterColumns<Dim>& water, const WetRows<Dim>& rows, std::vector<Real>& next,
                  FaceField<Dim>& flux)
        : water_(water), shape_(water.shape), rows_(rows), next_(next), flux_(flux),
          rises_(shape_.count(), 0), risen_(shape_.count()) {}

    /// Answers whether the surface of a column rose by more than a cell.
    bool run();
    /// Water that was put into cells, or taken out: it goes up to the surface beside what `run` found.
    void raise_by(std::span<const CellSource> sources);

private:
    static std::size_t at(auto i) noexcept { return static_cast<std::size_t>(i); }
    bool changes(Index n) const noexcept { return water_.changes(n, next_[at(n)]); }
    void renew_plane(int plane);

    WaterColumns<Dim>& water_;
    const HeightColumns<Dim>& shape_;
    const WetRows<Dim>& rows_;
    std::vector<Real>& next_;
    FaceField<Dim>& flux_;
    std::vector<Real> rises_;  ///< [column] what goes up through the level at work [m3]
    std::vector<typename WaterColumns<Dim>::Surface> risen_;  ///< [column] where the step leads
};

template <int Dim>
bool ColumnRenewal<Dim>::run() {
    water_.owe_nothing();
    rows_.for_each_plane([&](int plane) {
        for (int j = 0; j < shape_.across(); ++j) {
            const Index n = shape_.column(plane, j);
            if (water_.boundaries[vertical][1] == Boundary::outflow) {  // over the top
                const Real beyond = std::max(next_[at(n)] + water_.solid_in(n) - shape_.capacity(n), Real(0));
                flux_[vertical][shape_.cell(plane, j, shape_.levels())] = beyond;
                next_[at(n)] -= beyond;
            }
            if (changes(n)) risen_[at(n)] = water_.surface_of(plane, j, next_[at(n)], water_.top[at(n)]);
        }
    });
    std::vector<std::uint8_t> far(at(water_.grid.cells(0)), 0);
    rows_.for_each_plane([&](int plane) {
        renew_plane(plane);
        for (int j = 0; j < shape_.across(); ++j) {
            const Index n = shape_.column(plane, j);
            if (changes(n) && risen_[at(n)].level > water_.top[at(n)] + 1) far[at(plane)] = 1;
        }
    });
    shape_.parallel_for_each([&](int plane, int j, Index n) {
        if (changes(n)) water_.put(plane, j, n, next_[at(n)], risen_[at(n)]);
    });
    return std::ranges::any_of(far, [](std::uint8_t f) { return f != 0; });
}

/// From the bed up: what comes in sideways and finds no room in a cell goes up.
template <int Dim>
void ColumnRenewal<Dim>::renew_plane(int plane) {
    const Offset across = water_.layout.stride[0];
    struct Change {
        typename HeightColumns<Dim>::Surface surface;
        int low, high;
    };
    std::vector<Change> change(at(shape_.across()));
    int low = shape_.levels(), high = -1;
    for (int j = 0; j < shape_.across(); ++j) {
        const Index n = shape_.column(plane, j);
        Change& c = change[at(j)];
        c.surface = {water_.top[at(n)], 0, water_.height[at(n)]}, c.low = shape_.levels(), c.high = -1;
        if (!changes(n) || shape_.closed(n)) continue;
        c.surface = risen_[at(n)];
        c.low = std::min(c.surface.level, water_.top[at(n)]),
        c.high = std::max(c.surface.level, water_.top[at(n)]);
        low = std::min(low, c.low), high = std::max(high, c.high);
    }
    const auto fill = [&](int j, int k, Offset c) {
        const Change& of = change[at(j)];
        if (k < of.low || k > of.high) return Real(0);
        const Real now = k < of.surface.level ? 1 : k == of.surface.level ? of.surface.share : 0;
        return (now - std::exchange(water_.fraction[c], now)) * shape_.open(c) * shape_.volume(k);
    };
    if constexpr (Dim == 3) {
        Real* const __restrict rise = rises_.data() + shape_.column(plane, 0);
        for (int k = 0; k < shape_.levels(); ++k) {
            RowRange r = rows_.row(plane, k);
            if (k >= low && k <= high) r = {0, shape_.across()};
            if (r.empty()) continue;
            const Offset start = water_.layout.row_start(plane, k);
            const Real* const __restrict x = flux_[0].data() + start;
            const Real* const __restrict x_above = x + across;
            const Real* const __restrict y = flux_[1].data() + start;
            Real* const __restrict z = flux_[2].data() + start;
            if (k >= low && k <= high) {
                for (int j = r.begin; j < r.end; ++j) {
                    z[j] = rise[j];
                    rise[j] += x[j] - x_above[j] + y[j] - y[j + 1] - fill(j, k, start + j);
                }
                continue;
            }
#pragma omp simd
            for (int j = r.begin; j < r.end; ++j) {
                z[j] = rise[j];
                rise[j] += x[j] - x_above[j] + y[j] - y[j + 1];
            }
        }
    } else {
        RowRange r = rows_.row(plane, 0);
        if (low <= high) r = hull(r, {low, high + 1});
        Real rise = 0;
        for (int k = r.begin; k < r.end; ++k) {
            const Offset c = water_.layout.row_start(plane, 0) + k;
            flux_[vertical][c] = rise;
            rise += flux_[0][c] - flux_[0][c + across] - fill(0, k, c);
        }
    }
}

template <int Dim>
void ColumnRenewal<Dim>::raise_by(std::span<const CellSource> sources) {
    for (const CellSource& s : sources) {
        if (s.volume == 0) continue;
        const CellNumber<Dim> cell = water_.layout.number(s.cell);
        const Offset up = water_.layout.stride[vertical];
        Offset face = s.cell;
        // As far as `run` has counted: what it filled the column by above, it took for gone.
        const auto counted = [&](int k) {
            const RowRange r = rows_.row(cell[0], Dim == 3 ? k : 0);
            const int i = Dim == 3 ? cell[1] : k;
            return k <= water_.top[at(shape_.column(cell))] || (i >= r.begin && i < r.end);
        };
        for (int k = cell[vertical] + 1; k < shape_.levels() && counted(k); ++k)
            flux_[vertical][face += up] += s.volume;
    }
}

}  // namespace abrade::detail
