#pragma once
// How much of a box (an edge, a rectangle, a cell) a wall leaves open, from distances at its corners.

#include <abrade/fluid/embedded_boundary/shapes.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <exception>
#include <limits>
#include <optional>
#include <type_traits>

namespace abrade::detail {

/// A number per corner of a box; bit a of a corner's index says that it is the upper one along axis a.
template <int Dim>
using Corners = std::array<Real, std::size_t{1} << Dim>;

/// Open shares of the faces of a box: [axis][lower, upper].
template <int Dim>
using FaceShares = std::array<std::array<Real, 2>, static_cast<std::size_t>(Dim)>;

/// Corners of the face of a box at its lower (0) or upper (1) end along an axis.
template <int Dim>
Corners<Dim - 1> corners_of_face(const Corners<Dim>& d, int axis, std::size_t side) noexcept {
    Corners<Dim - 1> face;
    for (std::size_t k = 0; k < face.size(); ++k) {
        const std::size_t below = k & ((std::size_t{1} << axis) - 1);
        face[k] = d[((k - below) << 1) | (side << axis) | below];
    }
    return face;
}

enum class Content { closed, open, cut };

/// Water is where the distance is above 0.
template <std::size_t Count>
Content content(const std::array<Real, Count>& d) noexcept {
    std::size_t open = 0;
    for (const Real each : d) open += each > 0;
    return open == 0 ? Content::closed : open == Count ? Content::open : Content::cut;
}

/// Mean of the points where the wall crosses the edges of a box that it cuts, each found by linear
/// interpolation; in units of the box.
template <int Dim>
Point<Dim> mean_crossing(const Corners<Dim>& d) noexcept {
    Point<Dim> sum = Point<Dim>::Zero();
    Real crossings = 0;
    for (int a = 0; a < Dim; ++a) {
        const std::size_t step = std::size_t{1} << a;
        for (std::size_t i = 0; i < d.size(); ++i) {
            const std::size_t j = i | step;
            if (j == i || (d[i] > 0) == (d[j] > 0)) continue;
            for (int b = 0; b < Dim; ++b) sum[b] += static_cast<Real>((i >> b) & 1);
            sum[a] += d[i] / (d[i] - d[j]);
            crossings += 1;
        }
    }
    return sum / crossings;
}

/// Open share of a box of which a wall leaves the shares A open on its faces and passes through `point`, in
/// units of the box. The wall is taken as the cone from that point to where it meets the faces; as seen from
/// there it has no height, and the divergence theorem leaves
///   V = 1/Dim sum_a [ A(a, lower) x_a + A(a, upper) (1 - x_a) ],
/// exact for planes, and between 0 and 1 whatever the shares are.
template <int Dim>
Real share_within(const FaceShares<Dim>& faces, const Point<Dim>& point) noexcept {
    Real sum = 0;
    for (int a = 0; a < Dim; ++a) {
        const auto& [lower, upper] = faces[static_cast<std::size_t>(a)];
        sum += lower * point[a] + upper * (1 - point[a]);
    }
    return sum / Dim;
}

template <int Dim>
FaceShares<Dim> shares_of_faces(const Corners<Dim>& d) noexcept;

/// Open share of a box from its corners. On a rectangle this is marching squares; where four edges are
/// crossed the two walls meet halfway.
template <int Dim>
Real open_share(const Corners<Dim>& d) noexcept {
    switch (content(d)) {
        case Content::closed:
            return 0;
        case Content::open:
            return 1;
        default:
            break;
    }
    if constexpr (Dim == 1) {
        const Real crossing = d[0] / (d[0] - d[1]);
        return d[0] > 0 ? crossing : 1 - crossing;
    } else {
        return share_within<Dim>(shares_of_faces<Dim>(d), mean_crossing<Dim>(d));
    }
}

template <int Dim>
FaceShares<Dim> shares_of_faces(const Corners<Dim>& d) noexcept {
    FaceShares<Dim> shares;
    for (int a = 0; a < Dim; ++a)
        for (std::size_t side = 0; side < 2; ++side)
            shares[static_cast<std::size_t>(a)][side] = open_share<Dim - 1>(corners_of_face<Dim>(d, a, side));
    return shares;
}

/// What a shape answered at a place [m].
template <int Dim>
struct Answer {
    Point<Dim> where;
    Real distance = 0;
};

/// Whether answers change [m] by more than the way [m2, squared], as no distance does.
inline bool is_steep(Real change, Real way_squared) noexcept {
    constexpr Real round_off = 1e-6;
    return square(change) > (1 + round_off) * way_squared;
}
template <int Dim>
bool is_steep(const Answer<Dim>& a, const Answer<Dim>& b) noexcept {
    return is_steep(a.distance - b.distance, (a.where - b.where).squaredNorm());
}

/// Where a shape answered what is no number [m], or threw.
template <int Dim>
struct ShapeFailure {
    Point<Dim> where;
    std::exception_ptr thrown;  ///< none: it answered NaN
};

/// A wall, asked for its distance; remembers where it first failed to answer.
template <int Dim, class Wall>
class Probe {
public:
    explicit Probe(const Wall& wall) : wall_(wall) {}
    /// Never infinite, so that distances can be interpolated.
    Real operator()(const Point<Dim>& x) noexcept {
        constexpr Real far = 1e30;
        const Real d = ask(x);
        if (d > -far && d < far) return d;
        if (std::isnan(d) && !failure_) failure_ = {x, nullptr};
        return d > 0 ? far : -far;
    }
    const Wall& shape() const noexcept { return wall_; }
    const std::optional<ShapeFailure<Dim>>& failure() const noexcept { return failure_; }
    /// Takes over what another found of the same wall.
    void join(const std::optional<ShapeFailure<Dim>>& other) noexcept {
        if (!failure_) failure_ = other;
    }

private:
    Real ask(const Point<Dim>& x) noexcept {
        try {
            return wall_(x);
        } catch (...) {  // out of a thread's loop it would end the program
            if (!failure_) failure_ = {x, std::current_exception()};
            return std::numeric_limits<Real>::quiet_NaN();
        }
    }

