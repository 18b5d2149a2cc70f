#pragma once
// The liquid's volume in each cell of a staggered grid, and how it is carried along: class VolumeOfFluid.

#include <abrade/fluid/volume_of_fluid_class.hpp>
#include <abrade/fluid/volume_settling.hpp>
#include <abrade/fluid/volume_surface.hpp>
#include <abrade/fluid/volume_sweeps.hpp>
