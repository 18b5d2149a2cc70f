// What an unsteady or sheared fluid does to a body that it does not feel: the pressure gradient, added mass
// and lift, as forces and through the engine.
#include "../message_of.hpp"

#include <abrade/coupling/drag/drag.hpp>
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/uniform_flow.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

constexpr Real radius = 0.02, rho = 1000, g = 9.81;

/// Deep water whose velocity is linear in space, and which is accelerated as a whole.
struct Linear {
    static constexpr std::string_view name = "Linear";
    using Params = NoParams;
    Vec3 velocity = Vec3::Zero(), acceleration = Vec3::Zero();
    Mat3 gradient = Mat3::Zero();

    Linear() = default;
    explicit Linear(Params) {}
    const Params& params() const noexcept {
        static constexpr Params none{};
        return none;
    }
    FluidSample sample(const Vec3& x, Real t) const noexcept {
        return {velocity + gradient * x + t * acceleration, 1e3, rho, 1e-3};
    }
    FlowChange change(const Vec3&, Real) const noexcept { return {acceleration, gradient}; }
};
static_assert(FluidModel<Linear>);

/// A drag law that takes nothing, so that what is left can be told exactly.
using Inertia = WithInertia<NoDrag>;

struct Motion {
    Vec3 velocity;
    Ledger ledger;
};
Motion let_go(const Linear& fluid, Real ratio, bool wall = false, bool clump = false) {
    Scene scene;
    scene.gravity = {0, 0, -g};
    if (wall) scene.add_wall({0, 0, -1.001 * radius}, {0, 0, 1});
    if (clump)
        scene.add_stone(make_clump("two", {{{-0.5 * radius, 0, 0}, radius}, {{0.5 * radius, 0, 0}, radius}}),
                        {}, ratio * rho);
    else
        scene.add_sphere(radius, {}, ratio * rho);
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1e5}}).fluid(fluid, Inertia{});
    sim.run({.end_time = 0.1});
    return {sim.particles().velocity[0], sim.ledger()};
}

}  // namespace

TEST_CASE("a ball let go at rest is as slow as its added mass makes it") {
    for (const bool clump : {false, true})
        for (const Real ratio : {0.01, 0.3, 1.0, 2.65, 8.0}) {
            const Motion found = let_go(Linear(), ratio, false, clump);
            CHECK(std::abs(found.velocity.z() + 0.1 * g * (ratio - 1) / (ratio + 0.5)) < 1e-9 * g);
            CHECK(found.ledger.residual_relative() < 1e-12);
            if (ratio != 1) CHECK(found.ledger.flow_work < 0);  // the water's kinetic energy
        }
}

TEST_CASE(
    "water that is accelerated takes a ball along: as heavy as it, just so; heavier less; lighter more") {
    Linear fluid;
    fluid.acceleration = {2, 0, 0};
    for (const Real ratio : {0.1, 1.0, 2.65})
        CHECK(std::abs(let_go(fluid, ratio).velocity.x() - 0.1 * 2 * 1.5 / (ratio + 0.5)) < 1e-9);
}

TEST_CASE("a ball that lags in a shear is lifted to where the water is faster") {
    Linear fluid;
    fluid.velocity = {1, 0, 0};
    fluid.gradient(0, 2) = 10;
    const Immersed body{Vec3::Zero(), {0.2, 0, 0}, 4.0 / 3 * pi * cube(radius)};
    const FluidLoad load = fluid_load(Inertia{}, fluid.sample(body.position, 0),
                                      fluid.change(body.position, 0), body, {0, 0, -g});
    CHECK((load.inertial - Vec3(0, 0, 0.5 * rho * body.volume * 0.8 * 10)).norm() < 1e-12);
    CHECK(std::abs(load.added_mass - 0.5 * rho * body.volume) < 1e-15);
    // Half out of the water half of it.
    FluidSample half = fluid.sample(body.position, 0);
    half.depth = 0;
    const FluidLoad out = fluid_load(Inertia{}, half, fluid.change(body.position, 0), body, {0, 0, -g});
    CHECK((out.inertial - 0.5 * load.inertial).norm() < 1e-12);
}

TEST_CASE("a blow moves the water along: a ball that bounces makes and loses no energy") {
    // It loses nothing, and comes back to where it was: of energy in the body alone there is less.
    for (const Real ratio : {1.5, 2.65}) {
        const Motion found = let_go(Linear(), ratio, true);
        CHECK(found.ledger.residual_relative() < 1e-12);
        const Real mass = ratio * rho * 4.0 / 3 * pi * cube(radius);
        CHECK(std::abs(found.ledger.integration_residue()) < 1e-3 * mass * g * radius);
        CHECK(found.velocity.norm() < 0.1);  // it fell no deeper than a thousandth of its radius
    }
}

TEST_CASE("water on a grid knows its gradient and how it is accelerated") {
    // Four vortices.
    GridFluidParams<2> params{.grid = {.cells = {16, 16}, .low = {-1, -1}, .spacing = {0.125, 0.125}},
                              .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                              .velocity =
                                  [](const Point<2>& x) {
                                      return Point<2>(std::sin(pi * x[0]) * std::cos(pi * x[1]),
                                                      -std::cos(pi * x[0]) * std::sin(pi * x[1]));
                                  },
                              .density = rho,
                              .viscosity = 0};
    GridFluid<2, FullBox> flow(params);
    const Vec3 x(0.31, 0, 0.22);
    const auto exact = [&](int i, int j) {
        const Real c = pi * std::cos(pi * x.x()) * std::cos(pi * x.z()),
                   s = pi * std::sin(pi * x.x()) * std::sin(pi * x.z());
        return i == j ? (i == 0 ? c : -c) : (i == 0 ? -s : s);
    };
    const FlowChange change = flow.change(x, 0);
    for (const int i : {0, 2})
        for (const int j : {0, 2}) CHECK(std::abs(change.gradient(i, j) - exact(i / 2, j / 2)) < 0.1 * pi);
    CHECK(change.gradient.row(1).isZero());
    CHECK(std::abs(change.gradient.trace()) < 0.05);
    // Steady: by its own gradient alone, towards the middle of the vortex.
    const Vec3 u = flow.sample(x, 0).velocity;
    CHECK((change.acceleration - change.gradient * u).norm() < 1e-12);
}

TEST_CASE("uniform flow is sheared across its bed, and parameters are refused with their remedy") {
    const UniformFlow flow({.discharge = 0.5, .manning = 0.015});
    const Vec3 x(3, 0.2, flow.params().section.bed_height(0.2) + 0.05);
    const FlowChange change = flow.change(x, 0);
    for (int a = 0; a < 3; ++a) {
        const Vec3 step = 1e-5 * Vec3::Unit(a);
        const Vec3 slope = (flow.sample(x + step, 0).velocity - flow.sample(x - step, 0).velocity) / 2e-5;
        CHECK((change.gradient.col(a) - slope).norm() < 1e-4 * change.gradient.norm());
    }
    CHECK(change.acceleration.isZero());
    CHECK(message_of([] { WithInertia<>({.added_mass = -1}); }).find("WithInertia.added_mass") == 0);
}
