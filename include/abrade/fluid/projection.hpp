#pragma once
// Makes a velocity free of divergence, and finds the pressure that does it.

#include <abrade/fluid/multigrid.hpp>
#include <abrade/fluid/sides.hpp>

namespace abrade {

/// A face at which the pressure is known to be 0: between water and air, or where water leaves the box.
struct OpenFace {
    Offset face = 0;  ///< of the velocity component
    Offset cell = 0;  ///< the wet cell beside it
    int axis = 0;
    Real slope = 0;  ///< 1 / distance from the cell's centre to where p = 0; negative if that lies at the
                     ///< upper side [1/m]
};

/// Solves  div(grad phi) = div(u)  and takes grad phi from u; phi = p dt / density.
///
/// Tolerance: root mean square over the wet cells of |div u| dt, the share of its volume that a cell gains or
/// loses in a step. Solved in single precision by Multigrid; what is left is computed from the velocity
/// itself in double, and solved for again, so the tolerance means what it says.
template <int Dim, class State>
class Projection {
    static constexpr int outer = Layout<Dim>::outer, inner = Layout<Dim>::inner;

public:
    Projection(const Grid<Dim>& grid, const Sides<Dim>& sides)
        : grid_(&grid), sides_(sides), multigrid_(grid.layout(), mean_size(grid), periodic_axes(sides)) {
        for (auto& f : faces_) f = WetRows<Dim>(grid.layout());
        fill_box();
        multigrid_.build();
        find_rows();
    }

    /// Faces whose velocity the pressure changes: between two cells that take part.
    const std::array<WetRows<Dim>, Dim>& faces() const noexcept { return faces_; }
    const Multigrid<Dim>& multigrid() const noexcept { return multigrid_; }

    struct Report {
        int iterations = 0, rounds = 0;
        Real before = 0,
             after = 0;  ///< share of a cell's volume gained or lost in a step, root mean square [-]
    };

    /// `u`: normal components at the sides set, ghosts not needed. `pressure` over density [m2/s2] grows by
    /// phi / dt.
    Report project(FaceField<Dim, State>& u, Field<State>& pressure, Real time_step, Real tolerance) {
        Report report;
        Real norm = start(u);
        const Real unit = time_step / (mean_volume() * std::sqrt(static_cast<Real>(wet_cells_)));
        report.before = report.after = norm * unit;
        constexpr int most_rounds = 6, most_iterations = 60;
        while (report.after > tolerance && report.rounds < most_rounds) {
            // Half of what is allowed, since single precision promises more than it keeps.
            const auto solved =
                multigrid_.solve(std::max(0.5 * tolerance / unit, 1e-5 * norm), most_iterations);
            report.iterations += solved.iterations;
            ++report.rounds;
            norm = correct(u, pressure, time_step);
            report.after = norm * unit;
            if (!(report.after < report.before)) break;
        }
        return report;
    }

private:
    static std::array<bool, Dim> periodic_axes(const Sides<Dim>& sides) {
        std::array<bool, Dim> repeats;
        for (int a = 0; a < Dim; ++a) repeats[static_cast<std::size_t>(a)] = sides.periodic(a);
        return repeats;
    }
    static Point<Dim> mean_size(const Grid<Dim>& grid) {
        Point<Dim> mean;
        for (int a = 0; a < Dim; ++a) mean[a] = (grid.high(a) - grid.low(a)) / grid.cells(a);
        return mean;
    }
    Real mean_volume() const { return mean_size(*grid_).prod(); }

    /// Area of the lower face of a cell of the box along an axis [m2]; [m] in 2-D.
    Real area(int axis, const CellNumber<Dim>& cell) const noexcept {
        Real product = 1;
        for (int a = 0; a < Dim; ++a)
            if (a != axis) product *= grid_->size(a, cell[a]);
        return product;
    }

