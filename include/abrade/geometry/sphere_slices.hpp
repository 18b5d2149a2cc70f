#pragma once
// Volume, first and second moments of a union of many spheres, by slices of exposed arcs; of one
// sphere and of two in closed form.

#include <abrade/geometry/solid_moments.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace abrade::detail {

/// Nodes and weights of Gauss and Legendre on [-1, 1], by Newton's method on the Legendre polynomial.
template <std::size_t Count>
std::array<std::pair<Real, Real>, Count> gauss_legendre() {
    std::array<std::pair<Real, Real>, Count> rule{};
    constexpr Real n = static_cast<Real>(Count);
    for (std::size_t k = 0; k < Count; ++k) {
        Real x = std::cos(pi * (static_cast<Real>(k) + 0.75) / (n + 0.5)), slope = 0;
        for (int iteration = 0; iteration < 8; ++iteration) {
            Real p = 1, before = 0;
            for (std::size_t j = 1; j <= Count; ++j) {
                const Real degree = static_cast<Real>(j);
                before = std::exchange(p, ((2 * degree - 1) * x * p - (degree - 1) * before) / degree);
            }
            slope = n * (x * p - before) / (x * x - 1);
            x -= p / slope;
        }
        rule[k] = {x, 2 / ((1 - x * x) * slope * slope)};
    }
    return rule;
}

/// Integrals of 1, x, y, xx, xy, yy over a plane region.
struct AreaMoments {
    Real area = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
};

/// Adds the part that an arc of a boundary, run anticlockwise from angle `from` to `to`, has in the
/// moments of the region to its left. By Green's theorem
///   A = 1/2 int (x dy - y dx),  M_x = 1/2 int x^2 dy,  M_xx = 1/3 int x^3 dy,  M_xy = 1/2 int x^2 y dy, ...
/// with x = p + r cos(theta), y = q + r sin(theta): polynomials in cos and sin, in closed form.
inline void add_arc(AreaMoments& sum, Real p, Real q, Real r, Real from, Real to) {
    struct Multiples {  // cos(k theta), sin(k theta)
        std::array<Real, 5> c{}, s{};
        explicit Multiples(Real theta) {
            c[1] = std::cos(theta), s[1] = std::sin(theta);
            for (std::size_t k = 2; k < 5; ++k) {
                c[k] = c[k - 1] * c[1] - s[k - 1] * s[1];
                s[k] = s[k - 1] * c[1] + c[k - 1] * s[1];
            }
        }
    };
    const Multiples end(to), begin(from);
    std::array<Real, 5> c{}, s{};  // integrals of cos(k theta), sin(k theta)
    for (std::size_t k = 1; k < 5; ++k) {
        c[k] = (end.s[k] - begin.s[k]) / static_cast<Real>(k);
        s[k] = (begin.c[k] - end.c[k]) / static_cast<Real>(k);
    }
    const Real turn = to - from;
    const Real cc = 0.5 * (turn + c[2]), ss = 0.5 * (turn - c[2]), cs = 0.5 * s[2];
    const Real ccc = 0.25 * (3 * c[1] + c[3]), sss = 0.25 * (3 * s[1] - s[3]), ccs = 0.25 * (s[1] + s[3]);
    const Real cccc = 0.125 * (3 * turn + 4 * c[2] + c[4]), ssss = 0.125 * (3 * turn - 4 * c[2] + c[4]),
               cccs = 0.125 * (2 * s[2] + s[4]);
    const Real x2c = p * p * c[1] + 2 * p * r * cc + r * r * ccc;
    sum.area += 0.5 * r * (p * c[1] + q * s[1] + r * turn);
    sum.x += 0.5 * r * x2c;
    sum.y += 0.5 * r * (q * q * s[1] + 2 * q * r * ss + r * r * sss);
    sum.xx += r / 3 * (cube(p) * c[1] + 3 * p * p * r * cc + 3 * p * r * r * ccc + cube(r) * cccc);
    sum.yy += r / 3 * (cube(q) * s[1] + 3 * q * q * r * ss + 3 * q * r * r * sss + cube(r) * ssss);
    sum.xy += 0.5 * r * (q * x2c + r * (p * p * cs + 2 * p * r * ccs + r * r * cccs));
}

