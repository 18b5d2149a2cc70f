#pragma once
// Stokes flow through a periodic simple cubic array of fixed spheres: the drag on one of them.

#include "../coupling/resolved_bodies.hpp"
#include "reference_table.hpp"

#include <array>
#include <memory>

namespace sphere_array {

using namespace resolved;

struct Array {
    Real solid_fraction = 0.064;
    Real cells = 8;              ///< to a diameter, nearly: the period holds a whole number of cells
    Vec3 off = {0.3, 0.1, 0.2};  ///< of the sphere's centre from a corner of cells [cell]
};
struct ArrayDrag {
    Real factor = 0;    ///< F / (6 pi mu a U), F the mean pressure gradient times the period's volume [-]
    Real cells = 0;     ///< to a diameter
    Real unsteady = 0;  ///< change of `factor` in the last tenth of the run, over it [-]
    Real lost = 0;      ///< of what drives the water, without what the sphere got, over it [-]
};

/// A body force drives the water, at each step as strongly as the sphere held it back in the last: so the
/// flow keeps its discharge while its shape becomes steady. Diameter 1, kinematic viscosity 1, Re 0.1.
inline ArrayDrag drag_in(const Array& array) {
    const Real period = std::cbrt(pi / 6 / array.solid_fraction);
    const int n = static_cast<int>(std::round(array.cells * period));
    const Real h = period / n, speed = 0.1, volume = cube(period),
               of_water = (1 - array.solid_fraction) * volume;
    const auto force = std::make_shared<Real>(0);
    Water water({.grid = {.cells = {n, n, n}, .spacing = Vec3::Constant(h)},
                 .boundaries = BoundaryConditions<3>::all(Boundary::periodic),
                 .velocity = [&](const Vec3&) { return Vec3(speed, 0, 0); },
                 .body_force = [force](Real) { return Vec3(*force, 0, 0); },
                 .density = 1,
                 .viscosity = 1,
                 .courant = 1,
                 .tolerance = 1e-8},
                {}, MonolithicSolids<>({.resolved_from = 0}));
    std::vector<Ball> balls{{Vec3::Constant((n / 2) * h) + h * array.off, 0.5, 0}};
    const auto superficial = [&] {  // the sphere is at rest: what it covers of a face passes nothing
        Real sum = 0;
        water.grid().for_each([&](const auto&, Offset c) { sum += water.velocity()[0][c]; });
        for (const SolidFace& f : water.solids().covers()[0].faces)
            if (f.axis == 0) sum -= f.share * water.velocity()[0][f.face];
        return sum / cube(n);
    };
    const Real end = 0.25 * square(period);  // ten times the slowest mode's period^2 / (4 pi^2 nu)
    ArrayDrag drag{.cells = 1 / h};
    Real before = 0;
    const auto factor = [&] { return *force * volume / (3 * pi * superficial()); };
    while (water.time() < end) {
        step(water, balls, water.stable_step().seconds);
        const Real held = balls[0].body.load.force.x() / of_water;
        if (before == 0 && water.time() > 0.9 * end) before = factor();
        drag.lost = *force / held - 1;
        *force = held;
    }
    drag.factor = factor(), drag.unsteady = drag.factor / before - 1;
    return drag;
}

/// Sangani & Acrivos 1982, doi:10.1016/0301-9322(82)90029-5, as the table's source has it.
inline Real exact_factor(Real c) {
    return 1 / (1 - 1.7601 * std::cbrt(c) + c - 1.5593 * square(c) + 3.9799 * std::pow(c, 8.0 / 3) -
                3.0734 * std::pow(c, 10.0 / 3));
}

/// By how much smaller a sphere would have the drag that was found [its radius].
inline Real lacking_radius(Real solid_fraction, Real factor) {
    Real low = 0.3, high = 1.2;
    for (int k = 0; k < 60; ++k) {
        const Real radius = 0.5 * (low + high);
        (radius * exact_factor(cube(radius) * solid_fraction) < factor ? low : high) = radius;
    }
    return 1 - low;
}

/// Over places on the grid.
struct Deviation {
    Real least = 1e9, mean = 0, most = -1e9;  ///< of the factor from the exact one, over that [-]
    Real lacks = 0;                           ///< of the radius, mean [cell]
    Real cells = 0;                           ///< to a diameter
};
inline Deviation deviation_of(Real solid_fraction, Real cells) {
    const std::array places{Vec3(0, 0, 0), Vec3(0.3, 0.1, 0.2), Vec3(0.5, 0.5, 0.5)};
    Deviation sum;
    for (const Vec3& off : places) {
        const ArrayDrag drag = drag_in({solid_fraction, cells, off});
        const Real deviates = drag.factor / exact_factor(solid_fraction) - 1, share = 1.0 / places.size();
        sum.least = std::min(sum.least, deviates), sum.most = std::max(sum.most, deviates);
        sum.mean += share * deviates, sum.cells = drag.cells;
        sum.lacks += share * 0.5 * drag.cells * lacking_radius(solid_fraction, drag.factor);
    }
    return sum;
}

}  // namespace sphere_array
