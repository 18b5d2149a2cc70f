// Streams of given discharge and depth: the section carries the discharge, on the grid too; bad input.
#include <abrade/fluid/embedded_boundary/shapes.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/setup/inflow.hpp>
#include <abrade/fluid/uniform_flow.hpp>

#include <doctest/doctest.h>

#include "../message_of.hpp"

using namespace abrade;

namespace {

constexpr InflowProfile uniform = InflowProfile::uniform, logarithmic = InflowProfile::logarithmic;

}  // namespace

TEST_CASE("a metre of a wide channel: the mean of the profile is discharge over depth") {
    for (const auto profile : {uniform, logarithmic}) {
        const Inflow<2> stream(
            {.discharge = 0.6, .depth = 0.2, .bed = 0.05, .profile = profile, .roughness = 0.003});
        CHECK(stream.area() == 0.2);
        CHECK(stream.mean_velocity() == doctest::Approx(3));
        CHECK(stream.froude(9.81) == doctest::Approx(3 / std::sqrt(9.81 * 0.2)));
        Real sum = 0;
        constexpr int n = 20000;
        for (int k = 0; k < n; ++k) {
            const Point<2> u = stream.velocity({0, 0.05 + (k + 0.5) * 0.2 / n});
            sum += u[0] / n;
            CHECK_MESSAGE(u[1] == 0, k);
        }
        CHECK(sum == doctest::Approx(3).epsilon(1e-5).scale(0));
        CHECK(stream.depth_at({0, 0.2}) == doctest::Approx(0.05));
    }
}

TEST_CASE("over an invert: uniform flow's own profile; a uniform one is discharge over wetted area") {
    const UniformFlow flow({.discharge = 0.5, .manning = 0.015});
    const Inflow<3> stream({.discharge = 0.5,
                            .depth = flow.depth(),
                            .profile = logarithmic,
                            .roughness = std::pow(26 * 0.015, 6)});
    for (const Vec3& x : {Vec3(0, 0, 0.1), Vec3(0, 0.3, 0.15), Vec3(0, -0.4, 0.02)})
        CHECK(stream.velocity(x).x() == doctest::Approx(flow.sample(x, 0).velocity.x()).epsilon(1e-9));
    CHECK(stream.froude() == doctest::Approx(flow.froude()).epsilon(1e-9));
    const Inflow<3> plug({.discharge = 0.5, .depth = 0.3});
    CHECK(plug.velocity({0, 0.2, 0.1}).x() == doctest::Approx(0.5 / Invert{}.flow_area(0.3)));
}

TEST_CASE("what enters the grid is the discharge") {
    const Invert invert;
    const auto check = [&](InflowProfile profile, Real size) {
        const Inflow<3> stream({.discharge = 0.5,
                                .depth = 0.18,
                                .section = invert,
                                .profile = profile,
                                .roughness = std::pow(26 * 0.015, 6)});
        GridFluidParams<3> params{.grid = {.cells = {10, static_cast<int>(std::lround(1 / size)),
                                                     static_cast<int>(std::ceil(0.36 / size))},
                                           .low = {0, -0.5, 0},
                                           .spacing = Vec3::Constant(size)},
                                  .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                                  .wall = InvertWall(invert),
                                  .gravity = invert.gravity()};
        params.boundaries[0][1] = Boundary::outflow;
        stream.give_to(params);
        GridFluid<3> flow(params);
        flow.advance(0.02);
        // The front has not come to the other end: all that came in is there.
        const Real error = flow.liquid().volume() / (0.02 * 0.5) - 1;
        MESSAGE("cells of " << size << " m: discharge off by " << 100 * error << " %");
        CHECK(std::abs(error) < 1e-11);  // round-off of some hundred steps
    };
    for (const auto profile : {uniform, logarithmic})
        for (const Real size : {0.02, 0.05}) check(profile, size);
}

TEST_CASE("a bed that has worn at the inflow keeps the discharge") {
    GridFluidParams<2> params{.grid = {.cells = {20, 20}, .spacing = Point<2>::Constant(0.05)},
                              .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                              .wall = [](const Point<2>& x) { return x[1] - 0.21; },
                              .gravity = {0, -9.81}};
    Inflow<2>({.discharge = 0.6, .depth = 0.3, .bed = 0.21}).give_to(params);
    GridFluid<2> flow(params);
    flow.advance(0.05);
    flow.set_wall([](const Point<2>& x) { return x[1] - 0.19; });
    const Real volume = flow.liquid().volume();
    flow.advance(0.1);
    CHECK(flow.liquid().volume() - volume == doctest::Approx(0.05 * 0.6).epsilon(1e-11).scale(0));
}

TEST_CASE("bad input names field, value, rule and remedy") {
    const auto says = [](const Inflow<3>::Params& params) {
        return message_of([&] { Inflow<3> stream(params); });
    };
    CHECK(says({.discharge = -0.5, .depth = 0.2}) ==
          "Inflow.discharge must be finite and > 0, got -0.5 m3/s; a side through which nothing comes is a "
          "wall");
    CHECK(says({.discharge = 0.5}) ==
          "Inflow.depth must be finite and > 0, got 0 m; give the depth at the deepest point");
    CHECK(
        says({.discharge = 0.5, .depth = 0.2, .section = {.width = -1}}).starts_with("Invert.width must be"));
    CHECK(says({.discharge = 0.5, .depth = 0.2, .profile = logarithmic})
              .starts_with("Inflow.roughness must be > 0 and below 30 depths (6 m), got 0 m; Strickler's"));
    CHECK(message_of([] {
              Inflow<2> stream({.discharge = std::nan(""), .depth = 0.2});
          }).starts_with("Inflow.discharge must be finite and > 0, got nan m2/s"));
    GridFluidParams<2> box{.grid = {.cells = {8, 8}, .spacing = {0.1, 0.02}}};
    CHECK(message_of([&] { Inflow<2>({.discharge = 1, .depth = 0.2}).give_to(box); }) ==
          "Inflow.depth must be such that its surface lies below the top of the box (0.16 m), got 0.2 m; "
          "give the "
          "box more cells upwards");
    CHECK(message_of([&] { Inflow<2>({.discharge = 1, .depth = 0.1, .bed = -0.02}).give_to(box); }) ==
          "Inflow.bed must be no lower than the floor of the box (0 m), got -0.02 m; what flows below it "
          "would not enter: give the box more cells downwards");
}
