#pragma once
// Fills a solid with overlapping spheres that touch its surface from within.

#include <abrade/core/require.hpp>
#include <abrade/geometry/mesh_distance.hpp>
#include <abrade/geometry/sphere_union.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>

namespace abrade {

/// When to stop. Whatever comes first: a number of spheres, or a gap.
struct SphereFilling {
    Index max_spheres = 100;
    Real largest_gap = 0;      ///< done when no point of the surface is farther from the spheres [m]
    Real smallest_radius = 0;  ///< smaller spheres are not used [m]
    Index samples = 4000;      ///< points of the surface that are watched, at least one a triangle

    void validate() const {
        require(max_spheres >= 1,
                {"SphereFilling.max_spheres", ">= 1", "spheres", "more follow the surface closer"},
                max_spheres);
        require_not_negative(largest_gap, "SphereFilling.largest_gap", "m", "0 goes on up to max_spheres");
        require_not_negative(smallest_radius, "SphereFilling.smallest_radius", "m", "0 allows any");
        require(samples >= 1, {"SphereFilling.samples", ">= 1", "points", "more see smaller gaps"}, samples);
    }
};

/// What came out, and how far it is from the solid.
struct SphereFillingResult {
    std::vector<Sphere> spheres{};
    Real largest_gap = 0;     ///< from a watched point of the surface to the nearest sphere [m]
    Real sample_spacing = 0;  ///< a point between the watched ones may be farther by half of this [m]
    MomentsError error{};     ///< of the union, against the mesh's own volume, centroid and inertia
};

namespace detail {

struct SurfaceSample {
    Vec3 point = Vec3::Zero();
    Vec3 normal = Vec3::UnitX();  ///< out of the solid
    Real area = 1;                ///< that it stands for [m2]
};

/// The largest ball with its centre on the inward normal of a sample that keeps inside the surface and
/// stays within `slack` of the sample. With s the distance from sample to centre and r(s) the centre's
/// distance from the surface, s - r(s) never falls as s grows, because |r'| <= 1: bisection finds the
/// last s at which it is no more than `slack`. `known`: a radius of which a tangent ball is known to fit.
template <class Distance>
Sphere ball_under(const SurfaceSample& sample, const Distance& distance, Real slack, Real known,
                  Real extent) {
    Real low = known, high = extent;
    const auto centre = [&](Real s) -> Vec3 { return sample.point - s * sample.normal; };
    for (int halving = 0; halving < 30; ++halving) {
        const Real s = 0.5 * (low + high);
        (s - distance(centre(s)) <= slack ? low : high) = s;
    }
    const Vec3 at = centre(low);
    return {at, low > known ? distance(at) : known};
}

/// Walks from `ball`, inside the solid, to where the distance from the surface is largest nearby: in
/// ever shorter steps along the axes and diagonals, never out of the present ball.
template <class Distance>
Sphere largest_ball_near(Sphere ball, const Distance& distance) {
    for (Real step = 0.5; step > 1e-7;) {
        Sphere best = ball;
        for (int n = 0; n < 27; ++n) {
            const Vec3 way(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
            if (n == 13) continue;
            const Vec3 at = ball.centre + step * ball.radius * way.normalized();
            if (const Real r = distance(at); r > best.radius) best = {at, r};
        }
        if (best.radius > ball.radius * (1 + 1e-3 * step))
            ball = best;
        else
            step *= 0.5;
    }
    return ball;
}

/// Do two spheres overlap by at least `share` of the smaller radius?
inline bool overlap_by(Real share, const Sphere& a, const Sphere& b) {
    return (a.centre - b.centre).norm() <= a.radius + b.radius - share * std::min(a.radius, b.radius);
}
inline constexpr Real least_overlap = 0.1;  ///< below this two spheres are not taken to hang together

/// Can every sphere be reached from the first over overlaps?
inline bool hang_together(std::span<const Sphere> spheres) {
    std::vector<char> reached(spheres.size(), 0);
    std::vector<std::size_t> front{0};
    reached[0] = 1;
    for (std::size_t n = 0; n < front.size(); ++n)
        for (std::size_t m = 0; m < spheres.size(); ++m)
            if (!reached[m] && overlap_by(least_overlap, spheres[front[n]], spheres[m]))
                reached[m] = 1, front.push_back(m);
    return front.size() == spheres.size();
}

/// Spheres that fill a solid and hang together, and the gaps that they leave at its samples.
class GreedyFilling {
public:
    GreedyFilling(std::span<const SurfaceSample> samples, const SphereFilling& limits)
        : samples_{samples}, limits_{limits}, gaps_(samples.size(), std::numeric_limits<Real>::infinity()) {}

    void add(const Sphere& ball) {
        spheres_.push_back(ball);
        for (std::size_t s = 0; s < samples_.size(); ++s) gaps_[s] = std::min(gaps_[s], gap(s, ball));
    }

    /// Adds the ball of `pool` that fills the most, again and again: the sum of gap times area over the
    /// samples is, for narrow gaps, the volume that is missing. A ball's share of it can only fall as others
    /// are added, so one whose share, computed anew, still is the largest of all is the best. A ball that
    /// does not yet overlap any waits for one that it does.
    void fill_by_volume(const std::vector<Sphere>& pool) {
        std::priority_queue<std::pair<Real, std::size_t>> shares;
        for (std::size_t n = 0; n < pool.size(); ++n) shares.emplace(volume_filled(pool[n]), n);
        std::vector<std::size_t> waiting;
        while (!done() && !shares.empty()) {
            const std::size_t n = shares.top().second;
            shares.pop();
            const Real share = volume_filled(pool[n]);
            if (share <= 0) continue;
            if (!shares.empty() && share < shares.top().first) {
                shares.emplace(share, n);
            } else if (!hangs_on(pool[n])) {
                waiting.push_back(n);
            } else {
                add(pool[n]);
                for (const std::size_t w : waiting) shares.emplace(volume_filled(pool[w]), w);
                waiting.clear();
            }
        }
    }

    /// Adds a ball below the sample with the widest gap, again and again. A ball may miss its sample by a
    /// tenth of the gap: it can then lie deeper, and serves a wider part of the surface.
    template <class Distance>
    void fill_by_gap(const Distance& distance, Real known, Real extent) {
        std::vector<char> open(samples_.size(), 1);
        while (!done()) {
            std::size_t widest = samples_.size();
            for (std::size_t s = 0; s < samples_.size(); ++s)
                if (open[s] && (widest == samples_.size() || gaps_[s] > gaps_[widest])) widest = s;
            if (widest == samples_.size()) break;
            const Real slack = std::max(0.1 * gaps_[widest], 1e-9 * extent);
            const Sphere ball = ball_under(samples_[widest], distance, slack, known, extent);
            if (ball.radius >= limits_.smallest_radius && ball.radius > 0 &&
                gap(widest, ball) < 0.99 * gaps_[widest] && hangs_on(ball))
                add(ball);
            else
                open[widest] = 0;  // no ball that may be used comes nearer
        }
    }

    /// Takes out, smallest first but never the first `kept`, what is not needed for the wanted gap.
    void drop_redundant(std::size_t kept) {
        std::vector<std::size_t> order;
        for (std::size_t n = kept; n < spheres_.size(); ++n) order.push_back(n);
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return spheres_[a].radius < spheres_[b].radius;
        });
        std::vector<char> used(spheres_.size(), 1);
        for (const std::size_t n : order) {
            used[n] = 0;
            used[n] = !(hang_together(those(used)) && close_enough(used, n));
        }
        const std::vector<Sphere> left = those(used);
        spheres_.clear();
        gaps_.assign(samples_.size(), std::numeric_limits<Real>::infinity());
        for (const Sphere& ball : left) add(ball);
    }

