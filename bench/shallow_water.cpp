// What a step of depth-averaged water costs: per cell that it works on, in one dimension and two, with
// friction and without, from what fits a cache to what does not, and where most of the plane is dry. And what
// a stone's sample costs.

#include <abrade/fluid/shallow_water/shallow_water.hpp>

#include <benchmark/benchmark.h>

using namespace abrade;

namespace {

/// Water that goes on sloshing, over bumps.
template <int Dim>
ShallowWater<Dim> basin(Index cells, Real manning, Real level) {
    ShallowWaterParams<Dim> p;
    p.high.fill(1), p.cells.fill(cells);
    p.bed = [](Real x, Real y) { return 0.02 * std::sin(9 * x) * std::cos(7 * y); };
    p.surface = [level](Real x, Real y) { return x < 0.5 + 0.1 * y ? level + 0.1 : level; };
    p.manning = manning;
    return ShallowWater<Dim>(p);
}

template <int Dim>
void measure(benchmark::State& state, ShallowWater<Dim> water) {
    for (int n = 0; n < 20; ++n) water.advance(water.time() + water.stable_step().seconds);
    Real worked = 0;
    for (auto _ : state)
        for (int n = 0; n < 10; ++n) {
            water.advance(water.time() + 0.999 * water.stable_step().seconds);
            worked += water.cells_worked_on();
        }
    state.counters["cell_step"] =
        benchmark::Counter(worked, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["worked_on"] =
        worked / (10.0 * static_cast<double>(state.iterations())) / water.grid().cells();
    state.counters["volume_residual"] = water.volume_residual();
}

void plane(benchmark::State& state) { measure(state, basin<2>(static_cast<Index>(state.range(0)), 0, 0.1)); }
void plane_with_friction(benchmark::State& state) {
    measure(state, basin<2>(static_cast<Index>(state.range(0)), 0.015, 0.1));
}
void line(benchmark::State& state) { measure(state, basin<1>(static_cast<Index>(state.range(0)), 0, 0.1)); }

/// A pool of a hundredth of the plane: what the dry rest costs is what is above `plane`, per cell worked on.
void pool_in_a_desert(benchmark::State& state) {
    ShallowWaterParams<2> p;
    p.high.fill(1), p.cells.fill(static_cast<Index>(state.range(0)));
    p.bed = [](Real x, Real y) { return 2 * (square(x - 0.37) + square(y - 0.61)); };
    p.surface = [](Real x, Real) { return 2 * square(0.056) + 0.02 * (x - 0.37); };
    measure(state, ShallowWater<2>(p));
}
void desert(benchmark::State& state) {
    ShallowWaterParams<2> p;
    p.high.fill(1), p.cells.fill(static_cast<Index>(state.range(0)));
    ShallowWater<2> water(p);
    for (auto _ : state) water.advance(water.time() + 1);
    state.counters["cell_step"] = benchmark::Counter(
        water.grid().cells(), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void one_sample(benchmark::State& state) {
    const auto water = basin<2>(256, 0.015, 0.1);
    Vec3 x{0.3, 0.4, 0.05};
    for (auto _ : state) {
        benchmark::DoNotOptimize(water.sample(x, 0));
        x.x() = x.x() > 0.9 ? 0.1 : x.x() + 0.001;
    }
}

BENCHMARK(plane)->Arg(64)->Arg(256)->Arg(1024)->Unit(benchmark::kMillisecond);
BENCHMARK(plane_with_friction)->Arg(256)->Unit(benchmark::kMillisecond);
BENCHMARK(line)->Arg(1000)->Arg(65536)->Unit(benchmark::kMillisecond);
BENCHMARK(pool_in_a_desert)->Arg(1024)->Unit(benchmark::kMillisecond);
BENCHMARK(desert)->Arg(1024)->Unit(benchmark::kMillisecond);
BENCHMARK(one_sample);

}  // namespace
