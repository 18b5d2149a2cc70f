#pragma once
// Momentum: what flows and friction do to the velocity of a staggered grid in one stage of a Runge-Kutta
// step.

#include <abrade/fluid/mesh/level_table.hpp>
#include <abrade/fluid/mesh/volume_tolerance.hpp>
#include <abrade/fluid/mesh/wet_rows.hpp>
#include <abrade/fluid/momentum/advection_schemes.hpp>

namespace abrade {

/// One stage, for the cell around each face (control volume V of component a):
///   result = kept velocity + (1 - kept) ((M_before start - dt/V sum over its sides A G) / M + dt g_a) + w
///   dp/dx_a, G = W u_face - (nu + nu_t) du/dn,
/// u_face by an advection scheme, W the advecting flux: a velocity, or the liquid that went through in the
/// step. M is the share of V that liquid fills, by which momentum goes with the same fluxes as the liquid; 1
/// without a surface. kept = 0 for the first stage, 1/2 for the second: Heun's method. `result` may be
/// `start`.
///
/// What flows into a volume in the second stage has got the first one's acceleration b = g - dp/dx_a already;
/// what was in it gets that here, and a volume that fills or empties moves as one that does not:
///   result = kept velocity + (1 - kept) (M_before (start + dt b) - dt/V sum A G) / M + dt dp/dx_a,
/// with which the old pressure is taken back as a whole. That is the same where M = M_before and w = dt/2.
///
/// Eddies, where there are any, act in the Laplacian's form div((nu + nu_t) grad u): the transposed gradient
/// is left out, since beside walls and surfaces that cut cells it is not known.
template <int Dim, class State>
struct MomentumStage {
    const FaceField<Dim, State>& velocity;  ///< what is carried, ghosts filled [m/s]
    const FaceField<Dim, State>&
        advecting_flux;                  ///< W, ghosts filled [m/s], or with `carried_in` a volume [m3]
    const FaceField<Dim, State>& start;  ///< at the beginning of the step [m/s]
    FaceField<Dim, State>& result;       ///< [m/s]
    const Field<State>& pressure;        ///< over density [m2/s2]
    Real time_step = 0;                  ///< dt [s]
    Real kept = 0;                       ///< share of the stage before [-]
    Real pressure_weight = 0;            ///< w [s]
    Real viscosity = 0;                  ///< nu, kinematic [m2/s]
    Point<Dim> acceleration = Point<Dim>::Zero();  ///< g [m/s2]
    Real carried_in = 0;  ///< time in which `advecting_flux` went through [s]; 0: it is a velocity
    const Field<State>* liquid_fraction_before =
        nullptr;  ///< liquid in a cell at the step's beginning, share of the whole [-]
    const Field<State>* liquid_fraction = nullptr;  ///< at its end; none: all cells are full
    const FaceField<Dim>* aperture = nullptr;  ///< share of each face that walls leave open [-]; none: all
    /// [a][b] of the sides along b of component a's control volumes: the share that walls leave open over the
    /// distance between the centroids of what they leave open of both faces [1/cell]; with aperture.
    const PerAxis<FaceField<Dim, float>, Dim>* open_friction = nullptr;
    const Field<State>* eddy_viscosity = nullptr;  ///< nu_t of cells, ghosts filled [m2/s]; where Eddies
    /// What the pressure of the step before pushes more than over the distance of the centres, in dt [m/s]; 0
    /// but at the surface, beside cells that are not wet.
    const FaceField<Dim, State>* surface_push = nullptr;
    const Field<std::uint8_t>* wet = nullptr;  ///< with surface_push
    /// Below this share of a control volume what is carried into it is kept among what is around [-].
    Real bounded_below = 0.5;
};

namespace detail {

/// Fluxes through sides of the control volumes are computed once and kept until both neighbours have had
/// them. Loops go over whole packs; what lies in them beyond a row's range is computed and thrown away.
template <class Scheme, bool Eddies, int Dim, class State>
class MomentumRows {
    static constexpr int outer = Layout<Dim>::outer, inner = Layout<Dim>::inner, middle = 2;
    static constexpr int vertical = Grid<Dim>::vertical;
    /// With eddies a cell costs so much that few should be computed beyond a row's end; without, long loops
    /// are faster.
    static constexpr int lanes = Eddies ? 64 / static_cast<int>(sizeof(State)) : Layout<Dim>::lanes;
    static constexpr int pack(int i) noexcept { return i & ~(lanes - 1); }
    using Table = LevelTable<Dim, State>;
    /// With less of its control volume a face keeps its velocity, but for weight and pressure.
    static constexpr Real least_mass = volume_tolerance::mass;

public:
    MomentumRows(const Grid<Dim>& grid, const MomentumStage<Dim, State>& stage)
        : layout_(grid.layout()), s_(stage),
          pitch_(Layout<Dim>::pack(layout_.row_length() + 2 * Layout<Dim>::lanes)),
          below_(room(layout_.rows_per_plane())), above_(below_.size()), along_(room(1)), low_(room(1)),
          high_(room(1)) {
        for (int a = 0; a < Dim; ++a) {
            const int up = a == vertical;
            lower_half_[a] = Table(grid, [&](int k) { return half(grid, a, k, false); });
            upper_half_[a] = Table(grid, [&](int k) { return half(grid, a, k, true); });
            push_[a] = Table(grid, [&](int k) { return s_.pressure_weight / grid.gap(a, up ? k : 0); });
            for (int b = 0; b < Dim; ++b) {
                const int along = b == vertical;
                lower_[a][b] = Table(grid, [&](int k) {
                    return (a == b ? 0.5 : half(grid, a, k, false)) * per_flux(grid, b, k - up);
                });
                upper_[a][b] = Table(grid, [&](int k) {
                    return (a == b ? 0.5 : half(grid, a, k, true)) * per_flux(grid, b, k);
                });
                friction_[a][b] = Table(grid, [&](int k) {
                    return (Eddies ? 1 : s_.viscosity) /
                           (a == b ? grid.size(a, up ? k - 1 : 0) : grid.gap(b, along ? k : 0));
                });
                share_[a][b] = Table(grid, [&](int k) {
                    return s_.time_step / (a == b ? grid.gap(b, up ? k : 0) : grid.size(b, along ? k : 0));
                });
            }
        }
    }

