// A user's own force per volume on grid water, and water that is put in or taken out: in a full box, below a
// volume of fluid and below a height.
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>

#include <doctest/doctest.h>

#include <optional>
#include <string>

#include "../message_of.hpp"

using namespace abrade;

namespace {

constexpr Real g = 9.81, density = 1000;

/// Stems that water flows around: f = -1/2 rho C_D a |u| u, everywhere below `top` [m].
struct Stems {
    static constexpr std::string_view name = "Stems";
    Real per_length = 2, top = 1e9;  ///< C_D a [1/m]
    bool acts_at(const Point<2>& x) const noexcept { return x[1] < top; }
    FlowForce<2> force(const Point<2>&, const Point<2>& u, Real) const noexcept {
        return {.resistance = 0.5 * density * per_length * u.norm()};
    }
};

/// A porous bed, f = -mu/K u (H. Darcy), of `from` <= x < `to` [m].
struct PorousBed {
    static constexpr std::string_view name = "PorousBed";
    Real resistance = 1e5, from = 0.38, to = 0.78;  ///< mu/K [kg/(m3 s)]
    bool acts_at(const Point<2>& x) const noexcept { return x[0] > from && x[0] < to; }
    FlowForce<2> force(const Point<2>&, const Point<2>&, Real) const noexcept {
        return {.resistance = resistance};
    }
};

/// A pump: pushes along x in a part of the box, where it stands among stems.
struct PumpAmongStems {
    static constexpr std::string_view name = "Pump";
    Real push = 500;  ///< [N/m3]
    bool acts_at(const Point<2>&) const noexcept { return true; }
    FlowForce<2> force(const Point<2>& x, const Point<2>& u, Real) const noexcept {
        return {.push = {x[0] < 0.25 ? push : 0, 0}, .resistance = density * u.norm()};
    }
};

/// A spring and a drain.
struct Spring {
    static constexpr std::string_view name = "Spring";
    Point<2> at{0.3, 0.15};
    Real radius = 0.1, rate = 0.2;  ///< [m], [1/s]
    std::optional<Point<2>> drain{};
    bool acts_at(const Point<2>& x) const noexcept {
        return (x - at).norm() < radius || (drain && (x - *drain).norm() < radius);
    }
    FlowForce<2> force(const Point<2>&, const Point<2>&, Real) const noexcept { return {}; }
    Real source(const Point<2>& x, Real) const noexcept { return (x - at).norm() < radius ? rate : -rate; }
};

/// Pushes all of the water to and fro.
struct Shaken {
    static constexpr std::string_view name = "Shaken";
    bool acts_at(const Point<2>&) const noexcept { return true; }
    FlowForce<2> force(const Point<2>&, const Point<2>&, Real t) const noexcept {
        return {.push = {3 * density * std::cos(2 * t), 0}};
    }
};

/// A drain and, half of the box away, a spring, in a box of 1 m that is periodic along x.
struct AcrossTheSeam {
    static constexpr std::string_view name = "AcrossTheSeam";
    Real drain = 0.5;  ///< [m]
    static Real way(Real from, Real to) noexcept { return std::remainder(to - from, 1.0); }
    bool acts_at(const Point<2>&) const noexcept { return true; }
    FlowForce<2> force(const Point<2>&, const Point<2>&, Real) const noexcept { return {}; }
    Real source(const Point<2>& x, Real) const noexcept {
        return std::abs(way(drain, x[0])) < 0.1 ? -0.5 : std::abs(way(drain + 0.5, x[0])) < 0.1 ? 0.5 : 0;
    }
};

/// Goes wrong after a while.
struct Wrong {
    static constexpr std::string_view name = "Wrong";
    Real push = 0, resistance = 0, after = 0.1;
    bool acts_at(const Point<2>& x) const noexcept { return x[0] < 0.5; }
    FlowForce<2> force(const Point<2>&, const Point<2>&, Real t) const noexcept {
        if (t < after) return {};
        return {.push = {push, 0}, .resistance = resistance};
    }
};

/// A box with sides along x as told, free slip above and below.
GridFluidParams<2> box(CellNumber<2> cells, Real spacing, Boundary low, Boundary high) {
    GridFluidParams<2> params{.grid = {.cells = cells, .spacing = Point<2>::Constant(spacing)},
                              .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                              .tolerance = 1e-8};
    params.boundaries[0] = {low, high};
    return params;
}
GridFluidParams<2> periodic_box(int n) {
    auto params = box({n, 8}, 1.0 / n, Boundary::periodic, Boundary::periodic);
    params.tolerance = 1e-10;
    return params;
}

/// Of the water in the middle of the box.
template <class Flow>
Real speed_along(const Flow& flow) {
    return flow.velocity()[0][flow.grid().layout().at({3, 2})];
}

/// Volume of cells that a spring feeds [m2], and drains.
template <class Flow>
std::pair<Real, Real> areas(const Flow& flow, const Spring& spring) {
    Real in = 0, out = 0;
    flow.grid().for_each([&](const CellNumber<2>& cell, Offset) {
        const Point<2> x = flow.grid().centre(cell);
        if (spring.acts_at(x))
            ((x - spring.at).norm() < spring.radius ? in : out) += flow.grid().volume(cell);
    });
    return {in, out};
}

}  // namespace

