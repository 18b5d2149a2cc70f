// The energy account of water on a grid: it closes, its terms are those of closed forms, and what is left
// over is small. What is measured stands in docs/verification/water_energy.md.
#include <abrade/fluid/navier_stokes/grid_fluid.hpp>
#include <abrade/fluid/setup/inflow.hpp>

#include <doctest/doctest.h>

#include <random>
#include <stdexcept>
#include <string>

using namespace abrade;

namespace {

constexpr Real g = 9.81;
constexpr Real round_off = 1e-12;  // of the largest amount, over thousands of steps

/// Says all terms, and that they close.
template <class Flow>
void look_at(const std::string& scene, const Flow& flow) {
    std::string text;
    flow.energy().visit([&](std::string_view name, Real value) {
        if (value != 0) text += std::string(name) + " " + short_text(value) + ", ";
    });
    MESSAGE(scene << ": " << text << "residual " << flow.energy().residual_relative());
    CHECK(flow.energy().residual_relative() < round_off);
}

/// A wave of the first mode in a tank 1 m long, 0.5 m deep.
GridFluid<2> standing_wave(int cells, Real height) {
    return GridFluid<2>(
        {.grid = {.cells = {cells, cells * 3 / 4}, .spacing = Point<2>::Constant(1.0 / cells)},
         .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
         .water = [=](const Point<2>& x) { return 0.5 + height * std::cos(pi * x[0]) - x[1]; },
         .gravity = {0, -g},
         .viscosity = 0,
         .tolerance = 1e-8});
}
Real period() { return 2 * pi / std::sqrt(g * pi * std::tanh(0.5 * pi)); }

/// Half of a box is let go.
GridFluid<2> dam(Real largest_step) {
    return GridFluid<2>({.grid = {.cells = {64, 40}, .spacing = Point<2>::Constant(1.0 / 40)},
                         .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                         .water = [](const Point<2>& x) { return std::min(0.5 - x[0], 0.5 - x[1]); },
                         .gravity = {0, -g},
                         .largest_step = largest_step});
}

}  // namespace

TEST_CASE_TEMPLATE("centre of the part of a cell below a plane: by sections and by simplices", Number,
                   std::integral_constant<int, 2>, std::integral_constant<int, 3>) {
    constexpr int dim = Number::value;
    std::mt19937 random(7);
    std::uniform_real_distribution<Real> any(-1, 1);
    for (int n = 0; n < 300; ++n) {
        CellPlane<dim> plane;
        detail::HalfSpace<dim> half;
        for (std::size_t a = 0; a < dim; ++a) {
            plane.normal[a] = n % 5 == static_cast<int>(a) ? 0
                              : n % 7 == 0                 ? 1e-9 * any(random)
                                                           : any(random);
            half.slope[static_cast<int>(a)] = -plane.normal[a];
        }
        plane.distance = half.constant = 0.5 * any(random) * half.slope.template lpNorm<1>();
        const auto part = detail::part_of_cell<dim>({&half, 1});
        REQUIRE(part.volume == doctest::Approx(fraction_below(plane)).epsilon(1e-10));
        for (int a = 0; a < dim && part.volume > 1e-6; ++a)
            REQUIRE(std::abs(detail::centroid_along(plane, a) - part.moment[a] / part.volume) < 1e-8);
    }
}

