#pragma once
// Velocities of the air beside water, and of the liquid in it: the water's, carried on outward.

#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>
#include <abrade/fluid/mesh/volume_tolerance.hpp>
#include <abrade/fluid/mesh/water_cells.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace abrade {

/// Faces between dry cells get the mean of those beside them that are nearer to the water, layer by layer
/// outward, as far as the stencils of the next step reach. Liquid among them:
/// - beside a face of a wet cell (first layer) a face is slaved to that, its master face;
/// - in the second and third layer, with walls or without, and along cells that walls cut up to layer `wedge`
///   (a surface ends there in several cells that have no pressure), it has a velocity of its own, which the
///   pressure of the water may only reduce: v = own + push, push between 0 and -own,
///   push: the change of what the layers carry to it. Liquid of other faces could otherwise gain a speed
///   whose momentum no one gave;
/// - farther off it flies on as it does: drops and sheets thinner than a cell.
/// Same bits for any number of threads.
template <int Dim>
class VelocityExtension {
public:
    static constexpr int layers = 3;
    static constexpr int wedge = 8;  ///< longest of water on a wall that has no pressure of its own [cells]

    VelocityExtension(const Layout<Dim>& layout, const BoundaryConditions<Dim>& boundaries)
        : layout_(layout), boundaries_(boundaries), rows_(layout),
          waiting_(static_cast<std::size_t>(layout.planes())) {
        for (auto& state : state_) state = Field<std::uint8_t>(layout.total, unknown);
        for (auto* lists : {&slaved_, &carried_})
            for (auto& of_axis : *lists) of_axis.resize(waiting_.size());
        for (auto& of_axis : means_)
            for (auto& of_layer : of_axis) of_layer.resize(waiting_.size());
    }

    /// Walls that close faces; they must outlive this.
    void set_walls(const EmbeddedBoundary<Dim>& walls) {
        walls_ = &walls;
        for (int a = 0; a < Dim; ++a) {
            closed_[a] = Field<std::uint8_t>(layout_.total, 0);
            walls.grid().for_each(
                [&](const CellNumber<Dim>&, Offset c) { closed_[a][c] = walls.aperture()[a][c] == 0; });
        }
    }

    struct Water {
        const Field<std::uint8_t>& wet;      ///< 1 in cells that have a pressure, ghosts included
        const WetRows<Dim>& rows;            ///< to be looked at
        const Field<Real>& liquid_fraction;  ///< share of a cell that liquid fills [-]
        std::span<const WaterFace> still{};  ///< faces of wet cells that no pressure moves
    };

    /// Finds which faces lie in which layer, until water has moved.
    void find(const Water& water) {
        for (int a = 0; a < Dim; ++a) {
            // Where water has left nothing is known any more.
            rows_.for_each_row([&](int plane, int row, const RowRange& r) {
                std::fill_n(state_[a].data() + layout_.row_start(plane, row) + r.begin, r.length(), unknown);
            });
            begin(a, water);
            for (const WaterFace& face : water.still)
                if (face.axis == a) state_[a][face.face] = closed;
            for (int layer = 0; layer < layers; ++layer) {
                find_layer(a, layer, water.rows);
                if (layer == 0) find_slaved(a, water);
                know(a, layer);
                if (layer == 0) find_liquid(a, water);
            }
            find_wedges(a);
        }
        rows_ = water.rows;
    }

    /// Velocities of the air and of the liquid in it.
    template <class State>
    void extend(FaceField<Dim, State>& u) {
        for (int a = 0; a < Dim; ++a) {
            for_each_slaved(*this, a, [&](SlavedFace& slaved) { slaved.own = u[a][slaved.face]; });
            for (Film& film : films_[a]) film.own = u[a][film.face];
            take_means(a, u[a]);
            for (Film& film : films_[a]) {
                const Real led = u[a][film.face], push = led - film.led.value_or(film.own);
                const auto [least, most] = std::minmax({-film.own, Real(0)});
                u[a][film.face] = static_cast<State>(film.own + std::clamp(push, least, most));
                film.led = led;
            }
            clear_unknown(a, u[a]);
        }
    }

    /// Before a pressure pushes the water: what it carries outward until then.
    template <class State>
    void lead(FaceField<Dim, State>& u) {
        for (int a = 0; a < Dim; ++a) {
            if (films_[a].empty()) continue;
            for (Film& film : films_[a]) film.own = u[a][film.face];
            take_means(a, u[a]);
            for (Film& film : films_[a]) film.led = std::exchange(u[a][film.face], film.own);
        }
    }