TEST_CASE("uniform flow among stems: u = sqrt(2 g S / (C_D a)), whatever the step") {
    const Real slope = 0.02, stems = 4, expected = std::sqrt(2 * g * slope / stems);
    GridFluidParams<2> params = periodic_box(8);
    params.gravity = {g * slope, 0};
    for (const Real dt : {0.02, 0.1}) {
        GridFluid<2, Forced<Stems, FullBox>> flow(params, {}, {}, {.per_length = stems});
        for (int k = 0; k < 20 / dt; ++k) flow.step(dt);
        CHECK(speed_along(flow) == doctest::Approx(expected).epsilon(1e-9).scale(0));
    }
}

TEST_CASE_TEMPLATE("the same below a surface", Surface, FreeSurface, HeightSurface) {
    const Real slope = 0.02, stems = 4, expected = std::sqrt(2 * g * slope / stems);
    GridFluidParams<2> params = periodic_box(16);
    params.gravity = {g * slope, -g};
    params.water = [](const Point<2>& x) { return 0.27 - x[1]; };
    params.velocity = [&](const Point<2>&) { return Point<2>(0.8 * expected, 0); };
    GridFluid<2, Forced<Stems, Surface>> flow(params, {}, {}, {.per_length = stems});
    flow.advance(16);
    flow.open_energy_account();
    flow.advance(20);
    CHECK(speed_along(flow) == doctest::Approx(expected).epsilon(1e-4).scale(0));
    // The topmost row is a third full: its water has no pressure of its own, and feels the stems all the
    // same.
    for (int k = 0; k < 5; ++k)
        CHECK(flow.velocity()[0][flow.grid().layout().at({3, k})] ==
              doctest::Approx(expected).epsilon(1e-3).scale(0));
    const WaterEnergy& e = flow.energy();
    MESSAGE("body force " << e.body_force << " J, forcing " << e.forcing << " J, numerical " << e.numerical);
    CHECK(e.forcing < 0);
    CHECK(std::abs(e.numerical) < 2e-3 * e.body_force);
    CHECK(e.residual_relative() < 1e-12);
}

TEST_CASE("a porous bed: the pressure falls by mu/K U L, however dense") {
    for (const Real resistance : {1e3, 1e5, 1e7}) {
        const PorousBed bed{.resistance = resistance};
        const Real speed = 0.1;
        GridFluidParams<2> params = box({30, 4}, 0.04, Boundary::inflow, Boundary::outflow);
        params.boundary_velocity = [=](const Point<2>&, Real) { return Point<2>(speed, 0); };
        params.velocity = [=](const Point<2>&) { return Point<2>(speed, 0); };
        GridFluid<2, Forced<PorousBed, FullBox>> flow(params, {}, {}, bed);
        // Its pressure settles within dt mu/(K rho) steps.
        for (int k = 0; k < 1000; ++k) flow.step(std::min(0.05, 100 * density / resistance));
        const auto pressure = [&](int i) {
            return density * flow.pressure()[flow.grid().layout().at({i, 2})];
        };
        const Real fall = pressure(5) - pressure(25), expected = resistance * speed * 0.4;
        MESSAGE("mu/K " << resistance << " kg/(m3 s): " << fall << " of " << expected << " Pa");
        CHECK(fall == doctest::Approx(expected).epsilon(1e-3).scale(0));
    }
}

