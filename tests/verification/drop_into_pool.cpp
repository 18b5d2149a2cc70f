// A sphere dropped into a pool, at several places on the grid, on 4 cells to its diameter.
// docs/verification/resolved_bodies.md has the table.
#include "drop_into_pool.hpp"

#include <doctest/doctest.h>

using namespace drop_into_pool;

namespace {

template <class Surface>
void check(const Drop& d) {
    const Fall f = fall<Surface>(d);
    MESSAGE(d.cells << " cells, off " << d.off.x() << ", " << d.off.z() << ", " << (d.below ? 0 : d.speed)
                    << " m/s: " << f.depth << " diameters deep at " << f.speed << " m/s; without history "
                    << f.free.depth / diameter << " at " << f.free.speed << ", with it "
                    << f.slowed.depth / diameter << " at " << f.slowed.speed << "; crater " << f.crater
                    << ", closed as its top is at " << f.closes << ", dent later " << f.dent << "; lost "
                    << f.lost);
    CHECK(f.lost < 1e-10);
    CHECK(f.speed < f.free.speed);
    // While a crater stands open above it nothing presses on a dropped sphere from above: it falls behind
    // models that know of none.
    CHECK(f.speed > (d.below ? 1 : 0.88) * f.slowed.speed);
    CHECK(f.depth > (d.below ? 1 : 0.87) * f.slowed.depth / diameter);
    CHECK(f.depth < f.free.depth / diameter);
    if (d.below) return;
    CHECK(f.closes < 1.6);  // no void is left above it
    CHECK(f.dent > -0.1);
}

}  // namespace

TEST_CASE("a sphere in a pool, let go below the surface: between the models with and without history") {
    check<HeightSurface>({.off = {0.3, 0.1, 0.2}, .below = true});
}

TEST_CASE("a sphere goes through the surface, and the water closes over it, wherever it is on the grid") {
    for (const Vec3& off : {Vec3(0, 0, 0), Vec3(0.3, 0.1, 0.2), Vec3(0.5, 0.5, 0.7)})
        check<HeightSurface>({.off = off});
}

TEST_CASE("the same of a volume of fluid") {
    check<FreeSurface>({.off = {0.3, 0.1, 0.2}, .below = true});
    for (const Vec3& off : {Vec3(0, 0, 0), Vec3(0.3, 0.1, 0.2), Vec3(0.5, 0.5, 0.7)})
        check<FreeSurface>({.off = off});
}
