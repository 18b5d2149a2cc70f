// A slice of a column of gravel collapses in still water and in air: the same grains, averaged in cells of
// one grain. docs/verification/column_collapse.md has the table.
#include "column_collapse.hpp"

#include <abrade/coupling/exchange/monolithic.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

using namespace column_collapse;

namespace {

/// A closed box of water over the bed, its catching floor included, half as high again as the column.
auto still_water(const Column& column) {
    using Water = GridFluid<3, Among<MonolithicSolids<>, FullBox>>;
    const int along = static_cast<int>(std::ceil(reach_of(column))) + 2,
              across = static_cast<int>(std::lround(column.width)),
              up = static_cast<int>(std::ceil(1.5 * column.height())) + 2;
    auto boundaries = BoundaryConditions<3>::all(Boundary::free_slip);
    boundaries[1] = {Boundary::periodic, Boundary::periodic};
    return Water({.grid = {.cells = {along, across, up},
                           .low = {0, 0, -diameter},
                           .spacing = Vec3::Constant(diameter)},
                  .boundaries = boundaries,
                  .gravity = {0, 0, -g},
                  .courant = 0.9});
}

/// When the front has gone nine tenths of its way [sqrt(d/g)].
Real arrival(const Deposit& deposit) {
    const Real begins = deposit.column.radius, ends = deposit.fronts.back();
    for (std::size_t n = 0; n < deposit.times.size(); ++n)
        if (deposit.fronts[n] >= begins + 0.9 * (ends - begins)) return deposit.times[n];
    return deposit.times.back();
}

}  // namespace

TEST_CASE("a column collapses later and less far under water, and loses as much less as the water carries") {
    Column column = column_of(Shape::flat, 16, 4e3);
    column.aspect = 1, column.width = 6;
    const Grains grains = cut(settled(column), column.height());
    const Deposit dry = collapse(column, grains, grain_law(column)),
                  wet = collapse(column, grains, grain_law(column), still_water(column));
    const Ledger &in_air = dry.ledger, &in_water = wet.ledger;
    MESSAGE(grains.size() << " grains; runout " << dry.runout << " in air, " << wet.runout
                          << " under water; nine tenths of it after " << arrival(dry) << " and "
                          << arrival(wet) << " sqrt(d/g); height " << dry.height << " and " << wet.height);
    MESSAGE("lost in contacts " << in_air.lost() << " and " << in_water.lost() << " J, given to the water "
                                << -in_water.flow_work << " J, fallen "
                                << in_air.potential_start - in_air.potential << " and "
                                << in_water.potential_start - in_water.potential << " J");
    CHECK(wet.after.size() == wet.before.size());
    CHECK(wet.runout < dry.runout);
    CHECK(wet.runout > 0.4 * dry.runout);
    CHECK(arrival(wet) > 1.3 * arrival(dry));
    CHECK(in_water.residual_relative() < 1e-12);
    // What they fell: the water bears 1/2.65 of it, is stirred by more, and contacts have the rest.
    const Real fallen = in_water.potential_start - in_water.potential;
    CHECK(-in_water.flow_work > fallen / 2.65);
    CHECK(in_water.lost() < (1 - 1 / 2.65) * fallen);
    CHECK(std::abs(in_water.integration_residue()) < 0.02 * fallen);
}
