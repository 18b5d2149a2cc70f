#pragma once
// How far a point is from a surface, and on which side.

#include <abrade/geometry/surface_mesh.hpp>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace abrade {

/// The point of the triangle a b c that is nearest to x: that of its plane, or of an edge.
inline Vec3 nearest_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, normal = ab.cross(ac);
    // Barycentric coordinates of the foot of the perpendicular.
    const Real n2 = normal.squaredNorm();
    const Real u = (x - a).cross(ac).dot(normal) / n2, v = ab.cross(x - a).dot(normal) / n2;
    if (u >= 0 && v >= 0 && u + v <= 1) return a + u * ab + v * ac;
    Vec3 nearest = a;
    Real least = std::numeric_limits<Real>::infinity();
    for (const auto& [from, to] : {std::pair{&a, &b}, std::pair{&b, &c}, std::pair{&c, &a}}) {
        const Vec3 along = *to - *from;
        const Vec3 p = *from + std::clamp((x - *from).dot(along) / along.squaredNorm(), 0.0, 1.0) * along;
        if ((x - p).squaredNorm() < least) least = (x - p).squaredNorm(), nearest = p;
    }
    return nearest;
}

/// Distances from a surface. Every triangle is asked, but passed over where the ball around it is farther
/// than the nearest found so far: some 10 ns a triangle, no tree to build.
class MeshDistance {
public:
    explicit MeshDistance(const SurfaceMesh& mesh) : mesh_{&mesh} {
        for (std::size_t t = 0; t < mesh.triangles().size(); ++t) {
            const Vec3 middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
            Real radius = 0;
            for (std::size_t k = 0; k < 3; ++k)
                radius = std::max(radius, (mesh.corner(t, k) - middle).norm());
            balls_.push_back({middle, radius});
        }
    }
    explicit MeshDistance(SurfaceMesh&&) = delete;  // the mesh must outlive this

    /// Distance from x to the nearest point of the surface, >= 0 [m].
    Real to_surface(const Vec3& x) const noexcept {
        Real least = std::numeric_limits<Real>::infinity();
        for (std::size_t t = 0; t < balls_.size(); ++t) {
            const Real within = least + balls_[t].radius;
            if ((x - balls_[t].centre).squaredNorm() > within * within) continue;
            const Vec3 p =
                nearest_on_triangle(x, mesh_->corner(t, 0), mesh_->corner(t, 1), mesh_->corner(t, 2));
            least = std::min(least, (x - p).norm());
        }
        return least;
    }

    /// How many times the surface winds around x: 1 inside, 0 outside; the sum of the solid angles of its
    /// triangles over 4 pi, tan(Omega / 2) = a . (b x c) / (|a||b||c| + a . b |c| + b . c |a| + c . a |b|)
    /// (Van Oosterom and Strackee 1983, doi:10.1109/TBME.1983.325207).
    Real winding_number(const Vec3& x) const noexcept {
        Real sum = 0;
        for (std::size_t t = 0; t < balls_.size(); ++t) {
            const Vec3 a = mesh_->corner(t, 0) - x, b = mesh_->corner(t, 1) - x, c = mesh_->corner(t, 2) - x;
            const Real la = a.norm(), lb = b.norm(), lc = c.norm();
            sum +=
                std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
        }
        return sum / (2 * pi);
    }
    bool inside(const Vec3& x) const noexcept { return winding_number(x) > 0.5; }

    /// Distance from the surface, > 0 inside [m].
    Real depth(const Vec3& x) const noexcept { return inside(x) ? to_surface(x) : -to_surface(x); }

    const SurfaceMesh& mesh() const { return *mesh_; }

private:
    const SurfaceMesh* mesh_;
    std::vector<Sphere> balls_{};  ///< [triangle] a ball that holds it
};

}  // namespace abrade
