#pragma once
// The liquid's volume in each cell of a staggered grid, and how it is carried along: class VolumeOfFluid.

#include <abrade/fluid/vof/redistribution.hpp>
#include <abrade/fluid/vof/surface_position.hpp>
#include <abrade/fluid/vof/sweeps.hpp>
#include <abrade/fluid/vof/volume_of_fluid_class.hpp>
