#pragma once
// Waves on grid water with closed solutions: standing waves in tanks, a solitary wave, bores. Tests and
// charts share them.

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <cmath>
#include <vector>

namespace waves {

using namespace abrade;

constexpr Real gravity = 9.81;  ///< [m/s2]

/// Largest speed on a face of a cell that holds liquid [m/s].
template <class Flow>
Real fastest(const Flow& flow) {
    Real most = 0;
    flow.grid().for_each([&](const auto&, Offset c) {
        if (flow.liquid().fraction()[c] > 0)
            for (const auto& u : flow.velocity()) most = std::max(most, std::abs(u[c]));
    });
    return most;
}

/// To a time [s], by steps of `part` of the stable one.
template <class Flow>
void advance_by_parts(Flow& flow, Real end, Real part) {
    while (flow.time() < end) flow.step(std::min(part * flow.stable_step().seconds, end - flow.time()));
}

/// A wave that runs around in a box whose ends are one: eta = a cos(k x - omega t), omega^2 = g k tanh(k h),
///   u = a omega cosh(k z) / sinh(k h) cos(k x - omega t),  w = a omega sinh(k z) / sinh(k h) sin(k x - omega
///   t).
/// Without viscosity.
struct RunningWave {
    Real length = 1, depth = 0.3, amplitude = 0.005;  ///< L, h, a [m]

    Real number() const { return 2 * pi / length; }                                                 ///< k
    Real frequency() const { return std::sqrt(gravity * number() * std::tanh(number() * depth)); }  ///< omega

    /// `n` cells along it.
    GridFluid<2> box(int n) const {
        const Real h = length / n, k = number();
        GridFluidParams<2> params;
        params.grid = {.cells = {n, static_cast<int>(std::ceil((depth + 4 * amplitude) / h)) + 2},
                       .spacing = {h, h}};
        params.boundaries = BoundaryConditions<2>::all(Boundary::free_slip);
        params.boundaries[0] = {Boundary::periodic, Boundary::periodic};
        params.water = [*this, k](const Point<2>& x) {
            return depth + amplitude * std::cos(k * x[0]) - x[1];
        };
        params.velocity = [*this, k](const Point<2>& x) {
            const Real speed = amplitude * frequency() / std::sinh(k * depth), z = std::min(x[1], depth);
            return Point<2>(speed * std::cosh(k * z) * std::cos(k * x[0]),
                            speed * std::sinh(k * z) * std::sin(k * x[0]));
        };
        params.gravity = {0, -gravity};
        params.viscosity = 0;
        return GridFluid<2>(params);
    }

    struct Found {
        Real amplitude = 0, phase = 0;  ///< [m]; omega t, from -pi to pi
    };
    Found found_in(const GridFluid<2>& flow) const {
        Real c = 0, s = 0;
        const int n = flow.grid().cells(0);
        for (int i = 0; i < n; ++i) {
            const Real x = flow.grid().centre(0, i), eta = flow.surface_at({x, 0}) - depth;
            c += 2 * eta * std::cos(number() * x) / n, s += 2 * eta * std::sin(number() * x) / n;
        }
        return {std::hypot(c, s), std::atan2(s, c)};
    }
};

/// A wave that stands in a tank, eta = a cos(k x) cos(omega t), omega^2 = g k tanh(k h), k = n pi / L; in a
/// square tank eta = a cos(k x) cos(k y) cos(omega t), whose wave number is sqrt(2) k. Without viscosity.
struct StandingWave {
    Real length = 1, depth = 0.5;  ///< L, h [m]
    int mode = 1;                  ///< n
    Real amplitude = 0.01;         ///< a [m]
    Real largest_step = 0;         ///< [s]; 0: none

    Real number() const { return mode * pi / length; }  ///< k [1/m]
    Real frequency(int axes = 1) const {                ///< omega [rad/s]; waves along `axes` axes
        const Real k = std::sqrt(static_cast<Real>(axes)) * number();
        return std::sqrt(gravity * k * std::tanh(k * depth));
    }

