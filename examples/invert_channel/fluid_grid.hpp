#pragma once
// Water on a grid of its own, below a surface of either kind: runs down the dry channel before the stones
// begin, then beside them.

#include "run_channel.hpp"

#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

namespace abrade::examples {

/// Below a FreeSurface or a HeightSurface, among stones that it resolves or not.
template <class Surface, class Solids = NoSolids>
using ChannelFlow = GridFluid<3, Among<Solids, Turbulent<MixingLength, Surface>>>;

template <class Flow>
Flow grid_channel(const ChannelConfig& c, auto solids) {
    const WaterStart start(c);
    const Real half = 0.5 * c.invert.width;
    const auto [length, width, height] = start.box(c.invert);
    const CellNumber<3> count{cells_along(c, length), cells_along(c, width), cells_along(c, height)};
    const Point<3> size(c.invert.length / count[0], c.invert.width / count[1], c.fluid.spacing);
    BoundaryConditions<3> boundaries;
    boundaries[0][1] = Boundary::outflow;
    boundaries[2] = {Boundary::free_slip, Boundary::free_slip};
    try {
        GridFluidParams<3> params{.grid = {.cells = count, .low = {0, -half, 0}, .spacing = size},
                                  .boundaries = boundaries,
                                  .wall = InvertWall(c.invert),
                                  .wall_law = {WallLaw::Kind::logarithmic, roughness_of(c)},
                                  .gravity = c.invert.gravity(),
                                  .density = c.water.density,
                                  .viscosity = c.water.viscosity,
                                  .courant = 0.9,
                                  .tolerance = 1e-5,
                                  .start_time = -start.settle};
        const Inflow<3> stream = stream_of(c);
        stream.give_to(params);
        if (c.fluid.begins_uniform) {
            params.water = [stream](const Vec3& x) { return stream.depth_at(x); };
            params.velocity = [stream](const Vec3& x) { return stream.velocity(x); };
        }
        const UniformFlow& uniform = start.uniform;
        Flow flow(std::move(params),
                  MixingLength{{.depth = uniform.depth(), .friction_velocity = uniform.friction_velocity()}},
                  std::move(solids));
        if (c.fluid.energy) flow.open_energy_account();
        return flow;
    } catch (const InputError& error) {
        throw InputError(c.source + ", [fluid]: " + error.what());
    }
}

/// Of the cross-section that begins with cells of number i along the channel.
struct SectionOfCells {
    Real area = 0, discharge = 0, width = 0;  ///< [m2], [m3/s], [m]
};
inline SectionOfCells section_of_cells(const auto& flow, int i) {
    const Grid<3>& grid = flow.grid();
    const Offset along = grid.layout().stride[0];
    SectionOfCells s;
    for (int j = 0; j < grid.cells(1); ++j) {
        bool wet = false;
        for (int k = 0; k < grid.cells(2); ++k) {
            const Offset c = grid.layout().at({i, j, k});
            const Real part = flow.liquid().fraction()[c] * flow.walls()->open_fraction()[c] *
                              grid.size(1, j) * grid.size(2, k);
            wet = wet || flow.liquid().fraction()[c] > 0.5;
            s.area += part;
            s.discharge += part * 0.5 * (flow.velocity()[0][c] + flow.velocity()[0][c + along]);
        }
        s.width += wet ? grid.size(1, j) : 0;
    }
    return s;
}

/// Mean over the compared section of the depth at the centre line, and of the mean speed of its
/// cross-sections.
inline void measure(const ChannelConfig& c, const auto& flow, ChannelWater& water) {
    Real depth = 0, speed = 0, froude = 0, shear = 0;
    int counted = 0;
    for (int i = 0; i < flow.grid().cells(0); ++i) {
        const Real x = flow.grid().centre(0, i);
        if (x < c.comparison.from || x > c.comparison.to) continue;
        const SectionOfCells s = section_of_cells(flow, i);
        if (!(s.area > 1e-6)) continue;  // the water has not come so far
        const Real middle = flow.surface_at({x, 0, 0}), mean = s.discharge / s.area;
        depth += middle, speed += mean, ++counted;
        froude += mean / std::sqrt(standard_gravity * s.area / std::max(s.width, flow.grid().size(1, 0)));
        shear += c.water.density * standard_gravity * square(c.water.manning * mean) /
                 std::cbrt(s.area / c.invert.wetted_perimeter(middle));
    }
    if (counted == 0) return;
    water.depth_m = depth / counted, water.speed_m_per_s = speed / counted;
    water.froude = froude / counted, water.bed_shear_Pa = shear / counted;
}

inline void look_at_the_end(const auto& flow, ChannelWater& water) {
    const Grid<3>& grid = flow.grid();
    water.columns = grid.cells(0);
    for (int j = 0; j < grid.cells(1); ++j)
        for (int i = 0; i < grid.cells(0); ++i) {
            Real depth = 0;
            for (int k = 0; k < grid.cells(2); ++k) {
                const Offset c = grid.layout().at({i, j, k});
                depth += flow.liquid().fraction()[c] * flow.walls()->open_fraction()[c] * grid.size(2, k);
            }
            water.depth_map.push_back(depth);
        }
    for (int i = 0; i < grid.cells(0); ++i) {
        water.surface_x.push_back(grid.centre(0, i));
        water.surface_z.push_back(flow.surface_at({grid.centre(0, i), 0, 0}));
    }
    water.figures = {
        {"water_settled_s", std::min(flow.time(), 0.0) - flow.params().start_time},
        {"water_steps", static_cast<Real>(flow.steps())},
        {"water_cells", static_cast<Real>(grid.layout().cell_count())},
        {"water_cells_wet", static_cast<Real>(flow.wet_cells())},
        {"water_volume_m3", flow.liquid().volume()},
        {"water_discharge_at_outlet_m3_per_s", section_of_cells(flow, grid.cells(0) - 1).discharge}};
    if constexpr (requires { flow.solids().averaged(); }) {
        const Index averaged = flow.solids().averaged();
        const auto all = static_cast<Index>(flow.solids().bodies().size());
        water.figures.push_back({"stones_resolved", static_cast<Real>(all - averaged)});
        water.figures.push_back({"stones_averaged", static_cast<Real>(averaged)});
    }
    if (!flow.has_energy_account()) return;
    const WaterEnergy& energy = flow.energy();
    energy.visit([&](std::string_view name, Real value) {
        if (name != "advection")  // of a full box
            water.figures.push_back({"water_energy_" + std::string(name) + "_joule", value});
    });
    water.figures.push_back({"water_energy_residual_relative", energy.residual_relative()});
}

template <class Surface, class Solids = NoSolids>
ChannelRun run_below(const ChannelConfig& config, const ChannelFiles& files, Solids solids = {}) {
    const UniformFlow uniform{config.water};
    ChannelWater water;
    water.manning_depth_m = uniform.depth(), water.manning_speed_m_per_s = uniform.mean_velocity();
    ChannelRun run = run_channel<LinearHysteretic>(
        config, files, grid_channel<ChannelFlow<Surface, Solids>>(config, std::move(solids)), water,
        [&](const auto& flow, bool first) {
            first ? measure(config, flow, water) : look_at_the_end(flow, water);
        });
    run.results.water = std::move(water);
    return run;
}

}  // namespace abrade::examples
