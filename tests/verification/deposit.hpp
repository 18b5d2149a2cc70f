#pragma once
// Stones poured on bonded concrete and left to lie: does the worn volume stand still, to the last bit?

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/bond/parallel_bond.hpp>
#include <abrade/bond/twist_resistance.hpp>
#include <abrade/dem/laws/rolling_resistance.hpp>
#include <abrade/geometry/sphere_union.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <random>
#include <vector>

namespace deposit {

using namespace abrade;

enum class Slab { cubic, hexagonal };

struct Setting {
    int stones = 500, per_side = 6;  ///< in layers of per_side x per_side, one above the other
    Slab slab = Slab::hexagonal;
    Real rolling_friction = 0.1;  ///< [-]
    Real sleep_speed = 2e-3;      ///< of stones [m/s]; 0: none sleeps
    ConcreteLevel level = ConcreteLevel::dynamic;
};

/// Four spheres at the corners of a tetrahedron, with the volume of a sphere of diameter `size` [m].
inline Clump stone(Real size) {
    std::vector<Sphere> members;
    for (const Vec3& corner : {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)})
        members.push_back({0.3 * corner, 0.7});
    const Real scale = size * std::cbrt(pi / 6 / union_moments(members).volume);
    for (Sphere& s : members) s.centre *= scale, s.radius *= scale;
    return make_clump("four spheres", std::move(members));
}

/// Stones of 0.04, 0.05 and 0.075 m above three layers of concrete, between walls.
inline Scene scene(const Setting& setting) {
    constexpr Real apart = 0.09;
    constexpr LatticeSize size{.sphere_diameter = 0.04, .layers = 3};
    const Real side = (setting.per_side + 0.25) * apart;
    Scene all;
    all.concrete = ConcreteBlock{.lattice = setting.slab == Slab::cubic ? flat_lattice(side, side, size)
                                                                        : hexagonal_lattice(side, side, size),
                                 .level = setting.level};
    for (const Vec3& inward : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
        all.add_wall(-0.5 * side * inward, inward);
    std::mt19937_64 random(11);
    const auto uniform = [&] { return std::generate_canonical<Real, 53>(random) - 0.5; };
    const std::array sizes{0.04, 0.05, 0.075};
    const int per_layer = setting.per_side * setting.per_side;
    for (int n = 0; n < setting.stones; ++n) {
        const Real w = uniform(), x = uniform(), y = uniform(), z = uniform(),
                   middle = 0.5 * (setting.per_side - 1);
        all.add_stone(
            stone(sizes[static_cast<std::size_t>(n % 3)]),
            {.position = apart * Vec3(n % setting.per_side - middle,
                                      n / setting.per_side % setting.per_side - middle, 0.6 + n / per_layer),
             .orientation = Quaternion(w, x, y, z).normalized()});
    }
    return all;
}

inline const MohrCoulomb springs{{.tensile = 2.7e6, .stiffness = 5e5}};
/// As stiff along and across, and they carry moments.
inline const ParallelBond beams{
    {.youngs = 5e5 * 0.04 / (pi * square(0.02)), .stiffness_ratio = 0.2, .tensile = 2.7e6, .cohesion = 8e6}};

/// The springs, and what resists that one end of a bond twists against the other.
inline const TwistResistance<MohrCoulomb> twist_springs{{.bond = springs.params()}};

template <class Bond>
auto simulation(const Setting& setting, const Bond& bond) {
    return simulate(scene(setting))
        .contact(RollingResistance<LinearSpring>{
            {.contact = {.stiffness = 5e5, .restitution = 0.5, .friction = 0.6},
             .friction = setting.rolling_friction}})
        .bond(bond)
        .wear(SubParticleAbrasion{{.coefficient = 1.1e-7, .acceleration = 100}});
}

/// What is seen every 0.05 s.
struct History {
    std::vector<Real> time, worn, kinetic;  ///< [s], [m3], [J]
    Index asleep = 0, broken = 0;           ///< stones, bonds, at the end
    Real residual = 0;                      ///< of the ledger, relative, at the end [-]

    /// Since when the worn volume has been what it is at the end, to the last bit [s].
    Real unchanged_since() const {
        std::size_t n = worn.size() - 1;
        while (n > 0 && worn[n - 1] == worn.back()) --n;
        return time[n];
    }
};

template <class Bond>
History lie(const Setting& setting, const Bond& bond, Real end_time) {
    auto sim = simulation(setting, bond);
    History h;
    sim.run({.end_time = end_time, .observe_every = 0.05, .sleep_speed = setting.sleep_speed},
            [&](const auto& now) {
                h.time.push_back(now.time()), h.worn.push_back(now.concrete().worn_volume());
                h.kinetic.push_back(now.ledger().kinetic);
            });
    h.asleep = sim.world().state().sleep.count, h.broken = sim.bonds_broken();
    h.residual = sim.ledger().residual_relative();
    return h;
}

}  // namespace deposit
