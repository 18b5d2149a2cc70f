#pragma once
// The whole house, but for files: <abrade/io/...> needs HDF5 and is included on its own.

#include <abrade/bond/elastic_brittle.hpp>
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/bond/parallel_bond.hpp>
#include <abrade/bond/twist_resistance.hpp>
#include <abrade/coupling/drag/drag.hpp>
#include <abrade/dem/laws/elastic_plastic_hertz.hpp>
#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/dem/laws/linear_hysteretic.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/dem/laws/lubrication.hpp>
#include <abrade/dem/laws/material_pairs.hpp>
#include <abrade/dem/laws/rolling_resistance.hpp>
#include <abrade/fluid/shallow_water/shallow_water.hpp>
#include <abrade/fluid/uniform_flow.hpp>
#include <abrade/geometry/gravel.hpp>
#include <abrade/geometry/stone_shapes.hpp>
#include <abrade/geometry/surface_lattice.hpp>
#include <abrade/sim/print.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/archard.hpp>
#include <abrade/wear/finnie.hpp>
#include <abrade/wear/ishibashi.hpp>
#include <abrade/wear/sklar_dietrich.hpp>
#include <abrade/wear/sub_particle.hpp>

#ifdef ABRADE_COMPILED
#include <abrade/sim/compiled.hpp>
#endif
