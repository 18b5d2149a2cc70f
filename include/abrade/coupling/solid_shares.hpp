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

/// A face of whose control volume, which lies half in either cell, a body covers some, or whose centre is
/// less than a cell from its surface.
struct SolidFace {
    Offset face = 0;  ///< of the velocity component
    Offset low = 0;   ///< of the cell below it, across a periodic side where there is one
    int axis = 0;
    int plane = 0;            ///< of the face, across the longest axis; the last of the upper side's, too
    Real share = 0;           ///< sigma, of the control volume [-]
    Real core = 0;            ///< share of a body whose surface is retracted [-]
    Real friction = 0;        ///< rate of friction over C nu [1/m2]
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
    bool averaged = false;          ///< too small for its shape to count: it has its part in a cloud

    void clear() noexcept { faces.clear(), cells.clear(), inside.clear(), parts.clear(), cut = false; }
};

namespace detail {

/// Numbers of cells and faces that go on beyond a box.
struct GridNumbers {
    const Grid<3>& grid;
    const Sides<3>& sides;

    Real size(int a, int i) const noexcept { return grid.size(a, std::clamp(i, 0, grid.cells(a) - 1)); }
    /// Lower face of cell i, which may be one beyond the ghosts.
    Real face(int a, int i) const noexcept {
        const int n = grid.cells(a);
        if (i < 0) return grid.low(a) + i * size(a, 0);
        if (i > n) return grid.high(a) + (i - n) * size(a, n - 1);
        return grid.face(a, i);
    }
    Real centre(int a, int i) const noexcept { return face(a, i) + 0.5 * size(a, i); }
    int cell_at(int a, Real x) const noexcept {
        const int n = grid.cells(a);
        if (x < grid.low(a)) return static_cast<int>(std::floor((x - grid.low(a)) / size(a, 0)));
        if (x >= grid.high(a)) return n + static_cast<int>((x - grid.high(a)) / size(a, n - 1));
        const bool even = a != Grid<3>::vertical || grid.uniform();
        return detail::place_between(x, 0, n, size(a, 0), even, [&](int i) { return grid.face(a, i); }).low;
    }
    int wrapped(int a, int i) const noexcept {
        const int n = grid.cells(a);
        return sides.periodic(a) ? (i % n + n) % n : i;
    }
    /// Of a cube as large as the cell about a point [m].
    Real cell_width(const Vec3& x) const noexcept {
        Real volume = 1;
        for (int a = 0; a < 3; ++a) volume *= size(a, cell_at(a, x[a]));
        return std::cbrt(volume);
    }
};

/// Shares of a body that is a union of spheres, in the control volumes of the faces about it.
///
/// Within a volume the surface is taken for a plane across the line to the nearest sphere's centre, moved by
/// what its curvature takes: <t^2> / (2 R), t along the plane. Then the shares are corrected such that along
/// each axis they hold the body's volume, and its centroid across that axis: so a pressure that is linear in
/// space (that of water at rest) pushes with rho g V and does not turn the body, wherever it stands. The
/// correction is
///   sigma (1 - sigma) (a + b . arm), a and b from linear equations, at most sigma (1 - sigma).
/// What is closed (walls, what lies beyond them) holds nothing, and the rest takes it over. A body that is
/// hardly larger than a cell is spread: its spheres grow, and cover a share.
///
/// Friction is told by the distance d of a face's centre from the surface, in cells of the size h that the
/// control volume has across it: s / ((1 - s) h^2), s = (1 - d) / 2 the share of two cells that lies within.
template <class Closed>
class SolidCoverFinder : GridNumbers {
public:
    /// `closed(axis, face)`: faces that walls close. `retracted`: by how much the core's surface is [cell].
    SolidCoverFinder(const GridNumbers& numbers, Closed closed, Real retracted = 0)
        : GridNumbers(numbers), closed_(std::move(closed)), retracted_(retracted) {}

    void find(const FlowBody& body, SolidCover& cover) {
        cover.clear();
        body_ = &body;
        find_box();
        cover.cut = is_cut();
        for (int a = 0; a < 3; ++a) find_shares(a), list_faces(a, cover);
        list_cells(cover);
        find_shares(of_cells);
        for (const Volume& v : covered_)
            if (kind_[of_cells][v.k] == Kind::open && share_[of_cells][v.k] > 0)
                cover.parts.push_back(
                    {grid.layout().at(inside_box(v.n)), share_[of_cells][v.k] * v.size.prod()});
    }

private:
    static constexpr int of_cells = 3;  ///< after the three axes
    using Number = CellNumber<3>;
    /// Of a cell along an axis: its lower face, its middle, its size, how far its middle is from the last
    /// [m].
    struct Line {
        Real face, centre, size, gap;
    };
    /// A control volume that the body covers some of; k in `share_`, [m].
    struct Volume {
        Number n;
        std::size_t k;
        Vec3 centre, size;
        Real core, friction;
    };
    enum class Kind : char {
        closed,
        open,
        beyond  ///< could let water through, but is no part of the box
    };