    const std::vector<Sphere>& spheres() const { return spheres_; }
    Real largest_gap() const { return std::max(0.0, *std::max_element(gaps_.begin(), gaps_.end())); }
    bool gap_reached() const { return largest_gap() <= limits_.largest_gap; }
    bool done() const {
        return spheres_.size() >= static_cast<std::size_t>(limits_.max_spheres) || gap_reached();
    }

private:
    Real gap(std::size_t s, const Sphere& ball) const {
        return (samples_[s].point - ball.centre).norm() - ball.radius;
    }
    Real volume_filled(const Sphere& ball) const {
        Real sum = 0;
        for (std::size_t s = 0; s < samples_.size(); ++s)
            sum += samples_[s].area * std::max(0.0, gaps_[s] - gap(s, ball));
        return sum;
    }
    std::vector<Sphere> those(const std::vector<char>& used) const {
        std::vector<Sphere> some;
        for (std::size_t n = 0; n < spheres_.size(); ++n)
            if (used[n]) some.push_back(spheres_[n]);
        return some;
    }
    bool hangs_on(const Sphere& ball) const {
        return std::any_of(spheres_.begin(), spheres_.end(),
                           [&](const Sphere& other) { return overlap_by(least_overlap, ball, other); });
    }
    /// Is the widest gap among the samples of the dropped sphere `n` still narrow enough?
    bool close_enough(const std::vector<char>& used, std::size_t n) const {
        for (std::size_t s = 0; s < samples_.size(); ++s) {
            bool near = gap(s, spheres_[n]) > limits_.largest_gap;  // never was this one's sample
            for (std::size_t m = 0; m < spheres_.size() && !near; ++m)
                near = used[m] && gap(s, spheres_[m]) <= limits_.largest_gap;
            if (!near) return false;
        }
        return true;
    }
    std::span<const SurfaceSample> samples_;
    SphereFilling limits_;
    std::vector<Sphere> spheres_{};
    std::vector<Real> gaps_;  ///< [sample] distance to the nearest sphere [m]
};

/// Centroids of the k^2 equal parts of the triangle a b c.
template <class Use>
void each_part(const Vec3& a, const Vec3& b, const Vec3& c, int k, const Use& use) {
    const Vec3 u = (b - a) / k, v = (c - a) / k;
    for (int i = 0; i < k; ++i)
        for (int j = 0; i + j < k; ++j) {
            use(Vec3(a + (i + 1.0 / 3) * u + (j + 1.0 / 3) * v));
            if (i + j + 1 < k) use(Vec3(a + (i + 2.0 / 3) * u + (j + 2.0 / 3) * v));
        }
}

}  // namespace detail

