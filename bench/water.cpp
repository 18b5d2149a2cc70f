// What a step of water on a grid costs by cell, from 1e5 to 1e7 of them, in full boxes and half-full ones;
// how many iterations the pressure takes, up to 2e7 cells; what a second thread gives.

#include "../tests/verification/channel_water.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <random>

using namespace abrade;

namespace {

/// n^3 cells, a lid of speed 1 on top along x, Re 1000, steps of Courant number 0.32, or
/// `stable_step()` where that is shorter.
struct Cavity {
    GridFluid<3, FullBox> fluid;
    Real dt;

    explicit Cavity(int n)
        : fluid({.grid = {.cells = {n, n, n}, .spacing = Vec3::Constant(1.0 / n)},
                 .boundary_velocity = [](const Vec3& x, Real) { return Vec3(x.z() >= 1 ? 1 : 0, 0, 0); },
                 .density = 1,
                 .viscosity = 1e-3}),
          dt(0.32 / n) {}
    Real step_length() const { return std::min(dt, fluid.stable_step().seconds); }
};

/// Water that sloshes along a half-full channel of 4n x n x n cells and a little across it; steps of its own.
struct Channel {
    GridFluid<3> fluid;

    explicit Channel(int n)
        : fluid({.grid = {.cells = {4 * n, n, n}, .spacing = Vec3::Constant(1.0 / n)},
                 .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                 .water =
                     [](const Vec3& x) {
                         return 0.5 + 0.1 * std::cos(pi * x.x() / 4) + 0.02 * std::cos(pi * x.y()) - x.z();
                     },
                 .gravity = {0, 0, -9.81}}) {}
    Real step_length() const { return fluid.stable_step().seconds; }
};

/// The cross-section of the validation's channel, 50 x 26 cells of 0.02 m, half full, with waves of 2 m;
/// longer, not finer.
struct Reach {
    GridFluid<3> fluid;

    explicit Reach(int n)
        : fluid({.grid = {.cells = {n, 50, 26}, .spacing = Vec3::Constant(0.02)},
                 .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                 .water =
                     [](const Vec3& x) {
                         return 0.25 + 0.03 * std::cos(pi * x.x()) + 0.01 * std::cos(pi * x.y()) - x.z();
                     },
                 .gravity = {0, 0, -9.81}}) {}
    Real step_length() const { return fluid.stable_step().seconds; }
};

/// The validation's channel in n cells along it, full of uniform flow, which goes on.
struct InvertReach {
    channel_water::Channel<> fluid;

    explicit InvertReach(int n)
        : fluid(channel_water::channel(n * channel_water::spacing, true),
                MixingLength{{.depth = channel_water::wanted().depth}}) {}
    Real step_length() const { return fluid.stable_step().seconds; }
};

/// The same after 2 s: the flow has settled.
struct SettledReach : InvertReach {
    explicit SettledReach(int n) : InvertReach(n) { fluid.advance(2); }
};

/// The dam break of bench/peers, `times` finer.
struct DamBreak {
    GridFluid<3> fluid;
    Real dt;

