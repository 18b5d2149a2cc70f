#pragma once
// What leaves cells through their faces.

#include <abrade/fluid/mesh/level_table.hpp>
#include <abrade/fluid/pressure/poisson.hpp>

#include <bit>
#include <cstdint>
#include <type_traits>

namespace abrade::detail {

/// Area of a face along an axis of cells at a level [m2]; [m] in 2-D.
template <int Dim>
Real area_of_face(const Grid<Dim>& grid, int axis, int level) noexcept {
    Real product = 1;
    for (int a = 0; a < Dim; ++a)
        if (a != axis) product *= grid.size(a, a == Grid<Dim>::vertical ? level : 0);
    return product;
}

/// The right side of the pressure's equation, b = -(net outflow of a cell) + what it is to lose, computed in
/// `State` from velocities; and the largest speed.
template <int Dim, class State>
class NetOutflow {
    using Bits = std::conditional_t<sizeof(State) == 8, std::int64_t, std::int32_t>;

public:
    explicit NetOutflow(const Grid<Dim>& grid) {
        for (int b = 0; b < Dim; ++b) {
            area_[b] = Table(grid, [&](int k) { return area_of_face(grid, b, k); });
            per_size_[b] = Table(grid, [&](int k) { return 1 / grid.size(b, b == Dim - 1 ? k : 0); });
        }
    }

    /// Without walls shares are not read, nor are volumes and volume defects where there are none.
    struct Shares {
        const FaceField<Dim>* aperture;
        const Field<Real>* open_fraction;
        const Field<Real>*
            volume_defect;     ///< to be lost within `relaxation_time`, in shares of the open volume [-]
        Real relaxation_time;  ///< [s]
    };
    struct Sums {
        Real squares = 0;  ///< of b [m6/s2]
        Real fastest = 0;  ///< largest sum |u_a| / h_a over cells that take part [1/s]
    };

    /// Fills b on a plane.
    Sums of(const FaceField<Dim, State>& u, const Shares& shares, const Poisson<Dim>& m, Field<float>& right,
            int plane) const {
        Real total = 0;
        State fastest = 0;
        for (int row = 0; row < m.layout.rows_per_plane(); ++row) {
            const RowRange r = m.range(plane, row);
            if (r.empty()) continue;
            const Offset start = m.layout.row_start(plane, row);
            // Flat, not an array: so that loops see plain numbers.
            const auto area0 = area_[0].row(row), area1 = area_[1].row(row), area2 = area_[Dim - 1].row(row);
            const auto per0 = per_size_[0].row(row), per1 = per_size_[1].row(row),
                       per2 = per_size_[Dim - 1].row(row);
            PerAxis<const State*, 3> low{}, high{};
            PerAxis<const Real*, 3> low_open{}, high_open{};
            for (int a = 0; a < Dim; ++a) {
                low[a] = u[a].data() + start, high[a] = low[a] + m.layout.stride[a];
                if (shares.aperture)
                    low_open[a] = (*shares.aperture)[a].data() + start,
                    high_open[a] = low_open[a] + m.layout.stride[a];
            }
            float* const __restrict b = right.data() + start;
            const float* const __restrict inverse = m.inverse_diagonal.data() + start;
            const Real* const volume_defect =
                shares.volume_defect ? shares.volume_defect->data() + start : nullptr;
            const Real* const volume = shares.open_fraction ? shares.open_fraction->data() + start : nullptr;
            const auto per_step = static_cast<State>(1 / shares.relaxation_time);
            State sum = 0;
            // Reals from 0 on compare as their bits do, and clang++ has packs for the largest of these only.
            auto most = std::bit_cast<Bits>(fastest);
            const auto all = [&]<bool Open, bool Defect>() {
#pragma omp simd reduction(+ : sum) reduction(max : most)
                for (int i = r.begin; i < r.end; ++i) {
                    const auto net = [&](State area, const State* from, const State* to,
                                         const Real* from_open, const Real* to_open) {
                        if constexpr (Open)
                            return area * (to[i] * static_cast<State>(to_open[i]) -
                                           from[i] * static_cast<State>(from_open[i]));
                        else
                            return area * (to[i] - from[i]);
                    };
                    State out = net(area0[i], low[0], high[0], low_open[0], high_open[0]) +
                                net(area1[i], low[1], high[1], low_open[1], high_open[1]);
                    State rate = std::abs(low[0][i]) * per0[i] + std::abs(low[1][i]) * per1[i];
                    if constexpr (Dim == 3) {
                        out += net(area2[i], low[2], high[2], low_open[2], high_open[2]);
                        rate += std::abs(low[2][i]) * per2[i];
                    }
                    if constexpr (Defect) {
                        const Real beyond = Open ? volume_defect[i] * volume[i] : volume_defect[i];
                        out -= static_cast<State>(beyond) * per_step * (area0[i] / per0[i]);
                    }
                    out = inverse[i] > 0 ? out : State(0);
                    b[i] = static_cast<float>(-out);
                    sum += out * out;
                    most = std::max(most, std::bit_cast<Bits>(inverse[i] > 0 ? rate : State(0)));
                }
            };
            if (shares.aperture)
                volume_defect ? all.template operator()<true, true>()
                              : all.template operator()<true, false>();
            else
                volume_defect ? all.template operator()<false, true>()
                              : all.template operator()<false, false>();
            fastest = std::bit_cast<State>(most);
            total += static_cast<Real>(sum);
        }
        return {total, static_cast<Real>(fastest)};
    }

private:
    using Table = LevelTable<Dim, State>;
    PerAxis<Table, Dim> area_, per_size_;  ///< [m2], [1/m]
};

}  // namespace abrade::detail
