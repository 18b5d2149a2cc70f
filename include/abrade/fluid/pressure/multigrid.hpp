#pragma once
// Conjugate gradients preconditioned by geometric multigrid, for the pressure.

#include <abrade/fluid/pressure/coarse_poisson.hpp>
#include <abrade/fluid/pressure/solids_in_flow.hpp>
#include <abrade/fluid/pressure/wavefront.hpp>

namespace abrade {

/// Solves A e = b (Poisson) by conjugate gradients with one V-cycle of multigrid as preconditioner.
///
/// - Two red-black Gauss-Seidel sweeps before and two after, in reverse, so that the preconditioner is
/// symmetric.
/// - Coarse cells are pairs along each axis; residuals are summed, corrections are copied. A coarse face
/// conducts half
///   the sum of its fine faces, since the distance doubles; so does what is tied to e = 0. Only axes whose
///   cells are about as short as the shortest are paired, so stretched and flat cells keep the rate of cubes.
/// - All of it in single precision: the caller computes what is left in double and calls again.
/// Source: U. Trottenberg, C. Oosterlee, A. Schueller, Multigrid, Academic Press 2001; O. Tatebe, The
/// multigrid preconditioned conjugate gradient method, 6th Copper Mountain Conference on Multigrid Methods,
/// NASA CP-3224 (1993).
template <int Dim>
class Multigrid {
    static constexpr int outer = Layout<Dim>::outer, inner = Layout<Dim>::inner;

public:
    /// `lengths`: mean size of a cell along each axis [m]. `periodic`: axes whose ends meet.
    Multigrid(const Layout<Dim>& fine, const Point<Dim>& lengths, const PerAxis<bool, Dim>& periodic) {
        PerAxis<int, Dim> cells = fine.cells;
        Point<Dim> size = lengths;
        levels_.emplace_back(fine, periodic);
        while (*std::max_element(cells.begin(), cells.end()) > 1) {
            Real shortest = std::numeric_limits<Real>::infinity();
            for (int a = 0; a < Dim; ++a)
                if (cells[a] > 1) shortest = std::min(shortest, size[a]);
            Level& last = levels_.back();
            for (int a = 0; a < Dim; ++a) {
                last.paired[a] = cells[a] > 1 && size[a] < 1.5 * shortest;
                if (last.paired[a]) cells[a] = (cells[a] + 1) / 2, size[a] *= 2;
            }
            levels_.emplace_back(Layout<Dim>(cells), periodic);
        }
        search_ = Field<float>(fine.total);
        product_ = Field<float>(fine.total);
        solution_ = Field<float>(fine.total);
    }

    /// The finest operator, to be filled: `face`, `dirichlet`; then `build()`.
    Poisson<Dim>& matrix() noexcept { return levels_[0].matrix; }
    const Poisson<Dim>& matrix() const noexcept { return levels_[0].matrix; }
    Field<float>& right_side() noexcept { return levels_[0].b; }
    const Field<float>& solution() const noexcept { return solution_; }
    /// Of planes of the finest level, for threads.
    const detail::PlaneRuns& runs() const noexcept { return levels_[0].runs; }
    int level_count() const noexcept { return static_cast<int>(levels_.size()); }
    /// No cell is tied to a fixed value: e is known but for a constant.
    bool floating() const noexcept { return floating_; }

    /// Coarse operators from the finest.
    void build() {
        detail::close_periodic(levels_[0].matrix);
        detail::parallel_planes(levels_[0].runs, [&](int plane) { levels_[0].matrix.complete(plane); });
        for (std::size_t l = 0; l + 1 < levels_.size(); ++l)
            detail::coarsen(levels_[l].matrix, levels_[l].paired, levels_[l + 1].matrix, levels_[l + 1].runs);
        for (Level& level : levels_) level.share_out();
        floating_ = levels_.back().matrix.dirichlet[levels_.back().matrix.layout.at({})] == 0;
    }

    struct Report {
        int iterations = 0;
        Real before = 0, after = 0;  ///< norm of the residual: root of the sum of squares
    };

