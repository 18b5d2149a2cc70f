#pragma once
// Closed solutions of depth-averaged water, and the runs that are held against them. Tests and charts share
// them.

#include <abrade/fluid/shallow_water/shallow_water.hpp>

#include <cmath>
#include <functional>
#include <vector>

namespace shallow {

using namespace abrade;

/// Depth and speed at a place [m], [m/s].
struct Column {
    Real x = 0, depth = 0, speed = 0;
};

template <int Dim>
std::vector<Column> points_of(const ShallowWater<Dim>& water, Index row = 0) {
    std::vector<Column> points;
    for (Index i = 0; i < water.grid().count(0); ++i)
        points.push_back({water.grid().centre(0, i), water.depth(i, row), water.speed(0, i, row)});
    return points;
}

/// A dam at x = 0 breaks at t = 0, water of `left` and `right` [m] behind and before it; gravity [m/s2].
struct DamBreak {
    Real left = 1, right = 0, gravity = 9.81;

    /// State between the rarefaction and the shock, and the shock's speed: J. J. Stoker, Water Waves
    /// (1957), 10.8.
    struct Middle {
        Real depth = 0, speed = 0, shock = 0;
    };
    Middle middle() const {
        const Real c = std::sqrt(gravity * left);
        Real low = right, high = left;
        for (int n = 0; n < 200; ++n) {
            const Real h = 0.5 * (low + high);
            const Real behind = 2 * (c - std::sqrt(gravity * h));
            const Real before = (h - right) * std::sqrt(0.5 * gravity * (h + right) / (h * right));
            (behind > before ? low : high) = h;
        }
        const Real h = 0.5 * (low + high), u = 2 * (c - std::sqrt(gravity * h));
        return {h, u, h * u / (h - right)};
    }

    /// A. Ritter, Z. Ver. Dtsch. Ing. 36 (1892) 947 where the bed is dry, else Stoker.
    Column at(Real x, Real t) const {
        const Real c = std::sqrt(gravity * left), way = x / t;
        const auto fan = [&] { return Column{x, square(2 * c - way) / (9 * gravity), 2.0 / 3 * (c + way)}; };
        if (way <= -c) return {x, left, 0};
        if (right <= 0) return way < 2 * c ? fan() : Column{x, 0, 0};
        const Middle m = middle();
        if (way < m.speed - std::sqrt(gravity * m.depth)) return fan();
        return way < m.shock ? Column{x, m.depth, m.speed} : Column{x, right, 0};
    }

    ShallowWater<1> water(Index cells, Real half_length) const {
        return ShallowWater<1>{{.low = {-half_length},
                                .high = {half_length},
                                .cells = {cells},
                                .boundaries = {{{ShallowBoundary::outflow(), ShallowBoundary::outflow()}}},
                                .surface = [*this](Real x, Real) { return x < 0 ? left : right; },
                                .gravity = {0, 0, -gravity}}};
    }
};

/// Water that sloshes in a parabolic bowl z = h_0 (x^2 + y^2)/a^2 with a plane surface, its shore running up
/// and down the dry bed: W. C. Thacker, J. Fluid Mech. 107 (1981) 499, doi:10.1017/S0022112081001882. In one
/// dimension the surface swings, in two it goes round.
struct Bowl {
    Real depth = 0.1, radius = 1, swing = 0.5, gravity = 9.81;  ///< h_0, a [m], of the middle of the lake [m]

    Real frequency() const { return std::sqrt(2 * gravity * depth) / radius; }  ///< [rad/s]
    Real period() const { return 2 * pi / frequency(); }
    Real bed(Real x, Real y) const { return depth * (x * x + y * y) / square(radius); }
    /// The surface is the plane of a lake whose middle stands at (swing cos wt, swing sin wt).
    Real surface(Real x, Real y, Real t, bool round) const {
        const Real mx = swing * std::cos(frequency() * t), my = round ? swing * std::sin(frequency() * t) : 0;
        return depth + depth / square(radius) * (2 * (x * mx + y * my) - (mx * mx + my * my));
    }
    std::array<Real, 2> speed(Real t, bool round) const {
        const Real w = frequency();
        return {-swing * w * std::sin(w * t), round ? swing * w * std::cos(w * t) : 0};
    }

    ShallowWater<1> line(Index cells, Real courant = 0.5) const {
        return ShallowWater<1>{{.low = {-2},
                                .high = {2},
                                .cells = {cells},
                                .bed = [*this](Real x, Real) { return bed(x, 0); },
                                .surface = [*this](Real x, Real) { return surface(x, 0, 0, false); },
                                .gravity = {0, 0, -gravity},
                                .courant = courant}};
    }
    ShallowWater<2> plane(Index cells) const {
        return ShallowWater<2>{{.low = {-2, -2},
                                .high = {2, 2},
                                .cells = {cells, cells},
                                .bed = [*this](Real x, Real y) { return bed(x, y); },
                                .surface = [*this](Real x, Real y) { return surface(x, y, 0, true); },
                                .speed = {PlaneFunction([*this](Real, Real) { return speed(0, true)[0]; }),
                                          PlaneFunction([*this](Real, Real) { return speed(0, true)[1]; })},
                                .gravity = {0, 0, -gravity}}};
    }
    /// Mean error of depth over its greatest depth, over cells that are or should be wet [-].
    template <int Dim>
    Real error(const ShallowWater<Dim>& water) const {
        Real sum = 0;
        Index counted = 0;
        for (Index j = 0; j < water.grid().count(1); ++j)
            for (Index i = 0; i < water.grid().count(0); ++i) {
                const Real x = water.grid().centre(0, i), y = Dim == 2 ? water.grid().centre(1, j) : 0;
                const Real exact = std::max(0.0, surface(x, y, water.time(), Dim == 2) - bed(x, y));
                const Real h = water.depth(i, j);
                if (exact > 0 || h > water.params().dry_depth) sum += std::abs(h - exact), ++counted;
            }
        return sum / counted / depth;
    }
};

/// A simple wave: u - 2 c is the same everywhere, so u + c stays what it is along lines of that speed, until
/// they meet. Periodic over 1 m. Exact: c(x, t) solves c = c_0(x - (3 c - 2 c_mean) t).
struct SimpleWave {
    Real mean = 1, height = 0.1, gravity = 1;  ///< of c: mean and amplitude [m/s]