TEST_CASE(
    "potential energy of tilted water: on levels that are not even, and above a bed that cuts its cells") {
    const Vec3 gravity(0.5, 0.2, -g);
    const auto surface = [](Real x, Real y) { return 0.3 + 0.05 * (x - 0.5) + 0.1 * (y - 0.4); };
    for (const bool sloping : {false, true}) {
        const auto bed = [=](Real x) { return sloping ? 0.13 + 0.2 * x : 0.1; };
        GridFluid<3>::Params params{.grid = {.cells = {10, 8, 6},
                                             .low = Vec3(0, 0, 0.1),
                                             .spacing = Vec3(0.1, 0.1, 0.1),
                                             .levels = {0.1, 0.15, 0.22, 0.3, 0.42, 0.5, 0.7}},
                                    .boundaries = BoundaryConditions<3>::all(Boundary::free_slip),
                                    .water = [=](const Vec3& x) { return surface(x[0], x[1]) - x[2]; },
                                    .gravity = gravity};
        if (sloping) params.wall = [=](const Vec3& x) { return (x[2] - bed(x[0])) / std::hypot(1, 0.2); };
        GridFluid<3> flow(params);
        flow.open_energy_account();
        Real exact = 0;
        constexpr int n = 1000;  // columns each way: midpoints err by 1e-7
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const Real x = (i + 0.5) / n, y = 0.8 * (j + 0.5) / n, low = bed(x);
                const Real high = std::max(low, surface(x, y));
                exact -=
                    1000 * 0.8 / square(Real(n)) * (high - low) * gravity.dot(Vec3(x, y, 0.5 * (high + low)));
            }
        const Real off = flow.energy().potential / exact - 1;
        MESSAGE(std::string(sloping ? "sloping bed" : "uneven levels") << ": off by " << off);
        // Where the surface ends on the bed, cells take its place from others, and slivers are closed.
        CHECK(std::abs(off) < (sloping ? 3e-5 : 1e-6));
    }
}

TEST_CASE("without an account there is no energy") {
    const auto flow = standing_wave(16, 0);
    CHECK(!flow.has_energy_account());
    CHECK_THROWS_AS(flow.energy(), std::logic_error);
}

TEST_CASE("water at rest keeps what it has") {
    auto flow = standing_wave(16, 0);
    flow.open_energy_account();
    flow.advance(1);
    look_at("rest", flow);
    const WaterEnergy& e = flow.energy();
    const Real weight = 1000 * g * 0.5;
    // To the tolerance of its pressure.
    CHECK(e.potential == doctest::Approx(0.25 * weight).epsilon(1e-8).scale(0));
    CHECK(e.kinetic < 1e-12 * weight);
    CHECK(std::abs(e.numerical) < 1e-9 * weight);
    CHECK(e.supplied() == 0);
    CHECK(e.dissipated() == 0);
}

TEST_CASE("the same bits with and without an account") {
    auto flow = dam(0), other = dam(0);
    flow.open_energy_account();
    flow.advance(0.2), other.advance(0.2);
    flow.grid().for_each([&](const auto&, Offset c) {
        REQUIRE(flow.velocity()[0][c] == other.velocity()[0][c]);
        REQUIRE(flow.liquid().fraction()[c] == other.liquid().fraction()[c]);
    });
    auto copy = flow;
    copy.advance(0.3), flow.advance(0.3);
    CHECK(copy.energy().numerical == flow.energy().numerical);
}

TEST_CASE("a standing wave over ten periods: what the scheme gains") {
    for (const Real height : {0.01, 0.05}) {
        auto flow = standing_wave(32, height);
        flow.open_energy_account();
        const WaterEnergy& e = flow.energy();
        const Real wave = 0.25 * 1000 * g * square(height);
        CHECK(e.potential == doctest::Approx(1000 * g * 0.125 + wave).epsilon(1e-4).scale(0));
        Real least = 0, before = 0, most_gained = 0;
        for (int k = 1; k <= 10; ++k) {
            flow.advance(k * period());
            most_gained = std::max(most_gained, before - e.numerical);
            before = e.numerical, least = std::min(least, before);
        }
        look_at("wave of " + short_text(height) + " m", flow);
        MESSAGE("lost in ten periods " << 100 * e.numerical / wave << " % of the wave, gained in one at most "
                                       << 100 * most_gained / wave << " %");
        // Round-off decides which cells are wet: 1.7e-3; missed by clang++, 2.5e-3, and with
        // sanitizers, 2.1e-3.
#if defined(__clang__) || defined(__SANITIZE_ADDRESS__)
        WARN(most_gained < 2e-3 * wave);
        CHECK(most_gained < 3e-3 * wave);
#else
        CHECK(most_gained < 2e-3 * wave);
#endif
        CHECK(least > -2e-3 * wave);
    }
}