    /// `n` cells along the tank; the surface begins raised, at rest.
    template <int Dim>
    GridFluid<Dim> tank(int n) const {
        const Real h = length / n;
        GridFluidParams<Dim> params;
        params.grid.cells.fill(n);
        params.grid.cells[Dim - 1] = static_cast<int>(std::ceil((depth + 4 * amplitude) / h)) + 2;
        params.grid.spacing = Point<Dim>::Constant(h);
        params.boundaries = BoundaryConditions<Dim>::all(Boundary::free_slip);
        params.water = [*this](const Point<Dim>& x) {
            return depth + amplitude * shape<Dim>(x) - x[Dim - 1];
        };
        params.gravity[Dim - 1] = -gravity;
        params.viscosity = 0;
        params.largest_step = largest_step;
        return GridFluid<Dim>(params);
    }

    /// Amplitude of the mode as the surface stands [m].
    template <int Dim>
    Real amplitude_of(const GridFluid<Dim>& flow) const {
        const Grid<Dim>& grid = flow.grid();
        Real sum = 0, squares = 0;
        Point<Dim> x = Point<Dim>::Zero();
        for (int i = 0; i < grid.cells(0); ++i)
            for (int j = 0; j < (Dim == 3 ? grid.cells(1) : 1); ++j) {
                x[0] = grid.centre(0, i);
                if constexpr (Dim == 3) x[1] = grid.centre(1, j);
                sum += flow.surface_at(x) * shape<Dim>(x), squares += square(shape<Dim>(x));
            }
        return sum / squares;
    }

private:
    template <int Dim>
    Real shape(const Point<Dim>& x) const {
        Real product = 1;
        for (int a = 0; a < Dim - 1; ++a) product *= std::cos(number() * x[a]);
        return product;
    }
};

/// What a swing tells.
struct Swing {
    Real frequency = 0;        ///< mean [rad/s]
    Real lost_per_period = 0;  ///< share of the energy, which goes as the amplitude squared [-]
};

/// Follows a standing wave over whole periods.
template <int Dim>
Swing swing(const StandingWave& wave, GridFluid<Dim>& flow, int periods) {
    std::vector<Real> crossings, peaks;
    Real t0 = 0, t1 = flow.time(), a0 = 0, a1 = wave.amplitude_of(flow);
    peaks.push_back(std::abs(a1));
    while (static_cast<int>(crossings.size()) < 2 * periods + 1) {
        flow.step(flow.stable_step().seconds);
        const Real t2 = flow.time(), a2 = wave.amplitude_of(flow);
        if (a1 * a2 < 0) crossings.push_back(t1 + (t2 - t1) * a1 / (a1 - a2));
        if (std::abs(a1) > std::abs(a0) && std::abs(a1) > std::abs(a2) && t1 > t0 && t0 > 0) {
            // The top of the parabola through the last three.
            const Real left = (a0 - a1) / (t0 - t1), right = (a2 - a1) / (t2 - t1);
            const Real curvature = (right - left) / (t2 - t0);
            const Real slope = right - curvature * (t2 - t1);
            peaks.push_back(std::abs(a1 - square(slope) / (4 * curvature)));
        }
        t0 = t1, a0 = a1, t1 = t2, a1 = a2;
    }
    const auto halves = static_cast<Real>(peaks.size() - 1);
    return {
        .frequency = pi * (static_cast<Real>(crossings.size()) - 1) / (crossings.back() - crossings.front()),
        .lost_per_period = 1 - std::pow(peaks.back() / peaks.front(), 4 / halves)};
}

/// A wave that stays as it is while it runs: R. Grimshaw's third order, J. Fluid Mech. 46 (1971) 611, doi
/// 10.1017/S0022112071000739. With e = a/h, s = sech(q X), t = tanh(q X), q = sqrt(3 e / 4) (1 - 5 e / 8 +
/// 71 e^2 / 128), X and z from the crest and the bed in depths:
///   eta / h = e s^2 - 3/4 e^2 s^2 t^2 + e^3 (5/8 s^2 t^2 - 101/80 s^4 t^2),
///   c^2 / (g h) = 1 + e - e^2 / 20 - 3 e^3 / 70.
struct SolitaryWave {
    Real depth = 1, height = 0.2;  ///< h, a [m]
    Real start = 11, end = 45;     ///< where the crest begins; the channel's length [depth]

