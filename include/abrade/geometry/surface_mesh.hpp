#pragma once
// A closed surface of triangles: the skin of a solid, with its volume, centroid and inertia.

#include <abrade/core/require.hpp>
#include <abrade/geometry/solid_moments.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace abrade {

/// Three vertices, anticlockwise seen from outside.
using Triangle = std::array<std::size_t, 3>;

namespace detail {

/// Integrals over the tetrahedra between the origin and each triangle (a, b, c), with the sign of their
/// orientation, so that what lies outside cancels. With D = a . (b x c):
///   V = sum D / 6,   int x dV = sum D / 24 (a + b + c),
///   int x x^T dV = sum D / 120 (a a^T + b b^T + c c^T + (a + b + c)(a + b + c)^T).
/// Exact for any closed surface; e.g. Tonon 2004, doi:10.3844/jmssp.2005.8.11.
inline RawMoments tetrahedra_moments(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
    RawMoments sum;
    for (const Triangle& t : triangles) {
        const Vec3 &a = vertices[t[0]], &b = vertices[t[1]], &c = vertices[t[2]];
        const Real d = a.dot(b.cross(c));
        const Vec3 abc = a + b + c;
        sum.volume += d / 6;
        sum.first += d / 24 * abc;
        sum.second +=
            d / 120 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + abc * abc.transpose());
    }
    return sum;
}

}  // namespace detail

/// A checked, closed surface. Triangles may be given in either sense: each piece is turned to one sense, and
/// all are turned over when the surface is inside-out. A piece within another keeps its sense against it, so
/// a cavity stays one when its triangles look into it. That a surface does not cross itself is not checked.
class SurfaceMesh {
public:
    /// Throws InputError when there is no triangle, a vertex that is not finite, a triangle without area or
    /// with a vertex that does not exist, an edge that does not have exactly two triangles, a piece that has
    /// no two sides, or no volume.
    SurfaceMesh(std::vector<Vec3> vertices, std::vector<Triangle> triangles)
        : vertices_{std::move(vertices)}, triangles_{std::move(triangles)} {
        check_triangles();
        orient();
        find_moments();
    }

    const std::vector<Vec3>& vertices() const { return vertices_; }        ///< [m]
    const std::vector<Triangle>& triangles() const { return triangles_; }  ///< anticlockwise from outside
    const SolidMoments& moments() const { return moments_; }               ///< of the solid, unit density
    Real area() const { return area_; }                                    ///< [m2]
    const Vec3& low() const { return low_; }                               ///< corner of the bounding box [m]
    const Vec3& high() const { return high_; }                             ///< [m]

    const Vec3& corner(std::size_t triangle, std::size_t k) const {
        return vertices_[triangles_[triangle][k]];
    }
    /// Twice the area of a triangle times its normal, which points out of the solid [m2].
    Vec3 doubled_area(std::size_t triangle) const {
        const Vec3& a = corner(triangle, 0);
        return (corner(triangle, 1) - a).cross(corner(triangle, 2) - a);
    }
    Vec3 normal(std::size_t triangle) const { return doubled_area(triangle).normalized(); }

private:
    static constexpr std::string_view not_closed_ =
        "each edge belongs to two triangles: close holes, and give a vertex shared by triangles as the same "
        "numbers in each (or allow a merge_distance)";