TEST_CASE("Taylor-Green vortices: friction is the analytic dissipation, the rest is advection's") {
    constexpr int n = 64;
    constexpr Real nu = 0.01;
    GridFluid<2, FullBox> flow({.grid = {.cells = {n, n}, .spacing = Point<2>::Constant(2 * pi / n)},
                                .boundaries = BoundaryConditions<2>::all(Boundary::periodic),
                                .velocity =
                                    [](const Point<2>& x) {
                                        return Point<2>(std::cos(x[0]) * std::sin(x[1]),
                                                        -std::sin(x[0]) * std::cos(x[1]));
                                    },
                                .density = 1,
                                .viscosity = nu,
                                .tolerance = 1e-9});
    flow.open_energy_account();
    const WaterEnergy& e = flow.energy();
    const Real start = e.kinetic, lost = start * (1 - std::exp(-4 * nu * 5));
    CHECK(start == doctest::Approx(pi * pi).epsilon(1e-3).scale(0));
    flow.advance(5);
    look_at("Taylor-Green", flow);
    CHECK(e.viscous == doctest::Approx(lost).epsilon(0.01).scale(0));
    CHECK(std::abs(e.numerical) < 0.01 * lost);
    CHECK(std::abs(e.numerical - e.advection) < 1e-4 * lost);
}

TEST_CASE("flow between plates, one of which moves: each term is needed") {
    BoundaryConditions<2> boundaries;
    boundaries[0] = {Boundary::periodic, Boundary::periodic};
    GridFluid<2, FullBox> flow(
        {.grid = {.cells = {4, 16}, .spacing = {0.0625, 0.0625}},
         .boundaries = boundaries,
         .boundary_velocity = [](const Point<2>& x, Real) { return Point<2>(x[1] > 0.999 ? 1 : 0, 0); },
         .gravity = {8, 0},
         .density = 1,
         .viscosity = 1,
         .tolerance = 1e-11});
    flow.advance(1.5);
    flow.open_energy_account();
    flow.advance(2);
    look_at("plates", flow);
    const WaterEnergy& e = flow.energy();
    // u = z + 4 z (1 - z): discharge 1/2 + 2/3, shear at the wall that moves 1 - 4; for 0.5 s, 0.25 m long.
    CHECK(e.body_force == doctest::Approx(0.125 * 8 * (0.5 + 2.0 / 3)).epsilon(0.01).scale(0));
    CHECK(e.boundaries == doctest::Approx(0.125 * (1 - 4)).epsilon(0.01).scale(0));
    CHECK(e.viscous == doctest::Approx(e.body_force + e.boundaries).epsilon(1e-6).scale(0));
    for (const Real term : {e.body_force, e.boundaries, e.viscous})
        CHECK(std::abs(e.numerical) < 1e-6 * std::abs(term));
}

TEST_CASE("a channel from inflow to outflow: what comes in and does not leave is lost to friction") {
    BoundaryConditions<2> boundaries;
    boundaries[0] = {Boundary::inflow, Boundary::outflow};
    GridFluid<2, FullBox> flow({.grid = {.cells = {48, 16}, .spacing = {0.0625, 0.0625}},
                                .boundaries = boundaries,
                                .boundary_velocity =
                                    [](const Point<2>& x, Real) {
                                        const Real z = std::clamp(x[1], 0.0, 1.0);
                                        return Point<2>(x[0] < 0.01 ? 4 * z * (1 - z) : 0, 0);
                                    },
                                .gravity = {0, -g},
                                .density = 1,
                                .viscosity = 0.1,
                                .largest_step = 0.004,
                                .tolerance = 1e-9});
    flow.advance(12);
    flow.open_energy_account();
    flow.advance(13);
    look_at("channel", flow);
    const WaterEnergy& e = flow.energy();
    CHECK(e.viscous == doctest::Approx(0.1 * 16.0 / 3 * 3).epsilon(0.01).scale(0));
    CHECK(e.inflow - e.outflow == doctest::Approx(e.viscous).epsilon(1e-3).scale(0));
}