    explicit DamBreak(int times)
        : fluid({.grid = {.cells = {80 * times, 40 * times, 80 * times},
                          .spacing = Vec3::Constant(0.0073 / times)},
                 .water = [](const Vec3& x) { return std::min(0.1461 - x.x(), 0.292 - x.z()); },
                 .gravity = {0, 0, -9.81},
                 .viscosity = 1e-3,
                 .tolerance = 1e-7}),
          dt(0.001 / times) {}
    Real step_length() const { return dt; }
};

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

template <class Scene>
void measure(benchmark::State& state, int threads) {
    set_thread_count(threads);
    Scene scene(static_cast<int>(state.range(0)));
    for (int step = 0; step < 5; ++step) scene.fluid.step(scene.step_length());
    double wet = 0, iterations = 0, rounds = 0;
    const double from = now();
    const Real began = scene.fluid.time();
    for (auto _ : state) {
        scene.fluid.step(scene.step_length());
        wet += static_cast<double>(scene.fluid.wet_cells());
        iterations += scene.fluid.last_projection().iterations;
        rounds += scene.fluid.last_projection().rounds;
    }
    // When that was, for bench/phases.
    state.counters["from"] = from, state.counters["until"] = now();
    set_thread_count(1);
    const auto steps = static_cast<double>(state.iterations());
    const auto cells = static_cast<double>(scene.fluid.grid().layout().cell_count());
    const auto by = [](double things) {
        return benchmark::Counter(things, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    };
    state.counters["s/cell_step"] = by(steps * cells);
    state.counters["s/wet_cell_step"] = by(wet);
    state.counters["cells"] = cells;
    state.counters["wet_cells"] = static_cast<double>(scene.fluid.wet_cells());
    if constexpr (requires { scene.fluid.liquid(); })
        state.counters["band_cells"] = static_cast<double>(scene.fluid.liquid().band().cells().size());
    state.counters["seconds/step"] = (scene.fluid.time() - began) / steps;
    state.counters["iterations"] = iterations / steps;
    state.counters["rounds"] = rounds / steps;
    state.SetLabel(std::string(instruction_set));
}

/// Time of the processor, of one thread. As many steps on all grids: the first ones ask more of the pressure.
template <class Scene>
void water_step(benchmark::State& state) {
    measure<Scene>(state, 1);
}
BENCHMARK(water_step<Cavity>)
    ->Name("water_cavity")
    ->Iterations(12)
    ->Arg(46)
    ->Arg(64)
    ->Arg(100)
    ->Arg(128)
    ->Arg(160)
    ->Arg(215)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(water_step<Channel>)
    ->Name("water_channel")
    ->Iterations(12)
    ->Arg(30)
    ->Arg(64)
    ->Arg(96)
    ->Arg(136)
    ->Unit(benchmark::kMillisecond);

BENCHMARK(water_step<Reach>)
    ->Name("water_reach")
    ->Iterations(12)
    ->Arg(80)
    ->Arg(800)
    ->Arg(7700)
    ->Unit(benchmark::kMillisecond);

BENCHMARK(water_step<InvertReach>)
    ->Name("water_invert")
    ->Iterations(20)
    ->Arg(225)
    ->Arg(2250)
    ->Unit(benchmark::kMillisecond);

/// Wall clock, for two threads against one: alternate them, take the best
/// (--benchmark_repetitions=9 --benchmark_enable_random_interleaving=true).
template <class Scene>
void water_threads(benchmark::State& state) {
    measure<Scene>(state, static_cast<int>(state.range(1)));
}
void pairs(benchmark::internal::Benchmark* of) {
    of->ArgNames({"", "threads"})
        ->UseRealTime()
        ->ComputeStatistics(
            "least", [](const std::vector<double>& v) { return *std::min_element(v.begin(), v.end()); })
        ->Unit(benchmark::kMillisecond);
}
BENCHMARK(water_threads<Cavity>)
    ->Name("water_threads_cavity")
    ->ArgsProduct({{64, 128}, {1, 2}})
    ->Apply(pairs);
BENCHMARK(water_threads<DamBreak>)
    ->Name("water_threads_dam_break")
    ->ArgsProduct({{1, 2}, {1, 2}})
    ->Apply(pairs);

BENCHMARK(water_threads<InvertReach>)
    ->Name("water_threads_invert")
    ->ArgsProduct({{225}, {1, 2}})
    ->Iterations(20)
    ->Apply(pairs);
BENCHMARK(water_threads<SettledReach>)
    ->Name("water_settled_invert")
    ->ArgsProduct({{225}, {1, 2}})
    ->Iterations(20)
    ->Apply(pairs);

// --- the pressure alone
// ---------------------------------------------------------------------------------------

/// Random right sides until four digits are found. `wet` tells of a cell's number; none dry: a closed box.
void pressure(benchmark::State& state, const CellNumber<3>& cells, auto&& wet) {
    const Grid<3> grid({.cells = cells, .spacing = Vec3::Ones()});
    ConjugateGradients<3> solver(grid.layout(), Vec3::Ones(), {});
    Poisson<3>& m = solver.matrix();
    m.interior.fill(1);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> value(-1, 1), distance(1e-4f, 1);
    grid.for_each([&](const CellNumber<3>& cell, Offset c) {
        for (int a = 0; a < 3; ++a) {
            if (cell[a] == 0) continue;
            CellNumber<3> other = cell;
            --other[a];
            const bool here = wet(cell), there = wet(other);
            if (here && there) m.face[a][c] = 1;
            if (here != there) m.dirichlet[here ? c : grid.layout().at(other)] += 1 / distance(random);
        }
    });
    solver.build();
    double count = 0;
    grid.for_each([&](const CellNumber<3>&, Offset c) { count += m.inverse_diagonal[c] > 0; });
    typename ConjugateGradients<3>::Report report;
    for (auto _ : state) {
        state.PauseTiming();
        grid.for_each([&](const CellNumber<3>&, Offset c) {
            const float v = value(random);
            solver.right_side()[c] = m.inverse_diagonal[c] > 0 ? v : 0;
        });
        Real squares = 0;
        grid.for_each([&](const CellNumber<3>&, Offset c) {
            squares += square(static_cast<Real>(solver.right_side()[c]));
        });
        state.ResumeTiming();
        report = solver.solve(1e-4 * std::sqrt(squares), 60);
    }
    state.counters["wet_cells"] = count;
    state.counters["iterations"] = report.iterations;
    state.counters["digits/iteration"] = std::log10(report.before / report.after) / report.iterations;
    state.counters["s/cell_iteration"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * count * report.iterations,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// A closed box, all of it water.
void water_pressure_box(benchmark::State& state) {
    const int n = static_cast<int>(state.range(0));
    pressure(state, {n, n, n}, [](const auto&) { return true; });
}
BENCHMARK(water_pressure_box)->Arg(46)->Arg(100)->Arg(215)->Arg(271)->Unit(benchmark::kMillisecond);

/// The same under a bumpy surface, which is as near to centres as 1e-4 of a cell.
void water_pressure_surface(benchmark::State& state) {
    const int n = static_cast<int>(state.range(0));
    pressure(state, {n, n, n}, [n](const CellNumber<3>& c) {
        return c[2] < 0.75 * n + 4 * std::sin(0.3 * c[0]) * std::cos(0.2 * c[1]);
    });
}
BENCHMARK(water_pressure_surface)->Arg(50)->Arg(110)->Arg(236)->Arg(299)->Unit(benchmark::kMillisecond);

/// 45 m of the channel in cells of 0.02 m, half full.
void water_pressure_channel(benchmark::State& state) {
    pressure(state, {2250, 50, 26}, [](const CellNumber<3>& c) {
        return c[2] < 12 + 2 * std::sin(0.3 * c[0]) * std::cos(0.2 * c[1]);
    });
}
BENCHMARK(water_pressure_channel)->Unit(benchmark::kMillisecond);

}  // namespace