    const Wall& wall_;
    std::optional<ShapeFailure<Dim>> failure_;
};

/// A box of `Size` dimensions in space: a cell, or one of its faces.
template <int Dim, int Size>
struct Piece {
    Point<Dim> low, size;  ///< [m]; along the axes that it has
    std::array<int, static_cast<std::size_t>(Size)> axes;

    Point<Dim> at(const Point<Size>& unit) const noexcept {
        Point<Dim> x = low;
        for (int s = 0; s < Size; ++s) {
            const int a = axes[static_cast<std::size_t>(s)];
            x[a] = low[a] + unit[s] * size[a];
        }
        return x;
    }
    Real half_diagonal() const noexcept {
        Real sum = 0;
        for (const int a : axes) sum += square(size[a]);
        return 0.5 * std::sqrt(sum);
    }
    Real shortest() const noexcept {
        Real least = size[axes[0]];
        for (const int a : axes) least = std::min(least, size[a]);
        return least;
    }
};

/// What a wall leaves of a box, and where it passes through.
template <int Dim>
struct Opening {
    Real share = 0;
    Real weight = 0;                        ///< size of the wall, for the mean of its parts
    Point<Dim> point = Point<Dim>::Zero();  ///< [box]
};

/// When a box is halved along each axis before it is looked at.
struct Subdivision {
    int levels = 0;             ///< how often at most
    Real flatness = 0;          ///< where the distance at the centre differs by that share of the box
    bool bounded_slope = true;  ///< distances grow no faster than the way: far boxes need no look inside
};

/// Whether corners say too little: the distance at the centre is not their mean.
template <int Dim, int Size, class Wall>
bool is_rough(const Piece<Dim, Size>& piece, const Corners<Size>& d, Probe<Dim, Wall>& wall,
              const Subdivision& rule) noexcept {
    if (rule.levels == 0) return false;
    if (rule.bounded_slope) {
        Real nearest = std::abs(d[0]);
        for (const Real each : d) nearest = std::min(nearest, std::abs(each));
        if (nearest > piece.half_diagonal()) return false;
    }
    Real mean = 0;
    for (const Real each : d) mean += each;
    mean /= static_cast<Real>(d.size());
    const Real centre = wall(piece.at(Point<Size>::Constant(0.5)));
    return std::abs(centre - mean) > rule.flatness * piece.shortest();
}

template <int Dim, int Size, class Wall>
Opening<Size> halved(const Piece<Dim, Size>& piece, Probe<Dim, Wall>& wall, Subdivision rule) noexcept;

/// Open part of a box, halved where it is rough.
template <int Dim, int Size, class Wall>
Opening<Size> opening(const Piece<Dim, Size>& piece, const Corners<Size>& d, Probe<Dim, Wall>& wall,
                      const Subdivision& rule) noexcept {
    if (is_rough(piece, d, wall, rule)) return halved(piece, wall, rule);
    const Content inside = content(d);
    if (inside != Content::cut) return {.share = inside == Content::open ? 1.0 : 0.0};
    const Point<Size> point = mean_crossing<Size>(d);
    if constexpr (Size == 1) {
        return {open_share<1>(d), 1, point};
    } else {
        const FaceShares<Size> faces = shares_of_faces<Size>(d);
        Real weight = 0;
        for (const auto& [lower, upper] : faces) weight += square(upper - lower);
        return {share_within<Size>(faces, point), std::sqrt(weight), point};
    }
}

template <int Dim, int Size, class Wall>
Opening<Size> halved(const Piece<Dim, Size>& piece, Probe<Dim, Wall>& wall, Subdivision rule) noexcept {
    --rule.levels;
    constexpr std::size_t parts = std::size_t{1} << Size, points = Size == 1 ? 3 : Size == 2 ? 9 : 27;
    const auto bit = [](std::size_t bits, int s) { return (bits >> s) & 1; };
    std::array<Real, points>
        distance;  // of corners, middles of edges and faces, centre: by thirds of the index
    for (std::size_t n = 0; n < points; ++n) {
        const std::size_t place[3] = {n % 3, n / 3 % 3, n / 9};
        Point<Size> unit;
        for (int s = 0; s < Size; ++s) unit[s] = 0.5 * static_cast<Real>(place[s]);
        distance[n] = wall(piece.at(unit));
    }
    Opening<Size> sum;
    for (std::size_t part = 0; part < parts; ++part) {
        Piece<Dim, Size> half = piece;
        for (int s = 0; s < Size; ++s) {
            const int a = half.axes[static_cast<std::size_t>(s)];
            half.size[a] *= 0.5;
            half.low[a] += static_cast<Real>(bit(part, s)) * half.size[a];
        }
        Corners<Size> d;
        for (std::size_t corner = 0; corner < parts; ++corner) {
            std::size_t n = 0, third = 1;
            for (int s = 0; s < Size; ++s, third *= 3) n += third * (bit(part, s) + bit(corner, s));
            d[corner] = distance[n];
        }
        const Opening<Size> open = opening(half, d, wall, rule);
        sum.share += open.share;
        sum.weight += open.weight;
        for (int s = 0; s < Size; ++s)
            sum.point[s] += open.weight * 0.5 * (static_cast<Real>(bit(part, s)) + open.point[s]);
    }
    sum.share /= static_cast<Real>(parts);
    sum.point = sum.weight > 0 ? Point<Size>(sum.point / sum.weight) : Point<Size>::Constant(0.5);
    return sum;
}

/// Asks only what of a shape is near, where it can tell.
template <int Dim, int Size, class Wall>
Opening<Size> halved_nearby(const Piece<Dim, Size>& piece, Probe<Dim, Wall>& wall,
                            const Subdivision& rule) noexcept {
    if constexpr (requires(const Wall& w, const Point<Dim>& x) { w.nearby(x, Real{}); }) {
        const auto few = wall.shape().nearby(piece.at(Point<Size>::Constant(0.5)), piece.half_diagonal());
        Probe<Dim, std::remove_const_t<decltype(few)>> probe(few);
        const Opening<Size> open = halved(piece, probe, rule);
        wall.join(probe.failure());
        return open;
    } else {
        return halved(piece, wall, rule);
    }
}

}  // namespace abrade::detail
