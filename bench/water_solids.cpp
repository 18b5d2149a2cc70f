// What stones in water on a grid cost, by exchange: the validation's channel below a height, in cells of 0.02
// m, with its mixture of stones in the flow, against the same water alone.

#include "../tests/verification/channel_water.hpp"

#include <abrade/coupling/exchange/monolithic.hpp>
#include <abrade/coupling/exchange/one_fluid.hpp>
#include <abrade/geometry/stone_shapes.hpp>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <limits>
#include <random>

using namespace abrade;

namespace {

template <class Solids>
using Water = GridFluid<3, Among<Solids, Turbulent<MixingLength, HeightSurface>>>;
using Stones = MonolithicSolids<>;

/// The five classes by equal volumes, in the validation's shapes, on the bed and up to a few diameters above
/// it.
struct Gravel {
    std::vector<Sphere> spheres;
    std::vector<FlowBody> bodies;

    Gravel(Index count, Real length) {
        constexpr std::array sizes{0.04, 0.05, 0.075, 0.1, 0.15};
        std::array<Clump, sizes.size()> shapes;
        std::ranges::transform(sizes, shapes.begin(), [](Real d) {
            return make_stone(d <= 0.05 ? StoneShape::angular : StoneShape::ellipsoid, d);
        });
        std::mt19937 random(5);
        std::uniform_real_distribution<Real> unit(0, 1);
        Real numbers = 0;
        for (const Real d : sizes) numbers += 1 / cube(d);
        const Real arc = channel_water::uniform_flow(length).params().section.arc_radius;
        std::vector<Sphere> places;
        std::vector<std::size_t> first;
        for (Index n = 0; n < count; ++n) {
            Real pick = unit(random) * numbers;
            std::size_t c = 0;
            while (c + 1 < sizes.size() && pick > 1 / cube(sizes[c])) pick -= 1 / cube(sizes[c++]);
            const Real radius = 0.5 * sizes[c];
            Vec3 x;
            do {
                const Real y = 0.25 * (2 * unit(random) - 1), up = radius * (1 + 0.3 * unit(random));
                x = {0.2 + unit(random) * (length - 0.6), y, arc - std::sqrt(square(arc - up) - square(y))};
            } while (std::ranges::any_of(
                places, [&](const Sphere& s) { return (s.centre - x).norm() < s.radius + radius; }));
            places.push_back({x, radius}), first.push_back(spheres.size());
            for (const Sphere& s : shapes[c].members) spheres.push_back({x + s.centre, s.radius});
            FlowBody body{.id = n, .position = x, .volume = 4.0 / 3 * pi * cube(radius)};
            body.inverse_mass = 1 / (2650 * body.volume);
            body.inverse_inertia = Mat3::Identity() * body.inverse_mass / (0.4 * square(radius));
            bodies.push_back(body);
        }
        first.push_back(spheres.size());
        for (std::size_t n = 0; n < bodies.size(); ++n)
            bodies[n].spheres = std::span(spheres).subspan(first[n], first[n + 1] - first[n]);
    }
    void move(Real dt) {
        for (FlowBody& body : bodies) {
            body.velocity = {2.5, 0, 0}, body.angular_velocity.setZero();
            body.position += dt * body.velocity;
        }
        for (Sphere& s : spheres) s.centre += dt * Vec3(2.5, 0, 0);
    }
};

/// `resolved_from` cells to a diameter; `count` stones in n cells along the channel.
template <class Solids>
void steps(benchmark::State& state, Solids solids, Index count) {
    const int n = static_cast<int>(state.range(0)), threads = static_cast<int>(state.range(1));
    set_thread_count(threads);
    const Real length = n * channel_water::spacing;
    Water<Solids> water(channel_water::channel(length, true), channel_water::mixing_length(),
                        std::move(solids));
    Gravel gravel(count, length);
    const auto step = [&] {
        const Real dt = water.stable_step().seconds;
        gravel.move(dt);
        if constexpr (Solids::present)
            water.advance(water.time() + dt, gravel.bodies);
        else
            water.step(dt);
    };
    for (int k = 0; k < 5; ++k) step();
    double wet = 0, iterations = 0;
    for (auto _ : state) {
        step();
        wet += static_cast<double>(water.wet_cells()), iterations += water.last_projection().iterations;
    }
    set_thread_count(1);
    state.counters["stones"] = static_cast<double>(count);
    state.counters["wet_cells"] = wet / static_cast<double>(state.iterations());
    state.counters["iterations"] = iterations / static_cast<double>(state.iterations());
    state.counters["s/wet_cell_step"] =
        benchmark::Counter(wet, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
/// 36 in a metre, as many as the channel holds after 25 s.
Index stones_in(int cells) { return static_cast<Index>(36 * cells * channel_water::spacing); }

void alone(benchmark::State& state) { steps(state, NoSolids{}, 0); }
void unresolved(benchmark::State& state) {
    const Stones all({.resolved_from = std::numeric_limits<Real>::infinity()});
    steps(state, all, stones_in(static_cast<int>(state.range(0))));
}
void by_size(benchmark::State& state) { steps(state, Stones{}, stones_in(static_cast<int>(state.range(0)))); }
void resolved(benchmark::State& state) {
    steps(state, Stones({.resolved_from = 0}), stones_in(static_cast<int>(state.range(0))));
}
void thousand(benchmark::State& state) { steps(state, Stones({.resolved_from = 0}), 1000); }
void mixture(benchmark::State& state) {
    steps(state, MixtureSolids{}, stones_in(static_cast<int>(state.range(0))));
}
void direct(benchmark::State& state) {
    steps(state, DirectForcing{}, stones_in(static_cast<int>(state.range(0))));
}
void whole(benchmark::internal::Benchmark* of) {
    of->ArgNames({"cells", "threads"})
        ->ArgsProduct({{2250}, {1, 2}})
        ->Iterations(20)
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
}
void lengths(benchmark::internal::Benchmark* of) { of->ArgsProduct({{225}, {1, 2}})->Apply(whole); }
BENCHMARK(alone)->Name("water_solids_none")->Apply(lengths);
BENCHMARK(unresolved)->Name("water_solids_unresolved")->Apply(lengths);
BENCHMARK(by_size)->Name("water_solids_by_size")->Apply(lengths);
BENCHMARK(resolved)->Name("water_solids_resolved")->Apply(lengths);
BENCHMARK(thousand)->Name("water_solids_thousand")->Apply(whole);
BENCHMARK(mixture)->Name("water_solids_mixture")->Apply(lengths);
BENCHMARK(direct)->Name("water_solids_direct")->Apply(lengths);

}  // namespace