    /// The cells about the body, one more on either side than it reaches: the control volumes of their
    /// outermost faces hold nothing.
    void find_box() {
        const Real radius = 0.5 * body_->diameter(), least = 0.9 * cell_width(body_->position);
        grown_ = std::max(least - radius, 0.0);
        scale_ = grown_ > 0 ? cube(radius / least) : 1;
        std::size_t count = 1;
        for (int a = 0; a < 3; ++a) {
            Real low = std::numeric_limits<Real>::infinity(), high = -low;
            for (const Sphere& s : body_->spheres) {
                low = std::min(low, s.centre[a] - s.radius - grown_);
                high = std::max(high, s.centre[a] + s.radius + grown_);
            }
            first_[a] = cell_at(a, low) - 1;
            length_[a] = cell_at(a, high) + 3 - first_[a];
            stride_[a] = count;
            count *= static_cast<std::size_t>(length_[a]);
            auto& lines = lines_[a];
            lines.clear();
            for (int i = first_[a]; i < first_[a] + length_[a]; ++i)
                lines.push_back({face(a, i), centre(a, i), size(a, i), centre(a, i) - centre(a, i - 1)});
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
        for (int a = 0; a < 3; ++a) x[a] = a == axis ? line(a, n).face : line(a, n).centre;
        return x;
    }
    Vec3 extent(int axis, const Number& n) const noexcept {
        Vec3 s;
        for (int a = 0; a < 3; ++a) s[a] = a == axis ? line(a, n).gap : line(a, n).size;
        return s;
    }
    const Line& line(int a, const Number& n) const noexcept {
        return lines_[a][static_cast<std::size_t>(n[a] - first_[a])];
    }
    Number inside_box(const Number& n) const noexcept {
        Number inside;
        for (int a = 0; a < 3; ++a) inside[a] = wrapped(a, n[a]);
        return inside;
    }

    bool is_cut() const noexcept {
        for (int a = 0; a < 3; ++a)
            for (const Sphere& s : body_->spheres) {
                const Real reach = s.radius + grown_;
                if (sides.periodic(a)) continue;
                if (!is_closed(sides[a][0]) && s.centre[a] - reach < grid.low(a)) return true;
                if (!is_closed(sides[a][1]) && s.centre[a] + reach > grid.high(a)) return true;
            }
        return false;
    }

    Kind kind(int axis, const Number& n) const noexcept {
        bool beyond = false;
        for (int a = 0; a < 3; ++a) {
            const int first = a == axis ? 1 : 0, end = grid.cells(a);
            if (sides.periodic(a) || (n[a] >= first && n[a] < end)) continue;
            if (is_closed(sides[a][n[a] < first ? 0 : 1])) return Kind::closed;
            beyond |= a != axis || (n[a] != 0 && n[a] != end);  // and not the side itself
        }
        if (beyond) return Kind::beyond;
        return axis < 3 && closed_(axis, grid.layout().at(inside_box(n))) ? Kind::closed : Kind::open;
    }

    struct Near {
        Real distance = std::numeric_limits<Real>::infinity();  ///< to the surface, negative inside [m]
        Real radius = 0;
        Vec3 from = Vec3::Zero();  ///< that sphere's centre [m]
        Real length = 0;           ///< of that
    };
    /// Of spheres whose surface is no farther than `reach`.
    Near nearest(const Vec3& x, Real reach) const noexcept {
        Near near{.distance = reach};
        for (const Sphere& s : body_->spheres) {
            const Vec3 from = x - s.centre;
            const Real radius = s.radius + grown_, within = radius + near.distance,
                       square2 = from.squaredNorm();
            if (!(within > 0 && square2 < square(within))) continue;
            const Real length = std::sqrt(square2);
            near = {length - radius, radius, from, length};
        }
        return near;
    }

    /// A box of size s about a point, times the surface's normal.
    static Vec3 across(const Near& near, const Vec3& s) noexcept {
        return near.length > 0 ? Vec3(s.cwiseProduct(near.from) / near.length) : Vec3(0, 0, s.z());
    }
    /// Of a box of size s about a point.
    Real share_of(const Near& near, const Vec3& s) const noexcept {
        const Vec3 across = this->across(near, s);
        const Real curved = (s.squaredNorm() - across.squaredNorm()) / (24 * near.radius);
        return scale_ *
               liquid_fraction<3>(std::array{across[0], across[1], across[2]}, -near.distance - curved);
    }

    Real core_of(Near near, const Vec3& s) const noexcept {
        near.distance += retracted_ * std::cbrt(s.prod());
        return share_of(near, s);
    }

    Real friction_of(const Near& near, const Vec3& s) const noexcept {
        const Real size = across(near, s).norm(), d = near.distance / size;
        const Real within = scale_ * std::clamp(0.5 * (1 - d), 0.0, 1.0);
        constexpr Real least = 1e-12;  // of two cells: less is none
        return within / (std::max(1 - within, least) * square(size));
    }

    void find_shares(int axis) {
        auto& share = share_[axis];
        covered_.clear();
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        const Real unit = std::cbrt(body_->volume);  // lest the equations be as uneven as metres make them
        const auto terms = [&](const Vec3& x) {
            const Vec3 arm = (x - body_->position) / unit;
            return Vec3(1, arm[b], arm[c]);
        };
        for_each([&](const Number& n, std::size_t k) {
            const Vec3 x = place(axis, n), s = extent(axis, n);
            const Near near = nearest(x, std::max(0.6 * s.norm(), s.maxCoeff()));
            if (near.radius == 0) return;
            kind_[axis][k] = kind(axis, n);
            if (kind_[axis][k] == Kind::closed) return;
            share[k] = share_of(near, s);
            const Real friction = axis == of_cells ? 0 : friction_of(near, s);
            if (share[k] > 0 || friction > 0)
                covered_.push_back({n, k, x, s, retracted_ > 0 ? core_of(near, s) : 0, friction});
        });
        constexpr int most_rounds =
            4;  // one, but where a floor takes so much that shares are at their bounds
        for (int round = 0; round < most_rounds; ++round) {
            Mat3 matrix = 1e-12 * body_->volume * Mat3::Identity();
            Vec3 lacks(body_->volume, 0, 0);
            for (const Volume& v : covered_) {
                if (share[v.k] == 0) continue;
                const Vec3 x = terms(v.centre);
                const Real covers = share[v.k] * v.size.prod();
                lacks -= covers * x;
                matrix += covers * (1 - share[v.k]) * x * x.transpose();
            }
            if (lacks.norm() < 1e-14 * body_->volume) return;
            const Vec3 by = matrix.ldlt().solve(lacks);
            for (const Volume& v : covered_) {
                Real& of = share[v.k];
                if (of > 0 && of < 1) of += of * (1 - of) * std::clamp(by.dot(terms(v.centre)), -1.0, 1.0);
            }
        }
    }

    /// After `find_shares`.
    void list_faces(int axis, SolidCover& cover) const {
        const Layout<3>& l = grid.layout();
        for (const auto& [n, k, centre, s, core, friction] : covered_) {
            if (kind_[axis][k] != Kind::open) continue;
            const Number inside = inside_box(n);
            Number below = inside;
            below[axis] = wrapped(axis, inside[axis] - 1);
            cover.faces.push_back({.face = l.at(inside),
                                   .low = l.at(below),
                                   .axis = axis,
                                   .plane = std::min(inside[Layout<3>::outer], l.planes() - 1),
                                   .share = share_[axis][k],
                                   .core = retracted_ > 0 ? core : share_[axis][k],
                                   .friction = friction,
                                   .area = s.prod() / s[axis],
                                   .gap = s[axis],
                                   .arm = centre - body_->position});
        }
    }

    void list_cells(SolidCover& cover) const {
        for_each([&](const Number& n, std::size_t k) {
            const Number inside = inside_box(n);
            bool last = !grid.has(inside), all = true, none = true;
            for (int a = 0; a < 3; ++a) last |= n[a] == first_[a] + length_[a] - 1;
            if (last) return;
            SolidCell cell{.cell = grid.layout().at(inside), .arm = place(of_cells, n) - body_->position};
            for (int a = 0; a < 3; ++a)
                for (int up = 0; up < 2; ++up) {
                    const std::size_t at = k + static_cast<std::size_t>(up) * stride_[a];
                    const Real share = kind_[a][at] == Kind::open ? share_[a][at] : 0;
                    all &= share == 1, none &= share == 0;
                    if (share == 0) continue;
                    Number of = n;
                    of[a] += up;
                    const Vec3 s = extent(a, of);
                    const Real out = (up == 1 ? share : -share) * s.prod() / s[a];
                    cell.way[a] += out;
                    cell.turn += out * (place(a, of) - body_->position).cross(Vec3::Unit(a));
                }
            if (!none) (all ? cover.inside : cover.cells).push_back(cell);
        });
    }

    Closed closed_;
    Real retracted_;
    const FlowBody* body_ = nullptr;
    Real grown_ = 0, scale_ = 1;  ///< of a small body's spheres [m], of its shares [-]
    Number first_{}, length_{};
    PerAxis<std::size_t, 3> stride_{};
    PerAxis<std::vector<Line>, 3> lines_;
    std::vector<Volume> covered_;          ///< in the order of k
    PerAxis<std::vector<Real>, 4> share_;  ///< of the faces across each axis, of cells
    PerAxis<std::vector<Kind>, 4> kind_;
};

}  // namespace detail

/// The parts of the faces of `grid` that `body` covers; `closed(axis, face)`: faces that walls close.
template <class Closed>
SolidCover cover_of(const Grid<3>& grid, const Sides<3>& sides, const FlowBody& body, Closed closed) {
    SolidCover cover;
    detail::SolidCoverFinder<Closed>({grid, sides}, std::move(closed)).find(body, cover);
    return cover;
}

}  // namespace abrade