    /// Conductances of a box without walls or surface inside.
    void fill_box() {
        Poisson<Dim>& m = multigrid_.matrix();
        const Layout<Dim>& l = grid_->layout();
        for (auto& f : m.face) f.fill(0);
        m.dirichlet.fill(0);
        open_.clear();
        grid_->for_each([&](const CellNumber<Dim>& cell, Offset c) {
            for (int a = 0; a < Dim; ++a) {
                const Real g = area(a, cell);
                if (cell[a] > 0 || sides_.periodic(a))
                    m.face[a][c] = static_cast<float>(g / grid_->gap(a, cell[a]));
                const Real slope = 2 / grid_->size(a, cell[a]);
                if (cell[a] == 0 && sides_[a][0] == Side::outflow) open_.push_back({c, c, a, slope});
                if (cell[a] == l.cells[a] - 1 && sides_[a][1] == Side::outflow)
                    open_.push_back({c + l.stride[a], c, a, -slope});
                if (!open_.empty() && open_.back().cell == c && open_.back().axis == a)
                    m.dirichlet[c] += static_cast<float>(g * slope);
            }
        });
    }

    void find_rows() {
        const Poisson<Dim>& m = multigrid_.matrix();
        wet_cells_ = 0;
        for (int plane = 0; plane < m.layout.planes(); ++plane)
            for (int row = 0; row < m.layout.rows_per_plane(); ++row) {
                const Offset start = m.layout.row_start(plane, row);
                for (int i = 0; i < m.layout.row_length(); ++i)
                    wet_cells_ += m.inverse_diagonal[start + i] > 0;
                for (int a = 0; a < Dim; ++a) {
                    RowRange r{m.layout.row_length(), 0};
                    for (int i = 0; i < m.layout.row_length(); ++i)
                        if (m.face[a][start + i] > 0) r.begin = std::min(r.begin, i), r.end = i + 1;
                    faces_[a].row(plane, row) = r.empty() ? RowRange{} : r;
                }
            }
    }

    struct RowMetric {
        std::array<State, Dim> area;  ///< of the faces of a row's cells [m2]
        int plane, row;
    };
    RowMetric metric(int plane, int row) const noexcept {
        CellNumber<Dim> cell{};
        cell[outer] = plane;
        if constexpr (Dim == 3) cell[2] = row;
        RowMetric m;
        m.plane = plane, m.row = row;
        for (int a = 0; a < Dim; ++a) m.area[a] = static_cast<State>(area(a, cell));
        return m;
    }

    /// b = - net outflow of each cell; returns its square sum over the plane.
    Real diverge(const FaceField<Dim, State>& u, int plane) {
        const Poisson<Dim>& m = multigrid_.matrix();
        Real total = 0;
        for (int row = 0; row < m.layout.rows_per_plane(); ++row) {
            const RowRange r = m.range(plane, row);
            if (r.empty()) continue;
            const Offset start = m.layout.row_start(plane, row);
            const RowMetric metrics = metric(plane, row);
            std::array<const State*, Dim> low, high;
            for (int a = 0; a < Dim; ++a) low[a] = u[a].data() + start, high[a] = low[a] + m.layout.stride[a];
            float* const __restrict b = multigrid_.right_side().data() + start;
            const float* const __restrict inverse = m.inverse_diagonal.data() + start;
            State sum = 0;
#pragma omp simd reduction(+ : sum)
            for (int i = r.begin; i < r.end; ++i) {
                State out = 0;
                for (int a = 0; a < Dim; ++a) out += metrics.area[a] * (high[a][i] - low[a][i]);
                out = inverse[i] > 0 ? out : State(0);
                b[i] = static_cast<float>(-out);
                sum += out * out;
            }
            total += static_cast<Real>(sum);
        }
        return total;
    }

    Real start(const FaceField<Dim, State>& u) {
        const int planes = grid_->layout().planes();
        squares_.assign(static_cast<std::size_t>(planes), 0);
        detail::wavefront(planes, 1, false, thread_count(), [&](int, int plane) {
            squares_[static_cast<std::size_t>(plane)] = diverge(u, plane);
        });
        return root_of_squares();
    }

