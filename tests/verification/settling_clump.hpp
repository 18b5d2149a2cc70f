#pragma once
// A clump of two touching spheres settles in wide still water, through the whole engine, beside the sphere of
// its volume.

#include <abrade/coupling/exchange/monolithic.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/sim/simulation.hpp>

#include <algorithm>
#include <cmath>

namespace settling_clump {

using namespace abrade;

/// Drag coefficient by the diameter D of the sphere of its volume, and its surface over the body's, phi:
///   C_d = 24 / Re (1 + A Re^B) + C / (1 + D / Re),
/// A to D of phi. Of spheres to 3 %, of others to some 6 %, up to Re 2.6e5. A. Haider & O. Levenspiel 1989,
/// doi:10.1016/0032-5910(89)80008-7.
inline Real haider_levenspiel(Real reynolds, Real phi) {
    const Real phi2 = square(phi), phi3 = cube(phi);
    const Real a = std::exp(2.3288 - 6.4581 * phi + 2.4486 * phi2), b = 0.0964 + 0.5565 * phi;
    const Real c = std::exp(4.905 - 13.8944 * phi + 18.4222 * phi2 - 10.2599 * phi3);
    const Real d = std::exp(1.4681 + 12.2584 * phi - 20.7322 * phi2 + 15.8855 * phi3);
    return 24 / reynolds * (1 + a * std::pow(reynolds, b)) + c / (1 + d / reynolds);
}
/// Two spheres have 2^(1/3) of the surface of the one of their volume.
inline const Real doublet_sphericity = std::pow(2.0, -1.0 / 3);

/// Glass in water as in settling_in_water: Re 30 to 40.
constexpr Real diameter = 0.5e-3, ratio = 2.56, nu = 0.9e-6, g = 9.81;

/// At which weight and that drag are equal [m/s]. `wide`: diameter of the sphere of its volume [m].
inline Real terminal_speed(Real phi, Real wide = diameter) {
    Real speed = 0.05;
    for (int k = 0; k < 200; ++k) {
        const Real reynolds = speed * wide / nu;
        speed =
            0.5 * (speed + std::sqrt(4.0 / 3 * (ratio - 1) * g * wide / haider_levenspiel(reynolds, phi)));
    }
    return speed;
}

struct Settled {
    Real speed = 0;    ///< mean over the last 2 diameters [m/s]
    Real fastest = 0;  ///< [m/s]
    Real tilt = 0;     ///< of the clump's axis off the horizontal at the end [degree]
    Real levels = 0;   ///< way after which it is below 10 degrees first [diameter]
    Real residual = 0;
};
/// In a box 6 diameters wide, from rest through 15.5 diameters, whose sides let the water glide. `tilt`: of
/// the clump's axis off the horizontal at the start [degree]; `clump`: or the sphere of its volume.
inline Settled settle(bool clump, Real cells, Real tilt) {
    using Flow = GridFluid<3, Among<MonolithicSolids<>, FullBox>>;
    const Real h = diameter / cells;
    const int n = static_cast<int>(std::round(6 * cells)), up = static_cast<int>(std::round(20 * cells));
    const Flow water({.grid = {.cells = {n, n, up}, .spacing = Vec3::Constant(h)},
                      .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                      .gravity = {0, 0, -g},
                      .density = 1000,
                      .viscosity = 1000 * nu},
                     {}, MonolithicSolids<>({.resolved_from = 0}));
    Scene scene;
    scene.gravity = {0, 0, -g};
    BodyState state{.position = Vec3(3, 3, 18) * diameter + h * Vec3(0.3, 0.1, 0)};
    Vec3 axis = Vec3::UnitX();  // as the clump has it
    if (clump) {
        const Real r = 0.5 * diameter / std::cbrt(2.0), angle = tilt * pi / 180;
        const Clump doublet = make_clump("doublet", {{r * axis, r}, {-r * axis, r}});
        axis = doublet.members[0].centre.normalized();
        state.orientation.setFromTwoVectors(axis, Vec3(std::cos(angle), 0, std::sin(angle)));
        scene.add_stone(doublet, state, 1000 * ratio);
    } else {
        scene.add_sphere(0.5 * diameter, state, 1000 * ratio);
    }
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1, .restitution = 0.8}}).fluid(water);
    Settled found;
    Real from = 0, to = 0;
    bool done = false;
    const RunOptions options{.end_time = 60 * diameter / 0.05,
                             .observe_every = 0.1 * diameter / 0.05,
                             .stop = [&] { return done; }};
    sim.run(options, [&](const auto& now) {
        const Vec3& x = now.particles().position[0];
        found.fastest = std::max(found.fastest, -now.particles().velocity[0].z());
        found.residual = std::max(found.residual, now.ledger().residual_relative());
        const Vec3 along = now.particles().orientation[0] * axis;
        const Real tilt_now = std::asin(std::min(std::abs(along.z()), 1.0)) * 180 / pi;
        if (found.levels == 0 && tilt_now < 10) found.levels = 18 - x.z() / diameter;
        if (from == 0 && x.z() < 4.5 * diameter) from = now.time(), to = x.z();
        if (x.z() < 2.5 * diameter && !done) {
            done = true;
            found.speed = (to - x.z()) / (now.time() - from);
            if (clump) found.tilt = tilt_now;
        }
    });
    return found;
}

}  // namespace settling_clump