/// A union of spheres, cut by planes z = constant. A slice is a union of discs: its moments are sums over
/// the exposed arcs of their circles (after Lee and Richards 1971, doi:10.1016/0022-2836(71)90324-X), exact.
/// As functions of z they are smooth but where the pattern of arcs changes: at exposed poles of spheres,
/// at the highest and lowest points of the circles in which two spheres meet, and where three spheres
/// meet. Between these planes Gauss' rule converges exponentially, once a substitution takes away the
/// square roots at the ends. Points that another sphere covers change nothing and are left out.
class SphereSlices {
public:
    explicit SphereSlices(std::span<const Sphere> spheres) {
        for (std::size_t i = 0; i < spheres.size(); ++i) {
            const auto covered_by = [&](std::size_t k) {
                const Real beyond =
                    (spheres[i].centre - spheres[k].centre).norm() + spheres[i].radius - spheres[k].radius;
                return beyond < 0 || (beyond == 0 && (spheres[i].radius < spheres[k].radius || k < i));
            };
            bool covered = false;
            for (std::size_t k = 0; k < spheres.size() && !covered; ++k) covered = k != i && covered_by(k);
            if (!covered) spheres_.push_back(spheres[i]);
        }
        neighbours_.resize(spheres_.size());
        for (std::size_t i = 0; i < spheres_.size(); ++i) {
            tolerance_ = std::max(tolerance_, 1e-12 * spheres_[i].radius);
            neighbours_[i] = neighbours_of(i);
        }
        find_planes();
    }

    /// With `Nodes` planes between two changes of the pattern. Largest error measured on some thousand rows,
    /// pairs and heaps: 4e-9 of each quantity with 16, 1e-12 with 48.
    template <std::size_t Nodes>
    RawMoments moments() const {
        static const auto rule = gauss_legendre<Nodes>();
        RawMoments sum;
        for (std::size_t n = 1; n < planes_.size(); ++n) {
            const Real low = planes_[n - 1], length = planes_[n] - low;
            for (const auto& [node, weight] : rule) {
                // z = low + length t^2 (3 - 2t): (z - low)^(3/2) and the like become powers of t.
                const Real t = 0.5 * (1 + node);
                const Real z = low + length * t * t * (3 - 2 * t);
                add_slice(sum, z, 0.5 * weight * length * 6 * t * (1 - t));
            }
        }
        return sum;
    }

private:
    struct Neighbour {
        std::size_t index;
        Real distance;   ///< across the slices [m]
        Real direction;  ///< from x towards y [rad]
    };
    /// The spheres that cover a part of the surface of sphere i that no other one covers alone. Each covers
    /// a cap; one cap holds another if the angle between their axes is no more than that of their radii.
    std::vector<Neighbour> neighbours_of(std::size_t i) const {
        struct Cap {
            std::size_t sphere;
            Vec3 axis;
            Real angle;
        };
        std::vector<Cap> caps;
        const Real r = spheres_[i].radius;
        for (std::size_t k = 0; k < spheres_.size(); ++k) {
            if (k == i || !overlap(i, k)) continue;
            const Vec3 way = spheres_[k].centre - spheres_[i].centre;
            const Real d = way.norm();
            caps.push_back({k, way / d,
                            std::acos(std::clamp((d * d + r * r - square(spheres_[k].radius)) / (2 * d * r),
                                                 -1.0, 1.0))});
        }
        std::stable_sort(caps.begin(), caps.end(),
                         [](const Cap& a, const Cap& b) { return a.angle > b.angle; });
        std::vector<Cap> needed;
        for (const Cap& cap : caps) {
            const auto holds = [&](const Cap& other) {
                return std::atan2(cap.axis.cross(other.axis).norm(), cap.axis.dot(other.axis)) + cap.angle <=
                       other.angle;
            };
            if (std::none_of(needed.begin(), needed.end(), holds)) needed.push_back(cap);
        }
        std::vector<Neighbour> result;
        for (const Cap& cap : needed) {
            const Vec3 way = spheres_[cap.sphere].centre - spheres_[i].centre;
            result.push_back({cap.sphere, std::hypot(way.x(), way.y()), std::atan2(way.y(), way.x())});
        }
        return result;
    }
    bool overlap(std::size_t i, std::size_t k) const {
        return (spheres_[i].centre - spheres_[k].centre).norm() < spheres_[i].radius + spheres_[k].radius;
    }

    /// A point of the surfaces of the spheres i, j and k: is it on the surface of the union?
    bool exposed(const Vec3& point, std::size_t i, std::size_t j, std::size_t k) const {
        for (const auto& [other, distance, direction] : neighbours_[i])
            if (other != j && other != k &&
                (point - spheres_[other].centre).norm() < spheres_[other].radius - tolerance_)
                return false;
        return true;
    }
    void add_plane(const Vec3& point, std::size_t i, std::size_t j, std::size_t k) {
        if (!exposed(point, i, j, k)) return;
        planes_.push_back(point.z());
        for (const std::size_t sphere : {i, j, k}) {
            exposed_low_[sphere] = std::min(exposed_low_[sphere], point.z());
            exposed_high_[sphere] = std::max(exposed_high_[sphere], point.z());
        }
    }

