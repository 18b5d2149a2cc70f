// What a step costs on concrete that sleeps but where a stone hits it: blocks of 10,000 to 1,000,000 spheres.

#include <abrade/abrade.hpp>

#include <benchmark/benchmark.h>

#include <chrono>

using namespace abrade;

namespace {

/// Three layers, `columns` each way, and a stone that falls on the middle.
Scene block_under_a_stone(int columns) {
    const Real side = 0.02 * columns;
    Scene scene;
    scene.concrete = ConcreteBlock{flat_lattice(side, side, {.sphere_diameter = 0.02, .layers = 3})};
    scene.add_sphere(0.025, {.position = {0.003, 0.002, 0.045}});
    return scene;
}

void stone_on_sleeping_concrete(benchmark::State& state) {
    const auto columns = static_cast<int>(state.range(0));
    constexpr Real dt = 8e-6, start = 0.05, end = 0.45;
    double outside = 0, inside = 0;
    Real awake = 0;
    Index steps = 0;
    for (auto _ : state) {
        const auto before = std::chrono::steady_clock::now();
        auto sim = simulate(block_under_a_stone(columns))
                       .contact(LinearSpring{{.stiffness = 1e6, .restitution = 0.6, .friction = 0.4}})
                       .bond(MohrCoulomb{{.tensile = 2.7e6, .stiffness = 4e6, .damping = 0.3}})
                       .wear(SubParticleAbrasion{{.acceleration = 100}});
        const auto run = [&](Real until) { sim.run({.end_time = until, .time_step = dt, .wake_force = 3}); };
        run(start);  // what is measured begins above the concrete, long before the stone is there
        outside += std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
        const Real wall = sim.wall_seconds();
        const Index step = sim.steps();
        run(end);
        state.SetIterationTime(sim.wall_seconds() - wall);
        inside += sim.wall_seconds() - wall, steps += sim.steps() - step;
        awake = sim.awake_fraction_mean() * 2 * square(columns);
    }
    state.counters["s/step"] = benchmark::Counter(static_cast<double>(steps),
                                                  benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["spheres"] = 3.0 * columns * columns;
    state.counters["awake"] = awake;  // mean number of spheres
    state.counters["start_up_share"] = outside / (outside + inside);
}

BENCHMARK(stone_on_sleeping_concrete)
    ->Arg(58)
    ->Arg(184)
    ->Arg(578)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
