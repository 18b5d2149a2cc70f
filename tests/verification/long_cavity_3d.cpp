// The cube whose lid slides, at Re 1000, with the gates of the reference data.
#include "cavity_3d.hpp"

#include <doctest/doctest.h>

using namespace cavity_3d;

namespace {

template <abrade::AdvectionScheme Scheme>
void check(int n) {
    auto flow = half_cube<Scheme>(n);
    flow.advance(40);
    const Errors e = errors(flow);
    MESSAGE(Scheme::name << ", " << n << " cells: root mean square " << 100 * e.u.root_mean_square
                         << " % in u, " << 100 * e.w.root_mean_square << " % in w; extrema "
                         << 100 * e.u.extremum << " %, " << 100 * e.w.extremum << " %");
    CHECK(e.u.root_mean_square < 0.03);
    CHECK(e.w.root_mean_square < 0.03);
    CHECK(e.u.extremum < 0.13);  // that of 72 cells
    CHECK(e.w.extremum < 0.13);
}

}  // namespace

TEST_CASE("cube with a sliding lid at Re 1000, 64 cells, central fluxes") { check<abrade::Central>(64); }
TEST_CASE("cube with a sliding lid at Re 1000, 64 cells, limited fluxes") { check<abrade::Koren>(64); }
