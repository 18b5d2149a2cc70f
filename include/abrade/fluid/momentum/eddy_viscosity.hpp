#pragma once
// The eddy viscosity of cells, from the velocity on their faces.

#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>
#include <abrade/fluid/mesh/level_table.hpp>
#include <abrade/fluid/mesh/solid_parts.hpp>
#include <abrade/fluid/momentum/turbulence.hpp>
#include <abrade/fluid/setup/grid_fluid_params.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace abrade::detail {

/// nu_t in cells [m2/s]. Of a model with a mixing length it is l^2 |S|,
///   |S|^2 = 2 S_ij S_ij = 2 sum_a (du_a/dx_a)^2 + sum_{a<b} <(du_a/dx_b + du_b/dx_a)^2>,
/// <> the mean over those of the cell's four edges whose shear the grid knows: not beside closed faces, not
/// on logarithmic sides, where the velocity falls to 0 within the cell, and not where water leaves the box,
/// since of the air there no velocity is known. Other models are given the mean of the gradient over the same
/// edges.
///
/// l, and the d that models are given, come from the distance of the middle of what is open of a cell from
/// what the params call walls: sides, and the wall inside, taken as a distance. Same bits for any number of
/// threads.
template <int Dim, class State, TurbulenceModel Model>
class EddyViscosity {
    static constexpr bool has_length = HasMixingLength<Model>, has_bound = ModelsMeanFlow<Model>;
    static constexpr int lanes = Layout<Dim>::lanes, vertical = Grid<Dim>::vertical,
                         pairs = Dim * (Dim - 1) / 2;
    using Table = LevelTable<Dim, State>;

public:
    /// `walls` may be none.
    EddyViscosity(const Grid<Dim>& grid, const GridFluidParams<Dim>& params, const Model& model,
                  const EmbeddedBoundary<Dim>* walls, bool among_bodies = false)
        : layout_(grid.layout()), model_(model), field_(layout_.total), all_(WetRows<Dim>::whole(layout_)),
          most_(static_cast<std::size_t>(layout_.planes())),
          viscosity_(static_cast<State>(params.viscosity / params.density)) {
        (has_length ? length2_ : size_) = Field<State>(layout_.total);
        if constexpr (!has_length) distance_ = Field<State>(layout_.total);
        if constexpr (has_bound) {
            if (among_bodies) model.validate_among_bodies();
            bound_ = Field<State>(layout_.total);
        }
        for (int a = 0; a < Dim; ++a) {
            per_size_[a] = Table(grid, [&](int k) { return 1 / grid.size(a, a == vertical ? k : 0); });
            per_gap_[a] = Table(grid, [&](int k) { return 1 / grid.gap(a, a == vertical ? k : 0); });
        }
        const auto set_length = [&](const CellNumber<Dim>& cell, Offset c, const Point<Dim>& middle) {
            const Real size = std::pow(grid.volume(cell), 1.0 / Dim);
            const Real d = wall_distance(grid, params, middle);
            if constexpr (has_length)
                length2_[c] = static_cast<State>(square(model.length(size, d)));
            else
                size_[c] = static_cast<State>(size), distance_[c] = static_cast<State>(d);
            if constexpr (has_bound) bound_[c] = static_cast<State>(model.largest(d));
        };
        grid.for_each([&](const CellNumber<Dim>& cell, Offset c) { set_length(cell, c, grid.centre(cell)); });
        if (walls)
            for (const CutCell<Dim>& w : walls->cut_cells()) {
                const CellNumber<Dim> cell = layout_.number(w.cell);
                Point<Dim> middle = grid.centre(cell);
                for (int b = 0; b < Dim; ++b)
                    middle[b] +=
                        0.5 * (1 - walls->open_fraction()[w.cell]) * w.normal[b] * grid.size(b, cell[b]);
                set_length(cell, w.cell, middle);
            }
        bool leaves = false;
        for (const auto& ends : params.boundaries.kind)
            leaves = leaves || ends[0] == Boundary::outflow || ends[1] == Boundary::outflow;
        if (walls || leaves || params.wall_law.kind == WallLaw::Kind::logarithmic)
            find_known(grid, params, walls);
    }