/// Overlapping spheres inside `mesh`, each as large as its place allows, that hang together.
/// First the largest inscribed sphere. Then, from a pool of spheres that touch the surface from within, or
/// nearly so, the one that fills the most of what is still empty, and so on; where the pool is exhausted,
/// spheres below the widest gap. Tangent spheres grown below points of the surface are those of Ferellec and
/// McDowell 2010, doi:10.1007/s10035-010-0205-8; choosing the one that fills the most, instead of points at
/// random, is ours. For a comparison of such methods see Angelidakis et al. 2021,
/// doi:10.1016/j.softx.2021.100735. The result is the same for the same input. Once a wanted gap is reached,
/// spheres that turn out not to be needed for it are taken out again.
/// The spheres keep inside the mesh, so the union's volume is below the mesh's, and tends to it.
/// Throws InputError on bad limits, and when every sphere would be below the smallest radius.
inline SphereFillingResult fill_with_spheres(const SurfaceMesh& mesh, const SphereFilling& limits) {
    limits.validate();
    const MeshDistance distances(mesh);
    const auto distance = [&](const Vec3& x) { return distances.to_surface(x); };
    const Real extent = (mesh.high() - mesh.low()).norm();

    std::vector<detail::SurfaceSample> samples;
    const Real area_each = mesh.area() / limits.samples;
    Real spacing = 0;
    for (std::size_t t = 0; t < mesh.triangles().size(); ++t) {
        const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
        const Real longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
        const int parts = std::max(1, static_cast<int>(std::ceil(longest / std::sqrt(2 * area_each))));
        spacing = std::max(spacing, longest / parts);
        const Real area = 0.5 * mesh.doubled_area(t).norm() / square(parts);
        detail::each_part(a, b, c, parts, [&](const Vec3& point) {
            samples.push_back({point, mesh.normal(t), area});
        });
    }

    // Tangent balls of some slack, spread over the surface. The largest leads to the largest inscribed one.
    std::vector<Sphere> pool;
    Sphere deepest;
    const std::size_t stride = std::max<std::size_t>(1, samples.size() / 600);
    for (std::size_t s = 0; s < samples.size(); s += stride)
        for (const Real slack : {0.0005, 0.005, 0.02}) {
            const Sphere ball = detail::ball_under(samples[s], distance, slack * extent, 0, extent);
            if (ball.radius > deepest.radius) deepest = ball;
            if (ball.radius >= limits.smallest_radius && ball.radius > 0) pool.push_back(ball);
        }
    deepest = detail::largest_ball_near(deepest, distance);
    require(deepest.radius > 0 && deepest.radius >= limits.smallest_radius,
            {"SphereFilling.smallest_radius",
             "no larger than the largest inscribed sphere (" + short_text(deepest.radius) + " m)", "m",
             "make it smaller, or check the surface's unit"},
            limits.smallest_radius);

    detail::GreedyFilling filling(samples, limits);
    filling.add(deepest);
    filling.fill_by_volume(pool);
    filling.fill_by_gap(distance, 0, extent);
    if (filling.gap_reached()) filling.drop_redundant(1);
    return {filling.spheres(), filling.largest_gap(), spacing,
            moments_error(union_moments(filling.spheres()), mesh.moments())};
}

}  // namespace abrade
