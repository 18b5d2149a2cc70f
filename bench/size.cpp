// What a step costs a sphere in scenes of 5,000 to 1,000,000, and the memory it takes.

#include <abrade/abrade.hpp>

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <random>

using namespace abrade;

namespace {

/// A cubic crystal of pressed spheres of 0.02 m, `side` along each axis, periodic: three contacts each.
Scene crystal_of(int side) {
    const Real pitch = 0.02 * (1 - 1e-4);
    Scene scene;
    scene.gravity.setZero();
    scene.periodic_along = {true, true, true};
    scene.bounds = {Vec3::Zero(), Vec3::Constant(side * pitch)};
    std::mt19937 random(1);
    std::normal_distribution<Real> speed(0, 1e-3);
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j)
            for (int k = 0; k < side; ++k) {
                Vec3 velocity;
                for (Real& component : velocity) component = speed(random);
                scene.add_sphere(
                    0.01, {.position = pitch * Vec3(i + 0.5, j + 0.5, k + 0.5), .velocity = velocity}, 2500);
            }
    return scene;
}

void crystal(benchmark::State& state) {
    const Real dt = 1.4e-5;
    const Index steps = 100;
    auto sim = simulate(crystal_of(static_cast<int>(state.range(0))))
                   .contact(LinearSpring{{.stiffness = 1e5, .restitution = 0.5, .friction = 0.5}});
    const auto run = [&] { sim.run({.end_time = sim.time() + steps * dt, .time_step = dt, .skin = 0.002}); };
    run();
    for (auto _ : state) {
        const Real before = sim.wall_seconds();
        run();
        state.SetIterationTime(sim.wall_seconds() - before);
    }
    const auto spheres = static_cast<double>(sim.particles().bodies());
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    state.counters["s/sphere_step"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * steps * spheres,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    // Of the process, whose largest scene this must be.
    state.counters["peak_bytes/sphere"] = 1024.0 * static_cast<double>(usage.ru_maxrss) / spheres;
}

BENCHMARK(crystal)->Arg(17)->Arg(27)->Arg(46)->Arg(100)->UseManualTime()->Unit(benchmark::kMillisecond);

/// What one core moves through memory: an array larger than any cache, read and written.
void memory(benchmark::State& state) {
    std::vector<Real> numbers(20'000'000, 1.0);
    for (auto _ : state) {
        for (Real& x : numbers) x = 1.0001 * x + 1;
        benchmark::ClobberMemory();
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                            static_cast<std::int64_t>(2 * sizeof(Real) * numbers.size()));
}

BENCHMARK(memory)->Unit(benchmark::kMillisecond);

}  // namespace