    /// To what is a face's own, before and after something else changes the velocity that it was given.
    template <class State>
    void add_to_own(const FaceField<Dim, State>& u, Real times) {
        for (int a = 0; a < Dim; ++a) {
            for_each_slaved(*this, a, [&](SlavedFace& slaved) { slaved.own += times * u[a][slaved.face]; });
            for (Film& film : films_[a]) film.own += times * u[a][film.face];
        }
    }

    /// Slaved faces and films begin with the velocities of their own.
    template <class State>
    void give_own(FaceField<Dim, State>& u) const {
        for (int a = 0; a < Dim; ++a) {
            for_each_slaved(*this, a, [&](const SlavedFace& slaved) {
                u[a][slaved.face] = static_cast<State>(slaved.own);
            });
            for (const Film& film : films_[a]) u[a][film.face] = static_cast<State>(film.own);
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
                    const bool inner = a == Layout<Dim>::inner, given = boundaries_[a][0] == Boundary::inflow;
                    if (given && !inner && (a == Layout<Dim>::outer ? plane : row) == 0) continue;
                    const int first = std::max(begin, given && inner ? 1 : 0);
                    State* const values = u[a].data() + layout_.row_start(plane, row);
                    if (first < end) std::fill(values + first, values + end, State(0));
                }
        });
    }

    /// A face between dry cells that hold liquid: it moves as the mean of the faces of wet cells beside it.
    struct SlavedFace {
        Offset face = 0, master = 0;
        Real share = 0;  ///< of its liquid that this master face bears [-]
        Real own = 0;    ///< what it moved at by itself in the last extension [m/s]
    };
    /// By the planes of their master faces, those of a master one after the other; `own` is not theirs.
    const std::vector<std::vector<SlavedFace>>& carried(int a) const noexcept { return carried_[a]; }

    static void fields(auto&& field) {
        field("state", &VelocityExtension::state_), field("rows", &VelocityExtension::rows_),
            field.bytes("means", &VelocityExtension::means_),
            field.bytes("slaved", &VelocityExtension::slaved_),
            field.bytes("carried", &VelocityExtension::carried_),
            field.bytes("films", &VelocityExtension::films_);
    }

