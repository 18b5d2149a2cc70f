// Stones in water below a height, velocities of both found together with the pressure: all resolved, by size,
// all averaged.
#include "stones_in_water.hpp"

#include <abrade/coupling/exchange/monolithic.hpp>

using namespace same_bits;

namespace {

using Flow = GridFluid<3, Among<MonolithicSolids<>, HeightSurface>>;

Flow tank(MonolithicSolids<>::Params solids, int along = 14) {
    return Flow(stone_tank<HeightSurface>(along), {}, MonolithicSolids<>(solids));
}

const Register resolved{
    "stones.height_resolved",
    [] { return fall_in(tank({.resolved_from = 0}), stones_above_floor(0), 0.25).with({"flow_work"}); }};
const Register by_size{"stones.height_by_size", [] {
                           return fall_in(tank({.resolved_from = 3}), stones_above_floor(8), 0.25)
                               .with({"flow_work", "averaged"});
                       }};
const Register averaged{"stones.height_averaged", [] {
                            return fall_in(tank({.resolved_from = 100, .lift = 0.5}), stones_above_floor(8),
                                           0.25)
                                .with({"flow_work", "averaged"});
                        }};
const Register many{
    "stones.height_many", [] {
        return fall_in(tank({.resolved_from = 3}, 70), many_stones(), 0.12).with({"flow_work", "averaged"});
    }};

}  // namespace
