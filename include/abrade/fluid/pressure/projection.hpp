#pragma once
// Makes a velocity free of divergence, and finds the pressure that does it.

#include <abrade/fluid/mesh/water_cells.hpp>
#include <abrade/fluid/pressure/conjugate_gradients.hpp>
#include <abrade/fluid/pressure/net_outflow.hpp>
#include <abrade/fluid/pressure/pressure_solver.hpp>

#include <cstdint>

namespace abrade {

/// Solves  div(grad phi) = div(u) - target  and takes grad phi from u; phi = p dt / density.
///
/// Tolerance: root mean square over the wet cells of |div u| dt, the share of its volume that a cell gains or
/// loses in a step. Solved in single precision (PressureSolver); what is left is computed from the velocity
/// itself in double, and solved for again, so the tolerance means what it says.
template <int Dim, class State, PressureSolver<Dim> Solver = ConjugateGradients<Dim>>
class Projection {
    static constexpr int outer = Layout<Dim>::outer, inner = Layout<Dim>::inner,
                         vertical = Grid<Dim>::vertical;

public:
    /// A box full of water.
    Projection(const Grid<Dim>& grid, const BoundaryConditions<Dim>& boundaries)
        : grid_(&grid), boundaries_(boundaries), outflow_(grid),
          solver_(grid.layout(), mean_size(grid), boundaries.periodic_axes()) {
        for (int b = 0; b < Dim; ++b) {
            const auto level_along = [b](int k) { return b == vertical ? k : 0; };
            per_gap_[b] = Table(grid, [&](int k) { return 1 / grid.gap(b, level_along(k)); });
            conductance_[b] = detail::LevelTable<Dim, float>(
                grid, [&](int k) { return area(b, k) / grid.gap(b, level_along(k)); });
        }
        for (auto& f : faces_) f = WetRows<Dim>(grid.layout());
        fill_box();
    }

    /// All cells are wet.
    template <class Solids = const NoSolids>
    void fill_box(Solids& solids = no_solids) {
        Field<std::uint8_t> wet(grid_->layout().total, 0);
        const auto rows = WetRows<Dim>::whole(grid_->layout());
        grid_->for_each([&](const CellNumber<Dim>&, Offset c) { wet[c] = 1; });
        const std::vector<OpenFace> open = outflows(wet);
        set({wet, rows, open}, solids);
    }

    /// Faces of wet cells at sides where water leaves.
    std::vector<OpenFace> outflows(const Field<std::uint8_t>& wet) const {
        std::vector<OpenFace> found;
        for (int a = 0; a < Dim; ++a)
            for (const int end : {0, 1}) {
                if (boundaries_[a][end] != Boundary::outflow) continue;
                grid_->for_each_beside(a, end == 1, [&](const CellNumber<Dim>& cell, Offset c) {
                    if (!wet[c]) return;
                    const Real slope = 2 / grid_->size(a, cell[a]);
                    found.push_back(
                        {end == 0 ? c : c + grid_->layout().stride[a], c, a, end == 0 ? slope : -slope});
                });
            }
        return found;
    }

    /// Takes over which cells are wet; builds the operator and its coarser ones.
    template <class Solids = const NoSolids>
    void set(const WaterCells<Dim>& water, [[maybe_unused]] Solids& solids = no_solids) {
        open_.assign(water.open.begin(), water.open.end());
        aperture_ = water.aperture;
        open_fraction_ = water.open_fraction;
        Poisson<Dim>& m = solver_.matrix();
        const Layout<Dim>& l = grid_->layout();
        for (int a = 0; a < Dim; ++a) m.interior[a] = static_cast<float>(area(a, 0) / grid_->gap(a, 0));
        water.rows.for_each_plane([&](int plane) {
            for (int row = 0; row < l.rows_per_plane(); ++row) conduct(water, plane, row);
        });
        if constexpr (Solids::present) solids.close(m, open_faces());
        for (std::size_t n = 0; n < open_.size(); ++n) {
            const OpenFace& open = open_[n];
            Real area = face_area(open);
            if constexpr (Solids::present) area *= solids.water_share(n);
            m.dirichlet[open.cell] += static_cast<float>(area * std::abs(open.slope));
        }
        solver_.build();
        if constexpr (Solids::present) solids.find_closed_cells(m);
        find_faces();
    }

