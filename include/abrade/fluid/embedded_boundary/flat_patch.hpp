#pragma once
// A flat piece of a cell's wall or face: where its middle is, and how far it spreads.

#include <abrade/fluid/embedded_boundary/cut_cell.hpp>
#include <abrade/fluid/mesh/grid.hpp>

#include <array>
#include <cmath>
#include <cstddef>

namespace abrade::detail {

/// A convex polygon in space; in two dimensions a line between two points.
template <int Dim>
class FlatPatch {
public:
    /// What a plane through a point cuts out of a box between two corners [m].
    static FlatPatch in_box(const Point<Dim>& point, const Point<Dim>& normal, const Point<Dim>& low,
                            const Point<Dim>& high) noexcept {
        FlatPatch patch;
        const Real reach = 2 * (high - low).norm();
        if constexpr (Dim == 2) {
            const Point<2> along(-normal[1], normal[0]);
            patch.add(point - reach * along), patch.add(point + reach * along);
        } else {
            const Vec3 first = normal.unitOrthogonal(), second = normal.cross(first);
            for (const auto& [s, t] :
                 {std::pair{-1, -1}, std::pair{1, -1}, std::pair{1, 1}, std::pair{-1, 1}})
                patch.add(point + reach * (s * first + t * second));
        }
        for (int a = 0; a < Dim; ++a) {
            patch.keep([&](const Point<Dim>& x) { return x[a] - low[a]; });
            patch.keep([&](const Point<Dim>& x) { return high[a] - x[a]; });
        }
        return patch;
    }
    /// What a wall leaves open of a cell's face, from its distances at the corners of the face.
    static FlatPatch open_face(const Grid<Dim>& grid, const CellNumber<Dim>& cell, int axis, std::size_t end,
                               const Corners<Dim - 1>& distance) noexcept {
        FlatPatch patch;
        constexpr std::array<std::size_t, 4> around{0, 1, 3, 2};
        std::array<Real, 4> at{};
        for (std::size_t k = 0; k < distance.size(); ++k) {
            const std::size_t corner = Dim == 2 ? k : around[k];
            std::size_t bit = 0;
            Point<Dim> x;
            for (int a = 0; a < Dim; ++a) {
                const std::size_t up = a == axis ? end : corner >> bit++ & 1;
                x[a] = grid.face(a, cell[a] + static_cast<int>(up));
            }
            at[k] = distance[corner];
            patch.add(x);
        }
        patch.keep_known(at);
        return patch;
    }

    /// Cuts off where a linear function is below 0.
    void keep(auto&& function) noexcept {
        std::array<Real, most> at{};
        for (std::size_t k = 0; k < size_; ++k) at[k] = function(corner_[k]);
        keep_known(at);
    }

    bool empty() const noexcept { return size_ < (Dim == 2 ? 2 : 3); }

    struct Moments {
        Real area = 0;                           ///< [m2]; in two dimensions [m]
        Point<Dim> centre = Point<Dim>::Zero();  ///< [m]
        Eigen::Matrix<Real, Dim, Dim> second =
            Eigen::Matrix<Real, Dim, Dim>::Zero();  ///< about it [m4]; [m3]
    };
    Moments moments() const noexcept {
        Moments m;
        if (empty()) return m;
        if constexpr (Dim == 2) {
            const Point<2> along = corner_[1] - corner_[0];
            m.area = along.norm(), m.centre = 0.5 * (corner_[0] + corner_[1]);
            m.second = m.area / 12 * along * along.transpose();
        } else {
            Point<3> sum = Point<3>::Zero();
            Eigen::Matrix<Real, 3, 3> about_first = Eigen::Matrix<Real, 3, 3>::Zero();
            for (std::size_t k = 2; k < size_; ++k) {  // triangles that share the first corner
                const Vec3 b = corner_[k - 1] - corner_[0], c = corner_[k] - corner_[0], bc = b + c;
                const Real area = 0.5 * b.cross(c).norm();
                m.area += area, sum += area / 3 * bc;
                about_first += area / 12 * (b * b.transpose() + c * c.transpose() + bc * bc.transpose());
            }
            if (m.area == 0) return m;
            const Vec3 off = sum / m.area;
            m.centre = corner_[0] + off;
            m.second = about_first - m.area * off * off.transpose();
        }
        return m;
    }

private:
    static constexpr std::size_t most = 16;

    void add(const Point<Dim>& x) noexcept {
        if (size_ < most) corner_[size_++] = x;
    }
    /// As `keep`, from the function's values at the corners (I. Sutherland and G. Hodgman 1974,
    /// doi:10.1145/360767.360802).
    void keep_known(const auto& at) noexcept {
        FlatPatch kept;
        for (std::size_t k = 0; k < size_; ++k) {
            const std::size_t next = (k + 1) % size_;
            if (at[k] >= 0) kept.add(corner_[k]);
            if (Dim == 2 && k == 1) break;  // a line does not close
            if ((at[k] >= 0) != (at[next] >= 0))
                kept.add(corner_[k] + at[k] / (at[k] - at[next]) * (corner_[next] - corner_[k]));
        }
        *this = kept;
    }

    std::array<Point<Dim>, most> corner_;
    std::size_t size_ = 0;
};

}  // namespace abrade::detail
