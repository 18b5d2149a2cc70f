#pragma once
// Stones of a given size, form and roundness, each an individual: clumps of overlapping spheres.

#include <abrade/core/require.hpp>
#include <abrade/geometry/rounded_polyhedron.hpp>
#include <abrade/geometry/sphere_slices.hpp>
#include <abrade/geometry/sphere_union.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace abrade {

/// What a stone is to be. With L >= I >= S its longest, intermediate and shortest axis: the sides of the box
/// around it along its principal axes of inertia. Zingg's ratios, see Blott and Pye 2008,
/// doi:10.1111/j.1365-3091.2007.00892.x; roundness after Wadell 1932, doi:10.1086/623964, taken in space
/// instead of in an outline.
struct Gravel {
    Real size = 0;         ///< nominal diameter: that of the sphere of equal volume [m]
    Real elongation = 1;   ///< I / L, in [0.2, 1]
    Real flatness = 1;     ///< S / I, in [0.2, 1]
    Real roundness = 0.5;  ///< radius of the corners over that of the largest inscribed sphere, in [0.05, 1]
    Real largest_gap = 0.03;  ///< between the spheres and the smooth stone they stand for, over size
    Index max_spheres = 100;  ///< no more than this, even if gaps are then wider
    std::uint64_t seed = 0;   ///< another seed, another stone

    void validate() const {
        require_positive(size, "Gravel.size", "m");
        require_share(elongation, 0.2, "Gravel.elongation", "it is I / L, 1 where both are equal");
        require_share(flatness, 0.2, "Gravel.flatness", "it is S / I, 1 where both are equal");
        require_share(roundness, 0.05, "Gravel.roundness", "1 is round, less has sharper corners");
        require(largest_gap >= 0.002 && largest_gap <= 1,
                {"Gravel.largest_gap", "in [0.002, 1]", {}, "it is a share of the size"}, largest_gap);
        require(max_spheres >= 9,
                {"Gravel.max_spheres", ">= 9", "spheres", "one inside and one at each of eight corners"},
                max_spheres);
    }

private:
    static void require_share(Real value, Real least, std::string_view field, std::string_view remedy) {
        require(value >= least && value <= 1, {field, "in [" + short_text(least) + ", 1]", {}, remedy},
                value);
    }
};

/// Sides of the box around a clump along its principal axes of inertia [m], longest first.
struct StoneForm {
    Real longest = 0;
    Real intermediate = 0;
    Real shortest = 0;
    Real elongation() const { return intermediate / longest; }
    Real flatness() const { return shortest / intermediate; }
};

namespace detail {

struct Box {
    Vec3 low = Vec3::Constant(std::numeric_limits<Real>::infinity());
    Vec3 high = -low;
};
inline Box box_around(std::span<const Sphere> spheres) {
    Box box;
    for (const Sphere& s : spheres) {
        box.low = box.low.cwiseMin((s.centre.array() - s.radius).matrix());
        box.high = box.high.cwiseMax((s.centre.array() + s.radius).matrix());
    }
    return box;
}

/// Eight directions spread over the sphere, turned and shaken by chance.
inline std::vector<Vec3> random_corners(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    // The distributions of the standard library differ from one compiler to the next, and so does the order
    // in which arguments are evaluated; the engine does not.
    const auto uniform = [&] { return static_cast<Real>(random() >> 11) * 0x1p-52 - 1; };
    const Real k = uniform(), j = uniform(), i = uniform(), w = uniform();
    const Quaternion turn = Quaternion(w, i, j, k).normalized();
    constexpr int count = 8;
    constexpr Real golden_angle = 2.399963229728653, shake = 0.3;
    std::vector<Vec3> corners;
    for (int n = 0; n < count; ++n) {
        const Real z = 1 - (2 * n + 1.0) / count, r = std::sqrt(1 - z * z);
        const Vec3 even(r * std::cos(golden_angle * n), r * std::sin(golden_angle * n), z);
        const Real x = uniform(), y = uniform();
        corners.push_back((turn * even + shake * Vec3(x, y, uniform())).normalized());
    }
    return corners;
}

/// A stone whose longest axis is 1, in the making: a rounded polyhedron, and spheres that fill it. Each
/// sphere stands at a fixed place of the polyhedron's shape, and follows when that is stretched or sheared.
class GravelInTheMaking {
public:
    explicit GravelInTheMaking(const Gravel& wanted)
        : wanted_{wanted}, axes_{1, wanted.elongation, wanted.elongation * wanted.flatness},
          stone_{random_corners(wanted.seed)} {
        stone_.set(0.5 * axes_.asDiagonal().toDenseMatrix(), 0);
    }