TEST_CASE("a laminar film on a side and on a bed inside a cell: gravity's work is friction's") {
    constexpr Real slope = 0.1;
    for (const Real bed : {0.0, 0.03}) {
        GridFluidParams<2> params{.grid = {.cells = {8, 24}, .spacing = {0.05, 0.05}},
                                  .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                                  .water = [=](const Point<2>& x) { return bed + 0.78 - x[1]; },
                                  .gravity = {g * std::sin(slope), -g * std::cos(slope)},
                                  .viscosity = 200,
                                  .tolerance = 1e-9};
        params.boundaries[0] = {Boundary::periodic, Boundary::periodic};
        if (bed == 0)
            params.boundaries[1][0] = Boundary::wall;
        else
            params.wall = [=](const Point<2>& x) { return x[1] - bed; };
        GridFluid<2> flow(params);
        flow.advance(8);
        flow.open_energy_account();
        flow.advance(9);
        look_at("film, bed at " + short_text(bed) + " m", flow);
        const WaterEnergy& e = flow.energy();
        // g^2 s^2 h^3 / (3 nu) a unit area; the grid's discharge is off by its own error.
        const Real exact = 1000 * 0.4 * square(g * std::sin(slope)) * cube(0.78) / (3 * 0.2);
        CHECK(e.body_force == doctest::Approx(exact).epsilon(0.01).scale(0));
        CHECK(e.dissipated() == doctest::Approx(e.body_force).epsilon(0.01).scale(0));
        // The film's uppermost fifth of a cell rides: what of gravity's push it gives on, as in an inelastic
        // impact, is lost in part.
        const Real least = bed > 0 ? 2e-5 : 1e-6;
        CHECK(e.dissipated() + e.gained() == doctest::Approx(e.body_force).epsilon(least).scale(0));
        CHECK((e.wall_friction > 0) == (bed > 0));
        CHECK(std::abs(e.numerical) < least * e.body_force);
    }
}

TEST_CASE("uniform flow with eddies over a rough bed: what gravity puts in") {
    BoundaryConditions<2> boundaries;
    boundaries[0] = {Boundary::periodic, Boundary::periodic}, boundaries[1][1] = Boundary::free_slip;
    GridFluid<2, Turbulent<MixingLength, FullBox>> flow(
        {.grid = {.cells = {4, 16}, .spacing = {0.0125, 0.00625}},
         .boundaries = boundaries,
         .wall_law = {WallLaw::Kind::logarithmic, 3.5e-3},
         .velocity = [](const Point<2>&) { return Point<2>(1, 0); },
         .gravity = {g * 0.005, -g},
         .tolerance = 1e-9},
        MixingLength{{.depth = 0.1}});
    flow.advance(5);
    flow.open_energy_account();
    flow.advance(8);
    look_at("uniform flow", flow);
    const WaterEnergy& e = flow.energy();
    CHECK(e.turbulent > 0.1 * e.body_force);
    CHECK(e.wall_friction > 0.1 * e.body_force);
    CHECK(e.dissipated() + e.gained() == doctest::Approx(e.body_force).epsilon(1e-3).scale(0));
}

TEST_CASE("a stream with a surface: in - out is what friction and eddies take, and the rest is told") {
    constexpr Real depth = 0.1, speed = 2;
    GridFluidParams<2> params{.grid = {.cells = {80, 16}, .spacing = {0.025, 0.0125}},
                              .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                              .wall_law = {WallLaw::Kind::logarithmic, 3.5e-3},
                              .water = [](const Point<2>& x) { return depth - x[1]; },
                              .velocity = [=](const Point<2>&) { return Point<2>(speed, 0); },
                              .gravity = {g * std::sin(0.01), -g * std::cos(0.01)},
                              .tolerance = 1e-7};
    params.boundaries[0] = {Boundary::inflow, Boundary::outflow}, params.boundaries[1][0] = Boundary::wall;
    Inflow<2>({.discharge = speed * depth, .depth = depth}).give_to(params);
    GridFluid<2, Turbulent<MixingLength>> flow(params, MixingLength{{.depth = depth}});
    flow.open_energy_account();
    flow.advance(4);
    const Real kinetic = flow.energy().kinetic;
    flow.open_energy_account();
    const WaterEnergy& e = flow.energy();
    CHECK(e.kinetic_start == doctest::Approx(kinetic).epsilon(1e-5).scale(0));
    flow.advance(7);
    look_at("stream", flow);
    CHECK(e.dissipated() + e.gained() == doctest::Approx(e.inflow - e.outflow).epsilon(0.02).scale(0));
    CHECK(std::abs(e.numerical) < 0.1 * e.turbulent);
}

