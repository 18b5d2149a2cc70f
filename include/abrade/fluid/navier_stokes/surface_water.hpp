#pragma once
// Water below a free surface: where it is, what it touches, and the advecting flux of its momentum.

#include <abrade/fluid/navier_stokes/surface_water_class.hpp>
#include <abrade/fluid/navier_stokes/surface_water_faces.hpp>
