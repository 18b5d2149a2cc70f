// Packs of bonds answer as their bonds do one by one, whatever they hold and whichever break.
#include <abrade/bond/bond_pack.hpp>
#include <abrade/bond/elastic_brittle.hpp>
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/bond/parallel_bond.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

template <class Law>
Law weak() {
    if constexpr (std::same_as<Law, MohrCoulomb>)
        return MohrCoulomb{{.tensile = 1e5, .stiffness = 4e6, .damping = 0.2}};
    else if constexpr (std::same_as<Law, ElasticBrittle>)
        return ElasticBrittle{{.tensile = 1e5, .shear = 2e5, .stiffness = 4e6, .damping = 0.2}};
    else
        return ParallelBond{{.youngs = 1e8, .tensile = 1e5, .cohesion = 1e5, .damping = 0.2}};
}

}  // namespace

TEST_CASE_TEMPLATE("a pack of bonds answers as its bonds do one by one", Law, MohrCoulomb, ElasticBrittle,
                   ParallelBond) {
    static_assert(AnswersBondPacks<Law>);
    const Law law = weak<Law>();
    std::mt19937 random(8);
    std::uniform_real_distribution<Real> u(-1, 1);
    const auto any_vector = [&](Real size) {
        const Real z = u(random), y = u(random), x = u(random);
        return Vec3(size * Vec3(x, y, z));
    };
    int fates[3] = {}, contacts = 0;
    for (int n = 0; n < 4000; ++n) {
        BondKinematicsOf<Pack> bonds;
        typename Law::template MemoryOf<Pack> memory;
        std::array<BondKinematics, pack_lanes> single;
        std::array<typename Law::Memory, pack_lanes> held;
        Pack left = 1;
        bonds.time_step = 1e-6;
        for (int k = 0; k < pack_lanes; ++k) {
            BondKinematics& b = single[static_cast<std::size_t>(k)];
            auto& m = held[static_cast<std::size_t>(k)];
            const Real size = std::pow(10, -6 + 2 * u(random));
            b = {.normal = any_vector(1).normalized(),
                 .compression = size * u(random),
                 .velocity = any_vector(1e4 * size),
                 .radius = 0.01,
                 .length = 0.02,
                 .effective_mass = 0.005,
                 .time_step = 1e-6,
                 .travel = any_vector(1e-2 * size),
                 .spin = any_vector(1e5 * size),
                 .turn = any_vector(0.1 * size),
                 .effective_inertia = 2e-7};
            m = {};
            m.spring = any_vector(size), m.broken = u(random) > 0.7;
            if constexpr (requires { m.bend; })
                if (!(m.broken > 0)) m.bend = any_vector(10 * size), m.twist = 10 * size * u(random);
            left.set(k, 0.5 + 0.5 * u(random));
            for (int a = 0; a < 3; ++a) {
                bonds.normal[a].set(k, b.normal[a]), bonds.velocity[a].set(k, b.velocity[a]);
                bonds.travel[a].set(k, b.travel[a]), bonds.spin[a].set(k, b.spin[a]);
                bonds.turn[a].set(k, b.turn[a]);
            }
            bonds.compression.set(k, b.compression), bonds.radius.set(k, b.radius);
            bonds.length.set(k, b.length), bonds.effective_mass.set(k, b.effective_mass);
            bonds.effective_inertia.set(k, b.effective_inertia);
            detail::set_memory_of_lane(memory, k, m);
        }
        const auto all = law.respond(bonds, left, memory);
        for (int k = 0; k < pack_lanes; ++k) {
            const auto one =
                law.respond(single[static_cast<std::size_t>(k)], left[k], held[static_cast<std::size_t>(k)]);
            const auto fate = all.fate.tension[k] ? Fate::tension
                              : all.fate.shear[k] ? Fate::shear
                                                  : Fate::intact;
            CHECK(fate == one.fate);
            ++fates[static_cast<int>(fate)];
            contacts += one.memory.broken > 0;
            const Real scale = 1e-11 * (one.load.force.norm() + 1e-3);
            CHECK((detail::lane_of(all.load.force, k) - one.load.force).norm() <= scale);
            CHECK((detail::lane_of(all.load.couple, k) - one.load.couple).norm() <= scale);
            const Real energy = one.load.stored + one.load.lost_bond + one.load.lost_normal +
                                one.load.lost_tangential + 1e-12;
            CHECK(std::abs(all.load.stored[k] - one.load.stored) <= 1e-10 * energy);
            CHECK(std::abs(all.load.lost_bond[k] - one.load.lost_bond) <= 1e-10 * energy);
            CHECK(std::abs(all.load.lost_normal[k] - one.load.lost_normal) <= 1e-10 * energy);
            CHECK(std::abs(all.load.lost_tangential[k] - one.load.lost_tangential) <= 1e-10 * energy);
            const auto next = detail::memory_of_lane<typename Law::Memory>(all.memory, k);
            CHECK((next.spring - one.memory.spring).norm() <= 1e-10 * (one.memory.spring.norm() + 1e-12));
            CHECK(next.broken == one.memory.broken);
        }
    }
    CHECK(fates[0] > 1000);
    CHECK(fates[1] > 200);
    CHECK(fates[2] > 200);
    CHECK(contacts > 1000);
}