    /// Faces between two wet cells.
    const PerAxis<WetRows<Dim>, Dim>& faces() const noexcept { return faces_; }
    std::span<const OpenFace> open_faces() const noexcept { return open_; }
    const Solver& solver() const noexcept { return solver_; }
    const FaceField<Dim>* aperture() const noexcept { return aperture_; }  ///< none: all open
    Index wet_cells() const noexcept { return wet_cells_; }

    struct Report {
        int iterations = 0, rounds = 0;
        /// Share of a cell's volume gained or lost in a step (or `relaxation_time`), root mean square [-].
        Real before = 0, after = 0;
        Real courant = 0;  ///< largest dt sum |u_a| / h_a over the wet cells [-]
    };

    struct Demand {
        Real step;       ///< dt [s]
        Real tolerance;  ///< of `Report::after` [-]
        bool push = false;
        /// Liquid that a cell holds beyond its volume, in shares of it [-], to be driven out; may be none.
        const Field<Real>* volume_defect = nullptr;
        /// A shorter step drives it out in this time [s], or a step that is next to nothing would shoot it
        /// out.
        Real relaxation_time = 0;
    };

    /// `u`: normal components at the sides set, ghosts not needed. `pressure` over density [m2/s2], 0 in dry
    /// cells, grows by phi / dt; with `push` its gradient is taken from u first.
    template <class Solids = const NoSolids>
    Report project(FaceField<Dim, State>& u, Field<State>& pressure, const Demand& asked,
                   Solids& solids = no_solids) {
        volume_defect_ = asked.volume_defect;
        step_ = asked.step, relaxation_time_ = std::max(asked.step, asked.relaxation_time);
        const Real tolerance = asked.tolerance;
        Report report;
        Real norm = asked.push ? correct(u, pressure, true, solids) : start(u);
        const Real unit = wet_cells_ > 0
                              ? relaxation_time_ / (mean_volume() * std::sqrt(static_cast<Real>(wet_cells_)))
                              : 0;
        report.before = report.after = norm * unit;
        constexpr int most_rounds = 6, most_iterations = 60;
        while (report.after > tolerance && report.rounds < most_rounds) {
            // Half of what is allowed, since single precision promises more than it keeps.
            const auto solved = solve(std::max(0.5 * tolerance / unit, 1e-5 * norm), most_iterations, solids);
            report.iterations += solved.iterations;
            ++report.rounds;
            const Real last = norm;
            norm = correct(u, pressure, false, solids);
            report.after = norm * unit;
            if (!(norm < last)) break;
        }
        for (const Real rate : rates_) report.courant = std::max(report.courant, rate * step_);
        return report;
    }

private:
    template <class Solids>
    auto solve(Real target, int limit, [[maybe_unused]] Solids& solids) {
        if constexpr (Solids::present)
            return solver_.solve(target, limit, solids);
        else
            return solver_.solve(target, limit);
    }

    static Point<Dim> mean_size(const Grid<Dim>& grid) {
        Point<Dim> mean;
        for (int a = 0; a < Dim; ++a) mean[a] = (grid.high(a) - grid.low(a)) / grid.cells(a);
        return mean;
    }
    Real mean_volume() const { return mean_size(*grid_).prod(); }
    Real area(int axis, int level) const noexcept { return detail::area_of_face(*grid_, axis, level); }
    static int number(int axis, int plane, int row, int i) noexcept {
        return axis == outer ? plane : axis == inner ? i : row;
    }
    Real face_area(const OpenFace& open) const noexcept {
        const int level = grid_->layout().number(open.cell)[vertical];
        return area(open.axis, level) * (aperture_ ? (*aperture_)[open.axis][open.face] : 1);
    }