    Real speed() const {  ///< [m/s]
        const Real e = height / depth;
        return std::sqrt(gravity * depth * (1 + e - e * e / 20 - 3 * e * e * e / 70));
    }
    Real elevation(Real x) const {  ///< above still water [m]
        const Real e = height / depth, t = std::tanh(scaled(x)), s2 = 1 - t * t, t2 = t * t;
        return depth *
               (e * s2 - 0.75 * e * e * s2 * t2 + e * e * e * (0.625 * s2 * t2 - 101.0 / 80 * s2 * s2 * t2));
    }
    Point<2> velocity(const Point<2>& x) const {  ///< [m/s]
        const Real e = height / depth, t = std::tanh(scaled(x[0])), s2 = 1 - t * t, s4 = s2 * s2,
                   s6 = s2 * s4;
        const Real z = x[1] / depth, z2 = z * z, z4 = z2 * z2, wave = std::sqrt(gravity * depth);
        const Real along =
            e * s2 - e * e * (-0.25 * s2 + s4 + z2 * (1.5 * s2 - 2.25 * s4)) -
            e * e * e *
                (19.0 / 40 * s2 + 0.2 * s4 - 1.2 * s6 + z2 * (-1.5 * s2 - 3.75 * s4 + 7.5 * s6) +
                 z4 * (-3.0 / 8 * s2 + 45.0 / 16 * s4 - 45.0 / 16 * s6));
        const Real up = e * s2 - e * e * (3.0 / 8 * s2 + 2 * s4 + z2 * (0.5 * s2 - 1.5 * s4)) -
                        e * e * e *
                            (49.0 / 640 * s2 - 17.0 / 20 * s4 - 18.0 / 5 * s6 +
                             z2 * (-13.0 / 16 * s2 - 25.0 / 16 * s4 + 7.5 * s6) +
                             z4 * (-3.0 / 40 * s2 + 9.0 / 8 * s4 - 27.0 / 16 * s6));
        return {wave * along, wave * std::sqrt(3 * e) * z * t * up};
    }

    /// `n` cells to the depth.
    GridFluid<2> channel(int n) const {
        const Real h = depth / n;
        const int levels = static_cast<int>(std::ceil((depth + 1.5 * height) / h)) + 2;
        return GridFluid<2>({.grid = {.cells = {static_cast<int>(end) * n, levels}, .spacing = {h, h}},
                             .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                             .water = [*this](const Point<2>& x) { return depth + elevation(x[0]) - x[1]; },
                             .velocity = [*this](const Point<2>& x) { return velocity(x); },
                             .gravity = {0, -gravity},
                             .viscosity = 0});
    }

private:
    Real scaled(Real x) const {
        const Real e = height / depth;
        return std::sqrt(0.75 * e) * (1 - 0.625 * e + 71.0 / 128 * e * e) * (x / depth - start);
    }
};

/// The top of the surface, by the parabola through the three highest columns; its place by what stands higher
/// than half of it above `level`, whose squares are the weights: a flat crest has no sharp place of its own.
struct Crest {
    Real place = 0, height = 0;  ///< [m], the height above `level`
};
inline Crest crest(const GridFluid<2>& flow, Real level) {
    const Grid<2>& grid = flow.grid();
    const auto above = [&](int i) { return flow.surface_at({grid.centre(0, i), 0}) - level; };
    int top = 1;
    for (int i = 1; i + 1 < grid.cells(0); ++i)
        if (above(i) > above(top)) top = i;
    const Real slope = 0.5 * (above(top + 1) - above(top - 1));
    const Real curvature = above(top + 1) - 2 * above(top) + above(top - 1);
    const Real share = curvature < 0 ? std::clamp(-slope / curvature, -1.0, 1.0) : 0;
    Real moment = 0, weights = 0;
    for (int i = 0; i < grid.cells(0); ++i)
        if (const Real z = above(i); z > 0.5 * above(top))
            moment += z * z * grid.centre(0, i), weights += z * z;
    return {moment / weights, above(top) + 0.5 * slope * share};
}

/// Kinetic energy and that of the surface against water at rest of the same volume [J/m].
inline Real wave_energy(const GridFluid<2>& flow) {
    const Grid<2>& grid = flow.grid();
    Real mean = 0, squares = 0;
    for (int i = 0; i < grid.cells(0); ++i) {
        const Real z = flow.surface_at({grid.centre(0, i), 0});
        mean += z / grid.cells(0), squares += z * z / grid.cells(0);
    }
    const Real length = grid.high(0) - grid.low(0);
    return flow.kinetic_energy() + 0.5 * flow.params().density * gravity * length * (squares - mean * mean);
}

/// A stream of depth h runs against a wall and a jump runs back into it: J. B. Belanger, Notes sur
/// l'hydraulique (1841), h_2 / h_1 = y = (sqrt(1 + 8 F^2) - 1) / 2. Behind it water rests where the stream
/// comes with c F (1 - 1/y), c = sqrt(g h); the jump runs at c F / y.
struct Bore {
    Real depth = 0.1, froude = 2;  ///< [m], [-]