TEST_CASE("a pump: what it does is what stems take, in the account as well") {
    GridFluidParams<2> params = periodic_box(16);
    params.largest_step = 0.02;
    GridFluid<2, Forced<PumpAmongStems, FullBox>> flow(params);
    flow.advance(4);
    flow.open_energy_account();
    flow.advance(30);
    // 500 N/m3 on a quarter of the box against rho u^2 on all of it.
    CHECK(speed_along(flow) == doctest::Approx(std::sqrt(500 * 0.25 / density)).epsilon(1e-6).scale(0));
    const WaterEnergy& e = flow.energy();
    MESSAGE("forcing " << e.forcing << ", numerical " << e.numerical << ", kinetic " << e.kinetic << " J");
    CHECK(std::abs(e.forcing - e.gained()) < 1e-6 * e.kinetic);
    CHECK(e.residual_relative() < 1e-12);
}

TEST_CASE("a force that changes in time is met to second order in the step") {
    const auto off = [](int steps) {
        GridFluidParams<2> params = periodic_box(8);
        params.courant = 1;
        GridFluid<2, Forced<Shaken, FullBox>> flow(params);
        for (int k = 0; k < steps; ++k) flow.step(1.0 / steps);
        return std::abs(speed_along(flow) - 1.5 * std::sin(2.0));
    };
    const Real coarse = off(60), fine = off(120);
    MESSAGE("errors " << coarse << ", " << fine << " m/s");
    CHECK(std::log2(coarse / fine) > 1.9);
}

TEST_CASE("a spring in a full box: all of it leaves at the outflow") {
    const Spring spring{};
    const auto params = box({32, 10}, 0.03, Boundary::free_slip, Boundary::outflow);
    GridFluid<2, Forced<Spring, FullBox>> flow(params, {}, {}, spring);
    flow.open_energy_account();
    flow.advance(3);
    Real leaves = 0;
    for (int k = 0; k < 10; ++k) leaves += 0.03 * flow.velocity()[0][flow.grid().layout().at({32, k})];
    CHECK(leaves == doctest::Approx(spring.rate * areas(flow, spring).first).epsilon(1e-6).scale(0));
    const WaterEnergy& e = flow.energy();
    MESSAGE("sources " << e.sources << ", outflow " << e.outflow << ", numerical " << e.numerical << " J");
    CHECK(e.sources > 0);
    CHECK(e.residual_relative() < 1e-12);
}

TEST_CASE("a spring and a drain in a closed box: as much goes as comes; a spring alone is refused") {
    GridFluidParams<2> params{.grid = {.cells = {32, 10}, .spacing = Point<2>::Constant(0.03)},
                              .boundaries = BoundaryConditions<2>::all(Boundary::wall),
                              .tolerance = 1e-8};
    const Spring both{.at = {0.255, 0.15}, .drain = Point<2>(0.705, 0.15)};
    GridFluid<2, Forced<Spring, FullBox>> flow(params, {}, {}, both);
    const auto [in, out] = areas(flow, both);
    REQUIRE(in == doctest::Approx(out));
    flow.advance(2);
    CHECK(flow.last_projection().after < 1e-7);
    Real between = 0;
    for (int k = 0; k < 10; ++k) between += 0.03 * flow.velocity()[0][flow.grid().layout().at({16, k})];
    CHECK(between == doctest::Approx(both.rate * in).epsilon(1e-5).scale(0));

    GridFluid<2, Forced<Spring, FullBox>> filled(params, {}, {}, Spring{});
    CHECK(message_of<FluidError>([&] { filled.advance(1); }).find("ask for another volume of water") !=
          std::string::npos);
}

