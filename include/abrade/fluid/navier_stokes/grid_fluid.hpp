#pragma once
// Water on a staggered Cartesian grid.

#include <abrade/fluid/navier_stokes/grid_fluid_class.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid_steps.hpp>
