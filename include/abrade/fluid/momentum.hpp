#pragma once
// Momentum: what flows and friction do to the velocity of a staggered grid in one stage of a Runge-Kutta
// step.

#include <abrade/fluid/advection_schemes.hpp>
#include <abrade/fluid/grid.hpp>
#include <abrade/fluid/wet_rows.hpp>

namespace abrade {

/// One stage, for the cell around each face (control volume V of component a):
///   result = kept velocity + (1 - kept) (start + dt (-1/V sum over its sides A G + g_a)) + w (dp/dx_a),
///   G = W u_face - nu du/dn,
/// u_face by an advection scheme, W the velocity that carries. kept = 0 for the first stage, 1/2 for the
/// second: Heun's method. `result` may be `start`.
template <int Dim, class State>
struct MomentumStage {
    const FaceField<Dim, State>& velocity;         ///< what is carried, ghosts filled [m/s]
    const FaceField<Dim, State>& carrier;          ///< W, ghosts filled [m/s]
    const FaceField<Dim, State>& start;            ///< at the beginning of the step [m/s]
    FaceField<Dim, State>& result;                 ///< [m/s]
    const Field<State>& pressure;                  ///< over density [m2/s2]
    Real time_step = 0;                            ///< dt [s]
    Real kept = 0;                                 ///< share of the stage before [-]
    Real pressure_weight = 0;                      ///< w [s]
    Real viscosity = 0;                            ///< nu, kinematic [m2/s]
    Point<Dim> acceleration = Point<Dim>::Zero();  ///< g [m/s2]
};

namespace detail {

/// Fluxes through sides of the control volumes are computed once and kept until both neighbours have had
/// them.
template <class Scheme, int Dim, class State>
class MomentumRows {
    static constexpr int outer = Layout<Dim>::outer, inner = Layout<Dim>::inner, middle = 2;

public:
    MomentumRows(const Grid<Dim>& grid, const MomentumStage<Dim, State>& stage)
        : grid_(grid), layout_(grid.layout()), s_(stage), pitch_(layout_.row_length() + 16) {}

    /// Component `a` on planes [first, last).
    void run(int a, const WetRows<Dim>& faces, int first, int last) {
        const int rows = faces.layout().rows_per_plane();
        const auto room = static_cast<std::size_t>(pitch_);
        plane_.resize(room * static_cast<std::size_t>(rows));
        above_.resize(room), along_.resize(room), low_.resize(room), high_.resize(room);
        for (int row = 0; row < rows; ++row)
            flux(a, outer, first, row, faces.range(first, row),
                 plane_.data() + room * static_cast<std::size_t>(row));
        for (int plane = first; plane < last; ++plane) {
            if constexpr (Dim == 3) flux(a, middle, plane, 0, faces.range(plane, 0), low_.data());
            for (int row = 0; row < rows; ++row) {
                const RowRange r = faces.range(plane, row);
                State* const below = plane_.data() + room * static_cast<std::size_t>(row);
                flux(a, outer, plane + 1, row, hull(r, faces.range(plane + 1, row)), above_.data());
                if constexpr (Dim == 3)
                    flux(a, middle, plane, row + 1, hull(r, faces.range(plane, row + 1)), high_.data());
                if (!r.empty()) {
                    flux(a, inner, plane, row, {r.begin, r.end + 1}, along_.data());
                    combine(a, plane, row, r, below);
                }
                std::copy(above_.begin(), above_.end(), below);
                std::swap(low_, high_);
            }
        }
    }

private:
    /// Number of the cell of (plane, row) along `axis`, which is not the inner one.
    static int number(int axis, int plane, int row) noexcept { return axis == outer ? plane : row; }