    void find_planes() {
        exposed_low_.assign(spheres_.size(), std::numeric_limits<Real>::infinity());
        exposed_high_.assign(spheres_.size(), -std::numeric_limits<Real>::infinity());
        for (std::size_t i = 0; i < spheres_.size(); ++i) {
            const Sphere& a = spheres_[i];
            for (const Real side : {-1.0, 1.0})
                add_plane(a.centre + side * a.radius * Vec3::UnitZ(), i, i, i);
            for (const auto& [j, distance, direction] : neighbours_[i]) {
                if (j < i) continue;
                const Vec3 to_b = spheres_[j].centre - a.centre;
                const Real d2 = to_b.squaredNorm();
                const Vec3 middle =
                    a.centre + 0.5 * (1 + (square(a.radius) - square(spheres_[j].radius)) / d2) * to_b;
                const Real circle2 = square(a.radius) - (middle - a.centre).squaredNorm();
                if (circle2 <= 0) continue;
                const Vec3 axis = to_b / std::sqrt(d2);
                const Vec3 up = Vec3::UnitZ() - axis.z() * axis;
                if (up.norm() > 1e-9)
                    for (const Real side : {-1.0, 1.0})
                        add_plane(middle + side * std::sqrt(circle2) * up.normalized(), i, j, j);
                else
                    planes_.push_back(middle.z());
                add_triple_points(i, j, middle, axis, circle2);
            }
        }
        std::sort(planes_.begin(), planes_.end());
        planes_.erase(std::unique(planes_.begin(), planes_.end(),
                                  [&](Real low, Real high) { return high - low < tolerance_; }),
                      planes_.end());
    }

    /// Where the circle of the spheres i and j pierces a third sphere: middle + x u + y v with
    /// x^2 + y^2 = circle2 and x = distance of that sphere's plane.
    void add_triple_points(std::size_t i, std::size_t j, const Vec3& middle, const Vec3& axis, Real circle2) {
        for (const auto& [k, apart, direction] : neighbours_[i]) {
            if (k <= j || !overlap(j, k)) continue;
            const Vec3 to_third = spheres_[k].centre - middle;
            const Vec3 across = to_third - to_third.dot(axis) * axis;
            const Real distance = across.norm();
            if (distance <= tolerance_) continue;
            const Real x = (to_third.squaredNorm() + circle2 - square(spheres_[k].radius)) / (2 * distance);
            if (square(x) >= circle2) continue;
            const Vec3 u = across / distance, v = axis.cross(u);
            for (const Real side : {-1.0, 1.0})
                add_plane(middle + x * u + side * std::sqrt(circle2 - square(x)) * v, i, j, k);
        }
    }

    /// Moments of the union of discs at height z.
    AreaMoments slice(Real z) const {
        AreaMoments sum;
        std::vector<std::pair<Real, Real>> covered;  // angles on the circle of one disc
        for (std::size_t i = 0; i < spheres_.size(); ++i) {
            // Beyond the highest and lowest point of its exposed part, where the pattern changes, it is
            // hidden.
            if (z < exposed_low_[i] - tolerance_ || z > exposed_high_[i] + tolerance_) continue;
            const Sphere& a = spheres_[i];
            const Real r2 = square(a.radius) - square(z - a.centre.z());
            if (r2 <= 0) continue;
            const Real r = std::sqrt(r2);
            covered.clear();
            bool hidden = false;
            for (const Neighbour& n : neighbours_[i]) {
                const Sphere& b = spheres_[n.index];
                const Real other2 = square(b.radius) - square(z - b.centre.z()), d = n.distance;
                if (other2 <= 0) continue;
                const Real other = std::sqrt(other2);
                if (d >= r + other || d + other <= r) continue;
                hidden = d + r <= other;
                if (hidden) break;
                const Real half = std::acos(std::clamp((d * d + r2 - other2) / (2 * d * r), -1.0, 1.0));
                const Real from = n.direction - half, to = from + 2 * half;  // from >= -2 pi
                if (from < -pi) {
                    covered.emplace_back(from + 2 * pi, pi);
                    covered.emplace_back(-pi, to);
                } else if (to > pi) {
                    covered.emplace_back(from, pi);
                    covered.emplace_back(-pi, to - 2 * pi);
                } else {
                    covered.emplace_back(from, to);
                }
            }
            if (hidden) continue;
            std::sort(covered.begin(), covered.end());
            Real at = -pi;
            for (const auto& [from, to] : covered) {
                if (from > at) add_arc(sum, a.centre.x(), a.centre.y(), r, at, from);
                at = std::max(at, to);
            }
            if (at < pi) add_arc(sum, a.centre.x(), a.centre.y(), r, at, pi);
        }
        return sum;
    }

