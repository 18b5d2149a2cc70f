// What a step of volume of fluid costs, per wet cell: a dam breaking, a sloshing tank, a drop in a large dry
// box; and its parts: the plane in a cell, forth and back.

#include <abrade/fluid/vof/fill_below.hpp>
#include <abrade/fluid/vof/volume_of_fluid.hpp>

#include <benchmark/benchmark.h>

using namespace abrade;

namespace {

/// A box of 80 x 40 x 80 cells, `times` finer, with liquid where distance < 0, stirred by one roll about y.
struct Tank {
    Grid<3> grid;
    VolumeOfFluid<3> water;
    FaceField<3> flux = face_field<3>(grid.layout());
    FaceField<3> forth, back;
    Real dt = 0;

    Tank(int times, const auto& distance)
        : grid({.cells = {80 * times, 40 * times, 80 * times},
                .spacing = Point<3>::Constant(1.0 / (80 * times))}),
          water(grid, BoundaryConditions<3>::all(Boundary::wall)), forth(face_field<3>(grid.layout())) {
        fill_below<3>(water.fraction(), grid, distance, 2);
        water.prepare();
        const Real h = 1.0 / (80 * times);
        const auto stream = [](Real x, Real z) { return std::sin(pi * x) * std::sin(pi * z) / pi; };
        grid.for_each(
            [&](const CellNumber<3>& cell, Offset c) {
                const Real x = grid.face(0, cell[0]), z = grid.face(2, cell[2]);
                forth[0][c] = (stream(x, z + h) - stream(x, z)) / h;
                forth[2][c] = -(stream(x + h, z) - stream(x, z)) / h;
            },
            1);
        back = forth;
        for (auto& component : back)
            for (Offset i = 0; i < component.size(); ++i) component[i] = -component[i];
        dt = 0.6 * water.stable_step(forth);
    }
};

/// Five steps forth and five back, so that the surface stays as long as it was.
void measure(benchmark::State& state, Tank& tank) {
    long step = 0;
    double cells = 0, cut = 0;
    for (auto _ : state) {
        tank.water.advance(step++ / 5 % 2 == 0 ? tank.forth : tank.back, tank.dt, tank.flux);
        cells += static_cast<double>(tank.water.wet().cells());
        cut += tank.water.planes().count();
    }
    state.counters["s/wet_cell"] =
        benchmark::Counter(cells, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["s/cut_cell"] =
        benchmark::Counter(cut, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["wet_cells"] = cells / static_cast<double>(state.iterations());
    state.counters["cut_share"] = cut / cells;
    state.SetLabel(std::string(instruction_set));
}

Real wave(const Point<3>& x) { return 0.01 * std::sin(20 * x[1]) * std::cos(9 * x[0]); }

void volume_of_fluid_dam(benchmark::State& state) {
    Tank tank(static_cast<int>(state.range(0)),
              [](const Point<3>& x) { return 0.9 * std::max(x[0] - 0.5 - wave(x), x[2] - 0.5 - wave(x)); });
    measure(state, tank);
}

void volume_of_fluid_tank(benchmark::State& state) {
    Tank tank(static_cast<int>(state.range(0)),
              [](const Point<3>& x) { return 0.9 * (x[2] - 0.5 - 2 * wave(x)); });
    measure(state, tank);
}

void volume_of_fluid_drop(benchmark::State& state) {
    Tank tank(static_cast<int>(state.range(0)),
              [](const Point<3>& x) { return (x - Point<3>(0.5, 0.25, 0.5)).norm() - 0.1; });
    measure(state, tank);
}

/// Eight planes at once where the machine has the lanes.
template <bool back>
void planes_in_cells(benchmark::State& state) {
    std::array<Pack, 3> normal;
    Pack fraction{};
    for (int lane = 0; lane < pack_lanes; ++lane) {
        for (std::size_t a = 0; a < 3; ++a)
            normal[a].set(lane, std::sin(1.0 + lane + 3.0 * static_cast<Real>(a)));
        fraction.set(lane, 0.05 + 0.11 * lane);
    }
    Pack distance = plane_distance<3>(normal, fraction);
    for (auto _ : state) {
        benchmark::DoNotOptimize(normal);
        benchmark::DoNotOptimize(distance);
        if constexpr (back)
            benchmark::DoNotOptimize(plane_distance<3>(normal, fraction));
        else
            benchmark::DoNotOptimize(fraction_below<3>(normal, distance));
    }
    state.counters["s/plane"] = benchmark::Counter(static_cast<double>(state.iterations()) * pack_lanes,
                                                   benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(volume_of_fluid_dam)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);
BENCHMARK(volume_of_fluid_tank)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(volume_of_fluid_drop)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);
BENCHMARK(planes_in_cells<false>)->Name("volume_below_plane");
BENCHMARK(planes_in_cells<true>)->Name("plane_for_volume");

}  // namespace