    /// `liquid_fraction`: liquid in a cell [-], up to 0.01 of which there are no eddies (`least_liquid`);
    /// with `rows`, that hold it. None: all cells are full.
    void find(const FaceField<Dim, State>& u, const VelocityBoundaries<Dim>& boundaries,
              const WetRows<Dim>* rows = nullptr, const Field<Real>* liquid_fraction = nullptr) {
        const WetRows<Dim>& looked_at = rows ? *rows : all_;
        looked_at.for_each_plane([&](int plane) {
            State most = 0;
            for (int row = 0; row < layout_.rows_per_plane(); ++row) {
                const RowRange r = looked_at.row(plane, row);
                if (r.empty()) continue;
                const Offset start = layout_.row_start(plane, row);
                State* const nu = field_.data() + start;
                if constexpr (has_length)
                    by_length(u, row, start, r);
                else
                    by_gradient(u, row, start, r);
                if constexpr (has_bound) {
                    const State* const __restrict bound = bound_.data() + start;
                    for (int i = r.begin; i < r.end; ++i) nu[i] = std::min(nu[i], bound[i]);
                }
                if (liquid_fraction) {
                    const Real* const __restrict h = liquid_fraction->data() + start;
                    for (int i = r.begin; i < r.end; ++i) nu[i] = h[i] > least_liquid ? nu[i] : State(0);
                }
                for (int i = r.begin; i < r.end; ++i) most = std::max(most, nu[i]);
            }
            most_[static_cast<std::size_t>(plane)] = most;
        });
        largest_ = *std::max_element(most_.begin(), most_.end());
        boundaries.fill_cells(field_, rows);
        // No eddy reaches through a wall that is resolved: the mean of a cell and its mirror is 0.
        boundaries.for_sides(Boundary::wall, [&](int a, bool high) {
            const Offset out = high ? layout_.stride[a] : -layout_.stride[a];
            boundaries.along_side({a, high, rows},
                                  [&](Offset c, std::size_t) { field_[c + out] = -field_[c]; });
        });
        looked_at.for_each_plane([&](int plane) {
            State& most = most_[static_cast<std::size_t>(plane)];
            most = 0;
            for (int row = 0; row < layout_.rows_per_plane(); ++row)
                if (const RowRange r = looked_at.row(plane, row); !r.empty())
                    most = std::max(most,
                                    fastest_rate(u, row, layout_.row_start(plane, row), r, liquid_fraction));
        });
        rate_ = *std::max_element(most_.begin(), most_.end());
    }

    /// Beside what solids cover of cells, across faces, edges and corners, eddies are those that a cell does
    /// not resolve, from here on; of a model of the mean flow.
    void make_way(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries,
                  std::span<const SolidPart> solids) requires(Dim == 3 && has_bound) {
        for (const Shortened& last : shortened_) length2_[last.cell] = last.length2;
        shortened_.clear();
        for (const SolidPart& part : solids) {
            const CellNumber<3> middle = layout_.number(part.cell);
            PerAxis<std::array<Offset, 3>, 3> beside{};
            for (int a = 0; a < 3; ++a)
                for (int n = -1; n <= 1; ++n)
                    beside[a][at(n + 1)] =
                        layout_.stride[a] * (around(grid, boundaries, a, middle[a] + n) - middle[a]);
            const Real longest = model_.beside_bodies() * std::cbrt(grid.volume(middle));
            const auto most = static_cast<State>(square(longest));
            for (const Offset i : beside[0])
                for (const Offset j : beside[1])
                    for (const Offset k : beside[2]) {
                        const Offset c = part.cell + i + j + k;
                        if (length2_[c] > most) shortened_.push_back({c, std::exchange(length2_[c], most)});
                    }
        }
    }

