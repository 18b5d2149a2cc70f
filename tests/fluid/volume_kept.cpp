// No volume is lost, and fractions are within their bounds in every step.
#include "volume_kept.hpp"

using namespace abrade;

TEST_CASE("a dam") { volume_kept::collapse<2>(300); }

TEST_CASE("a jet that plunges") { volume_kept::plunge<2>(250); }

TEST_CASE("a dam along an invert") { volume_kept::run_in_invert<2>(400); }

TEST_CASE("dams that run around, down a slope: traces of air where the ends meet") {
    using namespace volume_kept;
    long double worst = 0;
    for (int k = 0; k < 40; ++k) {  // traces come to the ends in one of ten or so
        GridFluidParams<2> params{
            .grid = {.cells = {11, 22}, .spacing = {0.1, 0.05}},
            .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
            .water = [=](const Point<2>& x) { return std::min(0.3 + 0.014 * k - x[0], 0.62 - x[1]); },
            .gravity = {1.25, -g}};
        params.boundaries[0] = {Boundary::periodic, Boundary::periodic};
        GridFluid<2> flow(params);
        const Held before = held_by<2>(flow.liquid(), nullptr);
        flow.advance(3);
        worst = std::max(worst, std::abs(held_by<2>(flow.liquid(), nullptr).volume / before.volume - 1));
    }
    CHECK(worst < 1e-12);
}

TEST_CASE("traces of air beside the bulk, to round-off") {
    for (const Boundary side : {Boundary::wall, Boundary::periodic}) volume_kept::carry_traces<2>(side);
}
