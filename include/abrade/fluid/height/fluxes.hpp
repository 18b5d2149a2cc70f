#pragma once
// What flows sideways between columns of liquid below a height.

#include <abrade/fluid/height/columns.hpp>
#include <abrade/fluid/mesh/boundary_conditions.hpp>
#include <abrade/fluid/mesh/level_table.hpp>
#include <abrade/fluid/mesh/wet_rows.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace abrade::detail {

/// Liquid in columns and what moves it in a step.
template <int Dim>
struct HeightFlow {
    const HeightColumns<Dim>& columns;
    const Field<Real>& fraction;
    const std::vector<Real>& volume;  ///< [column][m3]
    const std::vector<Real>& height;  ///< [column][m]
    const std::vector<int>& top;      ///< [column] level of the cell at the surface
    const WetRows<Dim>& rows;         ///< hold all water, now and after the step, and one cell beside it
    const FaceField<Dim>& velocity;   ///< [m/s]
    const FaceField<Dim>* open;       ///< shares of faces; none: all open [-]
    FaceField<Dim>& moved;            ///< result [m3]
    Real seconds = 0;
    Real still = 0;  ///< a column of no more than this gives nothing [m3]
};

/// Fluxes Q = u dt A(h_face) through lower faces of cells, and their sums over the levels of each pair of
/// columns. h_face: the height of the column upstream, led to the face by a slope limited by those to both
/// sides (MC) and by half of the way that the water goes in the step.
template <int Dim>
class HeightFluxes {
    static constexpr int vertical = Grid<Dim>::vertical, inner = Layout<Dim>::inner,
                         outer = Layout<Dim>::outer;

public:
    HeightFluxes(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries)
        : grid_(grid), boundaries_(boundaries) {
        for (int a = 0; a < Dim - 1; ++a)
            area_[a] = LevelTable<Dim, Real>(
                grid, [&](int k) { return grid.size(vertical, k) * (Dim == 3 ? grid.size(1 - a, 0) : 1); });
        bottom_ = LevelTable<Dim, Real>(grid, [&](int k) { return grid.face(vertical, k); });
        per_size_ = LevelTable<Dim, Real>(grid, [&](int k) { return 1 / grid.size(vertical, k); });
    }

    void find(const HeightFlow<Dim>& flow) {
        const std::size_t count = flow.columns.count();
        for (int a = 0; a < Dim - 1; ++a) {
            up_[a].assign(count, 0), down_[a].assign(count, 0);
            lower_[a].resize(count, 0), upper_[a].resize(count, 0);
        }
        const int planes = grid_.cells(0);
        flow.rows.for_each_plane([&](int plane) {
            find_plane(flow, plane, plane);
            if (plane == planes - 1 && !boundaries_.periodic(0)) find_plane(flow, plane, plane + 1);
        });
        close_periodic(flow);
    }

    /// No column gives more than it has, and films nothing.
    void limit(const HeightFlow<Dim>& flow) {
        const HeightColumns<Dim>& columns = flow.columns;
        keeps_.assign(columns.count(), 1);
        const Real most_lacking = columns.parallel_max_of([&](int, int, Index n) {
            Real out = 0;
            for (int a = 0; a < Dim - 1; ++a) out += up_[a][at(n + columns.step(a))] + down_[a][at(n)];
            if (!(out > 0)) return Real(0);
            const Real has = flow.volume[at(n)], gives = has > flow.still ? has : 0;
            if (out > gives) keeps_[at(n)] = gives / out * (1 - 1e-15);
            return 1 - keeps_[at(n)];
        });
        if (most_lacking == 0) return;
        for (int a = 0; a < Dim - 1; ++a) {
            if (!boundaries_.periodic(a)) continue;
            for_each_pair_along(columns, a, [&](Index first, Index step) {
                keeps_[at(first - step)] = keeps_[at(first + (grid_.cells(a) - 1) * step)];
                keeps_[at(first + grid_.cells(a) * step)] = keeps_[at(first)];
            });
        }
        for (int plane = 0; plane <= grid_.cells(0); ++plane)
            for (int j = 0; j <= (Dim == 3 ? columns.across() : 0); ++j)
                for (int a = 0; a < Dim - 1; ++a) {
                    if ((a != 0 && plane == grid_.cells(0)) || (a == 0 && Dim == 3 && j == columns.across()))
                        continue;
                    const Index n = columns.column(plane, j);
                    const Real of_lower = keeps_[at(n - columns.step(a))], of_upper = keeps_[at(n)];
                    if (of_lower == 1 && of_upper == 1) continue;
                    for (int k = 0; k < columns.levels(); ++k) {
                        Real& m = flow.moved[a][columns.cell(plane, j, k)];
                        m *= m > 0 ? of_lower : of_upper;
                    }
                    up_[a][at(n)] *= of_lower, down_[a][at(n)] *= of_upper;
                }
    }