    Real start(Real x) const { return mean + height * std::sin(2 * pi * x); }
    Real breaks() const { return 1 / (3 * height * 2 * pi); }  ///< [s]
    /// c at x and t, by Newton's method from that of the start.
    Real at(Real x, Real t) const {
        Real c = start(x - mean * t);
        for (int n = 0; n < 100; ++n) {
            const Real from = x - (3 * c - 2 * mean) * t;
            const Real slope = 1 + 3 * t * height * 2 * pi * std::cos(2 * pi * from);
            c -= (c - start(from)) / slope;
        }
        return c;
    }
    Real depth(Real x, Real t) const { return square(at(x, t)) / gravity; }
    /// Of a cell, by Gauss-Legendre: averages and values at the middle differ by second order.
    Real cell_depth(Real low, Real size, Real t) const {
        constexpr std::array<Real, 3> place{-0.7745966692414834, 0, 0.7745966692414834}, weight{5, 8, 5};
        Real sum = 0;
        for (std::size_t n = 0; n < 3; ++n)
            sum += weight[n] / 18 * depth(low + 0.5 * size * (1 + place[n]), t);
        return sum;
    }
    /// The wave along x, or along y of a plane.
    ShallowWater<1> line(Index cells, Real courant = 0.5) const {
        const Real dx = 1.0 / cells;
        return ShallowWater<1>{
            {.low = {0},
             .high = {1},
             .cells = {cells},
             .boundaries = {{{ShallowBoundary::periodic(), ShallowBoundary::periodic()}}},
             .surface = [*this, dx](Real x, Real) { return cell_depth(x - 0.5 * dx, dx, 0); },
             .speed = {PlaneFunction([*this](Real x, Real) { return 2 * (start(x) - mean); })},
             .gravity = {0, 0, -gravity},
             .courant = courant}};
    }
    /// Mean error of depth [m].
    Real error(const ShallowWater<1>& water) const {
        const Real dx = water.grid().spacing(0);
        Real sum = 0;
        for (Index i = 0; i < water.grid().count(0); ++i)
            sum += dx * std::abs(water.depth(i) - cell_depth(i * dx, dx, water.time()));
        return sum;
    }
};

/// Order of accuracy between two runs: errors at n and at 2 n cells.
inline Real order(Real coarse, Real fine) { return std::log2(coarse / fine); }

/// A hydraulic jump: water of depth 1 m at a Froude number meets deeper water. g = 1, so c = 1 m/s before it.
struct Jump {
    Real froude = 2;

    /// Depth behind over depth before: J. B. Belanger, Notes sur l'hydraulique (1841).
    Real sequent() const { return 0.5 * (std::sqrt(1 + 8 * square(froude)) - 1); }

    /// In the frame of the water behind it: a stream runs against a wall, and the jump runs back into it.
    /// Behind it water rests, so the stream's speed is F (1 - 1/y) where the jump runs at F/y.
    ShallowWater<1> bore(Index cells) const {
        const Real speed = froude * (1 - 1 / sequent());
        return ShallowWater<1>{
            {.low = {0},
             .high = {40},
             .cells = {cells},
             .boundaries = {{{ShallowBoundary::inflow(speed, 1), ShallowBoundary::wall()}}},
             .surface = [](Real, Real) { return 1.0; },
             .speed = {PlaneFunction([speed](Real, Real) { return speed; })},
             .gravity = {0, 0, -1}}};
    }

    /// On a rough bed, before a weir: friction slows the stream down, so there is one place where the jump
    /// can stand.
    static constexpr Real length = 60, weir_at = 45, weir_width = 4;
    ShallowWater<1> standing(Index cells, Real weir) const {
        return ShallowWater<1>{
            {.low = {0},
             .high = {length},
             .cells = {cells},
             .boundaries = {{{ShallowBoundary::inflow(froude, 1), ShallowBoundary::outflow()}}},
             .bed =
                 [weir](Real x, Real) {
                     const Real way = (x - weir_at) / weir_width;
                     return std::abs(way) < 1 ? weir * square(1 - square(way)) : 0.0;
                 },
             .surface = [this](Real x, Real) { return x < 20        ? 1.0
                                                      : x < weir_at ? sequent()
                                                                    : 0.5; },
             .speed = {PlaneFunction([this](Real x, Real) { return x < 20 ? froude : froude / sequent(); })},
             .gravity = {0, 0, -1},
             .manning = 0.04}};
    }
};

}  // namespace shallow