TEST_CASE("a box that is shaken: the force's work is the energy gained") {
    GridFluid<2, FullBox> full({.grid = {.cells = {8, 8}, .spacing = Point<2>::Constant(0.125)},
                                .boundaries = BoundaryConditions<2>::all(Boundary::periodic),
                                .body_force = [](Real t) { return Point<2>(3 * std::cos(2 * t), 0); },
                                .largest_step = 0.01});
    full.open_energy_account();
    full.advance(1);
    look_at("full box", full);
    CHECK(full.energy().body_force ==
          doctest::Approx(500 * square(1.5 * std::sin(2.0))).epsilon(1e-4).scale(0));
    CHECK(std::abs(full.energy().numerical) < 1e-9 * full.energy().kinetic);

    constexpr Real frequency = 5.4;  // near the first mode's, 5.3
    GridFluid<2> tank({.grid = {.cells = {32, 24}, .spacing = Point<2>::Constant(1.0 / 32)},
                       .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                       .water = [](const Point<2>& x) { return 0.5 - x[1]; },
                       .gravity = {0, -g},
                       .body_force = [=](Real t) { return Point<2>(0.05 * std::sin(frequency * t), 0); },
                       .viscosity = 0,
                       .tolerance = 1e-8});
    tank.open_energy_account();
    tank.advance(2 * 2 * pi / frequency);
    look_at("tank", tank);
    CHECK(tank.energy().gained() == doctest::Approx(tank.energy().body_force).epsilon(0.01).scale(0));
}

TEST_CASE("dam break: what the scheme gains falls with the step") {
    std::array<Real, 2> most{};
    for (std::size_t k = 0; k < 2; ++k) {
        auto flow = dam(k == 0 ? 0 : 5e-4);
        flow.open_energy_account();
        const WaterEnergy& e = flow.energy();
        const Real start = e.total();
        for (int n = 1; n <= (k == 0 ? 40 : 8); ++n) {
            flow.advance(0.05 * n);
            most[k] = std::max(most[k], (e.total() + e.dissipated()) / start - 1);
        }
        look_at("dam", flow);
        MESSAGE("gained at most " << 100 * most[k] << " %");
    }
    CHECK(most[0] < 0.01);
    WARN(most[0] < 1e-3);  // missed at steps of its own
    CHECK(most[1] < 1e-3);
}

TEST_CASE("a bed that wears: what changing the wall takes is told apart") {
    Real bed = 0.243;
    GridFluidParams<2> params{.grid = {.cells = {32, 32}, .spacing = {1.0 / 32, 1.0 / 32}},
                              .boundaries = BoundaryConditions<2>::all(Boundary::free_slip),
                              .wall = [bed](const Point<2>& x) { return x[1] - bed; },
                              .water = [](const Point<2>& x) { return 0.613 - x[1]; },
                              .gravity = {0, -g}};
    GridFluid<2> flow(params);
    flow.open_energy_account();
    const WaterEnergy& e = flow.energy();
    CHECK(e.potential == doctest::Approx(500 * g * (square(0.613) - square(0.243))).epsilon(1e-9).scale(0));
    for (int step = 0; step < 40; ++step) {
        bed -= 2.0 / 32 / 40;
        flow.set_wall([bed](const Point<2>& x) { return x[1] - bed; });
        flow.advance(flow.time() + 0.025);
    }
    look_at("worn bed", flow);
    CHECK(e.reshaped == doctest::Approx(-1000 * g * 0.37 * 2.0 / 32).epsilon(1e-3).scale(0));
    CHECK(std::abs(e.numerical) < 1e-3 * std::abs(e.reshaped));
}

TEST_CASE("a step that went wrong is not booked") {
    auto flow = dam(0), other = dam(0);
    flow.open_energy_account(), other.open_energy_account();
    for (int k = 0; k < 5; ++k) flow.step(0.004), other.step(0.004);
    const WaterEnergy before = flow.energy();
    CHECK_THROWS_AS(flow.step(100), FluidError);
    CHECK(flow.energy().numerical == before.numerical);
    CHECK(flow.energy().kinetic == before.kinetic);
    for (int k = 0; k < 5; ++k) flow.step(0.004), other.step(0.004);
    CHECK(flow.energy().kinetic == doctest::Approx(other.energy().kinetic).epsilon(1e-6));
    look_at("after an error", flow);
}
