#pragma once
// A pile of discs poured from a hopper (docs/verification/sandpile.md): the long test and the chart share it.
//
// Set-up: example "2d-sandpile-formation" of Lethe (chaos-polymtl/lethe), after J. Ai, J.-F. Chen,
// J. M. Rotter, J. Y. Ooi, Powder Technol. 206 (2011) 269, doi:10.1016/j.powtec.2010.09.030.

#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/dem/laws/rolling_resistance.hpp>
#include <abrade/sim/simulation.hpp>

#include <algorithm>
#include <random>

namespace sandpile {

using namespace abrade;
using Law = RollingResistance<HertzMindlin>;

/// Hopper, channel and floor, in x and z [m]. The floor's z is that of the published figure: heights count
/// from it.
constexpr Real half_width = 0.035, channel_end = -0.220, floor_height = -0.570;
constexpr Real hopper_slope = 0.57 / 0.47, hopper_top = 0.66;
constexpr Real gate_opens = 4.5;  ///< where the published time stands then [s]
constexpr Real settling = 1.5;    ///< that we give the hopper's filling [s]
/// Published: 4 MPa. Discs so soft overlap by over a fifth of their radius as the first of them meet the
/// floor at 3.3 m/s, which the engine refuses.
constexpr Real youngs = 16e6;  ///< [Pa]

/// What is poured. A smaller pile takes a share of the discs and lengths that go with it; the discs stay as
/// they are.
struct Pile {
    Index discs = 3000;
    Real lengths = 1;   ///< of the hopper, against the published one
    Real large = 0.3;   ///< share of the discs that are large, by number; 1/6 are 30 % by volume of spheres
    bool flat = false;  ///< masses and inertias of discs 4.6 mm thick, not of spheres
    Real restitution = 0.7, rolling_friction = 0.3;  ///< [-]
    Law::Model model = Law::Model::elastic_plastic;
    unsigned seed = 1;  ///< of places and order
};

inline Law law(const Pile& pile) {
    return Law{
        {.contact = {.youngs = youngs, .poisson = 0.49, .restitution = pile.restitution, .friction = 0.8},
         .friction = pile.rolling_friction,
         .stiffness_factor = 3,  // discs
         .model = pile.model}};
}

/// Spheres in a row from a to b, so close that a disc rolls over them as over a plane: the row's face rises
/// and falls by 2 % of their radius.
inline void add_row(Lattice& lattice, const Vec3& a, const Vec3& b) {
    const int count = static_cast<int>(std::ceil((b - a).norm() / (0.4 * lattice.radius)));
    for (int n = 0; n <= count; ++n) {
        lattice.sites.push_back({.centre = a + (b - a) * n / count,
                                 .cell_volume = cube(lattice.radius),
                                 .along = lattice.count_along++});
        lattice.column_area.push_back(square(lattice.radius));
    }
}

/// Hopper and channel of fixed spheres, their faces where the published walls are; the floor. Everything has
/// y = 0: with nothing that points out of that plane, forces out of it are zeros, and discs stay in it.
inline Scene hopper(const Pile& pile) {
    Scene scene;
    scene.gravity = {0, 0, -9.81};
    scene.add_wall({0, 0, pile.lengths * floor_height}, {0, 0, 1});
    Lattice walls;
    walls.radius = 0.004, walls.count_across = walls.count_layers = 1;
    const Real l = pile.lengths;
    for (const Real side : {-1.0, 1.0}) {
        const Vec3 corner(side * half_width, 0, 0),
            top(side * (half_width + l * hopper_top / hopper_slope), 0, l * hopper_top);
        const Vec3 out = Vec3(side * hopper_slope, 0, -1).normalized();
        add_row(walls, corner + walls.radius * out, top + walls.radius * out);
        add_row(walls, corner + walls.radius * side * Vec3::UnitX(),
                Vec3(side * (half_width + walls.radius), 0, l * channel_end));
    }
    scene.concrete = ConcreteBlock{.lattice = std::move(walls)};
    return scene;
}

inline void add_disc(Scene& scene, const Pile& pile, Real radius, const BodyState& state) {
    Clump disc = make_clump("disc", {{Vec3::Zero(), radius}});
    if (pile.flat) {
        disc.volume = pi * square(radius) * 0.0046;
        disc.principal_moments.setConstant(0.5 * disc.volume * square(radius));
    }
    scene.add_stone(disc, state, 1056);
}

/// Discs on a loose grid in the hopper, in an order and with places that a seed decides.
inline void fill(Scene& scene, const Pile& pile) {
    std::mt19937 random(pile.seed);
    const auto uniform = [&] { return static_cast<Real>(random()) / 4294967296.0; };
    std::vector<Real> radii(static_cast<std::size_t>(pile.discs), 0.00345);
    const auto large = std::lround(pile.large * static_cast<Real>(pile.discs));
    std::fill_n(radii.begin(), large, 0.00445);
    for (std::size_t n = radii.size() - 1; n > 0; --n) std::swap(radii[n], radii[random() % (n + 1)]);
    constexpr Real pitch = 0.0103;
    std::size_t next = 0;
    for (Real z = 0.006; next < radii.size(); z += pitch) {
        const Real free = half_width + z / hopper_slope - 0.0075;
        const int count = static_cast<int>(2 * free / pitch) + 1;
        for (int n = 0; n < count && next < radii.size(); ++n, ++next)
            add_disc(scene, pile, radii[next],
                     {.position = {-0.5 * (count - 1) * pitch + n * pitch + 0.001 * (uniform() - 0.5), 0,
                                   z + 0.001 * (uniform() - 0.5)}});
    }
}

struct Disc {
    Vec3 position;
    Real radius;
};

struct Run {
    std::vector<Real> time, height;  ///< [s], of the highest disc's centre over the floor [m]
    std::vector<Disc> discs, walls;  ///< at the end
    Real off_plane = 0;              ///< largest |y| [m]
    Real residual = 0;               ///< of the ledger, relative, after the gate opened
    Real lost = 0, lost_rolling = 0, integration_residue = 0, kinetic = 0;  ///< likewise [J]
    Index steps = 0;
};

/// Fills the hopper, opens the gate, and watches for `seconds`. The gate is a plane that the second of two
/// simulations does not have: discs at rest enter it, with contacts that have no memory yet.
inline Run pour(const Pile& pile, Real seconds, Real observe_every, Real safety = 0.5) {
    Scene closed = hopper(pile);
    closed.add_wall({0, 0, 0}, {0, 0, 1});
    fill(closed, pile);
    const std::size_t walls = closed.concrete->lattice.sites.size();
    auto filling = simulate(closed).contact(law(pile));
    filling.run({.end_time = settling, .safety = safety});

    Scene open = hopper(pile);
    const Particles& p = filling.particles();
    for (std::size_t b = walls; b < p.position.size(); ++b)
        add_disc(open, pile, p.radius[b],
                 {.position = p.position[b],
                  .velocity = p.velocity[b],
                  .angular_velocity = p.angular_velocity(static_cast<Index>(b))});
    auto sim = simulate(open).contact(law(pile));
    Run run;
    sim.run({.end_time = seconds, .safety = safety, .observe_every = observe_every}, [&](const auto& now) {
        Real highest = -1e300;
        for (std::size_t b = walls; b < now.particles().position.size(); ++b) {
            highest = std::max(highest, now.particles().position[b].z());
            run.off_plane = std::max(run.off_plane, std::abs(now.particles().position[b].y()));
        }
        run.time.push_back(gate_opens + now.time());
        run.height.push_back(highest - pile.lengths * floor_height);
    });
    for (std::size_t b = 0; b < sim.particles().position.size(); ++b)
        (b < walls ? run.walls : run.discs)
            .push_back({sim.particles().position[b], sim.particles().radius[b]});
    const Ledger& e = sim.ledger();
    run.residual = e.residual_relative(), run.kinetic = e.kinetic;
    run.lost = e.lost(), run.lost_rolling = e.lost_rolling, run.integration_residue = e.integration_residue();
    run.steps = sim.steps();
    return run;
}

}  // namespace sandpile
