#pragma once
// Water in a tank that is moved to and fro: what a force of a changing direction does to a surface.

#include "reference_table.hpp"

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

namespace sloshing {

using namespace abrade;

constexpr Real gravity = 9.81;  ///< [m/s2]

/// Small waves of a tank that is pushed by b cos(W t), from rest. Of the force's x - L/2 the first mode
/// cos(k x), k = pi / L, has c = -4 L / pi^2, so
///   q'' + w^2 q = w^2 c b cos(W t) / g,   q = w^2 c b / g (cos(W t) - cos(w t)) / (w^2 - W^2),
/// w^2 = g k tanh(k h): linear theory of potential flow.
struct SmallSway {
    Real length = 1, depth = 0.5;  ///< L, h [m]
    Real push = 0.05;              ///< b [m/s2]
    Real pace = 0.7;               ///< W over w [-]

    Real number() const { return pi / length; }  ///< k [1/m]
    Real frequency() const { return std::sqrt(gravity * number() * std::tanh(number() * depth)); }  ///< w
    Real amplitude(Real t) const {                                                                  ///< q [m]
        const Real w = frequency(), c = -4 * length / square(pi);
        return c * push / gravity * (std::cos(pace * w * t) - std::cos(w * t)) / (1 - square(pace));
    }
    /// `n` cells along the tank.
    GridFluid<2> tank(int n) const {
        const Real h = length / n, turns = pace * frequency(), b = push;
        return GridFluid<2>(
            {.grid = {.cells = {n, static_cast<int>(1.2 * depth / h)}, .spacing = {h, h}},
             .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
             .water = [*this](const Point<2>& x) { return depth - x[1]; },
             .gravity = {0, -gravity},
             .body_force = [b, turns](Real t) { return Point<2>(b * std::cos(turns * t), 0); },
             .viscosity = 0});
    }
    Real amplitude_of(const GridFluid<2>& flow) const {  ///< of the mode as the surface stands [m]
        const Grid<2>& grid = flow.grid();
        Real sum = 0;
        for (int i = 0; i < grid.cells(0); ++i) {
            const Real x = grid.centre(0, i);
            sum += 2 * flow.surface_at({x, 0}) * std::cos(number() * x) / grid.cells(0);
        }
        return sum;
    }
};

/// A shallow tank that sways far: B. Bouscasse et al. 2013, doi 10.1515/ijnsns-2012-0100, series 5. The tank
/// is at A sin(W t); what is looked at is the surface 0.05 m from its left wall.
struct WideSway {
    Real length = 1, depth = 0.03;  ///< L, h [m]
    Real way = 2.333 * 0.03;        ///< A [m]
    Real pace = 1.231;              ///< W over that of the first mode [-]
    Real probe = 0.05;              ///< [m]
    Real roof = 0.5;                ///< the box's height [m]

    Real frequency() const {  ///< W [rad/s]
        const Real k = pi / length;
        return pace * std::sqrt(gravity * k * std::tanh(k * depth));
    }
    Real period() const { return 2 * pi / frequency(); }  ///< T [s]

    /// `n` cells to the depth. Water at rest, which the tank begins to pass by.
    GridFluidParams<2> params(int n) const {
        const Real h = depth / n, turns = frequency(), a = way * square(turns), passes = -way * turns;
        GridFluidParams<2> p;
        p.grid = {.cells = {static_cast<int>(std::lround(length / h)), static_cast<int>(std::ceil(roof / h))},
                  .spacing = {length / std::round(length / h), h}};
        p.boundaries = BoundaryConditions<2>::all(Boundary::free_slip);
        p.water = [d = depth](const Point<2>& x) { return d - x[1]; };
        p.velocity = [passes](const Point<2>&) { return Point<2>(passes, 0); };
        p.gravity = {0, -gravity};
        p.body_force = [a, turns](Real t) { return Point<2>(a * std::sin(turns * t), 0); };
        p.viscosity = 1e-3;
        return p;
    }
};

struct Elevation {
    Real time = 0, height = 0;  ///< t / T [-], above still water [m]
};

/// What the probe sees from one time [T] to another.
inline std::vector<Elevation> run(const WideSway& sway, GridFluid<2>& flow, Real from, Real to) {
    std::vector<Elevation> seen;
    flow.advance(from * sway.period());
    while (flow.time() < to * sway.period()) {
        flow.step(flow.stable_step().seconds);
        seen.push_back({flow.time() / sway.period(), flow.surface_at({sway.probe, 0}) - sway.depth});
    }
    return seen;
}

inline std::vector<Elevation> measured() {
    std::vector<Elevation> found;
    for (const ReferenceRow& row : reference_table("flu14_sloshing_bouscasse2013_series5.csv"))
        found.push_back({row.at("t_over_T"), row.at("elevation_m")});
    return found;
}

/// Means over crests. Each bore breaks in its own way, so crests differ by more than the measured ones do:
/// the longer the computed while, the better their mean is known.
struct Found {
    Real crest = 0;  ///< computed height over measured [-]
    Real late = 0;   ///< by how much the computed front comes later [T]
};

struct Crests {
    Real height = 0, arrival = 0;  ///< means [m]; [T] after the beginning of their period
};
inline Crests crests(const std::vector<Elevation>& series) {
    Crests mean;
    int count = 0;
    // The measured series ends soon after its last crest.
    for (Real from = 8.55; from + 0.4 < series.back().time; from += 1, ++count) {
        Real highest = 0, arrival = -1;
        for (const Elevation& e : series) {
            if (e.time < from || e.time >= from + 0.7) continue;
            highest = std::max(highest, e.height);
            // When the surface first stands 0.02 m above still water: the front is steep there.
            if (arrival < 0 && e.height > 0.02) arrival = e.time - from;
        }
        REQUIRE(arrival >= 0);
        mean.height += highest, mean.arrival += arrival;
    }
    return {mean.height / count, mean.arrival / count};
}

inline Found compare(const std::vector<Elevation>& here) {
    const Crests computed = crests(here), known = crests(measured());
    const Found found{computed.height / known.height, computed.arrival - known.arrival};
    MESSAGE("crests over the measured ones: " << found.crest << "; fronts later by " << found.late << " T");
    return found;
}

}  // namespace sloshing