    /// Volumes after the step.
    void sum(const HeightFlow<Dim>& flow, std::vector<Real>& next) const {
        const HeightColumns<Dim>& columns = flow.columns;
        flow.rows.for_each_plane([&](int plane) {
            for (int j = 0; j < columns.across(); ++j) {
                const Index n = columns.column(plane, j);
                Real net = 0;
                for (int a = 0; a < Dim - 1; ++a) net += through(a, n) - through(a, n + columns.step(a));
                next[at(n)] = flow.volume[at(n)] + net;
            }
        });
    }
    /// From the column below a column along an axis into it [m3].
    Real through(int a, Index column) const noexcept { return up_[a][at(column)] - down_[a][at(column)]; }

    static void fields(auto&& field) {
        field("lower", &HeightFluxes::lower_), field("upper", &HeightFluxes::upper_),
            field("up", &HeightFluxes::up_), field("down", &HeightFluxes::down_),
            field("keeps", &HeightFluxes::keeps_);
    }

private:
    static std::size_t at(auto i) noexcept { return static_cast<std::size_t>(i); }

    void for_each_pair_along(const HeightColumns<Dim>& columns, int a, auto&& body) const {
        const int others = a == 0 ? columns.across() : grid_.cells(0);
        for (int o = 0; o < others; ++o)
            body(a == 0 ? columns.column(0, o) : columns.column(o, 0), columns.step(a));
    }

    /// `faces`: the plane of the faces, that of the rows or the one behind the last.
    void find_plane(const HeightFlow<Dim>& flow, int plane, int faces) {
        const HeightColumns<Dim>& columns = flow.columns;
        const int n = columns.across();
        for (int a = 0; a < Dim - 1; ++a) {
            if (a != 0 && faces != plane) continue;
            for (int j = 0; j <= (a == 0 ? n - 1 : n); ++j) find_heights(flow, a, faces, j);
        }
        for (int row = 0; row < (Dim == 3 ? grid_.cells(Dim - 1) : 1); ++row) {
            RowRange r = flow.rows.row(plane, row);
            if (faces == plane && plane > 0) r = hull(r, flow.rows.row(plane - 1, row));
            if (r.empty()) continue;
            carry_row(flow, 0, faces, row, r);
            if constexpr (Dim == 3)
                if (faces == plane) carry_row(flow, 1, plane, row, {r.begin, r.end + 1});
        }
        for (int a = 0; a < Dim - 1; ++a) {
            if (a != 0 && faces != plane) continue;
            for (int j = 0; j <= (a == 0 ? n - 1 : n); ++j) carry_cut(flow, a, faces, j);
        }
    }

    /// Heights at the face below a column, as the columns to both sides of it have them.
    void find_heights(const HeightFlow<Dim>& flow, int a, int plane, int j) {
        const HeightColumns<Dim>& columns = flow.columns;
        const Index n = columns.column(plane, j), step = columns.step(a);
        const auto led = [&](Index own, Index below, Index above, Real side) {
            const Real h = flow.height[at(own)];
            // Beside a bed that rises above it a slope would lead below that bed.
            if (columns.bed(below) > h || columns.bed(above) > h) return h;
            const auto seen = [&](Index other) { return columns.closed(other) ? h : flow.height[at(other)]; };
            const Real back = h - seen(below), forth = seen(above) - h;
            if (!(back * forth > 0)) return h;
            const Real steep = 2 * std::min(std::abs(back), std::abs(forth));
            const Real slope = std::copysign(std::min(steep, 0.5 * std::abs(back + forth)), back);
            const int k = std::min(flow.top[at(own)], columns.levels() - 1);
            const Real courant = std::min(
                std::abs(flow.velocity[a][columns.cell(plane, j, k)]) * flow.seconds / grid_.size(a, 0),
                Real(1));
            return h + side * 0.5 * (1 - courant) * slope;
        };
        lower_[a][at(n)] = led(n - step, n - 2 * step, n, 1);
        upper_[a][at(n)] = led(n, n - step, n + step, -1);
    }

    void carry_row(const HeightFlow<Dim>& flow, int a, int plane, int row, RowRange r) {
        const HeightColumns<Dim>& columns = flow.columns;
        const Offset start = grid_.layout().row_start(plane, row);
        const Real* const __restrict u = flow.velocity[a].data() + start;
        const Real* const __restrict open = flow.open ? (*flow.open)[a].data() + start : u;
        Real* const __restrict m = flow.moved[a].data() + start;
        const auto area = area_[a].row(row), bottom = bottom_.row(row), per_size = per_size_.row(row);
        const Real dt = flow.seconds;
        const bool walls = flow.open != nullptr;
        const auto moved = [&](int i, Real lower, Real upper) {
            Real swept = u[i] * (dt * area[i]);
            swept = walls ? swept * open[i] : swept;
            const Real share = ((swept > 0 ? lower : upper) - bottom[i]) * per_size[i];
            return swept * std::min(std::max(share, Real(0)), Real(1));
        };
        if constexpr (Dim == 3) {
            const Index n = columns.column(plane, 0);
            const Real* const __restrict lower = lower_[a].data() + n;
            const Real* const __restrict upper = upper_[a].data() + n;
            Real* const __restrict up = up_[a].data() + n;
            Real* const __restrict down = down_[a].data() + n;
#pragma omp simd
            for (int i = r.begin; i < r.end; ++i) {
                const Real through = moved(i, lower[i], upper[i]);
                m[i] = through;
                up[i] += std::max(through, Real(0)), down[i] += std::max(-through, Real(0));
            }
        } else {
            const auto n = at(columns.column(plane, 0));
            const Real lower = lower_[a][n], upper = upper_[a][n];
            Real up = 0, down = 0;
#pragma omp simd reduction(+ : up, down)
            for (int i = r.begin; i < r.end; ++i) {
                const Real through = moved(i, lower, upper);
                m[i] = through;
                up += std::max(through, Real(0)), down += std::max(-through, Real(0));
            }
            up_[a][n] = up, down_[a][n] = down;
        }
    }

