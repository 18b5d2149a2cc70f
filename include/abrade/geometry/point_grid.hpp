#pragma once
// Points that stay where they are, sorted into cells: which of them are near a place.

#include <abrade/core/types.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace abrade {

class PointGrid {
public:
    PointGrid() = default;
    /// Cells of `cell` [m], wider where that would be far more cells than points.
    PointGrid(std::span<const Vec3> points, Real cell) {
        if (points.empty()) return;
        low_ = points.front();
        Vec3 high = low_;
        for (const Vec3& x : points) low_ = low_.cwiseMin(x), high = high.cwiseMax(x);
        const auto cells = [&] {
            Real all = 1;
            for (int a = 0; a < 3; ++a) all *= std::floor((high[a] - low_[a]) / cell) + 1;
            return all;
        };
        while (cells() > 4.0 * static_cast<Real>(points.size()) + 64) cell *= 1.25;
        per_cell_ = 1 / cell;
        for (int a = 0; a < 3; ++a) count_[a] = static_cast<Index>((high[a] - low_[a]) * per_cell_) + 1;
        start_.assign(at(count_[0]) * at(count_[1]) * at(count_[2]) + 1, 0);
        const auto cell_of = [&](const Vec3& x) {
            std::array<Index, 3> c{};
            for (int a = 0; a < 3; ++a) c[at(a)] = cell_along(x[a], a);
            return index(c[0], c[1], c[2]);
        };
        for (const Vec3& x : points) ++start_[cell_of(x) + 1];
        for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
        points_.resize(points.size());
        std::vector<Index> next(start_.begin(), start_.end() - 1);
        for (std::size_t n = 0; n < points.size(); ++n)
            points_[at(next[cell_of(points[n])]++)] = static_cast<Index>(n);
    }

    /// Calls `visit(point)` for the points of all cells that lie within `reach` [m] of x along each axis:
    /// those near x, and some others.
    template <class Visit>
    void each_about(const Vec3& x, Real reach, Visit&& visit) const {
        each_about(x, Vec3(Vec3::Constant(reach)), visit);
    }
    /// The same with a reach of its own along each axis, which may be infinite.
    template <class Visit>
    void each_about(const Vec3& x, const Vec3& reach, Visit&& visit) const {
        if (points_.empty()) return;
        std::array<Index, 3> from{}, to{};
        for (int a = 0; a < 3; ++a) {
            const Real first = (x[a] - reach[a] - low_[a]) * per_cell_,
                       last = (x[a] + reach[a] - low_[a]) * per_cell_;
            if (last < 0 || first >= static_cast<Real>(count_[a])) return;
            from[at(a)] = cell_along(x[a] - reach[a], a), to[at(a)] = cell_along(x[a] + reach[a], a);
        }
        for (Index i = from[0]; i <= to[0]; ++i)
            for (Index j = from[1]; j <= to[1]; ++j)
                for (Index n = start_[index(i, j, from[2])]; n < start_[index(i, j, to[2]) + 1]; ++n)
                    visit(points_[at(n)]);
    }

private:
    static std::size_t at(Index i) noexcept { return static_cast<std::size_t>(i); }
    Index cell_along(Real x, int axis) const noexcept {
        return static_cast<Index>(
            std::clamp((x - low_[axis]) * per_cell_, 0.0, static_cast<Real>(count_[axis] - 1)));
    }
    std::size_t index(Index i, Index j, Index k) const noexcept {
        return (at(i) * at(count_[1]) + at(j)) * at(count_[2]) + at(k);
    }

    Vec3 low_ = Vec3::Zero();
    Real per_cell_ = 0;  ///< [1/m]
    Eigen::Matrix<Index, 3, 1> count_ = Eigen::Matrix<Index, 3, 1>::Zero();
    std::vector<Index> start_;   ///< [cell + 1]
    std::vector<Index> points_;  ///< cell by cell
};

}  // namespace abrade
