#pragma once
// Velocities of the air beside water: the water's, carried on outward.

#include <abrade/fluid/walls.hpp>
#include <abrade/fluid/water_cells.hpp>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

namespace abrade {

/// A face of the velocity component along an axis.
struct WaterFace {
    Offset face = 0;
    int axis = 0;
};

/// Gives faces between dry cells the mean of the known velocities around them, layer by layer outward from
/// the water, as far as the stencils of the next step reach. Known are faces of wet cells; beyond the first
/// layer also those that hold liquid of their own, which fly on as they do; beside walls, beyond the last.
/// Same bits for any number of threads.
template <int Dim>
class VelocityExtension {
public:
    static constexpr int layers = 3;
    static constexpr int wedge = 8;  ///< longest of water on a wall that has no pressure of its own [cells]

    VelocityExtension(const Layout<Dim>& layout, const Sides<Dim>& sides)
        : layout_(layout), sides_(sides), state_(layout.total, unknown), before_(layout),
          found_(static_cast<std::size_t>(layout.planes())), waiting_(found_), riders_in_(found_.size()) {}

    /// Walls that close faces; they must outlive this.
    void set_walls(const Walls<Dim>& walls) {
        walls_ = &walls;
        for (int a = 0; a < Dim; ++a) {
            closed_[a] = Field<std::uint8_t>(layout_.total, 0);
            walls.grid().for_each(
                [&](const CellNumber<Dim>&, Offset c) { closed_[a][c] = walls.open_area()[a][c] == 0; });
        }
    }

    struct Water {
        const Field<std::uint8_t>& wet;      ///< 1 in cells that have a pressure, ghosts included
        const WetRows<Dim>& rows;            ///< to be looked at
        const Field<Real>& held;             ///< share of a cell that liquid fills [-]
        std::span<const WaterFace> still{};  ///< faces of wet cells that no pressure moves
    };

    template <class State>
    void extend(FaceField<Dim, State>& u, const Water& water) {
        const auto& [wet, rows, held, still] = water;
        // Where water has left nothing is known any more.
        before_.for_each_row([&](int plane, int row, const RowRange& r) {
            std::fill_n(state_.data() + layout_.row_start(plane, row) + r.begin, r.length(), unknown);
        });
        before_ = rows;
        for (int a = 0; a < Dim; ++a) {
            begin(a, u[a], wet, rows);
            for (const WaterFace& face : still)
                if (face.axis == a) state_[face.face] = unknown;
            riders_[a].clear();
            for (int layer = 0; layer < layers; ++layer) {
                join(u[a]);
                take_means(u[a], rows);
                if (layer == 0) find_riders(a, held, rows);
                know_found(rows);
                if (layer == 0) know_liquid(a, held, rows);
            }
            if (walls_) extend_wedges(u[a], rows);
            rows.for_each_row([&](int plane, int row, const RowRange& r) {
                const Offset start = layout_.row_start(plane, row);
                State* const __restrict v = u[a].data() + start;
                const std::uint8_t* const __restrict state = state_.data() + start;
                for (int first = Layout<Dim>::pack(r.begin); first < r.end; first += lanes) {
                    if (!any_unknown(state + first)) continue;
                    for (int i = std::max(first, r.begin); i < std::min(first + lanes, r.end); ++i)
                        v[i] = state[i] == unknown ? State(0) : v[i];
                }
            });
        }
    }

    /// Clears what lies in rows of `before` and in none of `now`, which water has left; but not what is given
    /// on lower sides, which let water in.
    template <class State>
    void clear_left(FaceField<Dim, State>& u, const WetRows<Dim>& before, const WetRows<Dim>& now) const {
        before.for_each_row([&](int plane, int row, const RowRange& r) {
            const RowRange& stays = now.row(plane, row);
            for (const auto& [begin, end] : {RowRange{r.begin, std::min(r.end, stays.begin)},
                                             RowRange{std::max(r.begin, stays.end), r.end}})
                for (int a = 0; a < Dim; ++a) {
                    const bool inner = a == Layout<Dim>::inner, given = sides_[a][0] == Side::inflow;
                    if (given && !inner && (a == Layout<Dim>::outer ? plane : row) == 0) continue;
                    const int first = std::max(begin, given && inner ? 1 : 0);
                    State* const values = u[a].data() + layout_.row_start(plane, row);
                    if (first < end) std::fill(values + first, values + end, State(0));
                }
        });
    }

