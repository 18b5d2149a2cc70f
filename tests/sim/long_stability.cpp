// The stable step of poured beds of clumps, and of balls under HertzMindlin: minutes of pouring.
#include "stable_limits.hpp"

using namespace abrade;
using namespace abrade::charts;

TEST_CASE("contacts as they stand: a poured packing, HertzMindlin") {
    const Clump ball = make_clump("ball", {{Vec3::Zero(), 0.5 * ball_diameter}});
    check_limits("balls", poured_bed(ball, 1.05 * ball_diameter, 3, hertz_law(0.5, 0)), hertz_law);
}

TEST_CASE("contacts as they stand: poured beds of clumps") {
    const Clump stone = make_stone(StoneShape::angular, 0.03);
    check_limits("clumps", poured_bed(stone, 0.042, 2, linear_law(0.5, 0)), linear_law);
    check_limits("clumps", poured_bed(stone, 0.042, 2, hertz_law(0.5, 0)), hertz_law);
}
