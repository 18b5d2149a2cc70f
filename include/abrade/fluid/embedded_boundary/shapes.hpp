#pragma once
// Solid walls by their distance: planes, the invert, packings of spheres, and what is made of them.

#include <abrade/fluid/mesh/grid.hpp>
#include <abrade/geometry/invert.hpp>
#include <abrade/geometry/lattice.hpp>
#include <abrade/geometry/point_grid.hpp>
#include <abrade/geometry/solid_moments.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <functional>
#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace abrade {

/// A wall: w(x) is the distance of x from its surface [m], above 0 in the water, below 0 in the solid. Any
/// function that is 0 at the surface will do; where it never changes by more than the way between two
/// points, as distances do, cells far from the wall cost nothing (EmbeddedBoundary::Params::bounded_slope).
/// Steeper ones are found out where their answers show it; one that levels off near the wall may hide what is
/// smaller than four cells. Called from many threads; `nearby`, where it has one, must not throw.
// clang-format off
template <class W, int Dim>
concept WallShape = requires(const W& wall, const Point<Dim>& x) {
    { wall(x) } -> std::convertible_to<Real>;
};
// clang-format on

/// Solid behind a plane; `normal` points into the water.
template <int Dim>
class PlaneWall {
public:
    PlaneWall(const Point<Dim>& point, const Point<Dim>& normal)
        : normal_(normal.normalized()), height_(normal_.dot(point)) {
        for (int a = 0; a < Dim; ++a)
            require_finite(point[a], std::string("PlaneWall.point.") + Grid<Dim>::axis_name(a), "m");
        require_positive(normal.norm(), "PlaneWall.normal: length", "", "let it point into the water");
    }
    Real operator()(const Point<Dim>& x) const noexcept { return normal_.dot(x) - height_; }

private:
    Point<Dim> normal_;
    Real height_;
};

/// Bed and walls of an invert, in its own coordinates (x along, y across, z normal to it at the centre
/// line). In two dimensions a point is (y, z): the cross-section.
///
/// Water is where both |y| < width/2 and the distance from the line z >= R above the arc's centre is below
/// R; the smaller of the two distances is exact in the water, and never too large outside.
class InvertWall {
public:
    explicit InvertWall(const Invert& invert) : half_width_(0.5 * invert.width), radius_(invert.arc_radius) {
        invert.validate();
    }
    Real operator()(const Point<2>& x) const noexcept { return distance(x[0], x[1]); }
    Real operator()(const Point<3>& x) const noexcept { return distance(x[1], x[2]); }

private:
    Real distance(Real y, Real z) const noexcept {
        return std::min(half_width_ - std::abs(y),
                        radius_ - std::sqrt(square(y) + square(std::min(z - radius_, 0.0))));
    }
    Real half_width_, radius_;
};

/// Solid spheres, as concrete is made of: the distance from the nearest. In two dimensions a point is
/// (x, z): a section along y = 0. Inside the solid it is the depth in one sphere, not in their union; in
/// the water it is cut short at a reach, which must not be below a cell's diagonal: walls are found by
/// interpolating it.
///
/// Spheres can be worn or taken out; EmbeddedBoundary::update then renews the cells about them.
class SpherePacking {
public:
    /// `reach` [m]; 0: two of the largest radii. Throws InputError for a centre that is not finite or a
    /// radius that is not > 0.
    explicit SpherePacking(std::span<const Sphere> spheres, Real reach = 0) {
        for (std::size_t n = 0; n < spheres.size(); ++n) {
            const auto& [centre, radius] = spheres[n];
            if (!centre.allFinite() || !(radius > 0) || !std::isfinite(radius)) {
                const std::string name = "SpherePacking.spheres[" + std::to_string(n) + "]";
                require_finite(centre, name + ".centre", "m");
                require_positive(radius, name + ".radius", "m");
            }
            centres_.push_back(centre), radii_.push_back(radius);
            largest_ = std::max(largest_, radius);
        }
        build(reach);
    }
    explicit SpherePacking(const Lattice& lattice, Real reach = 0) : largest_(lattice.radius) {
        require_positive(lattice.radius, "Lattice.radius", "m");
        for (const LatticeSite& site : lattice.sites) {
            require_finite(site.centre, "Lattice.sites.centre", "m");
            centres_.push_back(site.centre), radii_.push_back(lattice.radius);
        }
        build(reach);
    }

    std::size_t size() const noexcept { return centres_.size(); }
    Sphere sphere(std::size_t n) const { return {centres_[n], radii_[n]}; }
    /// Wears sphere n down to a radius, which must not grow beyond the largest of the packing.
    void set_radius(std::size_t n, Real radius) {
        require(radius > 0 && radius <= largest_,
                {"SpherePacking.set_radius", "above 0 and at most the largest (" + to_text(largest_) + " m)",
                 "m", "use remove() for spheres that are gone"},
                radius);
        radii_[n] = radius;
    }
    void remove(std::size_t n) noexcept { radii_[n] = -std::numeric_limits<Real>::infinity(); }