    /// Component `a` on planes [first, last).
    void run(int a, const WetRows<Dim>& faces, int first, int last) {
        const int rows = layout_.rows_per_plane();
        for (int row = 0; row < rows; ++row)
            flux(a, outer, first, row, faces.range(first, row), below_.data() + room(row));
        for (int plane = first; plane < last; ++plane) {
            if constexpr (Dim == 3) flux(a, middle, plane, 0, faces.range(plane, 0), low_.data());
            for (int row = 0; row < rows; ++row) {
                const RowRange r = faces.range(plane, row);
                flux(a, outer, plane + 1, row, hull(r, faces.range(plane + 1, row)),
                     above_.data() + room(row));
                if constexpr (Dim == 3)
                    flux(a, middle, plane, row + 1, hull(r, faces.range(plane, row + 1)), high_.data());
                if (!r.empty()) {
                    flux(a, inner, plane, row, {r.begin, r.end + 1}, along_.data());
                    combine(a, plane, row, r);
                }
                std::swap(low_, high_);
            }
            std::swap(below_, above_);
        }
    }

private:
    Offset room(int rows) const noexcept { return Offset{pitch_} * rows; }
    /// 1 over what turns an advecting flux of cells at a level into a velocity.
    Real per_flux(const Grid<Dim>& grid, int axis, int level) const noexcept {
        if (s_.carried_in == 0) return 1;
        Real area = 1;
        for (int a = 0; a < Dim; ++a)
            if (a != axis) area *= grid.size(a, a == vertical ? level : 0);
        return 1 / (area * s_.carried_in);
    }
    /// Share of the control volume of a face that lies in the cell below it (`upper` false) or above.
    static Real half(const Grid<Dim>& grid, int a, int level, bool upper) noexcept {
        const int number = a == vertical ? level : 0;
        return 0.5 * grid.size(a, upper ? number : number - 1) / grid.gap(a, number);
    }

