#pragma once
// Momentum: what flows and friction do to the velocity of a staggered grid in one stage of a Runge-Kutta
// step.

#include <abrade/fluid/advection_schemes.hpp>
#include <abrade/fluid/row_value.hpp>
#include <abrade/fluid/wet_rows.hpp>

namespace abrade {

/// One stage, for the cell around each face (control volume V of component a):
///   result = kept velocity + (1 - kept) ((M_before start - dt/V sum over its sides A G) / M + dt g_a) + w
///   dp/dx_a, G = W u_face - nu du/dn,
/// u_face by an advection scheme, W what carries: a velocity, or the liquid that went through in the step. M
/// is the share of V that liquid fills, by which momentum goes with the same fluxes as the liquid; 1 without
/// a surface. kept = 0 for the first stage, 1/2 for the second: Heun's method. `result` may be `start`.
template <int Dim, class State>
struct MomentumStage {
    const FaceField<Dim, State>& velocity;  ///< what is carried, ghosts filled [m/s]
    const FaceField<Dim, State>& carrier;   ///< W, ghosts filled [m/s], or with `carried_in` a volume [m3]
    const FaceField<Dim, State>& start;     ///< at the beginning of the step [m/s]
    FaceField<Dim, State>& result;          ///< [m/s]
    const Field<State>& pressure;           ///< over density [m2/s2]
    Real time_step = 0;                     ///< dt [s]
    Real kept = 0;                          ///< share of the stage before [-]
    Real pressure_weight = 0;               ///< w [s]
    Real viscosity = 0;                     ///< nu, kinematic [m2/s]
    Point<Dim> acceleration = Point<Dim>::Zero();  ///< g [m/s2]
    Real carried_in = 0;  ///< time in which `carrier` went through [s]; 0: it is a velocity
    const Field<State>* held_before =
        nullptr;                         ///< liquid in a cell at the step's beginning, share of the whole [-]
    const Field<State>* held = nullptr;  ///< at its end; none: all cells are full
    const FaceField<Dim>* open_area = nullptr;  ///< share of each face that walls leave open [-]; none: all
};

namespace detail {

/// Fluxes through sides of the control volumes are computed once and kept until both neighbours have had
/// them.
template <class Scheme, int Dim, class State>
class MomentumRows {
    static constexpr int outer = Layout<Dim>::outer, inner = Layout<Dim>::inner, middle = 2;
    static constexpr int vertical = Grid<Dim>::vertical;
    /// Below this share of a control volume there is no momentum to speak of: the velocity is taken from
    /// outside.
    static constexpr Real least_mass = 1e-9;

public:
    MomentumRows(const Grid<Dim>& grid, const MomentumStage<Dim, State>& stage)
        : grid_(grid), layout_(grid.layout()), s_(stage), pitch_(layout_.row_length() + 16) {}

