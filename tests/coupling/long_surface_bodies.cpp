// Balls in and about a surface that stands at every tenth of a cell, and a hair above the middle of one:
// fixed ones leave it at rest, others fall in, come up and float without throwing water about.
#include "pool.hpp"

#include <abrade/coupling/exchange/one_fluid.hpp>

#include <doctest/doctest.h>

using namespace resolved;

namespace {

template <class Solids>
void sweep(const typename Solids::Params& of_solids, Real still) {
    for (int tenth = 0; tenth <= 10; ++tenth)
        for (const Real z : {0.5, 0.56, 0.6, 0.625, 0.65, 0.7, 0.8})
            for (const Real ratio : {0.0, 0.3, 2.65})
                for (const Real radius : {0.06, 0.1}) {
                    const Real surface = 0.6 + h * (tenth < 10 ? 0.1 * tenth : 0.5 + 1e-6);
                    auto params = pool<Solids>().params();
                    params.water = [surface](const Vec3& x) { return surface - x.z(); };
                    PoolAmong<Solids> water(params, {}, Solids(of_solids));
                    Ball ball({0.515, 0.505, z}, radius, 1000 * ratio);
                    Real most = 0;
                    for (int k = 1; k <= 8; ++k)
                        advance(water, ball, 0.1 * k), most = std::max(most, fastest(water));
                    CAPTURE(surface);
                    CAPTURE(z);
                    CAPTURE(ratio);
                    CAPTURE(radius);
                    CHECK(most < (ratio == 0 ? still : 3.5));  // what falls in has 2 m/s
                }
}

}  // namespace

TEST_CASE("monolithic") { sweep<MonolithicSolids<>>({.resolved_from = 0}, 0.06); }
TEST_CASE("averaged") { sweep<MonolithicSolids<>>({.resolved_from = 99}, 0.06); }
TEST_CASE("one fluid") { sweep<MixtureSolids>({}, 0.25); }