    /// Fills `solution()` from `right_side()`, which is overwritten, until the residual's norm is at most
    /// `target` or `limit` iterations are done.
    template <class Solids = const NoSolids>
    Report solve(Real target, int limit, [[maybe_unused]] Solids& solids = no_solids) {
        Level& fine = levels_[0];
        const Poisson<Dim>& a = fine.matrix;
        if (floating_) remove_mean();
        Report report;
        report.before = report.after =
            std::sqrt(sum_over_planes([&](int plane) { return squares(fine.b, plane); }));
        detail::parallel_planes(fine.runs, [&](int plane) {
            for_rows(plane, [&](Offset start, RowRange r) {
                std::fill_n(solution_.data() + start + r.begin, r.length(), 0.0f);
            });
        });
        Real rho_before = 0;
        while (report.after > target && report.iterations < limit) {
            const Real rho = cycle(0);
            const float beta = rho_before > 0 ? static_cast<float>(rho / rho_before) : 0;
            rho_before = rho;
            Real curvature = search_along(a, beta);
            if constexpr (Solids::present) curvature += solids.add_product(search_, product_);
            if (!(curvature > 0) || !(rho > 0)) {
                // What is not a number must not outlive the solution that it came from.
                for (Level& level : levels_) level.x.fill(0), level.b.fill(0);
                for (Field<float>* field : {&search_, &product_, &solution_}) field->fill(0);
                break;
            }
            const float step = static_cast<float>(rho / curvature);
            report.after = std::sqrt(sum_over_planes([&](int plane) { return take(step, plane); }));
            ++report.iterations;
        }
        return report;
    }

private:
    struct Level {
        Poisson<Dim> matrix;
        Field<float> x, b;
        PerAxis<bool, Dim> paired{};  ///< with the next coarser level
        /// By the cells of the last build: any are right. For what does not smooth; for what does.
        detail::PlaneRuns runs, colour_runs;

        Level(const Layout<Dim>& layout, const PerAxis<bool, Dim>& periodic)
            : matrix(layout, periodic), x(layout.total), b(layout.total) {
            share_out();
        }
        void share_out() {
            const Layout<Dim>& l = matrix.layout;
            // Small levels are not worth waking a thread.
            const int least = l.total < 20000 ? l.planes() : detail::shortest_run;
            runs = detail::plane_runs(l, least, [&](int plane, int row) { return matrix.range(plane, row); });
            // Across an odd periodic axis equal colours are neighbours.
            const bool odd = matrix.periodic[outer] && l.planes() % 2 != 0;
            colour_runs = odd ? detail::PlaneRuns{0, l.planes()} : runs;
        }
    };

    /// x of level l from its b, one V-cycle; returns b . x.
    Real cycle(std::size_t l) {
        Level& level = levels_[l];
        const Poisson<Dim>& m = level.matrix;
        const int rows = m.layout.rows_per_plane(), planes = m.layout.planes();
        const bool last = l + 1 == levels_.size();
        if (last) {
            const Offset only = m.layout.at({});
            level.x[only] = level.b[only] * m.inverse_diagonal[only];
            return 0;
        }
        Level& coarse = levels_[l + 1];
        coarse.b.fill(0);
        detail::wavefront(level.colour_runs, 5, m.periodic[outer], [&](int stage, int plane) {
            if (stage == 4) return restrict_plane(level, coarse, plane);
            for (int row = 0; row < rows; ++row)
                if (stage == 0)
                    m.smooth_zero(level.x, level.b, plane, row, 0);
                else
                    m.smooth(level.x, level.b, plane, row, stage & 1);
        });
        cycle(l + 1);
        if (l == 0) partial_.assign(static_cast<std::size_t>(planes), 0);
        detail::wavefront(level.colour_runs, l == 0 ? 6 : 5, m.periodic[outer], [&](int stage, int plane) {
            if (stage == 0) return prolong_plane(level, coarse, plane);
            if (stage == 5) {
                partial_[static_cast<std::size_t>(plane)] = dot(level.b, level.x, plane);
                return;
            }
            for (int row = 0; row < rows; ++row) m.smooth(level.x, level.b, plane, row, stage & 1);
        });
        Real sum = 0;
        if (l == 0)
            for (const Real p : partial_) sum += p;
        return sum;
    }

    void restrict_plane(Level& fine, Level& coarse, int plane) {
        const Poisson<Dim>& m = fine.matrix;
        const Layout<Dim>&lf = m.layout, &lc = coarse.matrix.layout;
        thread_local std::vector<float> buffer;
        const int n = lf.row_length();
        buffer.resize(static_cast<std::size_t>(n + Layout<Dim>::lanes));
        for (int row = 0; row < lf.rows_per_plane(); ++row) {
            RowRange r = m.range(plane, row);
            if (r.empty()) continue;
            float* const left = buffer.data();
            m.residual(fine.x, fine.b, plane, row, left);
            float* const __restrict to =
                coarse.b.data() +
                lc.row_start(fine.paired[outer] ? plane / 2 : plane, fine.paired[Dim - 1] ? row / 2 : row);
            if (!fine.paired[inner]) {
                for (int i = r.begin; i < r.end; ++i) to[i] += left[i];
                continue;
            }
            if (r.begin & 1) left[--r.begin] = 0;
            if (r.end & 1) left[r.end++] = 0;
#pragma omp simd
            for (int j = r.begin / 2; j < r.end / 2; ++j) to[j] += left[2 * j] + left[2 * j + 1];
        }
    }

