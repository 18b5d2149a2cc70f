#pragma once
// Geometric multigrid for the pressure's operator: a preconditioner.

#include <abrade/fluid/pressure/coarse_poisson.hpp>
#include <abrade/fluid/pressure/wavefront.hpp>

namespace abrade {

/// One V-cycle on A z = b (Poisson).
///
/// - Two red-black Gauss-Seidel sweeps before and two after, in reverse, so that the preconditioner is
/// symmetric.
/// - Coarse cells are pairs along each axis; residuals are summed, corrections are copied. A coarse face
/// conducts half
///   the sum of its fine faces, since the distance doubles; so does what is tied to e = 0. Only axes whose
///   cells are about as short as the shortest are paired, so stretched and flat cells keep the rate of cubes.
/// Source: U. Trottenberg, C. Oosterlee, A. Schueller, Multigrid, Academic Press 2001.
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
    }

    /// The finest operator, to be filled: `face`, `dirichlet`; then `build()`.
    Poisson<Dim>& matrix() noexcept { return levels_[0].matrix; }
    const Poisson<Dim>& matrix() const noexcept { return levels_[0].matrix; }
    Field<float>& right_side() noexcept { return levels_[0].b; }
    const Field<float>& right_side() const noexcept { return levels_[0].b; }
    /// Of planes of the finest level, for threads.
    const detail::PlaneRuns& runs() const noexcept { return levels_[0].runs; }
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

    /// One V-cycle from the right side b, which it leaves: fills `correction()`, z, and returns b . z.
    Real precondition() { return cycle(0); }
    /// z is worked on in between: its ghosts may be written.
    Field<float>& correction() noexcept { return levels_[0].x; }
    /// Forgets what is not a number: it must not outlive the solution that it came from.
    void clear() {
        for (Level& level : levels_) level.x.fill(0), level.b.fill(0);
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
                partial_[static_cast<std::size_t>(plane)] = m.dot(level.b, level.x, plane);
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

    std::vector<Level> levels_;
    std::vector<Real> partial_;
    bool floating_ = false;
};

}  // namespace abrade