    void add_slice(RawMoments& sum, Real z, Real weight) const {
        const AreaMoments m = slice(z);
        sum.volume += weight * m.area;
        sum.first += weight * Vec3(m.x, m.y, z * m.area);
        sum.second +=
            weight * Mat3{{m.xx, m.xy, z * m.x}, {m.xy, m.yy, z * m.y}, {z * m.x, z * m.y, z * z * m.area}};
    }

    std::vector<Sphere> spheres_{};                     ///< none within another
    std::vector<std::vector<Neighbour>> neighbours_{};  ///< [sphere] those that cover a part of it
    std::vector<Real> exposed_low_{};   ///< [sphere] lowest point of its part in the union's surface [m]
    std::vector<Real> exposed_high_{};  ///< [sphere]
    std::vector<Real> planes_{};        ///< heights where the pattern of arcs changes [m]
    Real tolerance_ = 0;                ///< [m]
};

/// Moments of the union of `spheres`. The planes of the slices are inclined to the axes of the spheres'
/// frame: stones are often built along these, and a circle that lies almost in a slice converges slowest.
template <std::size_t Nodes = 48>
SolidMoments slice_moments(std::span<const Sphere> spheres) {
    Vec3 low = Vec3::Constant(std::numeric_limits<Real>::infinity()), high = -low;
    for (const Sphere& s : spheres) {
        low = low.cwiseMin((s.centre.array() - s.radius).matrix());
        high = high.cwiseMax((s.centre.array() + s.radius).matrix());
    }
    const Vec3 middle = 0.5 * (low + high);
    const Mat3 turn = Quaternion(0.8224, 0.3151, -0.2487, 0.4038).normalized().toRotationMatrix();
    std::vector<Sphere> turned(spheres.begin(), spheres.end());
    for (Sphere& s : turned) s.centre = (turn * (s.centre - middle)).eval();
    SolidMoments m = SphereSlices(turned).template moments<Nodes>().about_centroid();
    m.centroid = (middle + turn.transpose() * m.centroid).eval();
    m.inertia = (turn.transpose() * m.inertia * turn).eval();
    return m;
}

/// Adds the part of a ball between the planes `from` and `to` (signed distances from its centre along
/// `axis`). The integrands are polynomials of degree 4 at most, so three Gauss points are exact.
inline void add_ball_slice(RawMoments& sum, const Sphere& ball, const Vec3& axis, Real from, Real to) {
    if (to <= from) return;
    static constexpr std::array<std::pair<Real, Real>, 3> gauss{
        {{-0.7745966692414834, 5.0 / 9}, {0.0, 8.0 / 9}, {0.7745966692414834, 5.0 / 9}}};
    const Mat3 along = axis * axis.transpose();
    const Mat3 across = Mat3::Identity() - along;
    for (const auto& [node, weight] : gauss) {
        const Real s = 0.5 * (from + to) + 0.5 * (to - from) * node;
        const Real rho2 = std::max(0.0, square(ball.radius) - s * s);
        const Real area = 0.5 * (to - from) * weight * pi * rho2;
        const Vec3 centre = ball.centre + s * axis;
        sum.volume += area;
        sum.first += area * centre;
        sum.second += area * (centre * centre.transpose() + 0.25 * rho2 * across);
    }
}

/// Exact moments of one sphere or of the union of two.
inline RawMoments exact_moments(std::span<const Sphere> spheres) {
    RawMoments sum;
    if (spheres.size() == 1) {
        add_ball_slice(sum, spheres[0], Vec3::UnitX(), -spheres[0].radius, spheres[0].radius);
        return sum;
    }
    const Sphere &a = spheres[0], &b = spheres[1];
    const Real distance = (b.centre - a.centre).norm();
    if (distance <= std::abs(a.radius - b.radius)) return exact_moments({a.radius > b.radius ? &a : &b, 1});
    const Vec3 axis = (b.centre - a.centre) / distance;
    // The plane of the common circle, seen from a; beyond the touching distance each ball is whole.
    const Real plane = (square(distance) + square(a.radius) - square(b.radius)) / (2 * distance);
    add_ball_slice(sum, a, axis, -a.radius, std::min(plane, a.radius));
    add_ball_slice(sum, b, axis, std::max(plane - distance, -b.radius), b.radius);
    return sum;
}

}  // namespace abrade::detail