    /// G through the lower side along b of the control volumes of component a in a row.
    void flux(int a, int b, int plane, int row, RowRange r, State* __restrict out) const noexcept {
        if (r.empty()) return;
        const Offset start = layout_.row_start(plane, row), across = layout_.stride[b];
        const State* const __restrict u = s_.velocity[a].data() + start;
        const State* const __restrict far_below = u - 2 * across;
        const State* const __restrict below = u - across;
        const State* const __restrict above = u + across;
        const State* const __restrict w = s_.advecting_flux[b].data() + start;
        const State* const __restrict w_back = w - layout_.stride[a];
        // Half of what flows through the sides of each of the two cells that the volume lies in.
        const auto lower = lower_[a][b].row(row), upper = upper_[a][b].row(row),
                   friction = friction_[a][b].row(row);
        // Eddies of the four cells around the middle of the side, or of the one that it lies in.
        const State *eddy[4] = {u, u, u, u}, molecular = static_cast<State>(s_.viscosity);
        if constexpr (Eddies)
            for (int n = 0; n < 4; ++n)
                eddy[n] = s_.eddy_viscosity->data() + start - (a == b || n % 2 == 1 ? layout_.stride[a] : 0) -
                          (a != b && n >= 2 ? across : 0);
        const State* const __restrict eddy_0 = eddy[0], * const __restrict eddy_1 = eddy[1], * const __restrict eddy_2 = eddy[2], * const __restrict eddy_3 = eddy[3];
        const auto viscosity_over_gap = [&](int i) {
            if constexpr (Eddies)
                return friction[i] *
                       (molecular + State(0.25) * (eddy_0[i] + eddy_1[i] + eddy_2[i] + eddy_3[i]));
            else
                return friction[i];
        };
        const auto through = [&](int i, State open) {
            // All four are read before it is known which are needed: loads that wait for a condition are
            // slow.
            const State far_low = far_below[i], low = below[i], high = u[i], far_high = above[i];
            const State carried = upper[i] * w[i] + lower[i] * w_back[i];
            const bool rising = carried > 0;
            const State value =
                Scheme::at_face(rising ? far_low : far_high, rising ? low : high, rising ? high : low);
            return carried * value - open * viscosity_over_gap(i) * (high - low);
        };
        if (s_.aperture) {  // friction acts on what is open; the wall's own is added apart
            const float* const __restrict open = (*s_.open_friction)[a][b].data() + start;
            for (int i = pack(r.begin); i < r.end; i += lanes)
#pragma omp simd
                for (int k = i; k < i + lanes; ++k) out[k] = through(k, static_cast<State>(open[k]));
            return;
        }
        for (int i = pack(r.begin); i < r.end; i += lanes)
#pragma omp simd
            for (int k = i; k < i + lanes; ++k) out[k] = through(k, 1);
    }

    void combine(int a, int plane, int row, RowRange r) noexcept {
        const Offset start = layout_.row_start(plane, row), back = layout_.stride[a];
        const auto share_outer = share_[a][outer].row(row), share_middle = share_[a][Dim - 1].row(row),
                   share_inner = share_[a][inner].row(row), push = push_[a].row(row),
                   lower = lower_half_[a].row(row), upper = upper_half_[a].row(row);
        const auto gravity = static_cast<State>(s_.time_step * s_.acceleration[a]);
        const auto sliver = static_cast<State>(s_.bounded_below);
        const auto kept = static_cast<State>(s_.kept), fresh = static_cast<State>(1 - s_.kept);
        const auto early = static_cast<State>(s_.kept == 0), late = 1 - early;
        const State* const __restrict p = s_.pressure.data() + start;
        const State* const __restrict p_back = p - back;
        const State* const velocity = s_.velocity[a].data() + start;
        const State* const begin = s_.start[a].data() + start;
        State* const result = s_.result[a].data() + start;
        const State* const __restrict below = below_.data() + room(row);
        const State* const __restrict above = above_.data() + room(row);
        const State* const __restrict along = along_.data();
        const State* const __restrict low = low_.data(), * const __restrict high = high_.data();
        const auto change = [&](int i) {
            State sum = -share_outer[i] * (above[i] - below[i]) - share_inner[i] * (along[i + 1] - along[i]);
            if constexpr (Dim == 3) sum -= share_middle[i] * (high[i] - low[i]);
            return sum;
        };
        const State* const outer_below = velocity - layout_.stride[outer];
        const State* const outer_above = velocity + layout_.stride[outer];
        const State* const middle_below = velocity - layout_.stride[Dim - 1];
        const State* const middle_above = velocity + layout_.stride[Dim - 1];
        const State* const now = s_.liquid_fraction ? s_.liquid_fraction->data() + start : nullptr;
        const State* const before = s_.liquid_fraction ? s_.liquid_fraction_before->data() + start : nullptr;
        const State* const at_surface = s_.surface_push ? (*s_.surface_push)[a].data() + start : now;
        const State surface = s_.surface_push ? 1 : 0;
        const Real* const open = s_.aperture ? (*s_.aperture)[a].data() + start : nullptr;
        for (int first = pack(r.begin); first < r.end; first += lanes) {
            // Read as a whole before it is written: `result` may be `start`.
            alignas(64) State value[lanes];
            if (!now || (is_wet(start + first, back) && is_full(now + first, before + first, back))) {
#pragma omp simd
                for (int k = 0; k < lanes; ++k) {
                    const int i = first + k;
                    value[k] = kept * velocity[i] + fresh * (begin[i] + change(i) + gravity) +
                               push[i] * (p[i] - p_back[i]);
                }
            } else {
#pragma omp simd
                for (int k = 0; k < lanes; ++k) {
                    const int i = first + k;
                    const State mass = upper[i] * now[i] + lower[i] * now[i - back];
                    const State mass_before = upper[i] * before[i] + lower[i] * before[i - back];
                    // The second stage takes the old pressure back as a whole, and by half.
                    const State by_pressure =
                        (early - 2 * late) * push[i] * (p[i] - p_back[i]) + surface * at_surface[i];
                    const State faster = gravity + by_pressure;
                    // What is carried into little liquid is a mean of what was there and around: a sweep
                    // after another may have moved more liquid out of a sliver than it held at the beginning.
                    State least = velocity[i], most = least;
                    const auto widen = [&](State v) {
                        least = v < least ? v : least;
                        most = v > most ? v : most;
                    };
                    widen(begin[i]), widen(outer_below[i]), widen(outer_above[i]), widen(velocity[i - 1]);
                    widen(velocity[i + 1]), widen(middle_below[i]), widen(middle_above[i]);
                    const State some = mass > State(least_mass) ? mass : State(least_mass);
                    const State carried =
                        (mass_before * (begin[i] + late * faster) + change(i)) / some - late * faster;
                    const State raised = carried < least ? least : carried;
                    const State bounded = raised > most ? most : raised;
                    const State moved = mass < State(least_mass) ? begin[i]
                                        : mass < sliver          ? bounded
                                                                 : carried;
                    value[k] = kept * velocity[i] + fresh * (moved + faster) - late * by_pressure;
                }
            }
            if (open && is_shut(open + first))
                for (int k = 0; k < lanes; ++k) value[k] = open[first + k] > 0 ? value[k] : State(0);
            if (r.begin <= first && first + lanes <= r.end)
                std::copy_n(value, lanes, result + first);
            else
                for (int i = std::max(first, r.begin); i < std::min(first + lanes, r.end); ++i)
                    result[i] = value[i - first];
        }
    }

