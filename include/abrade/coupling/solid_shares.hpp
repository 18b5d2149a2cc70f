#pragma once
// Which parts of the faces of a staggered grid a rigid body covers.

#include <abrade/fluid/cut_cell.hpp>
#include <abrade/fluid/grid_place.hpp>
#include <abrade/fluid/solids_in_flow.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace abrade {

/// A face of whose control volume, which lies half in either cell, a body covers some.
struct SolidFace {
    Offset face = 0;  ///< of the velocity component
    Offset low = 0;   ///< of the cell below it, across a periodic side where there is one
    int axis = 0;
    int plane = 0;            ///< of the face, across the longest axis; the last of the upper side's, too
    Real share = 0;           ///< sigma, of the control volume [-]
    Real area = 0, gap = 0;   ///< of the face [m2]; between the centres of its cells [m]
    Vec3 arm = Vec3::Zero();  ///< from the body's centroid to the face's centre [m]

    Real volume() const noexcept { return area * gap; }
    /// What the face's velocity owes to the body's spin: component `axis` of spin x arm.
    Vec3 lever() const noexcept { return arm.cross(Vec3::Unit(axis)); }
};

/// A cell of which a body covers some. As the body moves by V dt and turns by W dt it gives
/// dt (way . V + turn . W) to the cells around.
struct SolidCell {
    Offset cell = 0;
    Vec3 way = Vec3::Zero();   ///< [m2]
    Vec3 turn = Vec3::Zero();  ///< [m3]
    Vec3 arm = Vec3::Zero();   ///< from the body's centroid to the cell's centre [m]
};

/// A body on the grid.
struct SolidCover {
    std::vector<SolidFace> faces;
    std::vector<SolidCell> cells;   ///< that it covers in part
    std::vector<SolidCell> inside;  ///< and as a whole
    std::vector<SolidPart> parts;   ///< its volume in cells
    bool cut = false;               ///< some of it lies beyond a side where water flows in or out
    bool averaged = false;          ///< too small for its shape to count: spread, and not turned
    Real reach = 0;                 ///< then, of a ball as wide as what it is spread over [m]
};

namespace detail {

/// Of a cube as large as the cell about a point [m].
inline Real cell_width(const Grid<3>& grid, const Vec3& x) noexcept {
    Real volume = 1;
    for (int a = 0; a < 3; ++a) {
        const GridPlace place = detail::place_between(
            std::clamp(x[a], grid.low(a), grid.high(a)), 0, grid.cells(a), grid.size(a, 0),
            a != Grid<3>::vertical || grid.uniform(), [&](int i) { return grid.face(a, i); });
        volume *= grid.size(a, std::min(place.low, grid.cells(a) - 1));
    }
    return std::cbrt(volume);
}

}  // namespace detail

/// Whether a body has less than `resolved_from` cells to a diameter.
inline bool is_averaged(const Grid<3>& grid, const FlowBody& body, Real resolved_from) noexcept {
    return body.diameter() < resolved_from * detail::cell_width(grid, body.position);
}

namespace detail {

/// Shares of a body that is a union of spheres, in the control volumes of the faces about it.
///
/// Within a volume the surface is taken for a plane across the line to the nearest sphere's centre, moved by
/// what its curvature takes: <t^2> / (2 R), t along the plane. Then the shares are corrected such that along
/// each axis they hold the body's volume, and its centroid across that axis: so a pressure that is linear in
/// space (that of water at rest) pushes with rho g V and does not turn the body, wherever it stands. The
/// correction is
///   sigma (1 - sigma) (a + b . arm), a and b from linear equations, at most sigma (1 - sigma).
/// What is closed (walls, what lies beyond them) holds nothing, and the rest takes it over.
///
/// A body of less than `resolved_from` cells to a diameter D = (6 V / pi)^(1/3) is averaged: each of its
/// spheres is spread by a triangle of as much variance along each axis as a ball of 3 D has, or of 3 cells,
/// and its faces have no lever.
template <class Open>
class SolidCoverFinder {
public:
    /// `open(axis, face)`: share that walls leave of a face.
    SolidCoverFinder(const Grid<3>& grid, const Sides<3>& sides, Real resolved_from, Open open)
        : grid_(grid), sides_(sides), resolved_from_(resolved_from), open_(std::move(open)) {}

