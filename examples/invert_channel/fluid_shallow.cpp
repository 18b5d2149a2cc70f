// Depth-averaged water: runs down the dry channel before the stones begin, then beside them, and feels them.

#include "run_channel.hpp"

#include <abrade/coupling/averaging/two_way_shallow.hpp>

namespace abrade::examples {

namespace {

TwoWayShallow<> shallow_channel(const ChannelConfig& c) {
    const WaterStart start(c);
    const Real half = 0.5 * c.invert.width;
    try {
        return TwoWayShallow<>{{.low = {0, -half},
                                .high = {c.invert.length, half},
                                .cells = {cells_along(c, c.invert.length), cells_along(c, c.invert.width)},
                                .boundaries = {{{ShallowBoundary::inflow(c.water.discharge, start.depth),
                                                 ShallowBoundary::outflow()},
                                                {ShallowBoundary::wall(), ShallowBoundary::wall()}}},
                                .bed = [invert = c.invert](Real, Real y) { return invert.bed_height(y); },
                                .gravity = c.invert.gravity(),
                                .manning = c.water.manning,
                                .density = c.water.density,
                                .viscosity = c.water.viscosity,
                                .start_time = -start.settle},
                               CliftGauvin{c.drag}};
    } catch (const InputError& error) {
        throw InputError(c.source + ", [fluid]: " + error.what());
    }
}

/// Depth of the water; 0 where it is dry [m].
Real depth_in_the_middle(const ShallowWater<2>& flow, Real x) {
    return std::max(0.0, flow.sample({x, 0, 0}, 0).depth);
}

/// Mean over the compared section of the depth at the centre line, and of the mean speed of its
/// cross-sections.
void measure(const ChannelConfig& c, const ShallowWater<2>& flow, ChannelWater& water) {
    Real depth = 0, speed = 0, froude = 0, shear = 0;
    Index counted = 0;
    for (Index i = 0; i < flow.grid().count(0); ++i) {
        const Real x = flow.grid().centre(0, i);
        if (x < c.comparison.from || x > c.comparison.to) continue;
        Real area = 0, width = 0;
        for (Index j = 0; j < flow.grid().count(1); ++j)
            if (flow.depth(i, j) > flow.params().dry_depth)
                area += flow.depth(i, j) * flow.grid().spacing(1), width += flow.grid().spacing(1);
        if (!(area > 0)) continue;  // the water has not come so far
        const Real middle = depth_in_the_middle(flow, x), mean = flow.discharge(i) / area;
        depth += middle, speed += mean, ++counted;
        froude += mean / std::sqrt(standard_gravity * area / width);
        shear += c.water.density * standard_gravity * square(c.water.manning * mean) /
                 std::cbrt(area / c.invert.wetted_perimeter(middle));
    }
    if (counted == 0) return;
    water.depth_m = depth / counted, water.speed_m_per_s = speed / counted;
    water.froude = froude / counted, water.bed_shear_Pa = shear / counted;
}

void look_at_the_end(const ShallowWater<2>& flow, ChannelWater& water) {
    water.columns = flow.grid().count(0);
    water.depth_map = flow.columns().depth;
    for (Index i = 0; i < water.columns; ++i) {
        water.surface_x.push_back(flow.grid().centre(0, i));
        water.surface_z.push_back(depth_in_the_middle(flow, water.surface_x.back()));
    }
    water.figures = {{"water_settled_s", std::min(flow.time(), 0.0) - flow.params().start_time},
                     {"water_steps", static_cast<Real>(flow.steps())},
                     {"water_cells", static_cast<Real>(flow.grid().cells())},
                     {"water_volume_m3", flow.volume()},
                     {"water_in_m3", flow.volume_in(0, false)},
                     {"water_out_m3", -flow.volume_in(0, true)},
                     {"water_volume_residual_relative", flow.volume_residual()},
                     {"water_discharge_at_outlet_m3_per_s", flow.discharge(flow.grid().count(0) - 1)}};
}

}  // namespace

ChannelRun run_in_shallow_water(const ChannelConfig& config, const ChannelFiles& files) {
    const UniformFlow uniform{config.water};
    ChannelWater water;
    water.manning_depth_m = uniform.depth(), water.manning_speed_m_per_s = uniform.mean_velocity();
    ChannelRun run = run_channel<LinearHysteretic>(
        config, files, shallow_channel(config), water, [&](const TwoWayShallow<>& flow, bool first) {
            first ? measure(config, flow.water(), water) : look_at_the_end(flow.water(), water);
        });
    run.results.water = std::move(water);
    return run;
}

}  // namespace abrade::examples