    std::vector<Sphere> make() {
        for (int n = 0; n < 20; ++n) adjust(false);
        // Filling anew changes the moments, and so, a little, the shape; it must not tear the spheres apart.
        for (int n = 0; n < 8; ++n) {
            fill();
            const bool last = n >= 2;
            for (int k = 0; k < (last ? 60 : 4) && adjust(true) > settled(); ++k) {
            }
            if (last && hang_together(spheres())) break;
        }
        return spheres();
    }

private:
    /// A step of L that is as good as none. Where two moments are nearly equal, a small error of the
    /// integrals turns the axes far, so there both are taken more exactly.
    Real settled() const { return nearly_equal_ ? 1e-10 : 1e-7; }
    static Mat3 covariance(const SolidMoments& m) {
        return 0.5 * m.inertia.trace() * Mat3::Identity() - m.inertia;
    }

    /// The spheres as they are now: the largest inscribed one, and those at places, each as large as fits.
    std::vector<Sphere> spheres() const {
        std::vector<Sphere> result;
        if (filled_) result.push_back(inscribed_);
        for (const Vec3& place : places_) {
            const Vec3 centre = stone_.map() * place;
            result.push_back({centre, stone_.depth(centre)});
        }
        return result;
    }

    /// One step towards the wanted axes and roundness, and, when `aligned`, towards principal axes along x, y
    /// and z: by shear, which unlike a turn also works where two axes are about equal. Returns its size.
    Real adjust(bool aligned) {
        inscribed_ = stone_.largest_inscribed();
        std::vector<Sphere> now = spheres();
        if (!filled_)
            for (const Vec3& corner : stone_.corners()) now.push_back({corner, stone_.radius()});
        Mat3 change = Mat3::Identity();
        if (aligned && now.size() > 1) {
            Mat3 c = covariance(slice_moments<6>(now));
            const Vec3 d = c.diagonal();
            nearly_equal_ = std::min({std::abs(d.x() - d.y()), std::abs(d.y() - d.z()),
                                      std::abs(d.z() - d.x())}) < 0.01 * d.sum();
            if (nearly_equal_) c = covariance(slice_moments<24>(now));
            // A shear E changes C_ij, the integral of x_i x_j, by E (C_ii + C_jj), if everything moves with
            // it. Here only centres do. The share of the core in the extent, to the first power, keeps the
            // iteration stable for any roundness, and quick enough where there is little core.
            const Box all = box_around(now);
            const Vec3 side2 = (all.high - all.low).cwiseAbs2();
            const Vec3 core2 = (all.high - all.low - Vec3::Constant(2 * stone_.radius())).cwiseAbs2();
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < i; ++j) {
                    const Real moves =
                        std::max(0.05, std::sqrt((core2[i] + core2[j]) / (side2[i] + side2[j])));
                    const Real shear = -c(i, j) / (moves * (c(i, i) + c(j, j)));
                    change(i, j) = change(j, i) = std::clamp(shear, -0.1, 0.1);
                }
        }
        // The core must keep some thickness: its faces are made of it.
        const Real radius = std::min(wanted_.roundness * inscribed_.radius, 0.5 * (1 - 1e-5) * axes_.z());
        const Box box = box_around(now);
        const Vec3 stretch =
            (axes_ - Vec3::Constant(2 * radius))
                .cwiseQuotient(
                    (box.high - box.low - Vec3::Constant(2 * stone_.radius())).cwiseMax(1e-6 * axes_));
        change = (stretch.asDiagonal() * change).eval();
        const Real step =
            (change * stone_.map() - stone_.map()).cwiseAbs().maxCoeff() + std::abs(radius - stone_.radius());
        stone_.set(change * stone_.map(), radius);
        return step;
    }

    void fill() {
        inscribed_ = stone_.largest_inscribed();
        filled_ = true;
        // Centres keep within the core: from outside of it the depth is not known, and a place would not
        // last.
        const auto depth = [&](const Vec3& x) { return stone_.in_core(x) ? stone_.depth(x) : -1.0; };
        const std::vector<SurfaceSample> samples = stone_.samples(5);
        std::vector<Sphere> pool;
        for (const SurfaceSample& sample : samples)
            for (const Real slack : {1e-9, 0.01, 0.04})
                pool.push_back(ball_under(sample, depth, slack, stone_.radius(), 1));

        const std::vector<Sphere> frame = frame_of_corners();
        const SphereFilling limits{.max_spheres = wanted_.max_spheres,
                                   .largest_gap = wanted_.largest_gap * nominal_diameter(pool)};
        require(frame.size() <= static_cast<std::size_t>(wanted_.max_spheres),
                {"Gravel.max_spheres", "at least " + std::to_string(frame.size()) + " for this form",
                 "spheres", "or make it rounder, less elongated or less flat"},
                wanted_.max_spheres);
        GreedyFilling filling(samples, limits);
        for (const Sphere& s : frame) filling.add(s);
        filling.fill_by_volume(pool);
        if (filling.gap_reached()) filling.drop_redundant(frame.size());
        places_.clear();
        const Mat3 back = stone_.map().inverse();
        for (std::size_t n = 1; n < filling.spheres().size(); ++n)
            places_.push_back(back * filling.spheres()[n].centre);
    }