    /// Where the surface upstream lies in a cell that a wall cuts, and where water flows in: anew.
    void carry_cut(const HeightFlow<Dim>& flow, int a, int plane, int j) {
        const HeightColumns<Dim>& columns = flow.columns;
        const Index n = columns.column(plane, j), step = columns.step(a);
        const int number = a == 0 ? plane : j, last = grid_.cells(a);
        const bool given_below = number == 0 && boundaries_[a][0] == Boundary::inflow,
                   given_above = number == last && boundaries_[a][1] == Boundary::inflow;
        const auto in_cut = [&](Index column, Real height) {
            const int whole = columns.whole_from(column);
            return columns.first(column) < whole &&
                   (whole >= columns.levels() || height < grid_.face(vertical, whole));
        };
        if (!given_below && !given_above && !in_cut(n - step, lower_[a][at(n)]) &&
            !in_cut(n, upper_[a][at(n)]))
            return;
        Real up = 0, down = 0;
        const Offset across = grid_.layout().stride[a];
        const Real highest = std::max(lower_[a][at(n)], upper_[a][at(n)]);
        for (int k = 0; k < columns.levels(); ++k) {
            const Offset c = columns.cell(plane, j, k);
            Real& m = flow.moved[a][c];
            const Real swept = flow.velocity[a][c] * (flow.seconds * area_[a].row(Dim == 3 ? k : 0)[k]) *
                               (flow.open ? (*flow.open)[a][c] : 1);
            const bool rising = swept > 0;
            Real share = 0;
            if (rising ? given_below : given_above)
                share = flow.fraction[rising ? c - across : c];
            else if (grid_.face(vertical, k) < highest)
                share = columns.share_below(inside(a, rising ? c - across : c, rising ? number - 1 : number),
                                            k, rising ? lower_[a][at(n)] : upper_[a][at(n)]);
            m = share > 0 ? swept * share : 0;
            (m > 0 ? up : down) += std::abs(m);
        }
        up_[a][at(n)] = up, down_[a][at(n)] = down;
    }
    /// Beyond a periodic side: the cell that comes in again; beyond an outflow the one before it.
    Offset inside(int a, Offset cell, int number) const noexcept {
        const int n = grid_.cells(a);
        if (number >= 0 && number < n) return cell;
        const int to = boundaries_.periodic(a) ? (number + n) % n : std::clamp(number, 0, n - 1);
        return cell + (to - number) * grid_.layout().stride[a];
    }

    /// The upper side of a periodic axis is the lower one.
    void close_periodic(const HeightFlow<Dim>& flow) {
        const HeightColumns<Dim>& columns = flow.columns;
        for (int a = 0; a < Dim - 1; ++a) {
            if (!boundaries_.periodic(a)) continue;
            const int n = grid_.cells(a);
            for_each_pair_along(columns, a, [&](Index first, Index step) {
                const auto from = at(first), to = at(first + n * step);
                up_[a][to] = up_[a][from], down_[a][to] = down_[a][from];
            });
            const int others = a == 0 ? columns.across() : grid_.cells(0);
            for (int o = 0; o < others; ++o)
                for (int k = 0; k < columns.levels(); ++k) {
                    const Offset from = a == 0 ? columns.cell(0, o, k) : columns.cell(o, 0, k);
                    flow.moved[a][from + n * grid_.layout().stride[a]] = flow.moved[a][from];
                }
        }
    }

    Grid<Dim> grid_;
    BoundaryConditions<Dim> boundaries_;
    PerAxis<LevelTable<Dim, Real>, Dim> area_;       ///< [m2]
    LevelTable<Dim, Real> bottom_, per_size_;        ///< [m], [1/m]
    PerAxis<std::vector<Real>, Dim> lower_, upper_;  ///< [axis][column] heights at its lower face [m]
    PerAxis<std::vector<Real>, Dim> up_, down_;      ///< [axis][column] through it, both ways [m3]
    std::vector<Real> keeps_;                        ///< [column] share of its outflow that it can give [-]
};

}  // namespace abrade::detail
