// expect: compile without -ffast-math
// Water alone, compiled with -ffast-math: guards against NaN and infinity would be dropped.
#undef __FINITE_MATH_ONLY__
#define __FINITE_MATH_ONLY__ 1
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

int main() {}