    /// Conductances of a row's lower faces.
    void conduct(const WaterCells<Dim>& water, int plane, int row) {
        Poisson<Dim>& m = solver_.matrix();
        const RowRange r = water.rows.row(plane, row);
        m.look_at(plane, row, r);
        if (r.empty()) return;
        const Layout<Dim>& l = grid_->layout();
        const Offset start = l.row_start(plane, row);
        const auto neighbours = m.neighbours(plane, row);
        const std::uint8_t* const wet = water.wet.data() + start;
        std::fill(m.dirichlet.data() + start + r.begin, m.dirichlet.data() + start + r.end, 0.0f);
        for (int a = 0; a < Dim; ++a) {
            float* const __restrict face = m.face[a].data() + start;
            const auto g = conductance_[a].row(row);
            const std::uint8_t* const low = wet + (a == inner ? -1 : neighbours.low[a]);
            if (!boundaries_.periodic(a) && number(a, plane, row, 1) == 0 && a != inner) {
                std::fill(face + r.begin, face + r.end, 0.0f);
            } else if (water.aperture) {
                const Real* const open = (*water.aperture)[a].data() + start;
#pragma omp simd
                for (int i = r.begin; i < r.end; ++i)
                    face[i] = g[i] * static_cast<float>(open[i]) * static_cast<float>(wet[i] & low[i]);
            } else {
#pragma omp simd
                for (int i = r.begin; i < r.end; ++i) face[i] = g[i] * static_cast<float>(wet[i] & low[i]);
            }
            if (a == inner && r.begin == 0) {
                const bool joined = boundaries_.periodic(a) && wet[0] != 0 && wet[l.row_length() - 1] != 0;
                const Real open = water.aperture ? (*water.aperture)[a][start] : 1;
                face[0] = joined ? g[0] * static_cast<float>(open) : 0.0f;
            }
            if (a == inner && r.end < l.row_length()) face[r.end] = 0;
        }
    }

    void find_faces() {
        const Poisson<Dim>& m = solver_.matrix();
        const Layout<Dim>& l = grid_->layout();
        std::vector<Index> counts(static_cast<std::size_t>(l.planes()), 0);
        detail::parallel_planes(solver_.runs(), [&](int plane) {
            for (int row = 0; row < l.rows_per_plane(); ++row) {
                const Offset start = l.row_start(plane, row);
                const RowRange cells = m.range(plane, row);
                Index count = 0;
                for (int i = cells.begin; i < cells.end; ++i) count += m.inverse_diagonal[start + i] > 0;
                counts[static_cast<std::size_t>(plane)] += count;
                for (int a = 0; a < Dim; ++a) {
                    RowRange r = cells;
                    while (r.begin < r.end && !(m.face[a][start + r.begin] > 0)) ++r.begin;
                    while (r.begin < r.end && !(m.face[a][start + r.end - 1] > 0)) --r.end;
                    faces_[a].row(plane, row) = r.begin < r.end ? r : RowRange{};
                }
            }
        });
        wet_cells_ = 0;
        for (const Index c : counts) wet_cells_ += c;
    }

    /// Fills the right side on a plane; returns the square sum of what it lacks.
    Real diverge(const FaceField<Dim, State>& u, int plane) {
        const auto found = outflow_.of(u, {aperture_, open_fraction_, volume_defect_, relaxation_time_},
                                       solver_.matrix(), solver_.right_side(), plane);
        rates_[static_cast<std::size_t>(plane)] = found.fastest;
        return found.squares;
    }

    void make_room() {
        const auto planes = static_cast<std::size_t>(grid_->layout().planes());
        squares_.assign(planes, 0);
        rates_.assign(planes, 0);
    }

    Real start(FaceField<Dim, State>& u) {
        make_room();
        detail::parallel_planes(solver_.runs(), [&](int plane) {
            join_upper_faces(u, plane);
            squares_[static_cast<std::size_t>(plane)] = diverge(u, plane);
        });
        return root_of_squares();
    }