    void check_triangles() {
        require(!triangles_.empty(),
                {"SurfaceMesh.triangles", "at least 4", "triangles", "is the surface empty?"}, 0);
        low_ = high_ = vertices_.empty() ? Vec3(Vec3::Zero()) : vertices_[0];
        for (std::size_t n = 0; n < vertices_.size(); ++n) {
            const Vec3& v = vertices_[n];
            if (!v.allFinite()) require_finite(v, "SurfaceMesh.vertices[" + std::to_string(n) + "]", "m");
            low_ = low_.cwiseMin(v);
            high_ = high_.cwiseMax(v);
        }
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            for (const std::size_t v : triangles_[t])
                require(
                    v < vertices_.size(),
                    {"SurfaceMesh.triangles[" + std::to_string(t) + "]",
                     "made of vertices below " + std::to_string(vertices_.size()), "", "they count from 0"},
                    static_cast<Real>(v));
            const Vec3 ab = corner(t, 1) - corner(t, 0), ac = corner(t, 2) - corner(t, 0);
            const Real height_share =
                ab.cross(ac).norm() / std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
            // Below this the cross product is round-off, and so would be the normal.
            require(height_share > 1e-12,
                    {"SurfaceMesh.triangles[" + std::to_string(t) + "]",
                     "a triangle with area (height over longest edge > 1e-12)",
                     {},
                     "remove degenerate triangles"},
                    height_share);
        }
    }

    /// A triangle beside an edge, and whether it runs along it from the smaller vertex to the larger.
    struct Side {
        std::size_t triangle;
        bool rising;
    };
    using Edges = std::map<std::pair<std::size_t, std::size_t>, std::vector<Side>>;
    static std::pair<std::size_t, std::size_t> edge(const Triangle& t, std::size_t k) {
        return std::minmax(t[k], t[(k + 1) % 3]);
    }

    /// One sense for each piece: that of its first triangle, where all agree; else the one with volume > 0.
    void orient() {
        Edges edges;
        for (std::size_t t = 0; t < triangles_.size(); ++t)
            for (std::size_t k = 0; k < 3; ++k)
                edges[edge(triangles_[t], k)].push_back({t, triangles_[t][k] < triangles_[t][(k + 1) % 3]});
        std::size_t broken = 0;
        const std::pair<const std::pair<std::size_t, std::size_t>, std::vector<Side>>* first = nullptr;
        for (const auto& item : edges)
            if (item.second.size() != 2 && ++broken == 1) first = &item;
        if (broken > 0) {
            const Vec3& a = vertices_[first->first.first];
            fail({"SurfaceMesh", "closed and manifold", {}, not_closed_},
                 std::to_string(broken) + " edges that do not, the first with " +
                     std::to_string(first->second.size()) + " at (" + short_text(a.x()) + ", " +
                     short_text(a.y()) + ", " + short_text(a.z()) + ") m");
        }
        std::vector<char> state(triangles_.size(), 0);  // 0: not seen, 1: keeps its sense, 2: turned over
        for (std::size_t start = 0; start < triangles_.size(); ++start) {
            if (state[start] != 0) continue;
            std::vector<std::size_t> piece{start};
            state[start] = 1;
            bool turned = false;
            for (std::size_t n = 0; n < piece.size(); ++n) {
                const std::size_t t = piece[n];
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::vector<Side>& sides = edges.at(edge(triangles_[t], k));
                    const std::size_t other = sides[sides[0].triangle == t ? 1 : 0].triangle;
                    // Neighbours of one sense run along their edge in opposite directions.
                    const bool same_sense = sides[0].rising != sides[1].rising;
                    const char wanted = same_sense ? state[t] : static_cast<char>(3 - state[t]);
                    if (state[other] == 0) {
                        state[other] = wanted;
                        turned = turned || wanted == 2;
                        piece.push_back(other);
                    } else if (state[other] != wanted) {
                        fail({"SurfaceMesh", "orientable", {}, "a solid has an outside and an inside"},
                             "a surface with one side");
                    }
                }
            }
            if (turned) turn_over(piece, state);
        }
    }

    void turn_over(const std::vector<std::size_t>& piece, const std::vector<char>& state) {
        std::vector<Triangle> own;
        for (const std::size_t t : piece) {
            if (state[t] == 2) std::swap(triangles_[t][1], triangles_[t][2]);
            own.push_back(triangles_[t]);
        }
        if (detail::tetrahedra_moments(vertices_, own).volume < 0)
            for (const std::size_t t : piece) std::swap(triangles_[t][1], triangles_[t][2]);
    }

    void find_moments() {
        // About the middle of the box: the tetrahedra are then no larger than the solid.
        const Vec3 middle = 0.5 * (low_ + high_);
        std::vector<Vec3> near = vertices_;
        for (Vec3& v : near) v -= middle;
        detail::RawMoments raw = detail::tetrahedra_moments(near, triangles_);
        if (raw.volume < 0) {
            for (Triangle& t : triangles_) std::swap(t[1], t[2]);
            raw = {-raw.volume, -raw.first, -raw.second};
        }
        for (std::size_t t = 0; t < triangles_.size(); ++t) area_ += 0.5 * doubled_area(t).norm();
        // A sphere has V = sqrt(A^3 / 36 pi); 1e-12 of that is the round-off of a flat surface.
        require(raw.volume > 1e-12 * std::sqrt(cube(area_) / (36 * pi)),
                {"SurfaceMesh.volume", "> 0", "m3", "a solid has thickness"}, raw.volume);
        moments_ = raw.about_centroid();
        moments_.centroid += middle;
    }

    std::vector<Vec3> vertices_;
    std::vector<Triangle> triangles_;
    SolidMoments moments_{};
    Vec3 low_ = Vec3::Zero(), high_ = Vec3::Zero();
    Real area_ = 0;
};

