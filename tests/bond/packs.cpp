// Packs of bonds answer as their bonds do one by one, whatever they hold and whichever break.
#include <abrade/bond/bond_pack.hpp>
#include <abrade/bond/elastic_brittle.hpp>
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/bond/parallel_bond.hpp>
#include <abrade/bond/twist_resistance.hpp>
#include <abrade/sim/simulation.hpp>

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
    else if constexpr (std::same_as<Law, TwistResistance<MohrCoulomb>>)
        return Law{{.bond = weak<MohrCoulomb>().params()}};
    else
        return ParallelBond{{.youngs = 1e8, .tensile = 1e5, .cohesion = 1e5, .damping = 0.2}};
}

}  // namespace

TEST_CASE_TEMPLATE("a pack of bonds answers as its bonds do one by one", Law, MohrCoulomb, ElasticBrittle,
                   ParallelBond, TwistResistance<MohrCoulomb>) {
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
                 .displacement = any_vector(1e-2 * size),
                 .spin = any_vector(1e5 * size),
                 .rotation = any_vector(0.1 * size),
                 .effective_inertia = 2e-7};
            m = {};
            m.spring = any_vector(size), m.broken = u(random) > 0.7;
            if constexpr (requires { m.bend; })
                if (!(m.broken > 0)) m.bend = any_vector(10 * size);
            if constexpr (requires { m.twist; })
                if (!(m.broken > 0)) m.twist = 10 * size * u(random);
            left.set(k, 0.5 + 0.5 * u(random));
            for (int a = 0; a < 3; ++a) {
                bonds.normal[a].set(k, b.normal[a]), bonds.velocity[a].set(k, b.velocity[a]);
                bonds.displacement[a].set(k, b.displacement[a]), bonds.spin[a].set(k, b.spin[a]);
                bonds.rotation[a].set(k, b.rotation[a]);
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
            const auto failure = all.failure.tension[k] ? FailureMode::tension
                                 : all.failure.shear[k] ? FailureMode::shear
                                                        : FailureMode::intact;
            CHECK(failure == one.failure);
            ++fates[static_cast<int>(failure)];
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
            if constexpr (requires { next.bend; }) {
                CHECK((next.bend - one.memory.bend).norm() <= 1e-10 * (one.memory.bend.norm() + 1e-12));
            }
            if constexpr (requires { next.twist; }) {
                CHECK(std::abs(next.twist - one.memory.twist) <= 1e-10 * std::abs(one.memory.twist) + 1e-22);
            }
        }
    }
    CHECK(fates[0] > 1000);
    CHECK(fates[1] > 200);
    CHECK(fates[2] > 200);
    CHECK(contacts > 1000);
}

namespace {

/// A spring that never breaks and heeds nothing: what it makes of left-over lanes must not count.
struct Unbreakable {
    static constexpr std::string_view name = "Unbreakable";
    using Params = NoParams;
    template <class Number>
    struct MemoryOf {
        Number broken = Number(0);
    };
    using Memory = MemoryOf<Real>;
    explicit Unbreakable(Params = {}) {}
    const Params& params() const noexcept {
        static constexpr Params none{};
        return none;
    }
    template <class Number>
    BondResponseOf<Number, MemoryOf<Number>> respond(const BondKinematicsOf<Number>& bond,
                                                     std::type_identity_t<Number>,
                                                     const MemoryOf<Number>& memory) const noexcept {
        BondResponseOf<Number, MemoryOf<Number>> answer;
        answer.load.force = Number(1e5) * bond.compression * bond.normal;
        answer.load.stored = Number(0.5e5) * bond.compression * bond.compression;
        answer.memory = memory;
        return answer;
    }
    Real strength(Real, Real) const noexcept { return 1; }
    template <class Number>
    BondRigidityOf<Number> rigidity(Number, Number) const noexcept {
        return {Number(1e5), Number(0), 0};
    }
};

/// The same law, asked for one bond at a time.
template <class Law>
struct OneByOne : Law {
    using Law::Law;
    template <class Number>
    using MemoryOf = void;
    using Memory = typename Law::template MemoryOf<Real>;
    BondResponse<Memory> respond(const BondKinematics& bond, Real left, const Memory& memory) const noexcept {
        return Law::respond(bond, left, memory);
    }
};

template <class Bond>
auto hanging_row(const Bond& bond) {
    std::vector<Vec3> centres;
    for (int n = 0; n < 5; ++n) centres.push_back({0, 0, -0.02 * n});
    Scene scene;
    Lattice row = lattice_of(centres, 0.01, 1e-4);
    row.sites.front().held = true;
    scene.concrete = ConcreteBlock{row};
    auto sim = simulate(std::move(scene)).contact(LinearSpring{{.stiffness = 1e5}}).bond(bond);
    sim.run({.end_time = 0.02});
    return sim;
}

}  // namespace

TEST_CASE("lanes that are left over answer nothing, whatever their law makes of them") {
    static_assert(AnswersBondPacks<Unbreakable>);
    const auto sim = hanging_row(Unbreakable{});
    const Ledger& e = sim.ledger();
    CHECK(e.stored_bonds > 0);
    CHECK(e.stored_bonds < 1);
    CHECK(e.residual_relative() < 1e-12);
    CHECK(std::abs(e.integration_residue()) < 1e-3 * e.throughput());
}

TEST_CASE("a law that is asked bond by bond moves the same") {
    const ParallelBond::Params beam{.youngs = 1e8, .tensile = 1e9, .cohesion = 1e9};
    const auto packs = hanging_row(ParallelBond{beam});
    const auto single = hanging_row(OneByOne<ParallelBond>{beam});
    static_assert(!AnswersBondPacks<OneByOne<ParallelBond>>);
    for (std::size_t b = 0; b < 5; ++b)
        CHECK((packs.particles().position[b] - single.particles().position[b]).norm() < 1e-15);
    CHECK(packs.ledger().stored_bonds ==
          doctest::Approx(single.ledger().stored_bonds).epsilon(1e-10).scale(0));
}

TEST_CASE("a sphere of a packing that nothing ties is a grain from the start, and rests on what is below") {
    Scene scene;
    Lattice body = lattice_of({{0, 0, 0}, {0, 0, 0.021}}, 0.01, 1.6e-5, 0.01, 0.001);
    scene.concrete = ConcreteBlock{body};
    auto sim = simulate(std::move(scene))
                   .contact(LinearSpring{{.stiffness = 1e5, .restitution = 0.3}})
                   .bond(MohrCoulomb{{.tensile = 1e6, .stiffness = 1e5}});
    sim.run({.end_time = 0.2});
    CHECK(sim.particles().kind[1] == Kind::grain);
    CHECK(sim.particles().position[1].z() == doctest::Approx(0.02).epsilon(1e-3).scale(0));
}
