// Balls of a thousandth to a fiftieth of the water's density, off the corners of the grid.
#include "pool.hpp"

#include <doctest/doctest.h>

using namespace resolved;

TEST_CASE("light balls rise through a full box, and are not spun up by what their spin was") {
    constexpr Real cell = 0.0125, start = 0.063;
    for (const Real density : {1.0, 10.0, 20.0})
        for (const Vec3& place :
             {Vec3(0.001, 0.004, start), Vec3(0.0055, 0.002, start), Vec3(0.003, 0.005, start)}) {
            Water water({.grid = {.cells = {16, 16, 28},
                                  .low = Vec3(-8 * cell, -8 * cell, 0),
                                  .spacing = Vec3::Constant(cell)},
                         .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                         .gravity = {0, 0, -g},
                         .density = 1000,
                         .viscosity = 1e-3});
            std::vector<Ball> balls{{place, 2 * cell, density}};
            const FlowBody& body = balls[0].body;
            Real spin = 0;
            while (body.position.z() < 0.25 && water.time() < 0.5) {
                step(water, balls,
                     std::min(water.stable_step().seconds, water.step_of_body(body.velocity.norm())));
                spin = std::max(spin, body.angular_velocity.norm() * 2 * cell);
            }
            CAPTURE(density);
            CAPTURE(place.x());
            MESSAGE("rises with " << body.velocity.z() << " m/s, its rim had at most " << spin << " m/s");
            CHECK(body.position.z() > 0.25);
            // 2.2 m/s and more, and the run's end, where it takes all of its change of spin.
            CHECK(spin < 0.6);
            CHECK(body.velocity.z() == doctest::Approx(1.17).epsilon(0.05));
        }
}

TEST_CASE_TEMPLATE("light balls come up through the surface and swim", Surface, HeightSurface, FreeSurface) {
    for (const Real density : {10.0, 20.0}) {
        auto water = pool<MonolithicSolids<>, Surface>();
        Ball ball({0.515, 0.49, 0.3}, 0.1, density);
        advance(water, ball, 0.01);
        const Real volume = water.liquid().volume();
        advance(water, ball, 2);
        const Real middle = advance(water, ball, 4);
        const Real lowest = volume + ball.body.volume * density / 1000 - (middle - 0.1);
        CAPTURE(density);
        MESSAGE("draft " << lowest << " m, exact " << draft_of(density / 1000) << " m");
        CHECK(std::abs(lowest - draft_of(density / 1000)) < 0.65 * h);  // too high, by half a cell
        CHECK(water.liquid().volume() == doctest::Approx(volume).epsilon(1e-12));
    }
}
