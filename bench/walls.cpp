// What walls on a grid cost: built, and renewed about one sphere; by cell and by cell that a wall cuts.

#include <abrade/fluid/embedded_boundary/embedded_boundary.hpp>

#include <benchmark/benchmark.h>

using namespace abrade;

namespace {

Grid<3> channel_grid(Real length, Real spacing) {
    const auto cells = [&](Real size) { return static_cast<int>(std::lround(size / spacing)); };
    return Grid<3>({.cells = {cells(length), cells(1.0), cells(0.52)},
                    .low = {0, -0.5, 0},
                    .spacing = Vec3::Constant(spacing)});
}

const Invert invert{.length = 45, .width = 1, .arc_radius = 1};

/// The bed as spheres of 0.02 m in three layers, on what is solid below them.
auto bed_of_spheres(Real length) {
    const Lattice lattice = invert_lattice({.length = length, .width = 1, .arc_radius = 1}, {});
    return SpherePacking(lattice);
}

void count(benchmark::State& state, const EmbeddedBoundary<3>& walls) {
    const auto per = [&](std::size_t things) {
        return benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(things),
                                  benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    };
    state.counters["s/cell"] = per(static_cast<std::size_t>(walls.grid().layout().cell_count()));
    state.counters["s/wall_cell"] = per(walls.cut_cells().size());
    state.counters["wall_cells"] = static_cast<double>(walls.cut_cells().size());
}

void build(benchmark::State& state, const Grid<3>& grid, const auto& shape) {
    const EmbeddedBoundary<3> walls(grid, shape);
    for (auto _ : state) benchmark::DoNotOptimize(EmbeddedBoundary<3>(grid, shape).open_cells());
    count(state, walls);
}

/// The channel of the validation: the whole of it has 2250 x 50 x 26 cells.
void walls_invert(benchmark::State& state) {
    build(state, channel_grid(static_cast<Real>(state.range(0)), 0.02), InvertWall(invert));
}
BENCHMARK(walls_invert)->Arg(5)->Arg(45)->Unit(benchmark::kMillisecond);

void walls_plane_in_cube(benchmark::State& state) {
    const int n = static_cast<int>(state.range(0));
    build(state, Grid<3>({.cells = {n, n, n}, .spacing = Vec3::Constant(1.0 / n)}),
          PlaneWall<3>({0.3, 0.3, 0.3}, {0.3, 0.5, 0.8}));
}
BENCHMARK(walls_plane_in_cube)->Arg(64)->Arg(128)->Unit(benchmark::kMillisecond);

void walls_spheres(benchmark::State& state) { build(state, channel_grid(2, 0.01), bed_of_spheres(2)); }
BENCHMARK(walls_spheres)->Unit(benchmark::kMillisecond);

/// One sphere of the bed wears: what a step pays in which concrete is lost.
void walls_update_one_sphere(benchmark::State& state) {
    SpherePacking bed = bed_of_spheres(2);
    const Grid<3> grid = channel_grid(2, 0.01);
    EmbeddedBoundary<3> walls(grid, bed);
    const std::size_t worn = bed.size() / 2;
    const auto [centre, radius] = bed.sphere(worn);
    for (auto _ : state) {
        bed.set_radius(worn, bed.sphere(worn).radius == radius ? 0.9 * radius : radius);
        walls.update(bed, centre - Vec3::Constant(radius), centre + Vec3::Constant(radius));
    }
    state.counters["wall_cells"] = static_cast<double>(walls.cut_cells().size());
}
BENCHMARK(walls_update_one_sphere)->Unit(benchmark::kMillisecond);

}  // namespace
