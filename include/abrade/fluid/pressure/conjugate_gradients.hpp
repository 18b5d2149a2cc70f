#pragma once
// Conjugate gradients for the pressure.

#include <abrade/fluid/pressure/multigrid.hpp>
#include <abrade/fluid/pressure/solids_in_flow.hpp>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

namespace abrade {

/// Solves A e = b (Poisson) by conjugate gradients with one cycle of a symmetric preconditioner an iteration.
/// All of it in single precision: the caller computes what is left in double and calls again. Source: O.
/// Tatebe, The multigrid preconditioned conjugate gradient method, 6th Copper Mountain Conference on
/// Multigrid Methods, NASA CP-3224 (1993).
template <int Dim, class Preconditioner = Multigrid<Dim>>
class ConjugateGradients {
    static constexpr int outer = Layout<Dim>::outer;

public:
    static constexpr std::string_view name = "ConjugateGradients";

    /// As Multigrid's.
    ConjugateGradients(const Layout<Dim>& layout, const Point<Dim>& lengths,
                       const PerAxis<bool, Dim>& periodic)
        : preconditioner_(layout, lengths, periodic), search_(layout.total), product_(layout.total),
          solution_(layout.total) {}

    /// The operator, to be filled: `face`, `dirichlet`; then `build()`.
    Poisson<Dim>& matrix() noexcept { return preconditioner_.matrix(); }
    const Poisson<Dim>& matrix() const noexcept { return preconditioner_.matrix(); }
    void build() { preconditioner_.build(); }
    Field<float>& right_side() noexcept { return preconditioner_.right_side(); }
    const Field<float>& right_side() const noexcept { return preconditioner_.right_side(); }
    const Field<float>& solution() const noexcept { return solution_; }
    const detail::PlaneRuns& runs() const noexcept { return preconditioner_.runs(); }
    bool floating() const noexcept { return preconditioner_.floating(); }
    const Preconditioner& preconditioner() const noexcept { return preconditioner_; }

    struct Report {
        int iterations = 0;
        Real before = 0, after = 0;  ///< norm of the residual: root of the sum of squares
    };

    /// Fills `solution()` from `right_side()`, which is overwritten, until the residual's norm is at most
    /// `target` or `limit` iterations are done.
    template <class Solids = const NoSolids>
    Report solve(Real target, int limit, [[maybe_unused]] Solids& solids = no_solids) {
        const Poisson<Dim>& a = matrix();
        if (floating()) remove_mean();
        Report report;
        report.before = report.after =
            std::sqrt(sum_over_planes([&](int plane) { return a.dot(right_side(), right_side(), plane); }));
        detail::parallel_planes(runs(), [&](int plane) {
            a.for_rows(plane, [&](Offset start, RowRange r) {
                std::fill_n(solution_.data() + start + r.begin, r.length(), 0.0f);
            });
        });
        Real rho_before = 0;
        while (report.after > target && report.iterations < limit) {
            const Real rho = preconditioner_.precondition();
            const float beta = rho_before > 0 ? static_cast<float>(rho / rho_before) : 0;
            rho_before = rho;
            Real curvature = search_along(a, beta);
            if constexpr (Solids::present) curvature += solids.add_product(search_, product_);
            if (!(curvature > 0) || !(rho > 0)) {
                preconditioner_.clear();
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
    /// Turns the search direction, p = z + beta p, and returns p . A p.
    Real search_along(const Poisson<Dim>& a, float beta) {
        const Field<float>& z = preconditioner_.correction();
        partial_.assign(static_cast<std::size_t>(a.layout.planes()), 0);
        detail::wavefront(runs(), 2, a.periodic[outer], [&](int stage, int plane) {
            if (stage == 0) {
                a.for_rows(plane, [&](Offset start, RowRange r) {
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
        matrix().for_rows(plane, [&](Offset start, RowRange r) {
            float* const __restrict e = solution_.data() + start;
            float* const __restrict b = right_side().data() + start;
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
        const Poisson<Dim>& m = matrix();
        Field<float>& b = right_side();
        Index cells = 0;
        Real sum = 0;
        const auto each = [&](auto&& body) {
            for (int plane = 0; plane < m.layout.planes(); ++plane)
                m.for_rows(plane, [&](Offset start, RowRange r) {
                    for (int i = r.begin; i < r.end; ++i)
                        if (m.inverse_diagonal[start + i] > 0) body(start + i);
                });
        };
        each([&](Offset c) { sum += static_cast<Real>(b[c]), ++cells; });
        if (cells == 0) return;
        const float mean = static_cast<float>(sum / cells);
        each([&](Offset c) { b[c] -= mean; });
    }

    template <class Term>
    Real sum_over_planes(Term&& term) {
        const int planes = matrix().layout.planes();
        partial_.assign(static_cast<std::size_t>(planes), 0);
        detail::parallel_planes(runs(),
                                [&](int plane) { partial_[static_cast<std::size_t>(plane)] = term(plane); });
        Real sum = 0;
        for (const Real p : partial_) sum += p;
        return sum;
    }

    Preconditioner preconditioner_;
    Field<float> search_, product_, solution_;
    std::vector<Real> partial_;
};

}  // namespace abrade