    Real operator()(const Point<2>& x) const noexcept { return (*this)(in_space(x)); }
    /// Beyond the reach: no more than the distance from the box about all of them, which costs no search.
    Real operator()(const Vec3& x) const noexcept {
        const Real beyond = (low_ - x).cwiseMax(x - high_).cwiseMax(0.0).norm();
        Real nearest = std::max(reach_, beyond);
        if (beyond < reach_)
            grid_.each_about(x, reach_ + largest_, [&](Index i) {
                const auto n = static_cast<std::size_t>(i);
                nearest = nearer(nearest, x, centres_[n], radii_[n]);
            });
        return nearest;
    }

    /// The same within `radius` of a place, from the few spheres that can be nearest there.
    class Few {
    public:
        Real operator()(const Point<2>& x) const noexcept { return (*this)(in_space(x)); }
        Real operator()(const Vec3& x) const noexcept {
            Real nearest = all_->reach_;
            for (std::size_t n = 0; n < count_; ++n)
                nearest = nearer(nearest, x, spheres_[n].centre, spheres_[n].radius);
            return too_many_ || nearest >= all_->reach_ ? (*all_)(x) : nearest;
        }

    private:
        friend SpherePacking;
        const SpherePacking* all_;
        bool too_many_ = false;
        std::size_t count_ = 0;
        std::array<Sphere, 32> spheres_;

        explicit Few(const SpherePacking* all) : all_(all) {}
    };
    Few nearby(const Point<2>& x, Real radius) const noexcept { return nearby(in_space(x), radius); }
    Few nearby(const Vec3& x, Real radius) const noexcept {
        Few few(this);
        const Real furthest = (*this)(x) + 2 * radius;  // of the surface nearest to any point about x
        grid_.each_about(x, furthest + largest_, [&](Index i) {
            const auto n = static_cast<std::size_t>(i);
            const Real most = furthest + radii_[n];
            if (most < 0 || (x - centres_[n]).squaredNorm() > square(most) * rounding) return;
            few.too_many_ = few.too_many_ || few.count_ == few.spheres_.size();
            if (!few.too_many_) few.spheres_[few.count_++] = {centres_[n], radii_[n]};
        });
        return few;
    }

private:
    static constexpr Real rounding = 1 + 1e-12;  // so that no nearest is missed by it, in whatever order

    static Vec3 in_space(const Point<2>& x) noexcept { return {x[0], 0, x[1]}; }
    static Real nearer(Real nearest, const Vec3& x, const Vec3& centre, Real radius) noexcept {
        const Real most = nearest + radius;
        const Real apart2 = (x - centre).squaredNorm();
        if (most < 0 || apart2 > square(most) * rounding) return nearest;
        return std::min(nearest, std::sqrt(apart2) - radius);
    }

    void build(Real reach) {
        require_not_negative(reach, "SpherePacking.reach", "m");
        reach_ = reach > 0 ? reach : 2 * largest_;
        grid_ = PointGrid(centres_, 2 * largest_);
        low_ = Vec3::Constant(std::numeric_limits<Real>::infinity()), high_ = -low_;
        for (const Vec3& x : centres_) low_ = low_.cwiseMin(x), high_ = high_.cwiseMax(x);
        low_.array() -= largest_, high_.array() += largest_;
    }

    std::vector<Vec3> centres_;  ///< [sphere] [m]
    std::vector<Real> radii_;    ///< [sphere] [m]; minus infinity: gone
    Real largest_ = 0;           ///< [m]
    Real reach_ = 0;             ///< distances beyond are cut short [m]
    Vec3 low_, high_;            ///< of the box about them [m]
    PointGrid grid_;
};

/// Several walls in one: solid is what is solid in any of them.
template <class... Shapes>
class WallUnion {
public:
    explicit WallUnion(Shapes... shapes) : shapes_(std::move(shapes)...) {}
    template <int Dim>
    requires(WallShape<Shapes, Dim>&&...) Real operator()(const Eigen::Matrix<Real, Dim, 1>& x) const {
        return std::apply([&](const auto&... shape) { return smallest({static_cast<Real>(shape(x))...}); },
                          shapes_);
    }

    /// For the same walls near a place (SpherePacking::nearby).
    auto nearby(const auto& x, Real radius) const {
        return std::apply(
            [&](const auto&... shape) {
                return WallUnion<decltype(few(shape, x, radius))...>(few(shape, x, radius)...);
            },
            shapes_);
    }

private:
    template <class Shape>
    static auto few(const Shape& shape, const auto& x, Real radius) {
        if constexpr (requires { shape.nearby(x, radius); }) {
            return shape.nearby(x, radius);
        } else {
            return std::cref(shape);
        }
    }
    /// NaN where any is NaN: an error must not hide behind another wall.
    static Real smallest(std::initializer_list<Real> distances) noexcept {
        Real least = std::numeric_limits<Real>::infinity();
        for (const Real d : distances) least = d < least || std::isnan(d) ? d : least;
        return least;
    }
    std::tuple<Shapes...> shapes_;
};

static_assert(WallShape<PlaneWall<2>, 2> && WallShape<PlaneWall<3>, 3>);
static_assert(WallShape<InvertWall, 2> && WallShape<InvertWall, 3>);
static_assert(WallShape<SpherePacking, 2> && WallShape<SpherePacking, 3>);
static_assert(WallShape<WallUnion<InvertWall, SpherePacking>, 3>);
static_assert(!WallShape<WallUnion<InvertWall, Invert>, 3>);
static_assert(!WallShape<Invert, 3>);

}  // namespace abrade
