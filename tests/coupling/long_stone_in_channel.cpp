// Drag of a stone that is held in the validation's channel, at Reynolds numbers of 1e5 to 3e5, where eddies
// of the mean flow are modelled: the table of docs/verification/resolved_bodies.md. Bounds are what was
// measured and some more, not what is wanted.
#include "../verification/channel_water.hpp"

#include <abrade/coupling/exchange/monolithic.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

/// Mean over places on the grid, and how it varies among them; over density, area, u^2/2 of the water there.
struct Drag {
    Real mean = 0, varies = 0;
};

template <class Turbulence>
Drag drag_of_stone(const Turbulence& turbulence, Real diameter, Real above_bed) {
    using Solids = MonolithicSolids<>;
    std::mt19937 random(3);
    std::uniform_real_distribution<Real> unit(0, 1);
    constexpr int places = 6;
    Real sum = 0, squares = 0;
    for (int place = 0; place < places; ++place) {
        const Real h = channel_water::spacing;
        const Vec3 x(0.5 + h * unit(random), h * unit(random), above_bed + h * (unit(random) - 0.5));
        GridFluid<3, Among<Solids, Turbulent<Turbulence, HeightSurface>>> water(
            channel_water::channel(1.2, true), turbulence, Solids({.resolved_from = 0}));
        const Real speed = water.sample(x, 0).velocity.x();
        const Sphere sphere{x, 0.5 * diameter};
        FlowBody body{.position = x, .volume = pi / 6 * cube(diameter), .spheres = {&sphere, 1}};
        Real force = 0, time = 0;
        while (water.time() < 0.4) {
            const Real dt = water.stable_step().seconds;
            water.advance(water.time() + dt, {&body, 1});
            if (water.time() > 0.15) force += dt * body.load.force.x(), time += dt;
        }
        const Real pressure = 0.5 * water.params().density * square(speed);
        const Real drag = force / time / (pressure * 0.25 * pi * square(diameter));
        sum += drag / places, squares += square(drag) / places;
    }
    return {sum, std::sqrt(std::max(squares - square(sum), Real(0)))};
}

}  // namespace

TEST_CASE("a stone in the channel's eddies: its drag is that of a sphere, not of one in syrup") {
    constexpr Real curve = 0.45;  // spheres from Re 1e4 to 3e5, Clift & Gauvin
    struct Case {
        Real diameter, above_bed, off;  // [m], [m], [-]
    };
    for (const Case& c : {Case{0.05, 0.08, 0.15}, Case{0.075, 0.08, 0.15}, Case{0.1, 0.07, 0.15}}) {
        const Drag drag = drag_of_stone(channel_water::mixing_length(), c.diameter, c.above_bed);
        const Real cells = c.diameter / channel_water::spacing;
        MESSAGE(cells << " cells: C_d " << drag.mean << " +- " << drag.varies);
        CHECK(std::abs(drag.mean / curve - 1) < c.off);
    }
    const Drag none = drag_of_stone(NoTurbulence{}, 0.075, 0.08);
    MESSAGE("no eddies, 3.75 cells: " << none.mean << " +- " << none.varies);
    CHECK(std::abs(none.mean / curve - 1) < 0.1);
}
