// Functions that are no templates, of abrade::compiled.

#define ABRADE_COMPILES_FUNCTIONS

#include <abrade/dem/store/cell_lists.hpp>
#include <abrade/geometry/sphere_union_moments.hpp>