    /// Takes the gradient of the last solution from u and adds it to the pressure, or (`push`) takes the
    /// gradient of the pressure itself; then finds the divergence of what comes out.
    template <class Solids>
    Real correct(FaceField<Dim, State>& u, Field<State>& pressure, bool push,
                 [[maybe_unused]] Solids& solids) {
        make_room();
        const Poisson<Dim>& m = solver_.matrix();
        const Field<float>& e = solver_.solution();
        const auto rate = static_cast<State>(1 / step_), dt = static_cast<State>(step_);
        for (const OpenFace& open : open_) {
            if (push && open.plain == 0) continue;
            const State value = push ? dt * pressure[open.cell] : static_cast<State>(e[open.cell]);
            u[open.axis][open.face] -= static_cast<State>(open.slope) * value;
        }
        if constexpr (Solids::present) push ? solids.push(pressure, step_) : solids.push(e, 1);
        // Stage 1 reads the next plane's lower faces, which stage 0 has corrected.
        detail::wavefront(solver_.runs(), 2, boundaries_.periodic(outer), [&](int stage, int plane) {
            if (stage == 1) {
                join_upper_faces(u, plane);
                squares_[static_cast<std::size_t>(plane)] = diverge(u, plane);
                return;
            }
            for (int row = 0; row < m.layout.rows_per_plane(); ++row)
                push ? take_gradient(u, pressure, dt, plane, row) : take_gradient(u, e, State(1), plane, row);
            if constexpr (Solids::present)
                push ? solids.correct(u, pressure, step_, plane, true)
                     : solids.correct(u, e, 1, plane, false);
            for (int row = 0; row < m.layout.rows_per_plane() && !push; ++row) {
                const RowRange r = m.range(plane, row);
                const Offset start = m.layout.row_start(plane, row);
                const float* const __restrict from = e.data() + start;
                State* const __restrict p = pressure.data() + start;
                const float* const __restrict inverse = m.inverse_diagonal.data() + start;
#pragma omp simd
                for (int i = r.begin; i < r.end; ++i)
                    p[i] += (inverse[i] > 0 ? rate : State(0)) * static_cast<State>(from[i]);
            }
        });
        return root_of_squares();
    }

    template <class Number>
    void take_gradient(FaceField<Dim, State>& u, const Field<Number>& of, State factor, int plane, int row) {
        const Poisson<Dim>& m = solver_.matrix();
        const Offset start = m.layout.row_start(plane, row);
        const Number* const __restrict from = of.data() + start;
        const auto neighbours = m.neighbours(plane, row);
        for (int a = 0; a < Dim; ++a) {
            RowRange r = faces_[a].row(plane, row);
            if (r.empty()) continue;
            const auto slope = per_gap_[a].row(row);
            const Number* const __restrict low = from + neighbours.low[a];
            State* const __restrict v = u[a].data() + start;
            const float* const __restrict conducts = m.face[a].data() + start;
            if (a == inner && r.begin == 0) {  // across the periodic side
                v[0] -= factor * slope[0] * static_cast<State>(from[0] - from[m.layout.row_length() - 1]);
                ++r.begin;
            }
#pragma omp simd
            for (int i = r.begin; i < r.end; ++i)
                v[i] -=
                    (conducts[i] > 0 ? factor : State(0)) * slope[i] * static_cast<State>(from[i] - low[i]);
        }
    }

    /// On periodic axes the upper face of the last cell is the lower face of the first.
    void join_upper_faces(FaceField<Dim, State>& u, int plane) const noexcept {
        const Layout<Dim>& l = grid_->layout();
        const auto copy_row = [&](int a, Offset to, Offset from) {
            std::memcpy(u[a].data() + to, u[a].data() + from,
                        sizeof(State) * static_cast<std::size_t>(l.row_length()));
        };
        if (boundaries_.periodic(outer) && plane == l.planes() - 1)
            for (int row = 0; row < l.rows_per_plane(); ++row)
                copy_row(outer, l.row_start(plane + 1, row), l.row_start(0, row));
        if constexpr (Dim == 3)
            if (boundaries_.periodic(2))
                copy_row(2, l.row_start(plane, l.rows_per_plane()), l.row_start(plane, 0));
        if (boundaries_.periodic(inner))
            for (int row = 0; row < l.rows_per_plane(); ++row) {
                const Offset start = l.row_start(plane, row);
                u[inner][start + l.row_length()] = u[inner][start];
            }
    }

    Real root_of_squares() const noexcept {
        Real sum = 0;
        for (const Real s : squares_) sum += s;
        return std::sqrt(sum);
    }

    using Table = detail::LevelTable<Dim, State>;

    const Grid<Dim>* grid_;
    BoundaryConditions<Dim> boundaries_;
    detail::NetOutflow<Dim, State> outflow_;
    PerAxis<Table, Dim> per_gap_;  ///< [1/m]
    PerAxis<detail::LevelTable<Dim, float>, Dim> conductance_;
    Solver solver_;
    PerAxis<WetRows<Dim>, Dim> faces_;
    std::vector<OpenFace> open_;
    const FaceField<Dim>* aperture_ = nullptr;
    const Field<Real>* open_fraction_ = nullptr;
    const Field<Real>* volume_defect_ = nullptr;
    Real step_ = 1, relaxation_time_ = 1;  ///< [s]
    std::vector<Real> squares_, rates_;
    Index wet_cells_ = 0;
};

}  // namespace abrade
