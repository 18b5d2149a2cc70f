// One flow of bench/peers, timed: bench_peers_water --case NAME. Prints JSON: a whole run with what its error
// is computed from, or for the cases that count cells the cell-steps a second.

#include "../../tests/verification/water_flows.hpp"

#include <abrade/core/simd.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <chrono>
#include <ctime>
#include <functional>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>

using namespace abrade;

namespace {

struct Options {
    std::string scene = "cavity", variant = "Koren";
    int cells = 32;  ///< across the side, the column, or the channel's length
    Real courant = 0.5;
    int warm = 10, steps = 20, rounds = 10, threads = 1;
    /// Share of a cell's volume gained or lost in a step, root mean square [-]; 0: what leaves no more of the
    /// divergence than OpenFOAM does.
    Real tolerance = 0;
};

/// What the last step left of |div u| dt. Full box: mean over the cells, as OpenFOAM's "sum local" of
/// continuity errors. Free surface: root mean square over wet cells, which is no less.
template <class Surface>
Real divergence(const GridFluid<3, Surface>& fluid, Real dt) {
    if constexpr (std::same_as<Surface, FreeSurface>) {
        return fluid.last_projection().after;
    } else {
        const Grid<3>& grid = fluid.grid();
        const auto& stride = grid.layout().stride;
        Real sum = 0;
        grid.for_each([&](const CellNumber<3>& cell, Offset c) {
            Real rate = 0;
            for (std::size_t a = 0; a < 3; ++a)
                rate += (fluid.velocity()[a][c + stride[a]] - fluid.velocity()[a][c]) /
                        grid.size(static_cast<int>(a), cell[a]);
            sum += std::abs(rate) * dt;
        });
        return sum / grid.layout().cell_count();
    }
}

/// 64^3 cells, a lid of speed 1 on top along x, Re 1000.
auto cavity_cells(const Options& o) {
    const int n = 64;
    return GridFluid<3, FullBox>(
        {.grid = {.cells = {n, n, n}, .spacing = Vec3::Constant(1.0 / n)},
         .boundary_velocity = [](const Vec3& x, Real) { return Vec3(x.z() >= 1 ? 1 : 0, 0, 0); },
         .density = 1,
         .viscosity = 1e-3,
         .tolerance = o.tolerance > 0 ? o.tolerance : 1e-9});
}

/// 80 x 40 x 80 cells, a column of 0.1461 m by 0.292 m across the whole width.
auto dam_break_cells(const Options& o) {
    return GridFluid<3>({.grid = {.cells = {80, 40, 80}, .spacing = Vec3::Constant(0.0073)},
                         .water = [](const Vec3& x) { return std::min(0.1461 - x.x(), 0.292 - x.z()); },
                         .gravity = {0, 0, -9.81},
                         .viscosity = 1e-3,
                         .tolerance = o.tolerance > 0 ? o.tolerance : 1e-7});
}

/// One thread: time on the processor, as OpenFOAM's ExecutionTime, which others on the machine do not
/// lengthen. More: wall clock.
Real now(int threads) {
    if (threads == 1) return static_cast<Real>(std::clock()) / CLOCKS_PER_SEC;
    return std::chrono::duration<Real>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Cells that hold water count as wet; those of the box count whether they do or not.
void measure(const Options& o, Real dt, auto&& make) {
    Real seconds = 0, wet_steps = 0, left = 0;
    Index box = 0;
    for (int round = 0; round < o.rounds; ++round) {
        auto fluid = make();
        box = fluid.grid().layout().cell_count();
        for (int step = 0; step < o.warm; ++step) fluid.step(dt);
        const Real start = now(o.threads);
        for (int step = 0; step < o.steps; ++step) fluid.step(dt);
        seconds += now(o.threads) - start;
        wet_steps += static_cast<Real>(fluid.wet_cells()) * o.steps;
        left = std::max(left, divergence(fluid, dt));
    }
    const Real box_steps = static_cast<Real>(box) * o.steps * o.rounds;
    const nlohmann::json result{{"case", o.scene},
                                {"wet_cell_steps_per_s", wet_steps / seconds},
                                {"box_cell_steps_per_s", box_steps / seconds},
                                {"divergence_dt_mean", left},
                                {"instruction_set", instruction_set},
                                {"compiler", ABRADE_COMPILER}};
    std::cout << result.dump() << "\n";
}

nlohmann::json data_of(const water_flows::CentreLines& f) { return {{"at", f.at}, {"u", f.u}, {"v", f.v}}; }
nlohmann::json data_of(const water_flows::Vortices& f) {
    return {{"u", f.u}, {"v", f.v}, {"u_at", {0, 0.5}}, {"v_at", {0.5, 0}}};
}
nlohmann::json data_of(const water_flows::Collapse& f) { return {{"time", f.time}, {"floor", f.floor}}; }
nlohmann::json data_of(const water_flows::Bump& f) { return {{"x", f.x}, {"level", f.surface}}; }

/// A whole run to its end, by the name of a variant.
template <class Flow>
using Variants = std::map<std::string, std::function<Flow(int, const water_flows::Choice&)>>;

template <class Flow>
void run_whole(const Options& o, const Variants<Flow>& variants) {
    const auto found = variants.find(o.variant);
    if (found == variants.end()) {
        std::string known;
        for (const auto& [name, once] : variants) known += (known.empty() ? "" : ", ") + name;
        throw std::runtime_error("case " + o.scene + " has no variant '" + o.variant + "'; there are " +
                                 known);
    }
    const auto run = water_flows::timed([&] {
        return found->second(o.cells,
                             {.tolerance = o.tolerance > 0 ? o.tolerance : 1e-6, .courant = o.courant});
    });
    const nlohmann::json result{{"case", o.scene},
                                {"variant", o.variant},
                                {"cells", run.flow.cost.cells},
                                {"steps", run.flow.cost.steps},
                                {"seconds", run.seconds},
                                {"data", data_of(run.flow)},
                                {"instruction_set", instruction_set},
                                {"compiler", ABRADE_COMPILER}};
    std::cout << result.dump() << "\n";
}

void run(const Options& o) {
    using namespace water_flows;
    if (o.scene == "cavity")
        run_whole<CentreLines>(o, {{"Koren", water_flows::cavity<Koren>},
                                   {"Central", water_flows::cavity<Central>},
                                   {"Koren in float", water_flows::cavity<Koren, float>},
                                   {"Central in float", water_flows::cavity<Central, float>}});
    if (o.scene == "taylor_green")
        run_whole<Vortices>(o, {{"Koren", taylor_green<Koren>},
                                {"Central", taylor_green<Central>},
                                {"Koren in float", taylor_green<Koren, float>},
                                {"Central in float", taylor_green<Central, float>}});
    if (o.scene == "dam_break")
        run_whole<Collapse>(
            o, {{"Koren", water_flows::dam_break<Koren>}, {"Central", water_flows::dam_break<Central>}});
    if (o.scene == "bump")
        run_whole<Bump>(o, {{"Koren", bump<FreeSurface, Koren>},
                            {"Central", bump<FreeSurface, Central>},
                            {"Koren, height", bump<HeightSurface, Koren>},
                            {"Central, height", bump<HeightSurface, Central>}});
    if (o.scene == "cavity_cells") measure(o, 0.005, [&] { return cavity_cells(o); });
    if (o.scene == "dam_break_cells") measure(o, 0.001, [&] { return dam_break_cells(o); });
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app{"Times the flows that bench/peers/run compares."};
    app.add_option("--case", options.scene)
        ->check(CLI::IsMember(
            {"cavity", "taylor_green", "dam_break", "bump", "cavity_cells", "dam_break_cells"}));
    app.add_option("--variant", options.variant, "scheme, state, surface");
    app.add_option("--cells", options.cells, "across the side, the column, or along the channel")
        ->check(CLI::PositiveNumber);
    app.add_option("--courant", options.courant)->check(CLI::PositiveNumber);
    app.add_option("--steps", options.steps, "timed, in each round")->check(CLI::PositiveNumber);
    app.add_option("--warm", options.warm, "steps before")->check(CLI::PositiveNumber);
    app.add_option("--rounds", options.rounds, "from the beginning each")->check(CLI::PositiveNumber);
    app.add_option("--tolerance", options.tolerance)->check(CLI::PositiveNumber);
    app.add_option("--threads", options.threads)->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);
    try {
        set_thread_count(options.threads);
        run(options);
    } catch (const std::exception& problem) {
        std::cerr << "error: " << problem.what() << "\n";
        return 1;
    }
}
