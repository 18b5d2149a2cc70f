#pragma once
// A heavy sphere dropped into a pool: how deep it comes over time, and that the water closes over it.

#include "../coupling/resolved_bodies.hpp"

namespace drop_into_pool {

using namespace resolved;

template <class Surface>
using Pool = GridFluid<3, Among<MonolithicSolids<>, Surface>>;

constexpr Real diameter = 0.1, density = 2650, rho = 1000, g = 9.81;  // [m], [kg/m3], [m/s2]
constexpr Real volume = pi / 6 * diameter * diameter * diameter, radius = 0.5 * diameter;

struct Drop {
    Real cells = 4;      ///< to the diameter
    Vec3 off{0, 0, 0};   ///< of the sphere's centre from a corner of cells, and of the surface [cell]
    Real speed = 1;      ///< as it meets the surface [m/s]
    Real viscosity = 1;  ///< [Pa s]
    bool below = false;  ///< it is let go from rest a diameter below the surface instead
};

/// Share of the sphere below the level that is `depth` above its lowest point [-].
inline Real share_below(Real depth) {
    const Real d = std::clamp(depth, 0.0, diameter);
    return pi * square(d) * (radius - d / 3) / volume;
}
inline Real schiller_naumann(Real reynolds) {
    return reynolds > 1000 ? 0.44 : 24 / reynolds * (1 + 0.15 * std::pow(reynolds, 0.687));
}

/// Depth of its lowest point and speed, by
///   d((m + s m_a) v)/dt = m g - s (rho V g + 1/2 rho C_d A v^2 + F_h),
/// s the share of the sphere below the surface at rest, m_a half the water in its place. F_h: nothing, or
/// Basset's force, 6 r^2 sqrt(pi rho mu) int dv/dt' / sqrt(t - t') dt': right in slow flow, too much at the
/// Reynolds numbers here, where wakes forget (R. Mei, J. Fluid Mech. 270, 1994). So a sphere's speed lies
/// between the two.
struct Model {
    Drop drop;
    bool history = false;
    Real depth = 0, speed = 0, time = 0;
    std::vector<Real> gained{};  ///< in each step [m/s]

    static constexpr Real dt = 5e-4;  ///< [s]

    void go_to(Real end) {
        const Real mass = density * volume, added = 0.5 * rho * volume;
        const Real basset = history ? 6 * square(radius) * std::sqrt(pi * rho * drop.viscosity * dt) : 0;
        for (; time + 0.5 * dt < end; time += dt) {
            const Real s = share_below(depth), reynolds = rho * speed * diameter / drop.viscosity;
            const Real drag =
                reynolds > 0 ? 0.5 * rho * schiller_naumann(reynolds) * pi * square(radius) * square(speed)
                             : 0;
            Real before = 0;
            for (std::size_t n = gained.size(), k = 0; history && k < n; ++k) {
                const auto ago = static_cast<Real>(n - k);
                before += gained[k] * 2 * (std::sqrt(ago + 1) - std::sqrt(ago)) / dt;
            }
            const Real force = mass * g - s * (rho * volume * g + drag + basset * before);
            depth += dt * speed;
            const Real now = 2 * s * basset, was = speed;
            speed =
                ((mass + s * added + now) * speed + dt * force) / (mass + share_below(depth) * added + now);
            gained.push_back(s > 0 ? speed - was : 0);
        }
    }
};

struct Fall {
    Real speed = 0;      ///< as its lowest point is 6 diameters deep [m/s]
    Real depth = 0;      ///< of its lowest point then [diameter]
    Model free, slowed;  ///< at the same time, without and with Basset's force
    Real crater = 0;     ///< deepest surface below the level at rest [diameter]
    Real closes = 0;     ///< depth of the sphere's top as no surface is half a diameter deep any more
                         ///< [diameter]
    Real dent = 0;       ///< deepest surface once its top is 4 diameters deep [diameter]
    Real lost = 0;       ///< of the water's volume, over the sphere's [-]
};

/// Into a pool 6 diameters wide and 8 deep, up and down alone, until its lowest point is 6 diameters deep.
template <class Surface = HeightSurface>
Fall fall(const Drop& d) {
    const Real h = diameter / d.cells, level = 8 * diameter + d.off.z() * h;
    const int n = static_cast<int>(std::round(6 * d.cells)), up = static_cast<int>(std::round(10 * d.cells));
    Pool<Surface> water({.grid = {.cells = {n, n, up}, .spacing = Vec3::Constant(h)},
                         .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                         .water = [level](const Vec3& x) { return level - x.z(); },
                         .gravity = {0, 0, -g},
                         .density = rho,
                         .viscosity = d.viscosity,
                         .largest_step = 0.004,
                         .tolerance = 1e-8},
                        {}, MonolithicSolids<>({.resolved_from = 0}));
    const Real above = d.below ? -2 * diameter : 0.1 * diameter;  // of its lowest point
    const Real speed = d.below ? 0 : std::sqrt(square(d.speed) - 2 * g * above);
    const Vec3 middle(0.5 * n * h + d.off.x() * h, 0.5 * n * h + d.off.y() * h, level + above + radius);
    std::vector<Ball> balls{{middle, radius, density}};
    FlowBody& body = balls[0].body;
    body.velocity.z() = -speed;
    const Real meets = d.below ? 0 : (d.speed - speed) / g;
    Fall found;
    found.free = {.drop = d, .depth = d.below ? 2 * diameter : 0, .speed = d.below ? 0 : d.speed};
    found.slowed = found.free, found.slowed.history = true;
    const auto& liquid = water.liquid();
    Real filled = 0;
    while (found.depth < 6) {
        body.velocity.head<2>().setZero(), body.load.force.head<2>().setZero();
        step(water, balls, water.stable_step().seconds);
        body.position.head<2>() = middle.head<2>();
        if (filled == 0) filled = liquid.volume();
        found.depth = (level - body.position.z() + radius) / diameter, found.speed = -body.velocity.z();
        Real low = 0;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j)
                low = std::min(low, (water.surface_at({(i + 0.5) * h, (j + 0.5) * h, 0}) - level) / diameter);
        found.crater = std::min(found.crater, low);
        if (low < -0.5) found.closes = found.depth - 1;
        if (found.depth > 5) found.dent = std::min(found.dent, low);
        found.lost = std::max(found.lost, std::abs(liquid.volume() - filled) / volume);
    }
    found.free.go_to(water.time() - meets), found.slowed.go_to(water.time() - meets);
    return found;
}

}  // namespace drop_into_pool