    /// G through the lower side along b of the control volumes of component a in a row.
    void flux(int a, int b, int plane, int row, RowRange r, State* __restrict out) const noexcept {
        if (r.empty()) return;
        const Offset start = layout_.row_start(plane, row), across = layout_.stride[b];
        const State* const __restrict u = s_.velocity[a].data() + start;
        const State* const __restrict w = s_.carrier[b].data() + start;
        const Offset back = layout_.stride[a];
        const int ia = a == inner ? 0 : number(a, plane, row), ib = b == inner ? 0 : number(b, plane, row);
        // Carried volume: half of what flows through the sides of each of the two cells that the volume lies
        // in.
        const Real gap = grid_.gap(a, ia);
        const auto lower = static_cast<State>(a == b ? 0.5 : 0.5 * grid_.size(a, ia - 1) / gap);
        const auto upper = static_cast<State>(a == b ? 0.5 : 0.5 * grid_.size(a, ia) / gap);
        const auto friction =
            static_cast<State>(s_.viscosity / (a == b ? grid_.size(a, ia - 1) : grid_.gap(b, ib)));
#pragma omp simd
        for (int i = r.begin; i < r.end; ++i) {
            const State carried = upper * w[i] + lower * w[i - back];
            const State far_low = u[i - 2 * across], low = u[i - across], high = u[i],
                        far_high = u[i + across];
            const bool rising = carried > 0;
            const State value =
                Scheme::at_face(rising ? far_low : far_high, rising ? low : high, rising ? high : low);
            out[i] = carried * value - friction * (high - low);
        }
    }

    void combine(int a, int plane, int row, RowRange r, const State* __restrict below) const noexcept {
        const Offset start = layout_.row_start(plane, row), back = layout_.stride[a];
        std::array<State, Dim> share;
        for (int b = 0; b < Dim; ++b) {
            const int i = b == inner ? 0 : number(b, plane, row);
            share[b] = static_cast<State>(s_.time_step / (a == b ? grid_.gap(b, i) : grid_.size(b, i)));
        }
        const auto gravity = static_cast<State>(s_.time_step * s_.acceleration[a]);
        const auto kept = static_cast<State>(s_.kept), fresh = static_cast<State>(1 - s_.kept);
        const auto push =
            static_cast<State>(s_.pressure_weight / grid_.gap(a, a == inner ? 0 : number(a, plane, row)));
        const State* const __restrict p = s_.pressure.data() + start;
        const State* const velocity = s_.velocity[a].data() + start;
        const State* const begin = s_.start[a].data() + start;
        State* const result = s_.result[a].data() + start;
        const State* const __restrict above = above_.data();
        const State* const __restrict along = along_.data();
        const State* const __restrict low = low_.data(), * const __restrict high = high_.data();
#pragma omp simd
        for (int i = r.begin; i < r.end; ++i) {
            State change =
                gravity - share[outer] * (above[i] - below[i]) - share[inner] * (along[i + 1] - along[i]);
            if constexpr (Dim == 3) change -= share[middle] * (high[i] - low[i]);
            result[i] = kept * velocity[i] + fresh * (begin[i] + change) + push * (p[i] - p[i - back]);
        }
    }

    const Grid<Dim>& grid_;
    const Layout<Dim>& layout_;
    const MomentumStage<Dim, State>& s_;
    int pitch_;
    std::vector<State> plane_, above_, along_, low_, high_;
};

}  // namespace detail

/// Computes one stage on the faces that `faces[a]` names, for each component a.
/// Same bits for any number of threads.
template <class Scheme, int Dim, class State>
void advance_momentum(const Grid<Dim>& grid, const std::type_identity_t<std::array<WetRows<Dim>, Dim>>& faces,
                      const MomentumStage<Dim, State>& stage) {
    const int planes = grid.layout().planes();
    const int runs = std::clamp(planes / 8, 1, thread_count());
    parallel_tasks(runs, [&](Index run) {
        detail::MomentumRows<Scheme, Dim, State> rows(grid, stage);
        const auto cut = [&](Index r) { return static_cast<int>(std::int64_t{planes} * r / runs); };
        for (int a = 0; a < Dim; ++a) rows.run(a, faces[a], cut(run), cut(run + 1));
    });
}

}  // namespace abrade
