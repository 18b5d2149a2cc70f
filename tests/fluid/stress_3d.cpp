// Scenes where solvers of free surfaces fail, in three dimensions; docs/verification/water_stress.md has the table.
#include "stress_checks.hpp"

TEST_CASE("thin water on cut walls, a hole, drops, a ball that moves: speed, energy, volume") {
    stress::check<3>(stress::space_scenes());
}
