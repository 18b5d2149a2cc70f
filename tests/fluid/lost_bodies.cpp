// Bodies that the water's box cannot hold end the run in the step where it is seen.

#include <abrade/fluid/navier_stokes/lost_bodies.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <string>

using namespace abrade;

namespace lost_bodies_test {

/// What is said of a ball of 0.1 m at `x` in a box of 1 x 1 x 0.5 m; empty: nothing.
std::string said_of(const Vec3& x, const BoundaryConditions<3>& boundaries = {}, bool has_surface = false,
                    Real volume = 5e-4, Real inverse_mass = 1) {
    const Grid<3> grid({.cells = {10, 10, 5}, .low = {0, 0, 0}, .spacing = {0.1, 0.1, 0.1}});
    FlowBody body{.id = 7, .position = x, .volume = volume, .inverse_mass = inverse_mass};
    try {
        detail::refuse_lost(grid, boundaries, {&body, 1}, has_surface);
    } catch (const FluidError& error) {
        return error.what();
    }
    return {};
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

TEST_CASE("a body inside says nothing, one beyond a closed side is named with the side and the remedy") {
    CHECK(said_of({0.5, 0.5, 0.25}).empty());
    CHECK(said_of({0, 1, 0.5}).empty());  // its centroid is on the side
    const std::string low = said_of({-0.01, 0.5, 0.25}), high = said_of({0.5, 1.2, 0.25});
    CHECK(has(low, "id 7 is beyond the closed side at x = 0 m, at x = -0.01 m"));
    CHECK(has(high, "y = 1 m, at y = 1.2 m"));
    CHECK(has(high, "Scene::add_wall"));
}

TEST_CASE("air above a surface, open sides and bodies that move as told are not closed sides") {
    CHECK(has(said_of({0.5, 0.5, 0.6}), "z = 0.5 m"));
    CHECK(said_of({0.5, 0.5, 0.6}, {}, true).empty());
    CHECK(has(said_of({0.5, 0.5, -0.1}, {}, true), "z = 0 m"));
    BoundaryConditions<3> open;
    open[0][1] = Boundary::outflow;
    CHECK(said_of({1.1, 0.5, 0.25}, open).empty());
    CHECK(!said_of({-0.1, 0.5, 0.25}, open).empty());
    CHECK(said_of({-1, 0.5, 0.25}, {}, false, 5e-4, 0).empty());
}

TEST_CASE("a body as large as the box, or of no known size, is refused, even one that moves as told") {
    CHECK(said_of({0.5, 0.5, 0.25}, {}, false, 0.499, 0).empty());
    const std::string large = said_of({0.5, 0.5, 0.25}, {}, true, 0.5, 0);
    CHECK(has(large, "id 7 has 0.5 m3, no less than the 0.5 m3 of the water's box; make the box larger"));
    CHECK(!said_of({0.5, 0.5, 0.25}, {}, false, std::numeric_limits<Real>::quiet_NaN()).empty());
}

}  // namespace lost_bodies_test
