#pragma once
// Stones of a given size, form and roundness, each an individual: clumps of overlapping spheres.

#include <abrade/core/require.hpp>
#include <abrade/geometry/rounded_polyhedron.hpp>
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
    Index max_spheres = 60;   ///< no more than this, even if gaps are then wider
    std::uint64_t seed = 0;   ///< another seed, another stone

    void validate() const {
        require_positive(size, "Gravel.size", "m");
        require_share(elongation, 0.2, "Gravel.elongation");
        require_share(flatness, 0.2, "Gravel.flatness");
        require_share(roundness, 0.05, "Gravel.roundness");
        require(largest_gap >= 0.002 && largest_gap <= 1,
                {"Gravel.largest_gap", "in [0.002, 1]", {}, "it is a share of the size"}, largest_gap);
        require(max_spheres >= 7,
                {"Gravel.max_spheres", ">= 7", "spheres", "one inside and one at each end of three axes"},
                max_spheres);
    }

private:
    static void require_share(Real value, Real least, std::string_view field) {
        require(value >= least && value <= 1, {field, "in [" + short_text(least) + ", 1]"}, value);
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

/// Twelve directions spread over the sphere, turned and shaken by chance.
inline std::vector<Vec3> random_corners(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    // The distributions of the standard library differ from one compiler to the next; the engine does not.
    const auto uniform = [&] { return static_cast<Real>(random() >> 11) * 0x1p-52 - 1; };
    Quaternion turn(uniform(), uniform(), uniform(), uniform());
    turn.normalize();
    constexpr int count = 12;
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
        for (int n = 0; n < 3; ++n) {
            fill();
            for (int k = 0; k < 8; ++k) adjust(true);
        }
        for (int k = 0; k < 60 && adjust(true) > 1e-9;) ++k;
        return spheres();
    }

private:
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
    /// and z. With C the integral of x x^T about the centroid, the shear x + E x, E_ij = -C_ij / (C_ii +
    /// C_jj), removes its off-diagonal part to first order, and unlike a turn also where two axes are about
    /// equal. Returns the size of the step.
    Real adjust(bool aligned) {
        inscribed_ = stone_.largest_inscribed();
        std::vector<Sphere> now = spheres();
        if (!filled_)
            for (const Vec3& corner : stone_.corners()) now.push_back({corner, stone_.radius()});
        Mat3 change = Mat3::Identity();
        if (aligned && now.size() > 1) {
            const SolidMoments m = slice_moments<12>(now);
            const Mat3 c = 0.5 * m.inertia.trace() * Mat3::Identity() - m.inertia;
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    if (i != j) change(i, j) = -c(i, j) / (c(i, i) + c(j, j));
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
        const std::vector<SurfaceSample> samples = stone_.samples(6);
        GreedyFilling filling(samples);
        filling.add(inscribed_);
        // The ends of the axes, so that the spheres have the extent of the stone.
        for (int axis = 0; axis < 3; ++axis)
            for (const Real side : {-1.0, 1.0}) {
                const auto end = std::max_element(
                    stone_.corners().begin(), stone_.corners().end(),
                    [&](const Vec3& a, const Vec3& b) { return side * a[axis] < side * b[axis]; });
                const Sphere ball{*end, stone_.radius()};
                const auto reaches = [&](const Sphere& s) {
                    return side * (ball.centre - s.centre)[axis] + ball.radius - s.radius < 1e-4;
                };
                if (std::none_of(filling.spheres().begin(), filling.spheres().end(), reaches))
                    filling.add(ball);
            }
        const std::size_t kept = filling.spheres().size();
        const Real nominal = std::cbrt(6 / pi * union_volume(filling.spheres()));
        const Real gap = wanted_.largest_gap * nominal;
        filling.fill_by_gap(
            {.max_spheres = wanted_.max_spheres, .largest_gap = gap},
            [&](const Vec3& x) { return stone_.depth(x); }, 0, stone_.radius(), 1);
        if (filling.largest_gap() <= gap) filling.drop_redundant(gap, kept);
        places_.clear();
        const Mat3 back = stone_.map().inverse();
        for (std::size_t n = 1; n < filling.spheres().size(); ++n)
            places_.push_back(back * filling.spheres()[n].centre);
    }
    static Real union_volume(std::span<const Sphere> spheres) {
        return spheres.size() < 3 ? exact_moments(spheres).volume : slice_moments<12>(spheres).volume;
    }

    Gravel wanted_;
    Vec3 axes_;  ///< L, I, S over L
    RoundedPolyhedron stone_;
    bool filled_ = false;
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

/// A stone of the wanted size, form and roundness: a random convex polyhedron of twelve corners, rounded, and
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
