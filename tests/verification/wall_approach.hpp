#pragma once
// A sphere that goes slowly towards a wall: its drag over that far from walls, H. Brenner 1961,
// doi:10.1016/0009-2509(61)80035-3.

#include "../coupling/resolved_bodies.hpp"
#include "reference_table.hpp"

#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/dem/laws/lubrication.hpp>

namespace wall_approach {

using namespace resolved;

struct Approach {
    Real gap = 1;           ///< between sphere and wall [radius]
    Real cells = 8;         ///< to a diameter
    Real box = 6;           ///< width and height [diameter]
    Vec3 off{0.3, 0.1, 0};  ///< of the sphere's centre from a corner of cells [cell]
    Real time = 1;          ///< after which it is steady [diameter^2 / nu]
};
struct ApproachDrag {
    Real factor = 0;    ///< F / (6 pi mu a U) [-]
    Real unsteady = 0;  ///< its change in the last tenth of the run, over it [-]
};

/// The sphere has the velocity of the approach and is held at its place: the flow becomes the steady one
/// there. Diameter 1, kinematic viscosity 1, Re 0.02.
inline ApproachDrag drag_in(const Approach& approach) {
    const Real h = 1 / approach.cells, speed = 0.02;
    const int n = static_cast<int>(std::round(approach.box * approach.cells));
    auto boundaries = BoundaryConditions<3>::all(Boundary::free_slip);
    boundaries[2][0] = Boundary::wall;
    Water water({.grid = {.cells = {n, n, n}, .spacing = Vec3::Constant(h)},
                 .boundaries = boundaries,
                 .density = 1,
                 .viscosity = 1,
                 .courant = 1,
                 .tolerance = 1e-9},
                {}, MonolithicSolids<>({.resolved_from = 0}));
    const Vec3 place = Vec3(0.5 * n * h, 0.5 * n * h, 0.5 * (1 + approach.gap)) + h * approach.off;
    const Sphere sphere{place, 0.5};
    FlowBody body{.position = place, .velocity = {0, 0, -speed}, .volume = pi / 6, .spheres = {&sphere, 1}};
    Real before = 0;
    while (water.time() < approach.time) {
        body.velocity = {0, 0, -speed};
        water.advance(water.time() + water.stable_step().seconds, {&body, 1});
        if (before == 0 && water.time() > 0.9 * approach.time) before = body.load.force.z();
    }
    return {body.load.force.z() / (3 * pi * speed), body.load.force.z() / before - 1};
}

/// What a film from a cell on adds to that factor.
inline Real film_at(Real gap, Real cells) {
    constexpr Real speed = 1e-6, radius = 0.5;
    const Lubricated<LinearSpring> film(
        {.contact = {.stiffness = 1}, .viscosity = 1, .range = 1 / cells, .roughness = 1e-4 * radius});
    ContactKinematics<Real> contact{};
    contact.normal = Vec3::UnitZ(), contact.overlap = -radius * gap, contact.curvature = 1 / radius;
    contact.velocity = {0, 0, -speed}, contact.inverse_mass = 1;
    return film.respond(contact, {}).load.force.z() / (6 * pi * radius * speed);
}

}  // namespace wall_approach