namespace detail {

/// Numbers points so that those within `distance` of an earlier one get its number; 0: equal ones only.
class PointNumbers {
public:
    PointNumbers(Real distance, Real smallest_cell)
        : distance_{distance}, cell_{std::max(distance, smallest_cell)} {}

    std::size_t number(const Vec3& point) {
        const auto key = [&](const Vec3& x) {
            return std::array{std::floor(x.x() / cell_), std::floor(x.y() / cell_),
                              std::floor(x.z() / cell_)};
        };
        const auto middle = key(point);
        for (const Real dx : {0.0, -1.0, 1.0})
            for (const Real dy : {0.0, -1.0, 1.0})
                for (const Real dz : {0.0, -1.0, 1.0}) {
                    const auto cell = cells_.find({middle[0] + dx, middle[1] + dy, middle[2] + dz});
                    if (cell == cells_.end()) continue;
                    for (const std::size_t n : cell->second)
                        if ((points_[n] - point).norm() <= distance_) return n;
                }
        cells_[middle].push_back(points_.size());
        points_.push_back(point);
        return points_.size() - 1;
    }
    std::vector<Vec3> take() { return std::move(points_); }

private:
    Real distance_, cell_;
    std::vector<Vec3> points_{};
    std::map<std::array<Real, 3>, std::vector<std::size_t>> cells_{};
};

}  // namespace detail

/// The surface of loose triangles, as an STL file has them. Vertices within `merge_distance` [m] of one
/// another become one; with 0 they must be equal. Triangles that this leaves without three different
/// vertices are dropped. Throws InputError as the constructor of SurfaceMesh does, and when merge_distance
/// is not >= 0.
inline SurfaceMesh mesh_of_triangles(std::span<const std::array<Vec3, 3>> loose, Real merge_distance = 0) {
    require_not_negative(merge_distance, "mesh_of_triangles.merge_distance", "m",
                         "0 merges equal vertices only");
    Real extent = 0;
    for (std::size_t t = 0; t < loose.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& v = loose[t][k];
            if (!v.allFinite())
                require_finite(
                    v, "SurfaceMesh.triangles[" + std::to_string(t) + "].corners[" + std::to_string(k) + "]",
                    "m", "mend the surface where it was made");
            extent = std::max(extent, v.cwiseAbs().maxCoeff());
        }
    detail::PointNumbers numbers(merge_distance, 1e-6 * extent);
    std::vector<Triangle> triangles;
    for (const auto& [a, b, c] : loose) {
        const Triangle t{numbers.number(a), numbers.number(b), numbers.number(c)};
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
    }
    return {numbers.take(), std::move(triangles)};
}

}  // namespace abrade