    /// Component `a` on planes [first, last).
    void run(int a, const WetRows<Dim>& faces, int first, int last) {
        const int rows = layout_.rows_per_plane();
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
    /// Number of a cell of (plane, row) along `axis`.
    static int number(int axis, int plane, int row, int i) noexcept {
        return axis == outer ? plane : axis == inner ? i : row;
    }
    /// 1 over what turns a carrier of cells at a number along the vertical into a velocity.
    Real per_carrier(int axis, int level) const noexcept {
        if (s_.carried_in == 0) return 1;
        Real area = 1;
        for (int a = 0; a < Dim; ++a)
            if (a != axis) area *= grid_.size(a, a == vertical ? level : 0);
        return 1 / (area * s_.carried_in);
    }
    /// Share of control volume a that lies in the cell below its face (`upper` false) or above.
    Real half(int a, int number_of_cell, bool upper) const noexcept {
        return 0.5 * grid_.size(a, upper ? number_of_cell : number_of_cell - 1) /
               grid_.gap(a, number_of_cell);
    }

    /// G through the lower side along b of the control volumes of component a in a row.
    void flux(int a, int b, int plane, int row, RowRange r, State* __restrict out) noexcept {
        if (r.empty()) return;
        const Offset start = layout_.row_start(plane, row), across = layout_.stride[b];
        const State* const __restrict u = s_.velocity[a].data() + start;
        const State* const __restrict w = s_.carrier[b].data() + start;
        const Offset back = layout_.stride[a];
        const auto cell = [&](int axis, int i) { return number(axis, plane, row, i); };
        // Half of what flows through the sides of each of the two cells that the volume lies in.
        const RowValue<Dim, State> lower(values_[0], r.begin, r.end, [&](int i) {
            const int level = cell(vertical, i) - (a == vertical ? 1 : 0);
            return (a == b ? 0.5 : half(a, cell(a, i), false)) * per_carrier(b, level);
        });
        const RowValue<Dim, State> upper(values_[1], r.begin, r.end, [&](int i) {
            return (a == b ? 0.5 : half(a, cell(a, i), true)) * per_carrier(b, cell(vertical, i));
        });
        const RowValue<Dim, State> friction(values_[2], r.begin, r.end, [&](int i) {
            return s_.viscosity / (a == b ? grid_.size(a, cell(a, i) - 1) : grid_.gap(b, cell(b, i)));
        });
        const auto through = [&](int i, State open) {
            const State carried = upper[i] * w[i] + lower[i] * w[i - back];
            const State far_low = u[i - 2 * across], low = u[i - across], high = u[i],
                        far_high = u[i + across];
            const bool rising = carried > 0;
            const State value =
                Scheme::at_face(rising ? far_low : far_high, rising ? low : high, rising ? high : low);
            return carried * value - open * friction[i] * (high - low);
        };
        if (s_.open_area) {  // friction acts on what is open; the wall's own is added apart
            const Real* const __restrict open = (*s_.open_area)[b].data() + start;
            for (int i = r.begin; i < r.end; ++i)
                out[i] = through(i, static_cast<State>(0.5 * (open[i] + open[i - back])));
            return;
        }
#pragma omp simd
        for (int i = r.begin; i < r.end; ++i) out[i] = through(i, 1);
    }

    void combine(int a, int plane, int row, RowRange r, const State* __restrict below) noexcept {
        const Offset start = layout_.row_start(plane, row), back = layout_.stride[a];
        const auto cell = [&](int axis, int i) { return number(axis, plane, row, i); };
        const auto share = [&](int b) {
            return [&, b](int i) {
                return s_.time_step / (a == b ? grid_.gap(b, cell(b, i)) : grid_.size(b, cell(b, i)));
            };
        };
        const auto share_outer = static_cast<State>(share(outer)(0));
        const auto share_middle = Dim == 3 ? static_cast<State>(share(Dim - 1)(0)) : State(0);
        const RowValue<Dim, State> share_inner(values_[0], r.begin, r.end, share(inner));
        const RowValue<Dim, State> push(values_[1], r.begin, r.end,
                                        [&](int i) { return s_.pressure_weight / grid_.gap(a, cell(a, i)); });
        const auto gravity = static_cast<State>(s_.time_step * s_.acceleration[a]);
        const auto kept = static_cast<State>(s_.kept), fresh = static_cast<State>(1 - s_.kept);
        const State* const __restrict p = s_.pressure.data() + start;
        const State* const velocity = s_.velocity[a].data() + start;
        const State* const begin = s_.start[a].data() + start;
        State* const result = s_.result[a].data() + start;
        const State* const __restrict above = above_.data();
        const State* const __restrict along = along_.data();
        const State* const __restrict low = low_.data(), * const __restrict high = high_.data();
        const auto change = [&](int i) {
            State sum = -share_outer * (above[i] - below[i]) - share_inner[i] * (along[i + 1] - along[i]);
            if constexpr (Dim == 3) sum -= share_middle * (high[i] - low[i]);
            return sum;
        };
        if (!s_.held) {
#pragma omp simd
            for (int i = r.begin; i < r.end; ++i)
                result[i] = kept * velocity[i] + fresh * (begin[i] + change(i) + gravity) +
                            push[i] * (p[i] - p[i - back]);
            return;
        }
        const State* const __restrict before = s_.held_before->data() + start;
        const State* const __restrict now = s_.held->data() + start;
        const RowValue<Dim, State> lower(values_[2], r.begin, r.end,
                                         [&](int i) { return half(a, cell(a, i), false); });
        const RowValue<Dim, State> upper(values_[3], r.begin, r.end,
                                         [&](int i) { return half(a, cell(a, i), true); });
#pragma omp simd
        for (int i = r.begin; i < r.end; ++i) {
            const State mass = upper[i] * now[i] + lower[i] * now[i - back];
            const State mass_before = upper[i] * before[i] + lower[i] * before[i - back];
            const State per_mass = mass > State(least_mass) ? 1 / mass : State(0);
            // What is carried into little liquid is a mean of what was there and around: a sweep after
            // another may have moved more liquid out of a sliver than it held at the beginning.
            State least = std::min(velocity[i], begin[i]), most = std::max(velocity[i], begin[i]);
            for (int b = 0; b < Dim; ++b) {
                const Offset across = layout_.stride[b];
                least = std::min(least, std::min(velocity[i - across], velocity[i + across]));
                most = std::max(most, std::max(velocity[i - across], velocity[i + across]));
            }
            const State carried = (mass_before * begin[i] + change(i)) * per_mass;
            const State moved =
                mass > State(least_mass) ? std::min(most, std::max(least, carried)) + gravity : State(0);
            result[i] = kept * velocity[i] + fresh * moved + push[i] * (p[i] - p[i - back]);
        }
        if (!s_.open_area) return;
        const Real* const __restrict open = (*s_.open_area)[a].data() + start;
#pragma omp simd
        for (int i = r.begin; i < r.end; ++i) result[i] = open[i] > 0 ? result[i] : State(0);
    }

    const Grid<Dim>& grid_;
    const Layout<Dim>& layout_;
    const MomentumStage<Dim, State>& s_;
    int pitch_;
    std::vector<State> plane_, above_, along_, low_, high_;
    std::array<std::vector<State>, 4> values_;
};

}  // namespace detail

/// Computes one stage on the faces that `faces[a]` names, for each component a.
/// Same bits for any number of threads.
template <class Scheme, int Dim, class State>
void advance_momentum(const Grid<Dim>& grid, const PerAxis<WetRows<Dim>, Dim>& faces,
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
