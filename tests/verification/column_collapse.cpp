// A column of grains collapses as its container is taken away (dem12): one small case. The scaling with the
// column's height is long_column_collapse.cpp.
#include "column_collapse.hpp"

#include <doctest/doctest.h>

using namespace column_collapse;

TEST_CASE(
    "a slice of a column as high as long spreads about as far as published, and comes to rest (dem12)") {
    Column column = column_of(Shape::flat, 16, 4e3);
    column.aspect = 0.75, column.width = 4;
    const Grains grains = settled(column);
    // A loose, frictional packing, beside walls.
    const Real filled = solid(cut(grains, column.height())) / (column.foot() * column.height());
    CHECK(filled > 0.5);
    CHECK(filled < 0.62);

    const Deposit deposit = collapse(column, cut(grains, column.height()));
    MESSAGE(deposit.after.size() << " grains, solid fraction " << filled << ", runout " << deposit.runout
                                 << " (law " << runout_law(Shape::flat, column.aspect) << "), height "
                                 << deposit.height << ", at rest after " << deposit.time << " sqrt(d/g)");
    const Real law = runout_law(Shape::flat, column.aspect);
    CHECK(deposit.runout > 0.5 * law);
    CHECK(deposit.runout < 2.5 * law);
    // Below a = 1 its top stays where it was, next to the wall.
    CHECK(deposit.height * column.radius > column.height() - 3);

    // Nothing is lost or made: all grains are there, and what they fell went into contacts.
    CHECK(deposit.after.size() == deposit.before.size());
    const Ledger& e = deposit.ledger;
    CHECK(e.residual_relative() < 1e-12);
    CHECK(std::abs(e.integration_residue()) < 0.02 * e.lost());
    CHECK(e.lost_sliding > e.lost_normal);
    CHECK(e.potential_start - e.potential == doctest::Approx(e.lost()).epsilon(0.05).scale(0));

    // It stands: at rest it is a pile, no layer, and not steeper than friction and rolling allow.
    const Real slope = deposit.height / (1 + deposit.runout);
    CHECK(slope > std::tan(radians(10)));
    CHECK(slope < std::tan(radians(35)));
}