    void find(const FlowBody& body, SolidCover& cover) {
        cover.faces.clear(), cover.cells.clear(), cover.inside.clear(), cover.parts.clear();
        body_ = &body;
        const Real diameter = body.diameter(), width = detail::cell_width(grid_, body.position);
        cover.averaged = averaged_ = is_averaged(grid_, body, resolved_from_);
        cover.reach = averaged_ ? 1.5 * std::max(diameter, width) : 0;
        grown_ = averaged_ ? std::sqrt(6.0 / 5) * cover.reach : std::max(0.9 * width - 0.5 * diameter, 0.0);
        scale_ = grown_ > 0 ? cube(0.5 * diameter / (0.9 * width)) : 1;
        find_box();
        cover.cut = is_cut();
        for (int a = 0; a < 3; ++a) find(a), list_faces(a, cover);
        list_cells(cover);
        find(of_cells);
        for_each([&](const Number& n, std::size_t k) {
            if (kind_[of_cells][k] == Kind::open && share_[of_cells][k] > 0)
                cover.parts.push_back(
                    {grid_.layout().at(inside_box(n)), share_[of_cells][k] * extent(of_cells, n).prod()});
        });
    }

private:
    static constexpr int of_cells = 3;  ///< after the three axes
    using Number = CellNumber<3>;
    enum class Kind : char {
        closed,
        open,
        beyond  ///< could let water through, but is no part of the box
    };

    Real size(int a, int i) const noexcept { return grid_.size(a, std::clamp(i, 0, grid_.cells(a) - 1)); }
    /// Lower face of cell i, which may be one beyond the ghosts.
    Real face(int a, int i) const noexcept {
        const int n = grid_.cells(a);
        if (i < 0) return grid_.low(a) + i * size(a, 0);
        if (i > n) return grid_.high(a) + (i - n) * size(a, n - 1);
        return grid_.face(a, i);
    }
    Real centre(int a, int i) const noexcept { return face(a, i) + 0.5 * size(a, i); }
    int cell_at(int a, Real x) const noexcept {
        const int n = grid_.cells(a);
        if (x < grid_.low(a)) return static_cast<int>(std::floor((x - grid_.low(a)) / size(a, 0)));
        if (x >= grid_.high(a)) return n + static_cast<int>((x - grid_.high(a)) / size(a, n - 1));
        const bool even = a != Grid<3>::vertical || grid_.uniform();
        return detail::place_between(x, 0, n, size(a, 0), even, [&](int i) { return grid_.face(a, i); }).low;
    }
    int wrapped(int a, int i) const noexcept {
        const int n = grid_.cells(a);
        return sides_.periodic(a) ? (i % n + n) % n : i;
    }

    /// The cells about the body, one more on either side than it reaches: the control volumes of their
    /// outermost faces hold nothing.
    void find_box() {
        std::size_t count = 1;
        for (int a = 0; a < 3; ++a) {
            Real low = std::numeric_limits<Real>::infinity(), high = -low;
            for (const Sphere& s : body_->spheres)
                low = std::min(low, s.centre[a] - reach(s)), high = std::max(high, s.centre[a] + reach(s));
            first_[a] = cell_at(a, low) - 1;
            length_[a] = cell_at(a, high) + 3 - first_[a];
            stride_[a] = count;
            count *= static_cast<std::size_t>(length_[a]);
        }
        for (auto& share : share_) share.assign(count, 0);
        for (auto& kind : kind_) kind.assign(count, Kind::closed);
    }
    void for_each(auto&& visit) const {
        std::size_t k = 0;
        Number n;
        for (n[2] = first_[2]; n[2] < first_[2] + length_[2]; ++n[2])
            for (n[1] = first_[1]; n[1] < first_[1] + length_[1]; ++n[1])
                for (n[0] = first_[0]; n[0] < first_[0] + length_[0]; ++n[0], ++k) visit(std::as_const(n), k);
    }
    /// Centre and size of the control volume of a face, or of a cell.
    Vec3 place(int axis, const Number& n) const noexcept {
        Vec3 x;
        for (int a = 0; a < 3; ++a) x[a] = a == axis ? face(a, n[a]) : centre(a, n[a]);
        return x;
    }
    Vec3 extent(int axis, const Number& n) const noexcept {
        Vec3 s;
        for (int a = 0; a < 3; ++a) s[a] = a == axis ? centre(a, n[a]) - centre(a, n[a] - 1) : size(a, n[a]);
        return s;
    }
    Number inside_box(const Number& n) const noexcept {
        Number inside;
        for (int a = 0; a < 3; ++a) inside[a] = wrapped(a, n[a]);
        return inside;
    }

