#pragma once
// A direct solver for the pressure, by Eigen: to check others by, and for small boxes.

#include <abrade/fluid/pressure/coarse_poisson.hpp>
#include <abrade/fluid/pressure/solids_in_flow.hpp>

#include <Eigen/SparseCholesky>

#include <cmath>
#include <memory>
#include <string_view>
#include <vector>

namespace abrade {

/// Solves A e = b (Poisson) by a sparse L D L^T in double precision (Eigen::SimplicialLDLT): exact, and slow
/// from some ten thousand cells on. Where e is known but for a constant, the one without a mean is found; one
/// connected body of water is assumed.
template <int Dim>
class SparseCholesky {
public:
    static constexpr std::string_view name = "SparseCholesky";

    SparseCholesky(const Layout<Dim>& layout, const Point<Dim>& /*lengths*/,
                   const PerAxis<bool, Dim>& periodic)
        : matrix_(layout, periodic), right_side_(layout.total), solution_(layout.total),
          runs_(detail::plane_runs(layout, layout.planes(), [](int, int) { return RowRange{}; })) {}

    Poisson<Dim>& matrix() noexcept { return matrix_; }
    const Poisson<Dim>& matrix() const noexcept { return matrix_; }
    Field<float>& right_side() noexcept { return right_side_; }
    const Field<float>& solution() const noexcept { return solution_; }
    const detail::PlaneRuns& runs() const noexcept { return runs_; }
    bool floating() const noexcept { return floating_; }

    void build() {
        detail::close_periodic(matrix_);
        const Layout<Dim>& l = matrix_.layout;
        cells_.clear();
        std::vector<int> number(static_cast<std::size_t>(l.total), -1);
        floating_ = true;
        for (int plane = 0; plane < l.planes(); ++plane) {
            matrix_.complete(plane);
            for_cells(plane, [&](Offset c) {
                number[static_cast<std::size_t>(c)] = static_cast<int>(cells_.size());
                cells_.push_back(c);
                floating_ = floating_ && matrix_.dirichlet[c] == 0;
            });
        }
        std::vector<Eigen::Triplet<double>> entries;
        for (int plane = 0; plane < l.planes(); ++plane)
            for (int row = 0; row < l.rows_per_plane(); ++row) {
                const auto neighbours = matrix_.neighbours(plane, row);
                const Offset start = l.row_start(plane, row);
                const RowRange r = matrix_.range(plane, row);
                for (int i = r.begin; i < r.end; ++i) add_row(entries, number, neighbours, start, i);
            }
        const auto n = static_cast<int>(cells_.size());
        Eigen::SparseMatrix<double> a(n, n);
        a.setFromTriplets(entries.begin(), entries.end());
        factor_ = n > 0 ? std::make_shared<Factor>(a) : nullptr;
    }

    struct Report {
        int iterations = 0;
        Real before = 0, after = 0;  ///< norm of the residual: root of the sum of squares
    };

    /// Fills `solution()`, whatever the target.
    template <class Solids = const NoSolids>
    Report solve(Real /*target*/, int limit, Solids& /*solids*/ = no_solids) {
        static_assert(!Solids::present, "SparseCholesky does not know what solids add to the operator");
        solution_.fill(0);
        if (!factor_) return {};
        Eigen::VectorXd b(static_cast<Eigen::Index>(cells_.size()));
        for (std::size_t k = 0; k < cells_.size(); ++k)
            b[static_cast<Eigen::Index>(k)] = static_cast<double>(right_side_[cells_[k]]);
        Report report{limit > 0, b.norm(), 0};
        if (limit == 0) return report;
        if (floating_) b.array() -= b.mean();
        Eigen::VectorXd e = factor_->solve(b);
        if (floating_) e.array() -= e.mean();
        for (std::size_t k = 0; k < cells_.size(); ++k)
            solution_[cells_[k]] = static_cast<float>(e[static_cast<Eigen::Index>(k)]);
        return report;
    }

private:
    using Factor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;
    static constexpr int inner = Layout<Dim>::inner;

    void for_cells(int plane, auto&& body) const {
        matrix_.for_rows(plane, [&](Offset start, RowRange r) {
            for (Offset c = start + r.begin; c < start + r.end; ++c)
                if (matrix_.inverse_diagonal[c] > 0) body(c);
        });
    }

    void add_row(std::vector<Eigen::Triplet<double>>& entries, const std::vector<int>& number,
                 const typename Poisson<Dim>::Neighbours& neighbours, Offset start, int i) const {
        const Offset c = start + i;
        const int own = number[static_cast<std::size_t>(c)];
        if (own < 0) return;
        auto diagonal = static_cast<double>(matrix_.dirichlet[c]);
        for (int a = 0; a < Dim; ++a)
            for (const bool high : {false, true}) {
                const auto g = static_cast<double>(matrix_.face[a][high ? c + matrix_.layout.stride[a] : c]);
                if (g == 0) continue;
                diagonal += g;
                Offset step = high ? neighbours.high[a] : neighbours.low[a];
                const int n = matrix_.layout.row_length();
                if (a == inner && matrix_.periodic[a] && (high ? i == n - 1 : i == 0))
                    step = high ? 1 - n : n - 1;
                entries.emplace_back(own, number[static_cast<std::size_t>(c + step)], -g);
            }
        constexpr double regular = 1e-12;  // what is tied to nothing stays where it is
        entries.emplace_back(own, own, (1 + regular) * diagonal);
    }

    Poisson<Dim> matrix_;
    Field<float> right_side_, solution_;
    detail::PlaneRuns runs_;
    std::vector<Offset> cells_;             ///< [unknown]
    std::shared_ptr<const Factor> factor_;  ///< shared among copies
    bool floating_ = false;
};

}  // namespace abrade
