#pragma once
// One stone strikes a block of bonded spheres: which bonds break, what comes loose, what the wear law takes,
// and what it costs to compute. With closed forms for the first bond to break.

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/dem/laws/linear_hysteretic.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <ctime>

namespace abrade::charts {

/// A block and a sphere of stone that strikes its middle. No gravity: what comes loose leaves.
struct Blow {
    static constexpr Real youngs = 26.8e9;        ///< E of concrete [Pa]
    static constexpr Real tensile = 2.7e6;        ///< sigma_t0 [Pa]
    static constexpr Real stone_density = 2650;   ///< [kg/m3]
    static constexpr Real restitution = 0.6;      ///< e [-]
    static constexpr Real stiffness_ratio = 0.2;  ///< k_s / k_n of bonds [-]
    static constexpr Real friction_angle = 35;    ///< of bonds [degrees]

    Real diameter = 0.005;          ///< d of the concrete's spheres [m]
    Index across = 20, layers = 6;  ///< spheres of the block, the deepest layer fixed
    ConcreteLevel level = ConcreteLevel::dynamic;
    bool wears = false;            ///< else nothing but fracture takes concrete off
    Real stone = 0.05, speed = 1;  ///< diameter [m], [m/s]
    Real angle = 90;               ///< between the way and the surface [degrees]
    bool in_hollow = false;        ///< between four spheres, else on top of one
    Real contact_stiffness = 2e7;  ///< k_1 of the contact [N/m]
    Real safety = 0.8;             ///< share of the stable step [-]

    Real mass() const { return stone_density * pi / 6 * cube(stone); }                   ///< [kg]
    Real energy() const { return 0.5 * mass() * square(speed); }                         ///< [J]
    Real bond_stiffness() const { return youngs * pi / 4 * diameter; }                   ///< E A/d [N/m]
    Real bond_strength() const { return MohrCoulomb{bond()}.capacity(0.5 * diameter); }  ///< f_b [N]
    MohrCoulomb::Params bond() const {
        return {.tensile = tensile,
                .friction_angle = friction_angle,
                .stiffness = bond_stiffness(),
                .stiffness_ratio = stiffness_ratio};
    }
    LinearHysteretic::Params contact() const {
        return {.stiffness = contact_stiffness, .restitution = restitution, .friction = 0.5};
    }
    /// Of the contact, had the stone nothing but it to press on [s].
    Real contact_time() const { return 0.5 * pi * (1 + restitution) * std::sqrt(mass() / contact_stiffness); }

    /// The force [N] on one sphere of the surface at which the bonds with its four neighbours fail in shear,
    /// while these and the sphere below stand:
    ///   F_c = f_b tan(phi) (k_n + 4 k_s) / k_s
    /// F k_s/(k_n + 4 k_s) is the share of one of them; nothing presses it, so it holds f_b tan(phi).
    Real critical_force() const {
        return bond_strength() * std::tan(radians(friction_angle)) * (1 / stiffness_ratio + 4);
    }
    /// Of the contact and the bonds of the sphere that is struck, one behind the other [N/m].
    Real joint_stiffness() const {
        const Real bonds = bond_stiffness() * (1 + 4 * stiffness_ratio);
        return level == ConcreteLevel::dynamic ? 1 / (1 / contact_stiffness + 1 / bonds) : contact_stiffness;
    }
    /// The speed [m/s] at which the peak force v sqrt(k m) of a blow on top of a sphere is `critical_force`.
    Real critical_speed() const { return critical_force() / std::sqrt(joint_stiffness() * mass()); }
    /// What sub-particle abrasion takes of a body that loses (1 - e^2) E at one blow, C_w/2 (1 - e^2) E [m3].
    static Real abraded_volume(Real energy) {
        return 0.5 * SubParticleAbrasion::Params{}.coefficient * (1 - square(restitution)) * energy;
    }