    Real reach(const Sphere& s) const noexcept { return averaged_ ? grown_ : s.radius + grown_; }
    /// What is averaged counts as a whole.
    bool is_cut() const noexcept {
        for (int a = 0; a < 3; ++a)
            for (const Sphere& s : body_->spheres) {
                const Real way = averaged_ ? 0 : reach(s);
                if (sides_.periodic(a)) continue;
                if (!is_closed(sides_[a][0]) && s.centre[a] - way < grid_.low(a)) return true;
                if (!is_closed(sides_[a][1]) && s.centre[a] + way > grid_.high(a)) return true;
            }
        return false;
    }

    Kind kind(int axis, const Number& n) const noexcept {
        bool beyond = false;
        for (int a = 0; a < 3; ++a) {
            const int first = a == axis ? 1 : 0, end = grid_.cells(a);
            if (sides_.periodic(a) || (n[a] >= first && n[a] < end)) continue;
            if (averaged_ || is_closed(sides_[a][n[a] < first ? 0 : 1])) return Kind::closed;
            beyond |= a != axis || (n[a] != 0 && n[a] != end);  // and not the side itself
        }
        if (beyond) return Kind::beyond;
        return axis < 3 && open_(axis, grid_.layout().at(inside_box(n))) == 0 ? Kind::closed : Kind::open;
    }
    /// Of a control volume [-].
    Real open(int axis, const Number& n) const noexcept {
        const Offset c = grid_.layout().at(inside_box(n));
        if (axis < 3) return open_(axis, c);
        Real sum = 0;
        for (int a = 0; a < 3; ++a) sum += open_(a, c) + open_(a, c + grid_.layout().stride[a]);
        return sum / 6;
    }

    void find(int axis) { averaged_ ? find_averaged(axis) : find_shares(axis); }

    /// Each axis has its own share of a sphere in each layer of the box.
    void find_averaged(int axis) {
        auto& share = share_[axis];
        for (const Sphere& s : body_->spheres) {
            PerAxis<std::vector<Real>, 3> part;
            for (int a = 0; a < 3; ++a)
                for (int i = first_[a]; i < first_[a] + length_[a]; ++i) {
                    const Real low = a == axis ? centre(a, i - 1) : face(a, i);
                    const Real high = a == axis ? centre(a, i) : face(a, i + 1);
                    part[a].push_back(below(high - s.centre[a]) - below(low - s.centre[a]));
                }
            const Real volume = body_->spheres.size() > 1 ? cube(s.radius) : 1;
            for_each([&](const Number& n, std::size_t k) {
                Real all = volume;
                for (int a = 0; a < 3; ++a) all *= part[a][static_cast<std::size_t>(n[a] - first_[a])];
                share[k] += all;
            });
        }
        Real sum = 0;
        for_each([&](const Number& n, std::size_t k) {
            if (share[k] == 0) return;
            kind_[axis][k] = kind(axis, n);
            share[k] *= kind_[axis][k] == Kind::open ? open(axis, n) : 0;
            sum += share[k];
        });
        constexpr Real most = 0.9;
        if (sum > 0)
            for_each([&](const Number& n, std::size_t k) {
                if (share[k] > 0)
                    share[k] = std::min(share[k] * body_->volume / (sum * extent(axis, n).prod()), most);
            });
    }
    /// Part of a triangle that is `grown_` wide to either side, below a place x from its middle [-].
    Real below(Real x) const noexcept {
        const Real t = std::clamp(x / grown_, -1.0, 1.0);
        return t < 0 ? 0.5 * square(1 + t) : 1 - 0.5 * square(1 - t);
    }

    struct Near {
        Real distance = std::numeric_limits<Real>::infinity();  ///< to the surface, negative inside [m]
        Real radius = 0;
        Vec3 from = Vec3::Zero();  ///< that sphere's centre [m]
    };
    Near nearest(const Vec3& x) const noexcept {
        Near near;
        for (const Sphere& s : body_->spheres) {
            const Vec3 from = x - s.centre;
            const Real radius = s.radius + grown_;
            const Real distance = from.norm() - radius;
            if (distance < near.distance) near = {distance, radius, from};
        }
        return near;
    }

    /// Of a box of size s about a point.
    Real share_of(const Near& near, const Vec3& s) const noexcept {
        const Real length = near.from.norm();
        const Vec3 normal = length > 0 ? Vec3(near.from / length) : Vec3(0, 0, 1);
        const Vec3 across = s.cwiseProduct(normal);
        const Real curved = (s.squaredNorm() - across.squaredNorm()) / (24 * near.radius);
        return scale_ *
               liquid_fraction<3>(std::array{across[0], across[1], across[2]}, -near.distance - curved);
    }

