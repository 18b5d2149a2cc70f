#pragma once
// A convex polyhedron whose corners and edges are rounded with one radius.

#include <abrade/core/require.hpp>
#include <abrade/geometry/sphere_filling.hpp>
#include <abrade/geometry/surface_mesh.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace abrade {

/// All points within `radius` of a convex polyhedron, the core: corners and edges are then rounded with
/// exactly that radius. The core is the image of a polyhedron with the corners `shape` under a linear map, so
/// its proportions can change while its faces keep their corners.
class RoundedPolyhedron {
public:
    /// The core is the convex hull of `shape`, whose points must all be corners of it, no four of them in
    /// one face. Throws InputError when they do not span a solid.
    explicit RoundedPolyhedron(std::vector<Vec3> shape) : shape_{std::move(shape)} {
        const std::size_t n = shape_.size();
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = i + 1; j < n; ++j)
                for (std::size_t k = j + 1; k < n; ++k) add_if_face({i, j, k});
        require(faces_.size() == 2 * n - 4 && n >= 4,
                {"RoundedPolyhedron.shape", "corners of a convex solid, with 2 n - 4 faces", "faces",
                 "leave out points within, and move one where four lie in a face"},
                static_cast<Real>(faces_.size()));
        set(Mat3::Identity(), 0);
    }

    /// Gives the core the corners `map` * shape, and the rounding its radius [m]. The map must not mirror.
    void set(const Mat3& map, Real radius) {
        map_ = map;
        radius_ = radius;
        corners_.clear();
        for (const Vec3& corner : shape_) corners_.push_back(map * corner);
        planes_.clear();
        for (const auto& [a, b, c] : faces_) {
            const Vec3 normal = (corners_[b] - corners_[a]).cross(corners_[c] - corners_[a]).normalized();
            planes_.push_back({normal, normal.dot(corners_[a])});
        }
    }

    const Mat3& map() const { return map_; }
    Real radius() const { return radius_; }
    const std::vector<Vec3>& shape() const { return shape_; }
    const std::vector<Vec3>& corners() const { return corners_; }  ///< of the core [m]

    /// Distance from a point of the core to the surface of the rounded solid [m].
    Real depth(const Vec3& x) const noexcept { return radius_ + std::max(0.0, core_depth(x)); }

    bool in_core(const Vec3& x) const noexcept { return core_depth(x) >= 0; }

    /// The largest inscribed sphere. It touches at least four faces, so among the points that are equally far
    /// from four of them its centre is the one farthest in.
    Sphere largest_inscribed() const {
        const std::size_t n = planes_.size();
        Real best = -std::numeric_limits<Real>::infinity(), extent = 0;
        for (const Vec3& c : corners_) extent = std::max(extent, c.norm());
        Vec3 centre = Vec3::Zero();
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = i + 1; j < n; ++j)
                for (std::size_t k = j + 1; k < n; ++k) {
                    const Vec3 mj = planes_[j].normal - planes_[i].normal,
                               mk = planes_[k].normal - planes_[i].normal, jk = mj.cross(mk);
                    for (std::size_t l = k + 1; l < n; ++l) {
                        const Vec3 ml = planes_[l].normal - planes_[i].normal;
                        const Real determinant = ml.dot(jk);
                        if (determinant == 0) continue;
                        const Vec3 x = ((planes_[j].offset - planes_[i].offset) * mk.cross(ml) +
                                        (planes_[k].offset - planes_[i].offset) * ml.cross(mj) +
                                        (planes_[l].offset - planes_[i].offset) * jk) /
                                       determinant;
                        const Real t = planes_[i].offset - planes_[i].normal.dot(x);
                        if (t > best && core_depth(x) >= t - 1e-12 * extent) best = t, centre = x;
                    }
                }
        return {centre, depth(centre)};
    }

    /// Points of the surface with their normals: over faces, edges and corners.
    std::vector<detail::SurfaceSample> samples(int parts) const {
        std::vector<detail::SurfaceSample> result;
        std::vector<Vec3> at_corner(corners_.size(), Vec3::Zero());
        for (std::size_t f = 0; f < faces_.size(); ++f) {
            const Vec3& normal = planes_[f].normal;
            detail::each_part(corners_[faces_[f][0]], corners_[faces_[f][1]], corners_[faces_[f][2]], parts,
                              [&](const Vec3& point) {
                                  result.push_back({point + radius_ * normal, normal});
                              });
            for (const std::size_t c : faces_[f]) at_corner[c] += normal;
            for (std::size_t g = f + 1; g < faces_.size(); ++g) add_edge(result, f, g, parts);
        }
        for (std::size_t c = 0; c < corners_.size(); ++c)
            if (at_corner[c].norm() > 1e-9) {
                const Vec3 normal = at_corner[c].normalized();
                const Real share = 4 * pi / static_cast<Real>(corners_.size());  // of the sphere, on average
                result.push_back({corners_[c] + radius_ * normal, normal, share * square(radius_)});
            }
        return result;
    }

private:
    struct Plane {
        Vec3 normal;  ///< out of the core
        Real offset;  ///< from the origin [m]
    };

    Real core_depth(const Vec3& x) const noexcept {
        Real least = std::numeric_limits<Real>::infinity();
        for (const Plane& p : planes_) least = std::min(least, p.offset - p.normal.dot(x));
        return least;
    }

    /// Three corners make a face when all others lie on one side of their plane.
    void add_if_face(Triangle t) {
        const Vec3& a = shape_[t[0]];
        const Vec3 normal = (shape_[t[1]] - a).cross(shape_[t[2]] - a);
        int above = 0, below = 0;
        for (std::size_t n = 0; n < shape_.size(); ++n) {
            if (n == t[0] || n == t[1] || n == t[2]) continue;
            normal.dot(shape_[n] - a) > 0 ? ++above : ++below;
        }
        if (above > 0 && below > 0) return;
        if (above > 0) std::swap(t[1], t[2]);
        faces_.push_back(t);
    }

    /// Samples along the edge of two faces, where they have one, turned from one normal to the other.
    void add_edge(std::vector<detail::SurfaceSample>& result, std::size_t f, std::size_t g, int parts) const {
        std::vector<std::size_t> shared;
        for (const std::size_t c : faces_[f])
            if (std::find(faces_[g].begin(), faces_[g].end(), c) != faces_[g].end()) shared.push_back(c);
        const Vec3 across = planes_[f].normal + planes_[g].normal;
        if (shared.size() != 2 || across.norm() < 1e-9) return;
        const Vec3 middle = across.normalized();
        const std::array<Vec3, 3> normals{(planes_[f].normal + middle).normalized(), middle,
                                          (planes_[g].normal + middle).normalized()};
        const Real turn = std::acos(std::clamp(planes_[f].normal.dot(planes_[g].normal), -1.0, 1.0));
        const Real length = (corners_[shared[1]] - corners_[shared[0]]).norm();
        const Real area = length / (2 * parts) * radius_ * turn / 3;
        for (int k = 0; k < 2 * parts; ++k) {
            const Real share = (k + 0.5) / (2 * parts);
            const Vec3 point = (1 - share) * corners_[shared[0]] + share * corners_[shared[1]];
            for (const Vec3& normal : normals) result.push_back({point + radius_ * normal, normal, area});
        }
    }

    std::vector<Vec3> shape_;
    std::vector<Triangle> faces_{};
    Mat3 map_ = Mat3::Identity();
    Real radius_ = 0;
    std::vector<Vec3> corners_{};
    std::vector<Plane> planes_{};
};

}  // namespace abrade
