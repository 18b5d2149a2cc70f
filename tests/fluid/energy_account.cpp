// The energy account of water on a grid: it closes, its terms are those of closed forms, and what is left over
// is small.
#include <abrade/fluid/grid_fluid.hpp>

#include <doctest/doctest.h>

#include <stdexcept>

using namespace abrade;

namespace {

constexpr Real g = 9.81;
constexpr Real round_off = 1e-12;  // of the largest amount, over thousands of steps

template <class Flow>
void tell(const char* scene, const Flow& flow) {
    std::string text;
    flow.energy().visit([&](std::string_view name, Real value) {
        if (value != 0) text += std::string(name) + " " + short_text(value) + ", ";
    });
    MESSAGE(scene << ": " << text << "residual " << flow.energy().residual_relative() << ", steps "
                  << flow.steps());
}

/// A wave of the first mode in a tank 1 m long, 0.5 m deep.
GridFluid<2> standing_wave(int cells, Real height, Real viscosity = 0) {
    return GridFluid<2>({.grid = {.cells = {cells, cells * 3 / 4}, .spacing = Point<2>::Constant(1.0 / cells)},
                         .sides = Sides<2>::all(Side::slip),
                         .water = [=](const Point<2>& x) {
                             return 0.5 + height * std::cos(pi * x[0]) - x[1];
                         },
                         .gravity = {0, -g},
                         .viscosity = viscosity,
                         .tolerance = 1e-8});
}
Real period() { return 2 * pi / std::sqrt(g * pi * std::tanh(0.5 * pi)); }

}  // namespace

TEST_CASE("no account, no energy") {
    const auto flow = standing_wave(16, 0);
    CHECK(!flow.has_energy_account());
    CHECK_THROWS_AS(flow.energy(), std::logic_error);
}

TEST_CASE("water at rest keeps what it has") {
    auto flow = standing_wave(16, 0);
    flow.open_energy_account();
    flow.advance(1);
    tell("rest", flow);
    const WaterEnergy& e = flow.energy();
    const Real weight = 1000 * g * 0.5;  // of the water, over a metre
    CHECK(e.potential == doctest::Approx(0.25 * weight).epsilon(1e-12).scale(0));
    CHECK(e.residual_relative() < round_off);
    CHECK(e.kinetic < 1e-12 * weight);
    CHECK(std::abs(e.numerical) < 1e-9 * weight);
    CHECK(e.supplied() == 0);
    CHECK(e.dissipated() == 0);
}

TEST_CASE("a standing wave over ten periods") {
    for (const int cells : {16, 32}) {
        const Real height = 0.05;
        auto flow = standing_wave(cells, height);
        flow.open_energy_account();
        const Real wave = 0.25 * 1000 * g * square(height);
        const WaterEnergy& e = flow.energy();
        CHECK(e.potential == doctest::Approx(1000 * g * 0.125 + wave).epsilon(1e-5).scale(0));
        Real least = 0;
        for (int k = 1; k <= 10; ++k) {
            flow.advance(k * period());
            MESSAGE(cells << " cells, period " << k << ": lost " << 100 * e.numerical / wave << " %, kinetic "
                          << 100 * e.kinetic / wave << " %");
            least = std::min(least, e.numerical);
        }
        tell("wave", flow);
        CHECK(e.residual_relative() < round_off);
        CHECK(least > -2e-3 * wave);
    }
}

TEST_CASE("Taylor-Green vortices: what friction takes is the analytic dissipation") {
    constexpr int n = 64;
    constexpr Real nu = 0.01;
    GridFluid<2, FullBox> flow({.grid = {.cells = {n, n}, .spacing = Point<2>::Constant(2 * pi / n)},
                                .sides = Sides<2>::all(Side::periodic),
                                .velocity = [](const Point<2>& x) {
                                    return Point<2>(std::cos(x[0]) * std::sin(x[1]),
                                                    -std::sin(x[0]) * std::cos(x[1]));
                                },
                                .density = 1,
                                .viscosity = nu,
                                .tolerance = 1e-9});
    flow.open_energy_account();
    const Real start = flow.energy().kinetic;
    CHECK(start == doctest::Approx(pi * pi).epsilon(1e-3).scale(0));
    flow.advance(5);
    tell("Taylor-Green", flow);
    const WaterEnergy& e = flow.energy();
    const Real lost = start * (1 - std::exp(-4 * nu * 5));
    CHECK(e.residual_relative() < round_off);
    CHECK(e.viscous == doctest::Approx(lost).epsilon(0.01).scale(0));
    CHECK(std::abs(e.numerical) < 0.01 * lost);
    CHECK(std::abs(e.numerical - e.advection) < 1e-3 * lost);
}

TEST_CASE("flow between plates: what drives it is what friction takes") {
    Sides<2> sides;
    sides[0] = {Side::periodic, Side::periodic};
    GridFluid<2, FullBox> flow({.grid = {.cells = {4, 16}, .spacing = {0.0625, 0.0625}},
                                .sides = sides,
                                .gravity = {8, 0},
                                .density = 1,
                                .viscosity = 1,
                                .tolerance = 1e-11});
    flow.advance(1.5);
    flow.open_energy_account();
    flow.advance(2);
    tell("plates", flow);
    const WaterEnergy& e = flow.energy();
    CHECK(e.residual_relative() < round_off);
    CHECK(e.body_force == doctest::Approx(8 * 0.25 * 2.0 / 3 * 0.5).epsilon(0.01).scale(0));
    CHECK(e.viscous == doctest::Approx(e.body_force).epsilon(1e-6).scale(0));
    CHECK(std::abs(e.numerical) < 1e-6 * e.body_force);
}

TEST_CASE("dam break") {
    GridFluid<2> flow({.grid = {.cells = {64, 40}, .spacing = Point<2>::Constant(1.0 / 40)},
                       .sides = Sides<2>::all(Side::slip),
                       .water = [](const Point<2>& x) { return std::min(0.5 - x[0], 0.5 - x[1]); },
                       .gravity = {0, -g}});
    flow.open_energy_account();
    const WaterEnergy& e = flow.energy();
    const Real start = e.total();
    Real most = 0;
    for (int k = 1; k <= 40; ++k) {
        flow.advance(0.05 * k);
        MESSAGE(flow.time() << " s: total " << e.total() / start << ", kinetic " << e.kinetic / start);
        most = std::max(most, e.total() / start - 1);
    }
    tell("dam", flow);
    CHECK(most < 1e-3);
}
