// No volume is lost in three dimensions, and fractions are within their bounds in every step.
#include "volume_kept.hpp"

using namespace abrade;

TEST_CASE("a dam") { volume_kept::collapse<3>(80); }

TEST_CASE("a jet that plunges") { volume_kept::plunge<3>(80); }

TEST_CASE("a dam along an invert") { volume_kept::run_in_invert<3>(60); }

TEST_CASE("traces of air beside the bulk, to round-off") {
    for (const Boundary side : {Boundary::wall, Boundary::periodic}) volume_kept::carry_traces<3>(side);
}
