// Hydraulic jumps that stand before a tailwater, in longer channels and for so long that what the start put
// behind them has left: Belanger's depth, and the energy that he says is lost. About ten minutes.
#include "hydraulic_jump.hpp"

#include <doctest/doctest.h>

using namespace hydraulic_jump;

namespace {

void check(Real froude, int n, Real toe) {
    const Jump jump{.froude = froude, .toe = toe, .length = toe + 120};
    // Behind the jump water runs at F / y: once and two thirds over that way.
    const Real leaves = (jump.length - jump.toe) * jump.sequent() / froude;
    const Jump::Found found = jump.run(n, 1.67 * leaves, 1.67 * leaves + 100);
    CHECK(std::abs(found.depth - 1) < 0.05);
    // Our own: it stands. See hydraulic_jump.cpp.
    CHECK(std::abs(found.momentum_lost) < 0.03);
    WARN(std::abs(found.speed) < 0.03);
    CHECK(std::abs(found.speed) < 0.045);
    CHECK(std::abs(found.lost - 1) < 0.1);
}

}  // namespace

TEST_CASE("Froude 2, 6 cells to the depth") { check(2, 6, 30); }

TEST_CASE("Froude 2, 10 cells to the depth") { check(2, 10, 30); }

TEST_CASE("Froude 3, 6 cells to the depth") { check(3, 6, 60); }
