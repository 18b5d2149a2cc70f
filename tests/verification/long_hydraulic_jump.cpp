// Hydraulic jumps that stand before a tailwater, on more cells and of a faster stream. About a minute.
#include "hydraulic_jump.hpp"

#include <doctest/doctest.h>

using namespace hydraulic_jump;

namespace {

void check(const Jump::Found& found) {
    CHECK(std::abs(found.depth - 1) < 0.05);
    CHECK(std::abs(found.speed) < 0.03);
    WARN(std::abs(found.lost - 1) < 0.1);
}

}  // namespace

TEST_CASE("Froude 2, 10 cells to the depth") { check(Jump{}.run(10, 40, 100)); }

TEST_CASE("Froude 3, 6 cells to the depth") {
    check(Jump{.froude = 3, .toe = 20, .length = 60}.run(6, 40, 80));
}