    /// Whether all cells of a pack's control volumes have a pressure: beside others `surface_push` may act.
    bool is_wet(Offset first, Offset back) const noexcept {
        if (!s_.wet) return true;
        const std::uint8_t* const wet = s_.wet->data() + first;
        const std::uint8_t* const wet_back = wet - back;
        unsigned dry = 0;
#pragma omp simd reduction(+ : dry)
        for (int k = 0; k < lanes; ++k) dry += (wet[k] & wet_back[k]) == 0;
        return dry == 0;
    }

    /// Whether walls close a face of a pack.
    static bool is_shut(const Real* open) noexcept {
        Real shut = 0;
#pragma omp simd reduction(+ : shut)
        for (int k = 0; k < lanes; ++k) shut += open[k] > 0 ? Real(0) : Real(1);
        return shut > 0;
    }

    /// Whether a pack's control volumes are full of liquid, before and now.
    static bool is_full(const State* now, const State* before, Offset back) noexcept {
        const State* const now_back = now - back;
        const State* const before_back = before - back;
        State short_of = 0;  // a number, not a flag: one width for all
#pragma omp simd reduction(+ : short_of)
        for (int k = 0; k < lanes; ++k) {
            short_of += (now[k] < 1 ? State(1) : State(0)) + (now_back[k] < 1 ? State(1) : State(0)) +
                        (before[k] < 1 ? State(1) : State(0)) + (before_back[k] < 1 ? State(1) : State(0));
        }
        return short_of == 0;
    }

    const Layout<Dim>& layout_;
    const MomentumStage<Dim, State>& s_;
    int pitch_;
    PerAxis<Table, Dim> lower_half_, upper_half_, push_;                  ///< [component]
    PerAxis<PerAxis<Table, Dim>, Dim> lower_, upper_, friction_, share_;  ///< [component][axis of the flux]
    Field<State> below_, above_, along_, low_, high_;  ///< fluxes; packs of fields are whole cache lines
};

}  // namespace detail

/// Computes one stage on the faces that `faces[a]` names, for each component a; with `Eddies` their viscosity
/// counts. Same bits for any number of threads.
template <class Scheme, bool Eddies = false, int Dim, class State>
void advance_momentum(const Grid<Dim>& grid, const PerAxis<WetRows<Dim>, Dim>& faces,
                      const MomentumStage<Dim, State>& stage) {
    // Each part computes the fluxes below its first plane anew.
    constexpr int least = 32;
    detail::parallel_parts(faces[0].runs(), least, [&](int first, int last) {
        detail::MomentumRows<Scheme, Eddies, Dim, State> rows(grid, stage);
        for (int a = 0; a < Dim; ++a) rows.run(a, faces[a], first, last);
    });
}

}  // namespace abrade
