// A body of bonded spheres that nothing holds, set spinning by stones that strike it: what it keeps.
#include <abrade/bond/elastic_brittle.hpp>
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/bond/parallel_bond.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

constexpr Real d = 0.02, stiffness = 4e6;

template <class Law>
Law bond_law(Real strength, Real damping) {
    if constexpr (std::same_as<Law, ParallelBond>)
        return Law{{.youngs = stiffness * 4 / (pi * d),
                    .tensile = strength,
                    .cohesion = 2 * strength,
                    .damping = damping}};
    else if constexpr (std::same_as<Law, ElasticBrittle>)
        return Law{{.tensile = strength, .shear = 2 * strength, .stiffness = stiffness, .damping = damping}};
    else
        return Law{{.tensile = strength, .stiffness = stiffness, .damping = damping}};
}

/// A block of 3 x 4 x 5 spheres and two stones that strike it at opposite ends, so that it spins and moves
/// on.
Scene struck_block(Real speed) {
    std::vector<Vec3> centres;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j)
            for (int k = 0; k < 5; ++k) centres.push_back(d * Vec3(i, j, k));
    Scene scene;
    scene.gravity.setZero();
    scene.concrete = ConcreteBlock{lattice_of(centres, 0.5 * d, 60 * cube(d))};
    scene.add_sphere(
        d, {.position = d * Vec3(-1.6, 0.3, 4.2), .velocity = {speed, 0, 0}, .angular_velocity = {0, 3, 20}});
    scene.add_sphere(0.7 * d, {.position = d * Vec3(3.4, 2.8, -0.1), .velocity = {-speed, 0.2 * speed, 0}});
    return scene;
}

struct Momenta {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();  ///< [kg m/s], about the origin [kg m2/s]
};

/// Of all bodies, or of bonded ones alone.
Momenta momenta_of(const Particles& p, bool bonded_only = false) {
    Momenta sum;
    for (std::size_t b = 0; b < p.position.size(); ++b) {
        if (bonded_only && p.kind[b] == Kind::stone) continue;
        sum.linear += p.mass[b] * p.velocity[b];
        sum.angular += p.mass[b] * p.position[b].cross(p.velocity[b]) + p.angular_momentum[b];
    }
    return sum;
}

/// Of a body that turns as a whole, with these momenta [J].
Real rigid_energy(const Particles& p) {
    Real mass = 0;
    Vec3 centre = Vec3::Zero();
    for (std::size_t b = 0; b < p.position.size(); ++b)
        if (p.kind[b] != Kind::stone) mass += p.mass[b], centre += p.mass[b] * p.position[b];
    centre /= mass;
    Mat3 inertia = Mat3::Zero();
    for (std::size_t b = 0; b < p.position.size(); ++b) {
        if (p.kind[b] == Kind::stone) continue;
        const Vec3 r = p.position[b] - centre;
        inertia += p.mass[b] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose()) +
                   Mat3::Identity() / p.inverse_inertia[b].x();
    }
    const Momenta all = momenta_of(p, true);
    const Vec3 spin = all.angular - centre.cross(all.linear);
    const Vec3 turning = inertia.ldlt().solve(spin);
    return 0.5 * all.linear.squaredNorm() / mass + 0.5 * spin.dot(turning);
}

}  // namespace

TEST_CASE_TEMPLATE("momenta of a free cluster are kept to round-off, whole or breaking", Law, MohrCoulomb,
                   ElasticBrittle, ParallelBond) {
    for (const bool breaks : {false, true}) {
        auto sim = simulate(struck_block(5))
                       .contact(LinearSpring{{.stiffness = 1e6, .restitution = 0.7, .friction = 0.4}})
                       .bond(bond_law<Law>(breaks ? 1e5 : 1e12, 0.1));
        Momenta start;
        Real linear = 0, angular = 0, momentum = 0, spin = 0;
        sim.run({.end_time = 0.03, .observe_every = 5e-4}, [&](const auto& now) {
            const Momenta all = momenta_of(now.particles());
            if (now.time() == 0) {
                start = all;
                for (std::size_t b = 0; b < now.particles().position.size(); ++b) {
                    const Vec3 one = now.particles().mass[b] * now.particles().velocity[b];
                    momentum += one.norm(), spin += now.particles().position[b].cross(one).norm();
                }
            }
            linear = std::max(linear, (all.linear - start.linear).norm());
            angular = std::max(angular, (all.angular - start.angular).norm());
        });
        MESSAGE(Law::name << ", " << sim.bonds_broken() << " of 133 bonds broken, " << sim.steps()
                          << " steps: momentum changed by " << linear / momentum
                          << " of what moved at the start, angular momentum by " << angular / spin
                          << "; residual " << sim.ledger().residual_relative());
        CHECK((sim.bonds_broken() > 10) == breaks);
        CHECK((sim.bonds_broken() == 0) != breaks);
        CHECK(linear < 1e-13 * momentum);
        CHECK(angular < 1e-13 * spin);
        CHECK(sim.ledger().residual_relative() < 1e-12);
    }
}

TEST_CASE_TEMPLATE("damped, a spinning cluster comes to turn as a whole and loses no more", Law, MohrCoulomb,
                   ParallelBond) {
    auto sim = simulate(struck_block(1))
                   .contact(LinearSpring{{.stiffness = 1e6, .restitution = 0.7}})
                   .bond(bond_law<Law>(1e12, 0.3));
    const auto kinetic = [&] {
        Real sum = 0;
        for (Index b = 0; b < sim.particles().bodies(); ++b)
            if (sim.particles().kind[static_cast<std::size_t>(b)] != Kind::stone)
                sum += sim.particles().kinetic_energy(b);
        return sum;
    };
    sim.run({.end_time = 0.1});
    const Real lost = sim.ledger().lost_bond, early = kinetic(), early_rigid = rigid_energy(sim.particles());
    sim.run({.end_time = 0.5});
    const Real late = kinetic(), late_rigid = rigid_energy(sim.particles());
    MESSAGE(Law::name << ": kinetic energy over that of one rigid body: after 0.1 s 1 + "
                      << early / early_rigid - 1 << ", after 0.5 s 1 + " << late / late_rigid - 1
                      << "; lost in bonds by then " << lost / early << ", afterwards "
                      << (sim.ledger().lost_bond - lost) / early << " of it");
    CHECK(early == doctest::Approx(early_rigid).epsilon(1e-3).scale(0));
    CHECK(late == doctest::Approx(late_rigid).epsilon(1e-3).scale(0));
    CHECK(sim.ledger().lost_bond - lost < 1e-3 * early);
}
