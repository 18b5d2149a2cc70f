// What wear laws cost: the increment alone, and a whole small simulation with each, beside none.

#include <abrade/abrade.hpp>

#include <benchmark/benchmark.h>

#include <random>

using namespace abrade;

namespace {

/// Contacts that press and slide, each in another way; none has just begun, as most have not.
struct Contacts {
    static constexpr std::size_t packs = 64;
    std::vector<ContactKinematics<Pack>> contacts{packs};
    std::vector<ContactLoad<Pack>> loads{packs};

    explicit Contacts(bool begin) {
        std::mt19937 random(3);
        std::uniform_real_distribution<Real> u(0, 1);
        const auto each = [&](auto&& value) {
            Pack all;
            for (int k = 0; k < pack_lanes; ++k) all.set(k, value());
            return all;
        };
        for (std::size_t n = 0; n < packs; ++n) {
            ContactKinematics<Pack>& c = contacts[n];
            c.normal = {Pack(0), Pack(0), Pack(1)};
            c.overlap = each([&] { return 1e-5 * u(random); });
            c.velocity = {each([&] { return u(random); }), each([&] { return u(random); }),
                          each([&] { return u(random) - 0.5; })};
            c.inverse_mass = each([&] { return 10 + u(random); });
            c.time_step = 1e-5;
            c.touched = Pack(begin ? 0.0 : 1.0);
            ContactLoad<Pack>& load = loads[n];
            load.force = {each([&] { return -5 * u(random); }), Pack(0),
                          each([&] { return 10 * u(random); })};
            load.lost_normal = each([&] { return 1e-5 * u(random); });
            load.lost_tangential = each([&] { return 1e-5 * u(random); });
        }
    }
};

template <WearLaw Wear>
void wear_increment(benchmark::State& state, const Wear& wear, bool begin = false) {
    const Contacts all(begin);
    for (auto _ : state) {
        Pack worn = 0;
        for (std::size_t n = 0; n < Contacts::packs; ++n) {
            const auto one = wear.increment(all.contacts[n], all.loads[n]);
            worn += one.normal + one.tangential;
        }
        benchmark::DoNotOptimize(worn);
    }
    constexpr auto contacts = static_cast<double>(Contacts::packs * pack_lanes);
    state.counters["s/contact"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * contacts,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.SetLabel(std::string(instruction_set));
}

/// A hundred stones that slide and roll down bonded concrete, 30 degrees steep, in a periodic space.
Scene slope() {
    constexpr Real side = 0.4, angle = 30 * pi / 180;
    Scene scene;
    scene.gravity = standard_gravity * Vec3(std::sin(angle), 0, -std::cos(angle));
    scene.concrete = ConcreteBlock{flat_lattice(side, side, {.sphere_diameter = 0.02, .layers = 2})};
    scene.periodic_along = {true, true, false};
    scene.bounds = {Vec3(-0.5 * side, -0.5 * side, -1), Vec3(0.5 * side, 0.5 * side, 1)};
    for (int i = 0; i < 10; ++i)
        for (int j = 0; j < 10; ++j)
            scene.add_sphere(0.015, {.position = 0.04 * Vec3(i - 4.5, j - 4.5, 0.4),
                                     .velocity = Vec3(0.5 + 0.01 * j, 0.01 * i, 0)});
    return scene;
}

/// The same path under each law: nothing breaks, and what wears is not felt.
template <WearLaw Wear>
void wear_in_a_simulation(benchmark::State& state, const Wear& wear) {
    constexpr Index steps = 1000;
    auto sim = simulate(slope())
                   .contact(LinearSpring{{.stiffness = 1e6, .restitution = 0.5, .friction = 0.5}})
                   .bond(MohrCoulomb{{.tensile = 2.7e8, .stiffness = 1e6}})
                   .wear(wear);
    sim.run({.end_time = 0.02});  // down to the concrete
    const Real dt = sim.time_step();
    for (auto _ : state) sim.run({.end_time = sim.time() + steps * dt, .time_step = dt});
    state.counters["s/step"] = benchmark::Counter(static_cast<double>(state.iterations()) * steps,
                                                  benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["worn_mm3"] = 1e9 * (sim.concrete().worn_volume() + sim.concrete().overflow_volume());
}

const SubParticleAbrasion sub_particle{{}};
const Archard archard{{.coefficient = 1e-4, .hardness = 1e9}};
const Finnie finnie{{.flow_stress = 1e8}};
const SklarDietrich sklar_dietrich{{.tensile = 2.7e6, .youngs = 2.7e10}};
const Ishibashi ishibashi{{.impact = 1e-9, .friction = 1e-10}};

BENCHMARK_CAPTURE(wear_increment, none, NoWear{});
BENCHMARK_CAPTURE(wear_increment, sub_particle, sub_particle);
BENCHMARK_CAPTURE(wear_increment, archard, archard);
BENCHMARK_CAPTURE(wear_increment, finnie, finnie);
BENCHMARK_CAPTURE(wear_increment, finnie_all_begin, finnie, true);
BENCHMARK_CAPTURE(wear_increment, sklar_dietrich, sklar_dietrich);
BENCHMARK_CAPTURE(wear_increment, ishibashi, ishibashi);

// As many iterations for each, so that all go the same way.
BENCHMARK_CAPTURE(wear_in_a_simulation, none, NoWear{})->Iterations(10)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(wear_in_a_simulation, sub_particle, sub_particle)
    ->Iterations(10)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(wear_in_a_simulation, archard, archard)->Iterations(10)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(wear_in_a_simulation, finnie, finnie)->Iterations(10)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(wear_in_a_simulation, sklar_dietrich, sklar_dietrich)
    ->Iterations(10)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(wear_in_a_simulation, ishibashi, ishibashi)->Iterations(10)->Unit(benchmark::kMillisecond);

}  // namespace
