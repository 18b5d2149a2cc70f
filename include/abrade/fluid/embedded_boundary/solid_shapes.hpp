#pragma once
// Solids that stand in the water: ball, box, cylinder, any closed mesh, and what is cut out of them.

#include <abrade/fluid/embedded_boundary/shapes.hpp>
#include <abrade/geometry/mesh_distance.hpp>

#include <memory>
#include <string>
#include <utility>

namespace abrade {

/// A solid ball; in two dimensions a disc, the section of a round pier.
///   w = |x - centre| - radius [m], the distance itself.
template <int Dim>
class BallWall {
public:
    /// Throws InputError for a centre that is not finite or a radius that is not > 0.
    BallWall(const Point<Dim>& centre, Real radius) : centre_(centre), radius_(radius) {
        for (int a = 0; a < Dim; ++a)
            require_finite(centre[a], std::string("BallWall.centre.") + Grid<Dim>::axis_name(a), "m");
        require_positive(radius, "BallWall.radius", "m");
    }
    Real operator()(const Point<Dim>& x) const noexcept { return (x - centre_).norm() - radius_; }

private:
    Point<Dim> centre_;
    Real radius_;
};

/// A solid box between two corners, along the axes. With d = |x - middle| - half of its size:
///   w = |max(d, 0)| + min(largest component of d, 0) [m], the distance itself.
/// Edges between grid planes are cut off within their cell.
template <int Dim>
class BoxWall {
public:
    /// Throws InputError for a corner that is not finite, or one of `high` that is not above that of `low`.
    BoxWall(const Point<Dim>& low, const Point<Dim>& high)
        : middle_(0.5 * (low + high)), half_(0.5 * (high - low)) {
        for (int a = 0; a < Dim; ++a) {
            const std::string axis(1, Grid<Dim>::axis_name(a));
            require_finite(low[a], "BoxWall.low." + axis, "m");
            require(high[a] > low[a] && std::isfinite(high[a]),
                    {"BoxWall.high." + axis, "finite and above low (" + to_text(low[a]) + " m)", "m",
                     "give the lower corner, then the upper one"},
                    high[a]);
        }
    }
    Real operator()(const Point<Dim>& x) const noexcept {
        const Point<Dim> d = (x - middle_).cwiseAbs() - half_;
        return d.cwiseMax(0.0).norm() + std::min(d.maxCoeff(), Real(0));
    }

private:
    Point<Dim> middle_, half_;
};

/// A solid, round cylinder between the middles of its ends. With r the distance from its axis less the
/// radius and s that beyond its nearer end, below 0 between the ends:
///   w = |max((r, s), 0)| + min(max(r, s), 0) [m], the distance itself.
class CylinderWall {
public:
    /// Throws InputError for an end that is not finite, ends that coincide, or a radius that is not > 0.
    CylinderWall(const Vec3& base, const Vec3& top, Real radius)
        : middle_(0.5 * (base + top)), axis_((top - base).normalized()), half_(0.5 * (top - base).norm()),
          radius_(radius) {
        require_finite(base, "CylinderWall.base", "m");
        require_finite(top, "CylinderWall.top", "m");
        require_positive(half_, "CylinderWall: half of its length", "m", "give the middles of both ends");
        require_positive(radius, "CylinderWall.radius", "m");
    }
    Real operator()(const Vec3& x) const noexcept {
        const Vec3 from = x - middle_;
        const Real along = from.dot(axis_);
        const Real r = (from - along * axis_).norm() - radius_, s = std::abs(along) - half_;
        return std::hypot(std::max(r, Real(0)), std::max(s, Real(0))) + std::min(std::max(r, s), Real(0));
    }

private:
    Vec3 middle_, axis_;
    Real half_, radius_;
};

/// The solid inside a closed mesh, from an STL file for instance (io/stl_file.hpp):
///   w = distance from its nearest triangle, below 0 where its triangles wind around x [m], the distance
/// itself. Each question asks every triangle; 15 to 40 ns a triangle, so thousands of them make a
/// large grid slow to build. Copies share the mesh.
class MeshWall {
public:
    explicit MeshWall(SurfaceMesh mesh)
        : mesh_(std::make_shared<const SurfaceMesh>(std::move(mesh))), distance_(*mesh_) {}
    Real operator()(const Vec3& x) const noexcept { return -distance_.depth(x); }
    const SurfaceMesh& mesh() const noexcept { return *mesh_; }

private:
    std::shared_ptr<const SurfaceMesh> mesh_;
    MeshDistance distance_;
};

/// The water is inside: a ball becomes a tank, a cylinder a pipe.
template <class Shape>
class InsideOut {
public:
    explicit InsideOut(Shape shape) : shape_(std::move(shape)) {}
    template <int Dim>
    requires(WallShape<Shape, Dim>) Real operator()(const Eigen::Matrix<Real, Dim, 1>& x) const {
        return -static_cast<Real>(shape_(x));
    }

private:
    Shape shape_;
};

/// Solid is what is solid in all of them (WallUnion: in any). The solid of `a` without that of `b` is
/// `WallIntersection(a, InsideOut(b))`. Near edges where they meet the distance is too short.
template <class... Shapes>
class WallIntersection {
public:
    explicit WallIntersection(Shapes... shapes) : shapes_(std::move(shapes)...) {}
    template <int Dim>
    requires(WallShape<Shapes, Dim>&&...) Real operator()(const Eigen::Matrix<Real, Dim, 1>& x) const {
        Real most = -std::numeric_limits<Real>::infinity();
        // NaN where any is NaN: an error must not hide behind another wall.
        const auto take = [&](Real d) { most = d > most || std::isnan(d) ? d : most; };
        std::apply([&](const auto&... shape) { (take(static_cast<Real>(shape(x))), ...); }, shapes_);
        return most;
    }

private:
    std::tuple<Shapes...> shapes_;
};

static_assert(WallShape<BallWall<2>, 2> && WallShape<BallWall<3>, 3>);
static_assert(WallShape<BoxWall<2>, 2> && WallShape<BoxWall<3>, 3>);
static_assert(WallShape<CylinderWall, 3>);
static_assert(WallShape<MeshWall, 3>);
static_assert(WallShape<InsideOut<BoxWall<3>>, 3>);
static_assert(WallShape<WallIntersection<CylinderWall, MeshWall>, 3>);
static_assert(!WallShape<WallIntersection<CylinderWall, Sphere>, 3> && !WallShape<InsideOut<Sphere>, 3>);

}  // namespace abrade
