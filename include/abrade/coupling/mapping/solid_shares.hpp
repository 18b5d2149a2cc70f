#pragma once
// Which parts of the faces of a staggered grid a rigid body covers.

#include <abrade/core/simd.hpp>
#include <abrade/coupling/mapping/solid_cover.hpp>
#include <abrade/fluid/vof/plic.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace abrade {

namespace detail {

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
        for_each_covered(of_cells, [&](const Number& n, std::size_t p, int lane) {
            const Real share = share_[of_cells][p][lane];
            if (share > 0) cover.parts.push_back({offset(n), share * extent(of_cells, n).prod()});
        });
    }

private:
    static constexpr int of_cells = 3;  ///< after the three axes
    using Number = CellNumber<3>;
    /// Of a cell along an axis: its lower face, its middle, its size, how far its middle is from the last
    /// [m].
    struct Line {
        Real face, centre, size, gap;
    };
    struct Place {
        std::size_t pack;
        int lane;
    };
    enum class Kind : char {
        closed,
        open,
        beyond  ///< could let water through, but is no part of the box
    };
    using Packs = std::vector<Pack>;

    /// The cells about the body, one more on either side than it reaches: the control volumes of their
    /// outermost faces hold nothing. Rows along x are whole packs.
    void find_box() {
        const Real radius = 0.5 * body_->diameter(), least = 0.9 * cell_width(body_->position);
        grown_ = std::max(least - radius, 0.0);
        scale_ = grown_ > 0 ? cube(radius / least) : 1;
        interior_ = true;
        for (int a = 0; a < 3; ++a) {
            Real low = std::numeric_limits<Real>::infinity(), high = -low;
            for (const Sphere& s : body_->spheres) {
                low = std::min(low, s.centre[a] - s.radius - grown_);
                high = std::max(high, s.centre[a] + s.radius + grown_);
            }
            first_[a] = cell_at(a, low) - 1;
            length_[a] = cell_at(a, high) + 3 - first_[a];
            interior_ &= first_[a] >= 1 && first_[a] + length_[a] <= grid.cells(a);
            auto& lines = lines_[a];
            lines.clear();
            for (int i = first_[a]; i < first_[a] + length_[a]; ++i)
                lines.push_back({face(a, i), centre(a, i), size(a, i), centre(a, i) - centre(a, i - 1)});
        }
        in_row_ = static_cast<std::size_t>((length_[0] + pack_lanes - 1) / pack_lanes);
        for (Packs& x : x_) x.assign(in_row_, Pack(far));
        for (int i = 0; i < length_[0]; ++i) {
            const int pack = i / pack_lanes, lane = i % pack_lanes;
            const Line& line = lines_[0][index(i)];
            x_[0][index(pack)].set(lane, line.face), x_[1][index(pack)].set(lane, line.centre);
        }
        const std::size_t rows = index(length_[1]) * index(length_[2]);
        for (auto& share : share_) share.assign(rows * in_row_, Pack(0));
        friction_.resize(rows * in_row_), core_.resize(rows * in_row_);
        for (auto& covered : covered_) covered.assign(rows, false);
    }
    static constexpr Real far = 1e30;  ///< from all bodies [m]
    static std::size_t index(int i) noexcept { return static_cast<std::size_t>(i); }

    /// Calls visit(number of its first volume, row).
    void for_each_row(auto&& visit) const {
        std::size_t row = 0;
        Number n{first_[0], 0, 0};
        for (n[2] = first_[2]; n[2] < first_[2] + length_[2]; ++n[2])
            for (n[1] = first_[1]; n[1] < first_[1] + length_[1]; ++n[1]) visit(std::as_const(n), row++);
    }
    /// Calls visit(number, pack, lane) for the volumes that `find_shares` has found last.
    void for_each_covered(int axis, auto&& visit) const {
        for_each_row([&](Number n, std::size_t row) {
            if (!covered_[axis][row]) return;
            for (std::size_t q = 0; q < in_row_; ++q) {
                const std::size_t p = row * in_row_ + q;
                unsigned lanes = lanes_of((share_[axis][p] > Pack(0)) | (friction_[p] > Pack(0)));
                for (; lanes != 0; lanes &= lanes - 1) {
                    const int lane = std::countr_zero(lanes);
                    n[0] = first_[0] + static_cast<int>(q) * pack_lanes + lane;
                    visit(std::as_const(n), p, lane);
                }
            }
        });
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
    const Line& line(int a, const Number& n) const noexcept { return lines_[a][index(n[a] - first_[a])]; }
    Number inside_box(Number n) const noexcept {
        for (int a = 0; a < 3; ++a) n[a] = wrapped(a, n[a]);
        return n;
    }
    Offset offset(const Number& n) const noexcept { return grid.layout().at(interior_ ? n : inside_box(n)); }

    bool is_cut() const noexcept {
        for (int a = 0; a < 3; ++a)
            for (const Sphere& s : body_->spheres) {
                const Real reach = s.radius + grown_;
                if (boundaries.periodic(a)) continue;
                if (!is_closed(boundaries[a][0]) && s.centre[a] - reach < grid.low(a)) return true;
                if (!is_closed(boundaries[a][1]) && s.centre[a] + reach > grid.high(a)) return true;
            }
        return false;
    }

    Kind kind(int axis, const Number& n) const noexcept {
        bool beyond = false;
        for (int a = 0; a < 3 && !interior_; ++a) {
            const int first = a == axis ? 1 : 0, end = grid.cells(a);
            if (boundaries.periodic(a) || (n[a] >= first && n[a] < end)) continue;
            if (is_closed(boundaries[a][n[a] < first ? 0 : 1])) return Kind::closed;
            beyond |= a != axis || (n[a] != 0 && n[a] != end);  // and not the side itself
        }
        if (beyond) return Kind::beyond;
        return axis < 3 && closed_(axis, offset(n)) ? Kind::closed : Kind::open;
    }

    /// Of boxes of size s in a row, the nearest of the body's spheres.
    struct Near {
        PackMask found;              ///< it is no farther from their middles than it could matter
        Pack distance, radius;       ///< to the surface, negative inside [m]
        std::array<Pack, 3> across;  ///< s times the surface's normal [m]
        Pack across2;                ///< its square [m2]
    };
    Near nearest(Pack x, Real y, Real z, const Vec3& s) const noexcept {
        const Real reach = std::max(0.6 * s.norm(), s.maxCoeff());
        Pack distance = reach, radius = 0, length = 0;
        std::array<Pack, 3> from{Pack(0), Pack(0), Pack(0)};
        for (const Sphere& sphere : body_->spheres) {
            const Real up = y - sphere.centre[1], over = z - sphere.centre[2];
            const Real grown = sphere.radius + grown_, beside = square(up) + square(over);
            if (!(beside < square(grown + reach))) continue;
            const Pack along = x - Pack(sphere.centre[0]), way = sqrt(along * along + Pack(beside));
            const PackMask nearer = way - Pack(grown) < distance;
            distance = select(nearer, way - Pack(grown), distance);
            radius = select(nearer, Pack(grown), radius), length = select(nearer, way, length);
            from[0] = select(nearer, along, from[0]);
            from[1] = select(nearer, Pack(up), from[1]), from[2] = select(nearer, Pack(over), from[2]);
        }
        const PackMask has_normal = length > Pack(0);
        const Pack per_length = Pack(1) / select(has_normal, length, Pack(1));
        Near near{radius > Pack(0), distance, radius, from, Pack(0)};
        for (int a = 0; a < 3; ++a) near.across[index(a)] *= Pack(s[a]) * per_length;
        near.across[2] = select(has_normal, near.across[2], Pack(s.z()));
        for (const Pack& part : near.across) near.across2 += part * part;
        return near;
    }
    /// Of boxes of size s, as if the surface were `retracted` [m].
    Pack share_of(const Near& near, const Vec3& s, Real retracted = 0) const noexcept {
        const Pack curved = (Pack(s.squaredNorm()) - near.across2) / (Pack(24) * near.radius);
        return select(
            near.found,
            Pack(scale_) * fraction_below<3>(near.across, -near.distance - Pack(retracted) - curved),
            Pack(0));
    }
    Pack friction_of(const Near& near) const noexcept {
        const Pack d = near.distance / sqrt(near.across2);
        const Pack within = Pack(scale_) * min(max(Pack(0.5) * (Pack(1) - d), Pack(0)), Pack(1));
        constexpr Real least = 1e-12;  // of two cells: less is none
        return select(near.found, within / (max(Pack(1) - within, Pack(least)) * near.across2), Pack(0));
    }

    void find_shares(int axis) {
        beyond_.clear();
        for_each_row([&](const Number& first, std::size_t row) {
            const Vec3 x = place(axis, first), s = extent(axis, first);
            for (std::size_t p = row * in_row_, q = 0; q < in_row_; ++q, ++p) {
                const Near near = nearest(x_[axis != 0][q], x[1], x[2], s);
                friction_[p] = core_[p] = Pack(0);
                if (!any(near.found)) continue;
                covered_[axis][row] = true;
                share_[axis][p] = share_of(near, s);
                if (axis == of_cells && interior_) continue;
                if (axis != of_cells) friction_[p] = friction_of(near);
                if (retracted_ > 0) core_[p] = share_of(near, s, retracted_ * std::cbrt(s.prod()));
                for (unsigned lanes = lanes_of(near.found); lanes != 0; lanes &= lanes - 1) {
                    const int lane = std::countr_zero(lanes);
                    Number n = first;
                    n[0] += static_cast<int>(q) * pack_lanes + lane;
                    const Kind kind = this->kind(axis, n);
                    if (kind == Kind::closed) clear(axis, {p, lane});
                    if (kind == Kind::beyond) beyond_.push_back({p, lane});
                }
            }
        });
        correct_shares(axis);
        for (const Place& place : beyond_) clear(axis, place);
    }

    void correct_shares(int axis) {
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        const Real per_unit = 1 / std::cbrt(body_->volume);  // or the equations are as uneven as metres
        // Calls visit(shares, their volume, arms along b and c).
        const auto for_each_pack = [&](auto&& visit) {
            for_each_row([&](const Number& first, std::size_t row) {
                if (!covered_[axis][row]) return;
                const Vec3 arm = (place(axis, first) - body_->position) * per_unit;
                const Real volume = extent(axis, first).prod();
                for (std::size_t q = 0; q < in_row_; ++q) {
                    const Pack along = (x_[axis != 0][q] - Pack(body_->position[0])) * Pack(per_unit);
                    visit(share_[axis][row * in_row_ + q], volume, b == 0 ? along : Pack(arm[b]),
                          c == 0 ? along : Pack(arm[c]));
                }
            });
        };
        // One, but where a floor takes so much that shares are at their bounds.
        constexpr int most_rounds = 4;
        constexpr Real sliver = 1e-2;  // of a face: less would be a nozzle
        for (int round = 0; round < most_rounds; ++round) {
            std::array<Pack, 3> covers;
            std::array<Pack, 6> moves;
            covers.fill(Pack(0)), moves.fill(Pack(0));
            for_each_pack([&](const Pack& share, Real volume, Pack at_b, Pack at_c) {
                const Pack all = share * Pack(volume);
                if (!any(all > Pack(0))) return;
                const Pack all_b = all * at_b, all_c = all * at_c, free = Pack(1) - share;
                covers[0] += all, covers[1] += all_b, covers[2] += all_c;
                moves[0] += free * all, moves[1] += free * all_b, moves[2] += free * all_c;
                moves[3] += free * all_b * at_b, moves[4] += free * all_b * at_c;
                moves[5] += free * all_c * at_c;
            });
            const Vec3 lacks(body_->volume - sum(covers[0]), -sum(covers[1]), -sum(covers[2]));
            if (lacks.norm() < 1e-14 * body_->volume) return;
            Mat3 matrix = 1e-12 * body_->volume * Mat3::Identity();
            for (const auto& [i, j, k] :
                 {std::array{0, 0, 0}, {1, 0, 1}, {2, 0, 2}, {1, 1, 3}, {2, 1, 4}, {2, 2, 5}})
                matrix(i, j) += sum(moves[index(k)]);
            const Vec3 by = matrix.ldlt().solve(lacks);  // which reads what is below the diagonal
            for_each_pack([&](Pack& share, Real, Pack at_b, Pack at_c) {
                const Pack more = Pack(by[0]) + Pack(by[1]) * at_b + Pack(by[2]) * at_c;
                share += share * (Pack(1) - share) * min(max(more, Pack(-1)), Pack(1));
                share = select(share > Pack(1 - sliver), Pack(1), share);
            });
        }
    }

    /// After `find_shares`.
    void list_faces(int axis, SolidCover& cover) const {
        const Layout<3>& l = grid.layout();
        for_each_covered(axis, [&](const Number& n, std::size_t p, int lane) {
            const Vec3 s = extent(axis, n);
            Number below = n;
            --below[axis];
            cover.faces.push_back(
                {.face = offset(n),
                 .low = offset(below),
                 .axis = axis,
                 .plane = std::min(wrapped(Layout<3>::outer, n[Layout<3>::outer]), l.planes() - 1),
                 .share = share_[axis][p][lane],
                 .core = (retracted_ > 0 ? core_[p] : share_[axis][p])[lane],
                 .friction = friction_[p][lane],
                 .area = s.prod() / s[axis],
                 .gap = s[axis],
                 .arm = place(axis, n) - body_->position});
        });
    }

    void list_cells(SolidCover& cover) const {
        for_each_row([&](Number n, std::size_t row) {
            const PerAxis<std::size_t, 3> up{row, row + 1, row + index(length_[1])};
            for (int a = 1; a < 3; ++a)
                if (n[a] == first_[a] + length_[a] - 1) return;
            bool some = false;
            for (int a = 0; a < 3; ++a) some |= covered_[a][row] || covered_[a][up[a]];
            if (!some) return;
            const Vec3 s = extent(of_cells, n), area = s.prod() * s.cwiseInverse();
            for (int i = 0; i < length_[0] - 1; ++i, ++n[0]) {
                Vec3 low, high;
                for (int a = 0; a < 3; ++a)
                    low[a] = share_at(a, row, i), high[a] = share_at(a, up[a], i + (a == 0));
                if (low.isZero(0) && high.isZero(0)) continue;
                if (!interior_ && !grid.has(inside_box(n))) continue;
                const Vec3 way = area.cwiseProduct(high - low), arm = place(of_cells, n) - body_->position;
                cover.cells.push_back({offset(n), way, arm.cross(way), arm});
            }
        });
    }
    void clear(int axis, const Place& at) noexcept {
        share_[axis][at.pack].set(at.lane, 0), friction_[at.pack].set(at.lane, 0);
    }
    Real share_at(int axis, std::size_t row, int i) const noexcept {
        return share_[axis][row * in_row_ + index(i / pack_lanes)][i % pack_lanes];
    }

    Closed closed_;
    Real retracted_;
    const FlowBody* body_ = nullptr;
    Real grown_ = 0, scale_ = 1;  ///< of a small body's spheres [m], of its shares [-]
    bool interior_ = true;        ///< the box of cells has no side of the grid near by
    Number first_{}, length_{};
    std::size_t in_row_ = 0;  ///< packs
    PerAxis<std::vector<Line>, 3> lines_;
    std::array<Packs, 2> x_;                 ///< of faces across x, of centres [m]
    PerAxis<Packs, 4> share_;                ///< of the faces across each axis, of cells
    Packs friction_, core_;                  ///< of those looked at last
    PerAxis<std::vector<char>, 4> covered_;  ///< [row]
    std::vector<Place> beyond_;
};

}  // namespace detail

/// The parts of the faces of `grid` that `body` covers; `closed(axis, face)`: faces that walls close.
template <class Closed>
SolidCover cover_of(const Grid<3>& grid, const BoundaryConditions<3>& boundaries, const FlowBody& body,
                    Closed closed) {
    SolidCover cover;
    detail::SolidCoverFinder<Closed>({grid, boundaries}, std::move(closed)).find(body, cover);
    return cover;
}

}  // namespace abrade