    /// u - grad e, p + e / dt, and the divergence of what comes out.
    Real correct(FaceField<Dim, State>& u, Field<State>& pressure, Real time_step) {
        const Poisson<Dim>& m = multigrid_.matrix();
        const Field<float>& e = multigrid_.solution();
        const auto rate = static_cast<State>(1 / time_step);
        const int planes = m.layout.planes();
        for (const OpenFace& open : open_)
            u[open.axis][open.face] -= static_cast<State>(open.slope) * static_cast<State>(e[open.cell]);
        // Stage 1 reads the next plane's lower faces, which stage 0 has corrected.
        detail::wavefront(planes, 2, sides_.periodic(outer), thread_count(), [&](int stage, int plane) {
            if (stage == 1) {
                join_upper_faces(u, plane);
                squares_[static_cast<std::size_t>(plane)] = diverge(u, plane);
                return;
            }
            for (int row = 0; row < m.layout.rows_per_plane(); ++row)
                correct_row(u, pressure, e, rate, plane, row);
        });
        return root_of_squares();
    }

    void correct_row(FaceField<Dim, State>& u, Field<State>& pressure, const Field<float>& e, State rate,
                     int plane, int row) noexcept {
        const Poisson<Dim>& m = multigrid_.matrix();
        const Offset start = m.layout.row_start(plane, row);
        const float* const __restrict from = e.data() + start;
        const auto neighbours = m.neighbours(plane, row);
        for (int a = 0; a < Dim; ++a) {
            RowRange r = faces_[a].range(plane, row);
            if (r.empty()) continue;
            const auto slope = static_cast<State>(1 / grid_->gap(a, a == inner   ? 0
                                                                    : a == outer ? plane
                                                                                 : row));
            const float* const __restrict low = from + neighbours.low[a];
            State* const __restrict v = u[a].data() + start;
            if (a == inner && sides_.periodic(a) && r.begin == 0) {
                v[0] -= slope * static_cast<State>(from[0] - from[m.layout.row_length() - 1]);
                ++r.begin;
            }
            const float* const __restrict conducts = m.face[a].data() + start;
#pragma omp simd
            for (int i = r.begin; i < r.end; ++i)
                v[i] -= conducts[i] > 0 ? slope * static_cast<State>(from[i] - low[i]) : State(0);
        }
        const RowRange r = m.range(plane, row);
        State* const __restrict p = pressure.data() + start;
#pragma omp simd
        for (int i = r.begin; i < r.end; ++i) p[i] += rate * static_cast<State>(from[i]);
    }

    /// On periodic axes the upper face of the last cell is the lower face of the first.
    void join_upper_faces(FaceField<Dim, State>& u, int plane) const noexcept {
        const Layout<Dim>& l = grid_->layout();
        const auto copy_row = [&](int a, Offset to, Offset from) {
            std::memcpy(u[a].data() + to, u[a].data() + from,
                        sizeof(State) * static_cast<std::size_t>(l.row_length()));
        };
        if (sides_.periodic(outer) && plane == l.planes() - 1)
            for (int row = 0; row < l.rows_per_plane(); ++row)
                copy_row(outer, l.row_start(plane + 1, row), l.row_start(0, row));
        if constexpr (Dim == 3)
            if (sides_.periodic(2))
                copy_row(2, l.row_start(plane, l.rows_per_plane()), l.row_start(plane, 0));
        if (sides_.periodic(inner))
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

    const Grid<Dim>* grid_;
    Sides<Dim> sides_;
    Multigrid<Dim> multigrid_;
    std::array<WetRows<Dim>, Dim> faces_;
    std::vector<OpenFace> open_;
    std::vector<Real> squares_;
    Index wet_cells_ = 0;
};

}  // namespace abrade
