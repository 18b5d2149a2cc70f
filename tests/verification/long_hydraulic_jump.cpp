// Hydraulic jumps that stand before a tailwater, in channels so long that the water behind them runs smoothly
// again, as Belanger has it: his depth, and the energy that he says is lost. About five minutes.
#include "hydraulic_jump.hpp"

#include <doctest/doctest.h>

using namespace hydraulic_jump;

namespace {

void check(const Jump& jump, int n) {
    const Jump::Found found = jump.run(n, 100, 200);
    CHECK(std::abs(found.depth - 1) < 0.05);
    CHECK(std::abs(found.lost - 1) < 0.1);
    // Our own: it stands.
    CHECK(std::abs(found.speed) < 0.03);
}

}  // namespace

TEST_CASE("Froude 2, 6 cells to the depth") { check({.length = 150}, 6); }

TEST_CASE("Froude 2, 10 cells to the depth") { check({.length = 150}, 10); }

TEST_CASE("Froude 3, 6 cells to the depth") { check({.froude = 3, .toe = 20, .length = 150}, 6); }