    /// A face between dry cells that hold liquid: it moves as the mean of the faces of wet cells beside it.
    struct Rider {
        Offset face = 0, carrier = 0;
        Real share = 0;  ///< of its liquid that this carrier bears [-]
    };
    const std::vector<Rider>& riders(int a) const noexcept { return riders_[a]; }  ///< of the last extension

private:
    static constexpr std::uint8_t unknown = 0, known = 1;
    static constexpr std::uint8_t fixed =
        2;  ///< what is there is of no use to others: closed, or a side's own

    /// Faces of wet cells are known, closed ones fixed at 0.
    template <class State>
    void begin(int a, Field<State>& u, const Field<std::uint8_t>& wet, const WetRows<Dim>& rows) {
        const Offset back = layout_.stride[a];
        const bool walls = walls_ != nullptr;
        rows.for_each_row([&](int plane, int row, const RowRange& r) {
            const Offset start = layout_.row_start(plane, row);
            const std::uint8_t* const __restrict here = wet.data() + start;
            const std::uint8_t* const __restrict closed = walls ? closed_[a].data() + start : here;
            std::uint8_t* const __restrict state = state_.data() + start;
            State* const __restrict v = u.data() + start;
            const std::uint8_t* const __restrict there = here - back;
            for (int first = Layout<Dim>::pack(r.begin); first < r.end; first += lanes) {
                if (!walls || !any(closed + first)) {
#pragma omp simd
                    for (int i = first; i < first + lanes; ++i)
                        state[i] = static_cast<std::uint8_t>(here[i] | there[i]);
                    continue;
                }
                static_assert(known == 1 && fixed == 2);
#pragma omp simd
                for (int i = first; i < first + lanes; ++i)
                    state[i] =
                        static_cast<std::uint8_t>(((here[i] | there[i]) & ~closed[i]) | closed[i] << 1);
#pragma omp simd
                for (int i = first; i < first + lanes; ++i) {
                    const State value = v[i];
                    v[i] = closed[i] != 0 ? State(0) : value;
                }
            }
            trim(state, r);
            if (sides_.periodic(a)) return;
            const auto fix = [&](std::uint8_t& s) { s = s == known ? known : fixed; };
            if (a == Layout<Dim>::inner) {
                if (r.begin == 0) fix(state[0]);
            } else if ((a == Layout<Dim>::outer ? plane : row) == 0) {
                for (int i = r.begin; i < r.end; ++i) fix(state[i]);
            }
        });
    }

    /// Whether one byte of a pack is not 0.
    static bool any(const std::uint8_t* pack) noexcept {
        std::uint64_t eights[lanes / 8], all = 0;
        std::memcpy(eights, pack, sizeof eights);
        for (const std::uint64_t eight : eights) all |= eight;
        return all != 0;
    }
    static bool any_unknown(const std::uint8_t* state) noexcept {
        alignas(lanes) std::uint8_t is[lanes];
#pragma omp simd
        for (int k = 0; k < lanes; ++k) is[k] = state[k] == unknown;
        return any(is);
    }

    /// What whole packs have set around a row's range is unknown.
    static void trim(std::uint8_t* state, const RowRange& r) noexcept {
        const int first = Layout<Dim>::pack(r.begin), last = Layout<Dim>::pack(r.end + lanes - 1);
        std::fill_n(state + first, r.begin - first, unknown);
        std::fill_n(state + r.end, last - r.end, unknown);
    }

    /// One layer.
    template <class State>
    void take_means(Field<State>& u, const WetRows<Dim>& rows) {
        rows.for_each_plane([&](int plane) {
            std::vector<Offset>& found = found_[static_cast<std::size_t>(plane)];
            found.clear();
            for (int row = 0; row < layout_.rows_per_plane(); ++row) {
                const RowRange r = rows.row(plane, row);
                const Offset start = layout_.row_start(plane, row);
                for_edge_cells(state_, layout_, start, r, [&](int i) { found.push_back(start + i); });
            }
            // None of them is known before all have their value.
            for (const Offset c : found) take_mean(u, c);
        });
    }
    /// Faces beyond periodic sides are those inside.
    template <class State>
    void join(Field<State>& u) {
        fill_periodic(state_, layout_, sides_);
        fill_periodic(u, layout_, sides_);
    }
    Offset inside(Offset face) const noexcept {
        const CellNumber<Dim> number = layout_.number(face);
        for (int a = 0; a < Dim; ++a)
            if (sides_.periodic(a))
                face += layout_.cells[a] * layout_.stride[a] *
                        ((number[a] < 0) - (number[a] >= layout_.cells[a]));
        return face;
    }
    /// Of what is known beside a face; answers whether anything is.
    template <class State>
    bool take_mean(Field<State>& u, Offset c) const noexcept {
        State sum = 0;
        int count = 0;
        for (const Offset s : layout_.stride)
            for (const Offset n : {c - s, c + s})
                if (state_[n] == known) sum += u[n], ++count;
        if (count > 0) u[c] = sum / static_cast<State>(count);
        return count > 0;
    }
    void know_found(const WetRows<Dim>& rows) {
        rows.for_each_plane([&](int plane) {
            for (const Offset c : found_[static_cast<std::size_t>(plane)]) state_[c] = known;
        });
    }

