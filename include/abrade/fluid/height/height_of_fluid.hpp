#pragma once
// Liquid below a surface that is a height: z = h(x, y, t).

#include <abrade/fluid/height/among_solids.hpp>
#include <abrade/fluid/height/height_of_fluid_class.hpp>
#include <abrade/fluid/height/step.hpp>
