// What one step costs, per body: gravel alone, and the slots that are filled beside it. An absent policy must
// cost nothing: `gravel_alone` and `gravel_with_empty_slots` are the same program.

#include <abrade/abrade.hpp>

#include <benchmark/benchmark.h>

using namespace abrade;

namespace {

/// Spheres of 0.02 m at rest in a box, or falling there, `count` along each side of the floor, three layers.
Scene gravel(Index count) {
    Scene scene;
    const Real d = 0.02;
    for (Index k = 0; k < 3; ++k)
        for (Index i = 0; i < count; ++i)
            for (Index j = 0; j < count; ++j)
                scene.add_sphere(0.5 * d, {.position = {i * d, j * d, (k + 0.4999) * d}});
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    return scene;
}

Scene slab(Index count, Index layers) {
    Scene scene;
    scene.concrete =
        ConcreteBlock{flat_lattice(0.02 * count, 0.02 * count, {.sphere_diameter = 0.02, .layers = layers})};
    return scene;
}

LinearSpring contact() { return LinearSpring{{.stiffness = 1e5, .restitution = 0.5, .friction = 0.5}}; }

template <class Sim>
void measure(benchmark::State& state, Sim sim) {
    const Index steps = 100;
    sim.run({.end_time = 1e-9});  // builds the lists
    const Real dt = 0.5 * sim.stable_time_step().seconds;
    for (auto _ : state) sim.run({.end_time = sim.time() + steps * dt, .time_step = dt});
    state.counters["body_steps/s"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * steps * sim.particles().bodies(),
                           benchmark::Counter::kIsRate);
    state.counters["ledger_residual"] = sim.ledger().residual_relative();
}

void gravel_alone(benchmark::State& state) { measure(state, simulate(gravel(32)).contact(contact())); }

void gravel_with_empty_slots(benchmark::State& state) {
    measure(state, simulate(gravel(32)).contact(contact()).bond(NoBond{}).wear(NoWear{}).fluid(NoFluid{}));
}

/// 4,096 spheres that fall into a box, by one thread and by two: on a machine that other programs use, too,
/// two are to be hardly slower than one.
void falling_spheres(benchmark::State& state) {
    const int before = thread_count();
    set_thread_count(static_cast<int>(state.range(0)));
    Scene scene = gravel(0);
    for (int i = 0; i < 4096; ++i)
        scene.add_sphere(0.01,
                         {.position = {0.021 * (i % 16), 0.021 * (i / 16 % 16), 0.02 + 0.021 * (i / 256)}});
    for (const Real side : {-1.0, 1.0}) {
        scene.add_wall({0.16 + 0.3 * side, 0, 0}, {-side, 0, 0});
        scene.add_wall({0, 0.16 + 0.3 * side, 0}, {0, -side, 0});
    }
    measure(state, simulate(scene).contact(contact()));
    set_thread_count(before);
}

void gravel_in_water(benchmark::State& state) {
    measure(state, simulate(gravel(32)).contact(contact()).fluid(UniformFlow{{.discharge = 0.5}}));
}

void bonded_slab(benchmark::State& state) {
    measure(state, simulate(slab(32, 4))
                       .contact(contact())
                       .bond(MohrCoulomb{{.tensile = 2.7e6, .stiffness = 1e6}})
                       .wear(SubParticleAbrasion{{}}));
}

BENCHMARK(gravel_alone)->Unit(benchmark::kMillisecond);
BENCHMARK(gravel_with_empty_slots)->Unit(benchmark::kMillisecond);
BENCHMARK(falling_spheres)->ArgName("threads")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(gravel_in_water)->Unit(benchmark::kMillisecond);
BENCHMARK(bonded_slab)->Unit(benchmark::kMillisecond);

}  // namespace