private:
    static constexpr std::uint8_t unknown = 0, known = 1;
    static constexpr std::uint8_t fixed = 2;   ///< a side's own: of no use to others
    static constexpr std::uint8_t closed = 4;  ///< of no use to others, and 0
    static constexpr std::uint8_t has_value = known | fixed;

    /// A face that has the mean of those known beside it; bit 2 n + 1 of `from` is the upper one along axis
    /// n.
    struct Mean {
        Offset face = 0;
        unsigned from = 0;
    };
    struct Film {
        Offset face = 0;
        Real own = 0;               ///< see SlavedFace
        std::optional<Real> led{};  ///< what the layers carried to it last [m/s]
    };

    /// Faces of wet cells are known, but for still ones.
    void begin(int a, const Water& water) {
        const Offset back = layout_.stride[a];
        const bool walls = walls_ != nullptr;
        water.rows.for_each_row([&](int plane, int row, const RowRange& r) {
            const Offset start = layout_.row_start(plane, row);
            const std::uint8_t* const __restrict here = water.wet.data() + start;
            const std::uint8_t* const __restrict shut = walls ? closed_[a].data() + start : here;
            std::uint8_t* const __restrict state = state_[a].data() + start;
            const std::uint8_t* const __restrict there = here - back;
            static_assert(known == 1 && closed == 4);
            for (int first = Layout<Dim>::pack(r.begin); first < r.end; first += lanes)
                if (walls)
#pragma omp simd
                    for (int i = first; i < first + lanes; ++i)
                        state[i] =
                            static_cast<std::uint8_t>(((here[i] | there[i]) & ~shut[i]) | shut[i] << 2);
                else
#pragma omp simd
                    for (int i = first; i < first + lanes; ++i)
                        state[i] = static_cast<std::uint8_t>(here[i] | there[i]);
            trim(state, r);
            if (boundaries_.periodic(a)) return;
            const auto fix = [&](std::uint8_t& s) { s = s == unknown ? fixed : s; };
            if (a == Layout<Dim>::inner) {
                if (r.begin == 0) fix(state[0]);
            } else if ((a == Layout<Dim>::outer ? plane : row) == 0) {
                for (int i = r.begin; i < r.end; ++i) fix(state[i]);
            }
        });
    }

    /// Whether one of a pack has no value.
    static bool any_without(const std::uint8_t* state) noexcept {
        alignas(lanes) std::uint8_t is[lanes];
#pragma omp simd
        for (int k = 0; k < lanes; ++k) is[k] = (state[k] & has_value) == 0;
        return detail::any_byte<lanes>(is);
    }

    /// What whole packs have set around a row's range is unknown.
    static void trim(std::uint8_t* state, const RowRange& r) noexcept {
        const int first = Layout<Dim>::pack(r.begin), last = Layout<Dim>::pack(r.end + lanes - 1);
        std::fill_n(state + first, r.begin - first, unknown);
        std::fill_n(state + r.end, last - r.end, unknown);
    }

    unsigned known_beside(int a, Offset c) const noexcept {
        unsigned from = 0;
        for (int n = 0; n < Dim; ++n) {
            const Offset s = layout_.stride[n];
            from |= unsigned{state_[a][c - s] == known} << 2 * n | unsigned{state_[a][c + s] == known}
                                                                       << (2 * n + 1);
        }
        return from;
    }
    void for_known_beside(const Mean& mean, auto&& body) const {
        for (int n = 0; n < Dim; ++n) {
            if (mean.from >> 2 * n & 1) body(mean.face - layout_.stride[n]);
            if (mean.from >> (2 * n + 1) & 1) body(mean.face + layout_.stride[n]);
        }
    }

    /// The faces of a layer; none of them is known before all are found.
    void find_layer(int a, int layer, const WetRows<Dim>& rows) {
        fill_periodic(state_[a], layout_, boundaries_);
        for (auto& means : means_[a][layer]) means.clear();
        rows.for_each_plane([&](int plane) {
            auto& means = means_[a][layer][static_cast<std::size_t>(plane)];
            for (int row = 0; row < layout_.rows_per_plane(); ++row) {
                const Offset start = layout_.row_start(plane, row);
                for_edge_cells(state_[a], layout_, start, rows.row(plane, row), [&](int i) {
                    means.push_back({start + i, known_beside(a, start + i)});
                });
            }
        });
    }
    void know(int a, int layer) {
        by_planes([&](std::size_t plane) {
            for (const Mean& mean : means_[a][layer][plane]) state_[a][mean.face] = known;
        });
    }

    /// Farther along water on walls; what no layer has reached flies on, the others are films.
    void find_wedges(int a) {
        for (int layer = layers; layer < wedge; ++layer) {
            fill_periodic(state_[a], layout_, boundaries_);
            by_planes([&](std::size_t p) {
                auto& means = means_[a][layer][p];
                means.clear();
                for (const Offset c : waiting_[p])
                    if (const unsigned from = known_beside(a, c);
                        state_[a][c] == unknown && from != 0 && is_cut(c, layout_.stride[a]))
                        means.push_back({c, from});
            });
            know(a, layer);
        }
        films_[a].clear();
        for (auto& waiting : waiting_) {
            for (const Offset c : waiting)
                if (std::exchange(state_[a][c], known) == known) films_[a].push_back({c});
            waiting.clear();
        }
    }

    template <class State>
    void take_means(int a, Field<State>& u) const {
        for (const auto& of_layer : means_[a]) {
            fill_periodic(u, layout_, boundaries_);
            by_planes([&](std::size_t plane) {
                for (const Mean& mean : of_layer[plane]) {
                    State sum = 0;
                    for_known_beside(mean, [&](Offset n) { sum += u[n]; });
                    u[mean.face] = sum / static_cast<State>(std::popcount(mean.from));
                }
            });
        }
    }

    template <class State>
    void clear_unknown(int a, Field<State>& u) const {
        rows_.for_each_row([&](int plane, int row, const RowRange& r) {
            const Offset start = layout_.row_start(plane, row);
            State* const __restrict v = u.data() + start;
            const std::uint8_t* const __restrict state = state_[a].data() + start;
            for (int first = Layout<Dim>::pack(r.begin); first < r.end; first += lanes) {
                if (!any_without(state + first)) continue;
                for (int i = std::max(first, r.begin); i < std::min(first + lanes, r.end); ++i)
                    v[i] = (state[i] & has_value) == 0 ? State(0) : v[i];
            }
        });
    }

    /// Faces beyond periodic sides are those inside.
    Offset inside(Offset face) const noexcept {
        const CellNumber<Dim> number = layout_.number(face);
        for (int a = 0; a < Dim; ++a)
            if (boundaries_.periodic(a))
                face += layout_.cells[a] * layout_.stride[a] *
                        ((number[a] < 0) - (number[a] >= layout_.cells[a]));
        return face;
    }

    /// Those of the first layer that hold liquid; and again by the planes of their master faces.
    void find_slaved(int a, const Water& water) {
        water.rows.for_each_plane([&](int plane) {
            std::vector<SlavedFace>& slaved = slaved_[a][static_cast<std::size_t>(plane)];
            slaved.clear();
            for (const Mean& mean : means_[a][0][static_cast<std::size_t>(plane)]) {
                if (water.liquid_fraction[mean.face] + water.liquid_fraction[mean.face - layout_.stride[a]] <
                    volume_tolerance::face)
                    continue;
                const Real share = 1.0 / std::popcount(mean.from);
                for_known_beside(mean, [&](Offset n) { slaved.push_back({mean.face, inside(n), share}); });
            }
        });
        const std::size_t planes = waiting_.size();
        by_planes([&](std::size_t plane) {
            std::vector<SlavedFace>& carried = carried_[a][plane];
            carried.clear();
            const Offset begin = layout_.row_start(static_cast<int>(plane), 0) - Layout<Dim>::lanes;
            const std::size_t near[] = {(plane + planes - 1) % planes, plane, (plane + 1) % planes};
            for (std::size_t n = 0; n < std::min<std::size_t>(planes, 3); ++n)
                for (const SlavedFace& slaved : slaved_[a][near[n]])
                    if (slaved.master >= begin && slaved.master < begin + layout_.stride[Layout<Dim>::outer])
                        carried.push_back(slaved);
            std::sort(carried.begin(), carried.end(), [](const SlavedFace& r, const SlavedFace& s) {
                return std::pair(r.master, r.face) < std::pair(s.master, s.face);
            });
        });
    }
    static void for_each_slaved(auto& self, int a, auto&& visit) {
        self.by_planes([&](std::size_t plane) {
            for (auto& slaved : self.slaved_[a][plane]) visit(slaved);
        });
    }
    void by_planes(auto&& body) const {
        parallel_for(
            static_cast<Index>(waiting_.size()), [&](Index plane) { body(static_cast<std::size_t>(plane)); },
            block_of_planes);
    }

    /// Faces that hold liquid and are not slaved wait for what is carried to them.
    void find_liquid(int a, const Water& water) {
        const Offset back = layout_.stride[a];
        water.rows.for_each_row([&](int plane, int row, const RowRange& r) {
            const Offset start = layout_.row_start(plane, row);
            const Real* const h = water.liquid_fraction.data() + start;
            const std::uint8_t* const state = state_[a].data() + start;
            for (int first = Layout<Dim>::pack(r.begin); first < r.end; first += lanes) {
                if (!any_without(state + first)) continue;
                for (int i = std::max(first, r.begin); i < std::min(first + lanes, r.end); ++i)
                    if (state[i] == unknown && h[i] + h[i - back] > volume_tolerance::face)
                        waiting_[static_cast<std::size_t>(plane)].push_back(start + i);
            }
        });
    }
    bool is_cut(Offset face, Offset back) const noexcept {
        return walls_ && (walls_->open_fraction()[face] < 1 || walls_->open_fraction()[face - back] < 1);
    }

    static constexpr int lanes = Layout<Dim>::lanes;
    Layout<Dim> layout_;
    BoundaryConditions<Dim> boundaries_;
    const EmbeddedBoundary<Dim>* walls_ = nullptr;
    FaceField<Dim, std::uint8_t> closed_;  ///< 1 where walls close a face; a byte of it costs less to read
    FaceField<Dim, std::uint8_t> state_;
    WetRows<Dim> rows_;                                                    ///< looked at
    PerAxis<PerAxis<std::vector<std::vector<Mean>>, wedge>, Dim> means_;   ///< [component][layer][plane]
    PerAxis<std::vector<std::vector<SlavedFace>>, Dim> slaved_, carried_;  ///< [component][plane]
    PerAxis<std::vector<Film>, Dim> films_;
    std::vector<std::vector<Offset>> waiting_;  ///< [plane] faces with liquid that are not slaved
};

}  // namespace abrade
