#pragma once
// Water on a staggered Cartesian grid.

#include <abrade/fluid/grid_fluid_class.hpp>
#include <abrade/fluid/grid_fluid_steps.hpp>