    /// Farther along water on walls; what is not reached flies on.
    template <class State>
    void extend_wedges(Field<State>& u, const WetRows<Dim>& rows) {
        rows.for_each_plane([&](int plane) { found_[static_cast<std::size_t>(plane)].clear(); });
        for (int layer = layers; layer < wedge; ++layer) {
            join(u);
            for (std::size_t p = 0; p < waiting_.size(); ++p)
                for (const Offset c : waiting_[p])
                    if (state_[c] == unknown && take_mean(u, c)) found_[p].push_back(c);
            know_found(rows);
        }
        for (auto& waiting : waiting_) {
            for (const Offset c : waiting)
                if (state_[c] == unknown) state_[c] = known;
            waiting.clear();
        }
    }

    /// While faces of the first layer are found, but not yet known.
    void find_riders(int a, const Field<Real>& held, const WetRows<Dim>& rows) {
        const auto wet = [&](Offset c) { return state_[c] == known; };
        rows.for_each_plane([&](int plane) {
            std::vector<Rider>& riders = riders_in_[static_cast<std::size_t>(plane)];
            riders.clear();
            for (const Offset c : found_[static_cast<std::size_t>(plane)]) {
                if (held[c] + held[c - layout_.stride[a]] < liquid_of_a_face) continue;
                int count = 0;
                for (const Offset s : layout_.stride) count += wet(c - s) + wet(c + s);
                for (const Offset s : layout_.stride)
                    for (const Offset n : {c - s, c + s})
                        if (wet(n)) riders.push_back({c, inside(n), 1.0 / count});
            }
        });
        for (const auto& riders : riders_in_)
            riders_[a].insert(riders_[a].end(), riders.begin(), riders.end());
    }

    /// Drops and sheets thinner than a cell. Not beside cells that walls cut: where a surface meets a wall
    /// at a shallow angle it ends in a wedge of several such cells, which lies on the wall.
    void know_liquid(int a, const Field<Real>& held, const WetRows<Dim>& rows) {
        const Offset back = layout_.stride[a];
        rows.for_each_row([&](int plane, int row, const RowRange& r) {
            const Offset start = layout_.row_start(plane, row);
            const Real* const h = held.data() + start;
            const Real* const open = walls_ ? walls_->open_volume().data() + start : nullptr;
            std::uint8_t* const state = state_.data() + start;
            for (int first = Layout<Dim>::pack(r.begin); first < r.end; first += lanes) {
                if (!any_unknown(state + first)) continue;
                for (int i = std::max(first, r.begin); i < std::min(first + lanes, r.end); ++i) {
                    if (state[i] != unknown || !(h[i] + h[i - back] > liquid_of_a_face)) continue;
                    if (!open || (open[i] == 1 && open[i - back] == 1))
                        state[i] = known;
                    else
                        waiting_[static_cast<std::size_t>(plane)].push_back(start + i);
                }
            }
        });
    }

    static constexpr int lanes = Layout<Dim>::lanes;
    Layout<Dim> layout_;
    Sides<Dim> sides_;
    const Walls<Dim>* walls_ = nullptr;
    FaceField<Dim, std::uint8_t> closed_;  ///< 1 where walls close a face; a byte of it costs less to read
    Field<std::uint8_t> state_;
    WetRows<Dim> before_;  ///< looked at the last time
    PerAxis<std::vector<Rider>, Dim> riders_;
    std::vector<std::vector<Offset>> found_;     ///< [plane] faces of a layer
    std::vector<std::vector<Offset>> waiting_;   ///< [plane] faces of water on walls
    std::vector<std::vector<Rider>> riders_in_;  ///< [plane]
};

}  // namespace abrade
