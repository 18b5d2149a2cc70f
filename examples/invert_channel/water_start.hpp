#pragma once
// How water that flows down the channel begins, and the cells that its grid has.

#include "config.hpp"

#include <abrade/fluid/setup/inflow.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace abrade::examples {

/// What flowing water begins with, where the configuration leaves it open.
struct WaterStart {
    explicit WaterStart(const ChannelConfig& c)
        : uniform(c.water), depth(c.fluid.inflow_depth > 0 ? c.fluid.inflow_depth : uniform.depth()),
          settle(c.fluid.settle) {
        if (settle > 0) return;
        settle = 1 + 3 * c.invert.length / uniform.mean_velocity();
        if (c.fluid.begins_uniform) settle = std::min(settle, Real(3));
    }
    UniformFlow uniform;
    Real depth;   ///< at the centre line, upstream [m]
    Real settle;  ///< before the stones begin [s]

    /// Of a grid along the channel, across and up: twice the depth, and the banks below its surface [m].
    std::array<Real, 3> box(const Invert& invert) const {
        return {invert.length, invert.width,
                std::max(2 * depth, depth + invert.bed_height(0.5 * invert.width))};
    }
};

/// Cells of a grid along a length [m].
inline Index cells_along(const ChannelConfig& c, Real length) {
    return static_cast<Index>(std::ceil(length / c.fluid.spacing - 1e-9));
}

/// Strickler's height k_s [m].
inline Real roughness_of(const ChannelConfig& c) { return std::pow(26 * c.water.manning, 6); }

/// The profile of uniform flow, at the depth that is given: what enters is the discharge. Throws InputError.
inline Inflow<3> stream_of(const ChannelConfig& c) {
    return Inflow<3>({.discharge = c.water.discharge,
                      .depth = WaterStart(c).depth,
                      .section = c.invert,
                      .profile = InflowProfile::logarithmic,
                      .roughness = roughness_of(c)});
}

/// Throws InputError where the water cannot be had on a grid of such cells, which is told before they are
/// made.
inline void check_cells(const ChannelConfig& c) {
    const WaterStart start(c);
    const bool shallow = c.fluid.model == "shallow";
    if (!shallow) stream_of(c);
    require(shallow || c.fluid.spacing <= start.depth,
            {"fluid.spacing", "at most the water's depth of " + short_text(start.depth) + " m", "m",
             "take smaller cells, deeper water or fluid.model = \"shallow\""},
            c.fluid.spacing);
    const auto [length, width, height] = start.box(c.invert);
    const Real columns = length * width / square(c.fluid.spacing);
    const Real cells = shallow ? columns : columns * height / c.fluid.spacing;
    constexpr Real most = 1e8;  // some 300 GB
    require(cells <= most,
            {"fluid.spacing of " + to_text(c.fluid.spacing) + " m: cells", "at most " + to_text(most), "",
             "take larger cells or a shorter channel"},
            cells);
}

}  // namespace abrade::examples