    void prolong_plane(Level& fine, const Level& coarse, int plane) {
        const Poisson<Dim>& m = fine.matrix;
        const Layout<Dim>&lf = m.layout, &lc = coarse.matrix.layout;
        for (int row = 0; row < lf.rows_per_plane(); ++row) {
            const RowRange r = m.range(plane, row);
            float* const __restrict to = fine.x.data() + lf.row_start(plane, row);
            const float* const __restrict from =
                coarse.x.data() +
                lc.row_start(fine.paired[outer] ? plane / 2 : plane, fine.paired[Dim - 1] ? row / 2 : row);
            if (fine.paired[inner]) {
                // What a pair has beyond the range is set anew by the sweeps that follow.
#pragma omp simd
                for (int j = r.begin / 2; j < (r.end + 1) / 2; ++j)
                    to[2 * j] += from[j], to[2 * j + 1] += from[j];
            } else
                for (int i = r.begin; i < r.end; ++i) to[i] += from[i];
        }
    }

    Real dot(const Field<float>& x, const Field<float>& y, int plane) const noexcept {
        Real total = 0;
        for_rows(plane, [&](Offset start, RowRange r) {
            const float *const p = x.data() + start, *const q = y.data() + start;
            float sum = 0;
#pragma omp simd reduction(+ : sum)
            for (int i = r.begin; i < r.end; ++i) sum += p[i] * q[i];
            total += static_cast<Real>(sum);
        });
        return total;
    }
    Real squares(const Field<float>& x, int plane) const noexcept { return dot(x, x, plane); }

    /// Turns the search direction, p = z + beta p, and returns p . A p.
    Real search_along(const Poisson<Dim>& a, float beta) {
        const Field<float>& z = levels_[0].x;
        partial_.assign(static_cast<std::size_t>(a.layout.planes()), 0);
        detail::wavefront(levels_[0].runs, 2, a.periodic[outer], [&](int stage, int plane) {
            if (stage == 0) {
                for_rows(plane, [&](Offset start, RowRange r) {
                    float* const __restrict p = search_.data() + start;
                    const float* const __restrict from = z.data() + start;
                    if (beta == 0) {  // what is there may be no number
                        std::copy(from + r.begin, from + r.end, p + r.begin);
                        return;
                    }
#pragma omp simd
                    for (int i = r.begin; i < r.end; ++i) p[i] = from[i] + beta * p[i];
                });
                return;
            }
            Real sum = 0;
            for (int row = 0; row < a.layout.rows_per_plane(); ++row)
                sum += a.apply(search_, product_, plane, row);
            partial_[static_cast<std::size_t>(plane)] = sum;
        });
        Real sum = 0;
        for (const Real p : partial_) sum += p;
        return sum;
    }

    /// Goes a step along the search direction on a plane; returns the square of the residual's norm there.
    Real take(float step, int plane) noexcept {
        Real total = 0;
        for_rows(plane, [&](Offset start, RowRange r) {
            float* const __restrict e = solution_.data() + start;
            float* const __restrict b = levels_[0].b.data() + start;
            const float* const __restrict p = search_.data() + start;
            const float* const __restrict q = product_.data() + start;
            float sum = 0;
#pragma omp simd reduction(+ : sum)
            for (int i = r.begin; i < r.end; ++i) {
                e[i] += step * p[i];
                b[i] -= step * q[i];
                sum += b[i] * b[i];
            }
            total += static_cast<Real>(sum);
        });
        return total;
    }

    void remove_mean() {
        const Poisson<Dim>& m = levels_[0].matrix;
        Field<float>& b = levels_[0].b;
        Index cells = 0;
        Real sum = 0;
        const auto each = [&](auto&& body) {
            for (int plane = 0; plane < m.layout.planes(); ++plane)
                for_rows(plane, [&](Offset start, RowRange r) {
                    for (int i = r.begin; i < r.end; ++i)
                        if (m.inverse_diagonal[start + i] > 0) body(start + i);
                });
        };
        each([&](Offset c) { sum += static_cast<Real>(b[c]), ++cells; });
        if (cells == 0) return;
        const float mean = static_cast<float>(sum / cells);
        each([&](Offset c) { b[c] -= mean; });
    }

    void for_rows(int plane, auto&& body) const noexcept {
        const Poisson<Dim>& m = levels_[0].matrix;
        for (int row = 0; row < m.layout.rows_per_plane(); ++row)
            if (const RowRange r = m.range(plane, row); !r.empty()) body(m.layout.row_start(plane, row), r);
    }
    template <class Term>
    Real sum_over_planes(Term&& term) {
        const int planes = levels_[0].matrix.layout.planes();
        partial_.assign(static_cast<std::size_t>(planes), 0);
        detail::parallel_planes(levels_[0].runs,
                                [&](int plane) { partial_[static_cast<std::size_t>(plane)] = term(plane); });
        Real sum = 0;
        for (const Real p : partial_) sum += p;
        return sum;
    }

    std::vector<Level> levels_;
    Field<float> search_, product_, solution_;
    std::vector<Real> partial_;
    bool floating_ = false;
};

}  // namespace abrade
