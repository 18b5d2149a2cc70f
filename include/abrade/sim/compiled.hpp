#pragma once
// The usual simulations without water on a grid, which abrade::compiled has compiled: a program that links it
// does not compile them again. Without that library this declares nothing.

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/bond/parallel_bond.hpp>
#include <abrade/core/compiled_as.hpp>
#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/dem/laws/linear_hysteretic.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/dem/laws/material_pairs.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

/// Calls one(contact, bond, wear, fluid, drag, force) for each of them.
// clang-format off
#define ABRADE_USUAL_GRAINS(one) \
    one(LinearSpring, NoBond, NoWear, NoFluid, NoDrag, NoForceOnBodies) \
    one(HertzMindlin, NoBond, NoWear, NoFluid, NoDrag, NoForceOnBodies) \
    one(MaterialPairs<LinearSpring>, NoBond, NoWear, NoFluid, NoDrag, NoForceOnBodies) \
    one(LinearSpring, NoBond, SubParticleAbrasion, NoFluid, NoDrag, NoForceOnBodies)
#define ABRADE_USUAL_BONDED(one) \
    one(LinearSpring, ParallelBond, NoWear, NoFluid, NoDrag, NoForceOnBodies) \
    one(LinearSpring, MohrCoulomb, NoWear, NoFluid, NoDrag, NoForceOnBodies) \
    one(LinearSpring, MohrCoulomb, SubParticleAbrasion, NoFluid, NoDrag, NoForceOnBodies) \
    one(LinearHysteretic, MohrCoulomb, SubParticleAbrasion, NoFluid, NoDrag, NoForceOnBodies)
// clang-format on

#ifdef ABRADE_COMPILED
namespace abrade {

#define ABRADE_IS_COMPILED(...)                         \
    extern template class World<Policies<__VA_ARGS__>>; \
    extern template class Simulation<__VA_ARGS__>;
ABRADE_USUAL_GRAINS(ABRADE_IS_COMPILED)
ABRADE_USUAL_BONDED(ABRADE_IS_COMPILED)
#undef ABRADE_IS_COMPILED

}  // namespace abrade
#endif
