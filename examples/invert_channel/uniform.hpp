#pragma once
// Steady uniform flow: prescribed, from Manning's formula. One file for each contact law, which is compiled
// by itself.

#include "run_channel.hpp"

namespace abrade::examples {

template <class Contact>
ChannelRun run_uniform(const ChannelConfig& config, const ChannelFiles& files) {
    ChannelWater water;
    ChannelRun run = run_channel<Contact>(
        config, files, UniformFlow{config.water}, water, [&](const UniformFlow& flow, bool) {
            water.depth_m = water.manning_depth_m = flow.depth();
            water.speed_m_per_s = water.manning_speed_m_per_s = flow.mean_velocity();
            water.froude = flow.froude(), water.bed_shear_Pa = flow.bed_shear();
            water.surface_x = {0, config.invert.length}, water.surface_z = {flow.depth(), flow.depth()};
        });
    run.results.water = std::move(water);
    return run;
}

}  // namespace abrade::examples