    Field<State>& field() noexcept { return field_; }
    const Field<State>& field() const noexcept { return field_; }
    Real largest() const noexcept { return largest_; }  ///< [m2/s]
    /// Of cells that hold liquid the largest sum over axes of |u_a| / h_a + 2 (nu + nu_t) / h_a^2 [1/s]; nu_t
    /// is the mean of both its faces along the axis.
    Real rate() const noexcept { return rate_; }

    static void fields(auto&& field) {
        field("field", "m2/s", &EddyViscosity::field_), field("largest", "m2/s", &EddyViscosity::largest_);
        field("rate", "1/s", &EddyViscosity::rate_);
    }

private:
    /// Liquid that fills less of a cell has no layers for eddies to mix; beside it velocities are the air's.
    static constexpr Real least_liquid = 0.01;

    /// A plane of the strain's shear.
    struct Pair {
        int a, b, number;
    };

    struct Shortened {
        Offset cell;
        State length2;
    };

    static std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }
    /// Of the cells along a: beyond a side the last one, or where it comes in again.
    static int around(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries, int a,
                      int i) noexcept {
        const int n = grid.cells(a);
        return boundaries.periodic(a) ? (i + n) % n : std::clamp(i, 0, n - 1);
    }

    static Real wall_distance(const Grid<Dim>& grid, const GridFluidParams<Dim>& params,
                              const Point<Dim>& x) {
        Real d = params.wall ? params.wall(x) : std::numeric_limits<Real>::infinity();
        for (int a = 0; a < Dim; ++a) {
            if (params.boundaries[a][0] == Boundary::wall) d = std::min(d, x[a] - grid.low(a));
            if (params.boundaries[a][1] == Boundary::wall) d = std::min(d, grid.high(a) - x[a]);
        }
        return d;
    }

    /// Edges at the lower corner of each cell whose shear counts: 1, else 0.
    void find_known(const Grid<Dim>& grid, const GridFluidParams<Dim>& params,
                    const EmbeddedBoundary<Dim>* walls) {
        known_.resize(pairs);
        const bool logarithmic = params.wall_law.kind == WallLaw::Kind::logarithmic;
        const auto unknown = [&](Boundary side) {
            return (logarithmic && side == Boundary::wall) || side == Boundary::outflow;
        };
        const auto on_side = [&](int a, int i) {
            return (i == 0 && unknown(params.boundaries[a][0])) ||
                   (i == grid.cells(a) && unknown(params.boundaries[a][1]));
        };
        int pair = 0;
        for (int a = 0; a < Dim; ++a)
            for (int b = a + 1; b < Dim; ++b, ++pair) {
                auto& known = known_[static_cast<std::size_t>(pair)] = Field<State>(layout_.total);
                const Offset to_a = layout_.stride[a], to_b = layout_.stride[b];
                grid.for_each(
                    [&](const CellNumber<Dim>& cell, Offset c) {
                        bool open = true;
                        if (walls) {
                            const auto& area = walls->aperture();
                            open = area[a][c] > 0 && area[a][c - to_b] > 0 && area[b][c] > 0 &&
                                   area[b][c - to_a] > 0;
                        }
                        known[c] = open && !on_side(a, cell[a]) && !on_side(b, cell[b]);
                    },
                    1);
            }
    }

    void by_length(const FaceField<Dim, State>& u, int row, Offset start, RowRange r) noexcept {
        State* const nu = field_.data() + start;
        stretch(u, row, start, r);
        int pair = 0;
        for (int a = 0; a < Dim; ++a)
            for (int b = a + 1; b < Dim; ++b, ++pair)
                known_.empty() ? shear<false>(u, {a, b, pair}, row, start, r)
                               : shear<true>(u, {a, b, pair}, row, start, r);
        const State* const length2 = length2_.data() + start;
        // Whole packs, as they were set.
        for (int i = Layout<Dim>::pack(r.begin); i < r.end; i += lanes)
            for (int k = i; k < i + lanes; ++k) nu[k] = length2[k] * std::sqrt(nu[k]);
    }

    void by_gradient(const FaceField<Dim, State>& u, int row, Offset start, RowRange r) noexcept {
        for (int i = r.begin; i < r.end; ++i)
            field_[start + i] = static_cast<State>(
                model_.viscosity(gradient(u, row, start, i), size_[start + i], distance_[start + i]));
    }
    /// Where no edge of a pair of axes is known their shear counts as none.
    Mat3 gradient(const FaceField<Dim, State>& u, int row, Offset start, int i) const noexcept {
        Mat3 g = Mat3::Zero();
        const Offset c = start + i;
        for (int a = 0; a < Dim; ++a)
            g(a, a) = (u[a][c + layout_.stride[a]] - u[a][c]) * per_size_[a].row(row)[i];
        std::size_t pair = 0;
        for (int a = 0; a < Dim; ++a)
            for (int b = a + 1; b < Dim; ++b, ++pair) {
                Real count = 0;
                for (const int up_a : {0, 1})
                    for (const int up_b : {0, 1}) {
                        const Offset to_a = layout_.stride[a], to_b = layout_.stride[b],
                                     edge = c + up_a * to_a + up_b * to_b;
                        const Real known = known_.empty() ? 1 : known_[pair][edge];
                        g(a, b) += known * (u[a][edge] - u[a][edge - to_b]) * per_gap(b, row, i, up_b);
                        g(b, a) += known * (u[b][edge] - u[b][edge - to_a]) * per_gap(a, row, i, up_a);
                        count += known;
                    }
                if (count > 0) g(a, b) /= count, g(b, a) /= count;
            }
        return g;
    }
    /// Between a cell and the one below it along a, or above it (`up` 1) [1/m].
    State per_gap(int a, int row, int i, int up) const noexcept {
        return Dim == 3 ? per_gap_[a].row(row + up)[i] : per_gap_[a].row(row)[i + up];
    }

    /// 2 sum (du_a/dx_a)^2.
    void stretch(const FaceField<Dim, State>& u, int row, Offset start, RowRange r) noexcept {
        State* const __restrict sum = field_.data() + start;
        for (int a = 0; a < Dim; ++a) {
            const State* const __restrict v = u[a].data() + start;
            const State* const __restrict v_up = v + layout_.stride[a];
            const auto per_size = per_size_[a].row(row);
            const State before = a > 0;
            for (int i = Layout<Dim>::pack(r.begin); i < r.end; i += lanes)
#pragma omp simd
                for (int k = i; k < i + lanes; ++k) {
                    const State rate = (v_up[k] - v[k]) * per_size[k];
                    sum[k] = (before > 0 ? sum[k] : State(0)) + 2 * rate * rate;
                }
        }
    }

    /// See `rate`. Where there is no liquid nobody has set eddies.
    State fastest_rate(const FaceField<Dim, State>& u, int row, Offset start, RowRange r,
                       const Field<Real>* liquid_fraction) const noexcept {
        const State* const __restrict nu = field_.data() + start;
        std::array<State, static_cast<std::size_t>(lanes)> rate;
        State most = 0;
        for (int first = Layout<Dim>::pack(r.begin); first < r.end; first += lanes) {
            rate.fill(0);
            for (int a = 0; a < Dim; ++a) {
                const Offset s = layout_.stride[a];
                const State* const __restrict v = u[a].data() + start;
                const Real* const __restrict h = liquid_fraction ? liquid_fraction->data() + start : nullptr;
                const auto per_size = per_size_[a].row(row);
                const auto add = [&](auto eddies) {
#pragma omp simd
                    for (int k = 0; k < lanes; ++k) {
                        const int i = first + k;
                        const State twice = eddies(i) + State(0.5) * (eddies(i - s) + eddies(i + s));
                        rate[static_cast<std::size_t>(k)] +=
                            per_size[i] * (std::abs(v[i]) + per_size[i] * (2 * viscosity_ + twice));
                    }
                };
                if (liquid_fraction)
                    add([&](Offset i) { return h[i] > least_liquid ? nu[i] : State(0); });
                else
                    add([&](Offset i) { return nu[i]; });
            }
            for (int i = std::max(first, r.begin); i < std::min(first + lanes, r.end); ++i)
                if (!liquid_fraction || (*liquid_fraction)[start + i] > least_liquid)
                    most = std::max(most, rate[static_cast<std::size_t>(i - first)]);
        }
        return most;
    }

    /// Adds the mean square of the shear rates at the four edges.
    template <bool Weighted>
    void shear(const FaceField<Dim, State>& u, Pair p, int row, Offset start, RowRange r) noexcept {
        const Offset to_a = layout_.stride[p.a], to_b = layout_.stride[p.b];
        State* const __restrict sum = field_.data() + start;
        const State* const __restrict v = u[p.a].data() + start;
        const State* const __restrict w = u[p.b].data() + start;
        const State* const __restrict known =
            Weighted ? known_[static_cast<std::size_t>(p.number)].data() + start : v;
        // Of the cell's own level; those one level up only count along the vertical.
        const auto gap_a = per_gap_[p.a].row(row), gap_b = per_gap_[p.b].row(row),
                   gap_a_up = per_gap_[p.a].row(Dim == 3 ? row + 1 : row),
                   gap_b_up = per_gap_[p.b].row(Dim == 3 ? row + 1 : row);
        constexpr int next = Dim == 3 ? 0 : 1;
        for (int i = Layout<Dim>::pack(r.begin); i < r.end; i += lanes)
#pragma omp simd
            for (int k = i; k < i + lanes; ++k) {
                const State a0 = gap_a[k], a1 = gap_a_up[k + next], b0 = gap_b[k], b1 = gap_b_up[k + next];
                const auto square_at = [&](Offset at, State per_a, State per_b) {
                    const State rate = (v[at] - v[at - to_b]) * per_b + (w[at] - w[at - to_a]) * per_a;
                    return rate * rate;
                };
                const State s0 = square_at(k, a0, b0), s1 = square_at(k + to_a, a1, b0),
                            s2 = square_at(k + to_b, a0, b1), s3 = square_at(k + to_a + to_b, a1, b1);
                if constexpr (Weighted) {
                    const State w0 = known[k], w1 = known[k + to_a], w2 = known[k + to_b],
                                w3 = known[k + to_a + to_b];
                    const State all = w0 + w1 + w2 + w3, none = all > 0 ? State(0) : State(1);
                    sum[k] += (w0 * s0 + w1 * s1 + w2 * s2 + w3 * s3) / (all + none);
                } else {
                    sum[k] += State(0.25) * (s0 + s1 + s2 + s3);
                }
            }
    }

    Layout<Dim> layout_;
    Model model_;
    Field<State> field_;                ///< nu_t [m2/s]
    Field<State> length2_;              ///< l^2 [m2], of a model that has one
    Field<State> size_, distance_;      ///< Delta, d [m], of another
    Field<State> bound_;                ///< of nu_t [m2/s]; may be none
    std::vector<Shortened> shortened_;  ///< l^2 of cells beside solids, as it was without them
    std::vector<Field<State>> known_;   ///< [pair of axes]; none: all edges count
    PerAxis<Table, Dim> per_size_, per_gap_;
    WetRows<Dim> all_;
    std::vector<State> most_;  ///< [plane]
    State viscosity_ = 0;      ///< molecular, kinematic [m2/s]
    Real largest_ = 0, rate_ = 0;
};

}  // namespace abrade::detail