    Real sequent() const { return 0.5 * (std::sqrt(1 + 8 * square(froude)) - 1); }
    Real wave() const { return std::sqrt(gravity * depth); }
    Real stream() const { return wave() * froude * (1 - 1 / sequent()); }
    Real speed() const { return wave() * froude / sequent(); }

    /// `n` cells to the stream's depth, a channel of `length` depths.
    GridFluid<2> channel(int n, int length) const {
        const Real h = depth / n;
        const int levels = static_cast<int>(std::ceil(3 * sequent() * n));
        BoundaryConditions<2> boundaries = BoundaryConditions<2>::all(Boundary::free_slip);
        boundaries[0][0] = Boundary::inflow;
        const Real enters = stream();
        const auto below = [*this](const Point<2>& x) { return depth - x[1]; };
        return GridFluid<2>(
            {.grid = {.cells = {length * n, levels}, .spacing = {h, h}},
             .boundaries = boundaries,
             .boundary_velocity = [enters](const Point<2>&, Real) { return Point<2>(enters, 0); },
             .water = below,
             .inflow_water = below,
             .velocity = [enters](const Point<2>&) { return Point<2>(enters, 0); },
             .gravity = {0, -gravity}});
    }
    /// Where the surface first comes half way up, from the inlet [m].
    Real front(const GridFluid<2>& flow) const {
        const Grid<2>& grid = flow.grid();
        const Real half = 0.5 * (1 + sequent()) * depth;
        for (int i = 0; i < grid.cells(0); ++i)
            if (flow.surface_at({grid.centre(0, i), 0}) > half) return grid.centre(0, i);
        return grid.high(0);
    }
    /// Mean depth from a place to the wall [m].
    static Real behind(const GridFluid<2>& flow, Real from) {
        const Grid<2>& grid = flow.grid();
        Real sum = 0;
        int counted = 0;
        for (int i = 0; i < grid.cells(0); ++i)
            if (grid.centre(0, i) >= from) sum += flow.surface_at({grid.centre(0, i), 0}), ++counted;
        return sum / counted;
    }

    struct Found {
        /// Over Belanger's; the speed from half way to the end. The roller's toe runs to and fro by half a
        /// depth, so the speed is known to a tenth or so.
        Real depth = 0, speed = 0;
    };
    /// `n` cells to the stream's depth; until the jump has gone `way` of the depths behind it. Its roller,
    /// five such depths long, is not counted.
    Found run(int n, int way) const {
        const Real unit = sequent() * depth;
        GridFluid<2> flow = channel(n, static_cast<int>(std::ceil((way + 3) * sequent())));
        flow.advance(0.5 * way * unit / speed());
        const Real time = flow.time(), place = front(flow);
        flow.advance(way * unit / speed());
        return {behind(flow, front(flow) + 5 * unit) / unit,
                (place - front(flow)) / (flow.time() - time) / speed()};
    }
};

/// A dam at the middle of a channel breaks: water of two depths, J. J. Stoker, Water Waves (1957), 10.8.
struct DamBreak {
    Real left = 1, right = 0.1;  ///< [m]

    /// `n` cells to the left depth.
    GridFluid<2> channel(int n, int length) const {
        const Real h = left / n, middle = 0.5 * length;
        return GridFluid<2>(
            {.grid = {.cells = {length * n, 5 * n / 4}, .spacing = {h, h}},
             .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
             .water = [*this,
                       middle](const Point<2>& x) { return x[0] < middle ? left - x[1] : right - x[1]; },
             .gravity = {0, -gravity}});
    }
};

}  // namespace waves