    /// The largest inscribed sphere, one at each corner, which give the stone its extent and its roundness,
    /// and what it takes to tie them together.
    std::vector<Sphere> frame_of_corners() const {
        std::vector<Sphere> frame{inscribed_};
        for (const Vec3& corner : stone_.corners()) {
            const auto covers = [&](const Sphere& s) {
                return (s.centre - corner).norm() + stone_.radius() - s.radius < 1e-5;
            };
            if (std::none_of(frame.begin(), frame.end(), covers)) tie(frame, {corner, stone_.radius()});
        }
        return frame;
    }

    /// Adds `tip` and, towards the nearest sphere of the frame, spheres that each overlap the one before.
    void tie(std::vector<Sphere>& frame, const Sphere& tip) const {
        const Sphere nearest =
            *std::min_element(frame.begin(), frame.end(), [&](const Sphere& a, const Sphere& b) {
                return (a.centre - tip.centre).norm() - a.radius < (b.centre - tip.centre).norm() - b.radius;
            });
        constexpr Real overlap = 0.3;  // more than must be, since the stone still changes a little
        frame.push_back(tip);
        while (!overlap_by(overlap, frame.back(), nearest) && frame.size() < 10'000) {
            // The farther along the way, the less it overlaps the one before: the last place that will do.
            const Sphere before = frame.back();
            Real low = 0, high = 1;
            const auto at = [&](Real share) -> Sphere {
                const Vec3 centre = before.centre + share * (nearest.centre - before.centre);
                return {centre, stone_.depth(centre)};
            };
            for (int halving = 0; halving < 30; ++halving) {
                const Real share = 0.5 * (low + high);
                (overlap_by(overlap, before, at(share)) ? low : high) = share;
            }
            frame.push_back(at(low));
        }
    }

    /// Of the union of the largest spheres: close enough to say what a gap is.
    Real nominal_diameter(std::vector<Sphere> pool) const {
        constexpr std::size_t enough = 30;
        const std::size_t stride = std::max<std::size_t>(1, pool.size() / enough);
        std::vector<Sphere> some{inscribed_};
        for (std::size_t n = 0; n < pool.size(); n += stride) some.push_back(pool[n]);
        return std::cbrt(6 / pi * slice_moments<12>(some).volume);
    }

    Gravel wanted_;
    Vec3 axes_;  ///< L, I, S over L
    RoundedPolyhedron stone_;
    bool filled_ = false;
    bool nearly_equal_ = false;  ///< are two of the principal moments
    Sphere inscribed_{};
    std::vector<Vec3> places_{};  ///< of the other spheres' centres, in the polyhedron's shape
};

}  // namespace detail

/// L, I and S of a clump.
inline StoneForm form_of(const Clump& clump) {
    const detail::Box box = detail::box_around(clump.members);
    Vec3 sides = box.high - box.low;
    std::sort(sides.data(), sides.data() + 3);
    return {sides.z(), sides.y(), sides.x()};
}

/// A stone of the wanted size, form and roundness: a random convex polyhedron of eight corners, rounded, and
/// filled with the largest inscribed sphere, spheres at its corners, whose radius is that of the rounding,
/// and what it takes to close the gaps between them. Its volume is that of the nominal sphere to round-off,
/// elongation and flatness are met to 1e-3, and roundness to 1e-3; the same input gives the same stone.
/// With roundness 1 all spheres have one radius, S / 2: a ball, a capsule or a tablet.
/// Throws InputError when a value is out of its range.
inline Clump make_gravel(const Gravel& wanted) {
    wanted.validate();
    std::vector<Sphere> spheres = detail::GravelInTheMaking(wanted).make();
    const Real scale = wanted.size * std::cbrt(pi / 6 / union_moments(spheres).volume);
    for (Sphere& s : spheres) {
        s.centre *= scale;
        s.radius *= scale;
    }
    return make_clump("gravel", std::move(spheres));
}

}  // namespace abrade