    Scene scene() const {
        Scene scene;
        scene.gravity.setZero();
        const Real side = static_cast<Real>(across) * diameter;
        scene.concrete = ConcreteBlock{
            .lattice = flat_lattice(side, side, {.sphere_diameter = diameter, .layers = layers}),
            .level = level};
        return scene;
    }
    /// Where the lowest point of the stone is as it touches, over the middle of the block: between four
    /// spheres it lies lower.
    Vec3 target() const {
        const bool odd = across % 2 != 0;
        const Real aside = odd == in_hollow ? 0.5 * diameter : 0;
        const Real reach = 0.5 * (stone + diameter);
        const Real sinks = in_hollow ? reach - std::sqrt(square(reach) - 0.5 * square(diameter)) : 0;
        return {aside, aside, -sinks};
    }
    void add_stone(Scene& scene, const Vec3& at, Real time) const {
        const Vec3 way(std::cos(radians(angle)), 0, -std::sin(radians(angle)));
        scene.add_sphere(0.5 * stone, {.position = at + Vec3(0, 0, 0.5 * stone) - speed * time * way,
                                       .velocity = speed * way});
    }

    /// Calls `with(simulation)`, with or without the wear law.
    auto simulated(Scene scene, auto&& with) const {
        auto sim = simulate(std::move(scene)).contact(LinearHysteretic{contact()}).bond(MohrCoulomb{bond()});
        if (wears) return with(std::move(sim).wear(SubParticleAbrasion{{}}));
        return with(std::move(sim));
    }
};

/// What came of one blow, or of several on the same block.
struct BlowAnswers {
    Real broken = 0, let_go = 0;           ///< bonds, spheres
    Real removed = 0;                      ///< volume worn, or come loose as grains [m3]
    Real lost_contact = 0, lost_bond = 0;  ///< [J]
    Real energy = 0;                       ///< of the stones [J]
    Real steps = 0, processor = 0;         ///< [-], time of one core [s]
    Real crushed = 0;                      ///< 1 where a run ended by an overlap beyond a fifth of a radius

    /// Calls f(name, member) for each.
    static void visit(auto&& f) {
        f("bonds_broken", &BlowAnswers::broken), f("spheres_let_go", &BlowAnswers::let_go);
        f("removed_m3", &BlowAnswers::removed), f("lost_contact_J", &BlowAnswers::lost_contact);
        f("lost_bond_J", &BlowAnswers::lost_bond), f("energy_J", &BlowAnswers::energy);
        f("steps", &BlowAnswers::steps), f("processor_s", &BlowAnswers::processor);
        f("crushed", &BlowAnswers::crushed);
    }
};

/// Runs to `end_time` [s]; `look(simulation)` sees the end.
template <class Sim, class Look>
BlowAnswers answers_of(Sim sim, Real end_time, Real safety, Look&& look) {
    BlowAnswers a;
    const std::clock_t start = std::clock();
    try {
        sim.run({.end_time = end_time, .safety = safety});
    } catch (const RunError&) {
        a.crushed = 1;
    }
    a.processor = static_cast<Real>(std::clock() - start) / CLOCKS_PER_SEC;
    const Concrete& concrete = sim.concrete();
    const Ledger& ledger = sim.ledger();
    a.broken = static_cast<Real>(sim.bonds_broken());
    for (Index s = 0; s < concrete.sites(); ++s) a.let_go += concrete.gone(s);
    a.removed = concrete.worn_volume() + concrete.detached_volume();
    a.lost_contact = ledger.lost_normal + ledger.lost_sliding;
    a.lost_bond = ledger.lost_bond;
    a.energy = ledger.kinetic_start;
    a.steps = static_cast<Real>(sim.steps());
    look(sim);
    return a;
}

/// One blow, followed for four contact times: what flies off has left by then.
inline BlowAnswers run(const Blow& blow) {
    Scene scene = blow.scene();
    const Real before = 0.02 * blow.contact_time();
    blow.add_stone(scene, blow.target(), before / std::sin(radians(blow.angle)));
    return blow.simulated(std::move(scene), [&](auto sim) {
        return answers_of(std::move(sim), 4 * blow.contact_time(), blow.safety, [](const auto&) {});
    });
}

}  // namespace abrade::charts
