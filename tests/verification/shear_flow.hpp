#pragma once
// A body that is as heavy as the water turns in a slow shear between two walls: G. Jeffery 1922,
// doi:10.1098/rspa.1922.0078.

#include "../coupling/resolved_bodies.hpp"
#include "reference_table.hpp"

#include <Eigen/Geometry>

namespace shear_flow {

using namespace resolved;

/// A prolate spheroid as a union of the largest spheres that it holds along its axis: the envelope of all
/// of them is the spheroid itself.
struct Spheroid {
    Real aspect = 2;         ///< long over short axis; 1: a sphere
    Real half_length = 0.5;  ///< long semi-axis [m]
    Vec3 axis = Vec3::UnitX();

    Real half_width() const noexcept { return half_length / aspect; }
    Real volume() const noexcept { return 4 * pi / 3 * half_length * square(half_width()); }
    std::vector<Sphere> spheres(const Vec3& centre) const {
        if (aspect == 1) return {{centre, half_length}};
        constexpr int count = 41;
        const Real a = half_length, b = half_width(),
                   last = a - square(b) / a;  // the ends' circles of curvature
        std::vector<Sphere> all;
        for (int k = 0; k < count; ++k) {
            const Real s = last * (2.0 * k / (count - 1) - 1);
            all.push_back({centre + s * axis, b * std::sqrt(1 - square(s) / (square(a) - square(b)))});
        }
        return all;
    }
    Mat3 inverse_inertia(Real density) const {
        const Real mass = density * volume(), along = 0.4 * square(half_width()),
                   across = 0.2 * (square(half_length) + square(half_width()));
        const Mat3 ends = axis * axis.transpose();
        return (ends / along + (Mat3::Identity() - ends) / across) / mass;
    }
};

/// Shear u = G z between two walls, periodic else. The body's length, density and nu are 1.
struct Shear {
    Real cells = 8;           ///< to the body's length
    Real box = 5, width = 3;  ///< between the walls and along them [length of the body]
    Real rate = 0.2;          ///< G; G a^2 / nu is a quarter of it [1/s]
    Vec3 off{0.3, 0.1, 0.2};  ///< of the body's centre from a corner of cells [cell]

    Vec3 place() const { return Vec3(0.5 * width, 0.5 * width, 0.5 * box) + off / cells; }
    Water water() const {
        const int up = static_cast<int>(std::round(box * cells));
        const int n = static_cast<int>(std::round(width * cells));
        auto boundaries = BoundaryConditions<3>::all(Boundary::periodic);
        boundaries[2] = {Boundary::wall, Boundary::wall};
        const auto shear = [g = rate, zero = place().z()](const Vec3& x) {
            return Vec3(g * (x.z() - zero), 0, 0);
        };
        return Water({.grid = {.cells = {n, n, up}, .spacing = Vec3::Constant(1 / cells)},
                      .boundaries = boundaries,
                      .boundary_velocity = [shear](const Vec3& x, Real) { return shear(x); },
                      .velocity = shear,
                      .density = 1,
                      .viscosity = 1,
                      .courant = 1,
                      .tolerance = 1e-8},
                     {}, MonolithicSolids<>({.resolved_from = 0}));
    }
};

/// A body as heavy as the water, free to turn.
struct Turning {
    Spheroid spheroid;
    Water water;
    std::vector<Sphere> spheres{};
    FlowBody body{};

    Turning(const Spheroid& shape, const Shear& shear) : spheroid(shape), water(shear.water()) {
        body.position = shear.place(), body.volume = shape.volume(), body.inverse_mass = 1 / shape.volume();
        body.angular_velocity = {0, 0.5 * shear.rate, 0};
    }
    /// One step; a `held` body takes up its spin and stays as it lies.
    void step(bool held) {
        const Real dt = water.stable_step().seconds;
        body.inverse_inertia = spheroid.inverse_inertia(1);
        body.velocity += dt * body.inverse_mass * body.load.force;
        body.angular_velocity += dt * body.inverse_inertia * body.load.torque;
        if (!held) {
            body.position += dt * body.velocity;
            const Real angle = dt * body.angular_velocity.norm();
            spheroid.axis = Eigen::AngleAxis<Real>(angle, body.angular_velocity.normalized()) * spheroid.axis;
        }
        spheres = spheroid.spheres(body.position);
        body.spheres = spheres;
        water.advance(water.time() + dt, {&body, 1});
        body.load.added_mass = 0, body.load.shared.setZero();  // what holds it holds the body alone
        if (held) body.velocity.setZero();
    }
};

/// The spin that a body takes up that is held with its axis at an angle to the gradient of the shear [G].
inline Real spin_at(Real angle, Real aspect, const Shear& shear) {
    Turning turning({.aspect = aspect, .axis = Vec3(std::sin(angle), 0, std::cos(angle))}, shear);
    while (turning.water.time() < 0.5) turning.step(true);
    return turning.body.angular_velocity.y() / shear.rate;
}
/// Time of a whole turn [1 / G] by the spins at four angles, which Jeffery has as w0 + c cos 2 phi.
inline Real period_by_spins(Real aspect, const Shear& shear) {
    const Real upright = spin_at(0, aspect, shear), flat = spin_at(0.5 * pi, aspect, shear);
    const Real ahead = spin_at(0.25 * pi, aspect, shear), behind = spin_at(0.75 * pi, aspect, shear);
    const Real mean = 0.25 * (upright + flat + ahead + behind);
    return 2 * pi / std::sqrt(square(mean) - 0.25 * (square(upright - flat) + square(ahead - behind)));
}
/// The same of a body that is free: from upright on, twice the time of half a turn.
inline Real period_of_turn(Real aspect, const Shear& shear) {
    Turning turning({.aspect = aspect, .axis = Vec3::UnitZ()}, shear);
    Real before = 0;
    while (true) {
        const Real time = turning.water.time();
        turning.step(false);
        const Real across = turning.spheroid.axis.x();  // sin phi: below 0 once it has turned by half
        if (across < 0) {
            const Real share = before / (before - across);
            return 2 * shear.rate * (time + share * (turning.water.time() - time));
        }
        before = across;
    }
}

}  // namespace shear_flow