    void find_shares(int axis) {
        auto& share = share_[axis];
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        const Real unit = std::cbrt(body_->volume);  // lest the equations be as uneven as metres make them
        const auto terms = [&](const Vec3& x) {
            const Vec3 arm = (x - body_->position) / unit;
            return Vec3(1, arm[b], arm[c]);
        };
        for_each([&](const Number& n, std::size_t k) {
            const Vec3 s = extent(axis, n);
            const Near near = nearest(place(axis, n));
            if (near.distance > 0.6 * s.norm()) return;
            kind_[axis][k] = kind(axis, n);
            if (kind_[axis][k] != Kind::closed) share[k] = share_of(near, s);
        });
        constexpr int most_rounds =
            4;  // one, but where a floor takes so much that shares are at their bounds
        for (int round = 0; round < most_rounds; ++round) {
            Mat3 matrix = 1e-12 * body_->volume * Mat3::Identity();
            Vec3 lacks(body_->volume, 0, 0);
            for_each([&](const Number& n, std::size_t k) {
                if (share[k] == 0) return;
                const Vec3 x = terms(place(axis, n));
                const Real volume = extent(axis, n).prod();
                lacks -= share[k] * volume * x;
                matrix += share[k] * (1 - share[k]) * volume * x * x.transpose();
            });
            if (lacks.norm() < 1e-14 * body_->volume) return;
            const Vec3 by = matrix.ldlt().solve(lacks);
            for_each([&](const Number& n, std::size_t k) {
                if (share[k] == 0 || share[k] == 1) return;
                share[k] += share[k] * (1 - share[k]) * std::clamp(by.dot(terms(place(axis, n))), -1.0, 1.0);
            });
        }
    }

    void list_faces(int axis, SolidCover& cover) const {
        const Layout<3>& l = grid_.layout();
        for_each([&](const Number& n, std::size_t k) {
            if (kind_[axis][k] != Kind::open || share_[axis][k] == 0) return;
            const Number inside = inside_box(n);
            Number below = inside;
            below[axis] = wrapped(axis, inside[axis] - 1);
            const Vec3 s = extent(axis, n);
            cover.faces.push_back(
                {.face = l.at(inside),
                 .low = l.at(below),
                 .axis = axis,
                 .plane = std::min(inside[Layout<3>::outer], l.planes() - 1),
                 .share = share_[axis][k],
                 .area = s.prod() / s[axis],
                 .gap = s[axis],
                 .arm = averaged_ ? Vec3(Vec3::Zero()) : Vec3(place(axis, n) - body_->position)});
        });
    }

    void list_cells(SolidCover& cover) const {
        for_each([&](const Number& n, std::size_t k) {
            const Number inside = inside_box(n);
            bool last = !grid_.has(inside), all = true, none = true;
            for (int a = 0; a < 3; ++a) last |= n[a] == first_[a] + length_[a] - 1;
            if (last) return;
            SolidCell cell{.cell = grid_.layout().at(inside), .arm = place(of_cells, n) - body_->position};
            for (int a = 0; a < 3; ++a)
                for (int up = 0; up < 2; ++up) {
                    const std::size_t at = k + static_cast<std::size_t>(up) * stride_[a];
                    const Real share = kind_[a][at] == Kind::open ? share_[a][at] : 0;
                    all &= share == 1, none &= share == 0;
                    Number of = n;
                    of[a] += up;
                    const Vec3 s = extent(a, of);
                    const Real out = (up == 1 ? share : -share) * s.prod() / s[a];
                    cell.way[a] += out;
                    if (!averaged_) cell.turn += out * (place(a, of) - body_->position).cross(Vec3::Unit(a));
                }
            if (!none) (all ? cover.inside : cover.cells).push_back(cell);
        });
    }

    const Grid<3>& grid_;
    const Sides<3>& sides_;
    Real resolved_from_;  ///< [cell]
    Open open_;
    const FlowBody* body_ = nullptr;
    bool averaged_ = false;
    Real grown_ = 0, scale_ = 1;  ///< of a small body's spheres [m], of its shares [-]
    Number first_{}, length_{};
    PerAxis<std::size_t, 3> stride_{};
    PerAxis<std::vector<Real>, 4> share_;  ///< of the faces across each axis, of cells
    PerAxis<std::vector<Kind>, 4> kind_;
};

}  // namespace detail

/// The parts of the faces of `grid` that `body` covers; `open(axis, face)`: share that walls leave of one.
template <class Open>
SolidCover cover_of(const Grid<3>& grid, const Sides<3>& sides, const FlowBody& body, Open open,
                    Real resolved_from = 0) {
    SolidCover cover;
    detail::SolidCoverFinder<Open>(grid, sides, resolved_from, std::move(open)).find(body, cover);
    return cover;
}

}  // namespace abrade
