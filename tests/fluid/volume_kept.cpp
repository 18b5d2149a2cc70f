// No volume is lost, and fractions are within their bounds in every step.
#include "volume_kept.hpp"

using namespace abrade;

TEST_CASE("a dam") { volume_kept::collapse<2>(300); }

TEST_CASE("a jet that plunges") { volume_kept::plunge<2>(250); }

TEST_CASE("a dam along an invert") { volume_kept::run_in_invert<2>(400); }

TEST_CASE("traces of air beside the bulk, to round-off") {
    for (const Side side : {Side::wall, Side::periodic}) volume_kept::carry_traces<2>(side);
}