TEST_CASE("a drain across a periodic seam takes as one in the middle does") {
    const auto run = [](Real drain) {
        GridFluidParams<2> params = periodic_box(16);
        params.velocity = [](const Point<2>&) { return Point<2>(0.3, 0); };
        GridFluid<2, Forced<AcrossTheSeam, FullBox>> flow(params, {}, {}, {.drain = drain});
        for (int k = 0; k < 50; ++k) flow.step(0.02);
        return flow;
    };
    const auto middle = run(0.5), seam = run(0);
    Real off = 0;
    middle.grid().for_each([&](const CellNumber<2>& cell, Offset c) {
        const Offset there = middle.grid().layout().at({(cell[0] + 8) % 16, cell[1]});
        off = std::max(off, std::abs(middle.velocity()[0][c] - seam.velocity()[0][there]));
    });
    CHECK(off < 1e-7);  // what the tolerance leaves
}

TEST_CASE("walls that change leave a force where it acts, and its limit of the step") {
    const auto floor_at = [](Real z) { return [z](const Point<2>& x) { return x[1] - z; }; };
    GridFluidParams<2> params = periodic_box(16);
    params.gravity = {0, -g};
    params.wall = floor_at(0.03);
    params.water = [](const Point<2>& x) { return 0.27 - x[1]; };
    GridFluid<2, Forced<PumpAmongStems>> flow(params, {}, {}, {.push = 2e6});
    const Real before = flow.stable_step().seconds;
    flow.set_wall(floor_at(0.031));
    CHECK(flow.stable_step().seconds == doctest::Approx(before).epsilon(1e-6).scale(0));
    flow.step(flow.stable_step().seconds);
    CHECK(flow.velocity()[0][flow.grid().layout().at({2, 2})] > 0);
}

TEST_CASE_TEMPLATE("a spring under water fills a tank, a drain empties it", Surface, FreeSurface,
                   HeightSurface) {
    for (const Real rate : {0.1, -0.1}) {
        const Spring spring{.rate = rate};
        GridFluidParams<2> params{.grid = {.cells = {32, 16}, .spacing = Point<2>::Constant(0.03)},
                                  .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                                  .water = [](const Point<2>& x) { return 0.33 - x[1]; },
                                  .gravity = {0, -g},
                                  .tolerance = 1e-8};
        GridFluid<2, Forced<Spring, Surface>> flow(params, {}, {}, spring);
        const Real start = flow.liquid().volume(), flows = rate * areas(flow, spring).first;
        flow.open_energy_account();
        flow.advance(2);
        CHECK(flow.liquid().volume() - start == doctest::Approx(2 * flows).epsilon(1e-9).scale(0));
        const WaterEnergy& e = flow.energy();
        MESSAGE("rate " << rate << " 1/s: sources " << e.sources << ", gained " << e.gained()
                        << ", numerical " << e.numerical << " J");
        // It comes in below rho g h and is to be lifted from its centre to the surface.
        CHECK(e.sources == doctest::Approx(e.gained()).epsilon(0.03).scale(0));
        CHECK(e.residual_relative() < 1e-12);
        const Real level = flow.surface_at({0.5, 0});
        CHECK(level == doctest::Approx(0.33 + 2 * flows / 0.96).epsilon(0.02).scale(0));
    }
}

TEST_CASE("a drain that has nothing to take takes nothing") {
    const Spring drain{.rate = -5};
    GridFluidParams<2> params{.grid = {.cells = {32, 16}, .spacing = Point<2>::Constant(0.03)},
                              .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                              .water = [](const Point<2>& x) { return 0.12 - x[1]; },
                              .gravity = {0, -g}};
    GridFluid<2, Forced<Spring>> flow(params, {}, {}, drain);
    flow.advance(3);
    const Real volume = flow.liquid().volume();
    CHECK(volume > -1e-12);
    CHECK(volume < 0.96 * 0.12);
}

TEST_CASE("a force that is no number, or a resistance that drives, ends the step and names itself") {
    const auto message = [](Wrong wrong) {
        GridFluid<2, Forced<Wrong, FullBox>> flow(periodic_box(8), {}, {}, wrong);
        return message_of<FluidError>([&] {
            for (int k = 0; k < 100; ++k) flow.step(0.02);
        });
    };
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    CHECK(message({.push = nan}).find("Wrong.force at x = ") != std::string::npos);
    CHECK(message({.push = nan}).find("N/m3") != std::string::npos);
    CHECK(message({.resistance = -1}).find("resistance must be >= 0, got -1 kg/(m3 s)") != std::string::npos);
    CHECK(message({.resistance = nan}).find("resistance") != std::string::npos);
}
