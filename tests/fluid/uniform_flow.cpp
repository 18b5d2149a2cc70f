// Uniform flow: Manning's depth, the logarithmic profile, and the discharge that both must carry.
#include <abrade/fluid/uniform_flow.hpp>

#include <doctest/doctest.h>

#include <limits>

using namespace abrade;

namespace {

const Invert arc{.length = 45, .width = 1, .arc_radius = 1, .slope = 0.05};
const Invert rectangle{.length = 45, .width = 1, .arc_radius = 1e4, .slope = 0.05};

struct Row {
    Real manning, depth, speed, froude, shear;  // [s/m^(1/3)], [m], [m/s], [-], [Pa]
};

UniformFlow flow(const Invert& section, Real manning) {
    return UniformFlow{{.section = section, .discharge = 0.5, .manning = manning}};
}

}  // namespace

TEST_CASE("rectangle: depth, speed, Froude number and bed shear of the model's table") {
    for (const Row& row :
         {Row{.012, .125, 4.0, 3.6, 49}, Row{.014, .138, 3.6, 3.1, 53}, Row{.020, .175, 2.9, 2.2, 64}}) {
        const UniformFlow water = flow(rectangle, row.manning);
        CAPTURE(row.manning);
        // The table is rounded: half a unit of its last place.
        CHECK(std::abs(water.depth() - row.depth) < 0.0006);
        CHECK(std::abs(water.mean_velocity() - row.speed) < 0.051);
        CHECK(std::abs(water.froude() - row.froude) < 0.051);
        CHECK(std::abs(water.bed_shear() - row.shear) < 0.51);
    }
}

TEST_CASE("arc: the model's table, whose arc goes on beyond the channel's walls") {
    // At 1 m the arc is a half pipe, 2 m wide: the water finds no wall, and the table is met to its last
    // place.
    const Invert open_arc{.length = 45, .width = 2, .arc_radius = 1, .slope = 0.05};
    for (const Row& row :
         {Row{.012, .163, 4.1, 4.0, 51}, Row{.015, .181, 3.5, 3.2, 57}, Row{.020, .208, 2.9, 2.5, 65}}) {
        CAPTURE(row.manning);
        const UniformFlow open = flow(open_arc, row.manning);
        CHECK(std::abs(open.depth() - row.depth) < 0.0006);
        CHECK(std::abs(open.mean_velocity() - row.speed) < 0.051);
        CHECK(std::abs(open.froude() - row.froude) < 0.051);
        CHECK(std::abs(open.bed_shear() - row.shear) < 0.51);
        // With walls at y = 0.5 m the water above 0.134 m loses up to 9 % of its width: a little less
        // perimeter for the same area, so the hydraulic radius and with it the speed are 2 to 4 % more than
        // in the table.
        const UniformFlow walled = flow(arc, row.manning);
        CHECK(walled.depth() == doctest::Approx(row.depth).epsilon(0.02));
        CHECK(walled.mean_velocity() == doctest::Approx(row.speed).epsilon(0.045));
        CHECK(walled.mean_velocity() > open.mean_velocity());
        CHECK(walled.bed_shear() == doctest::Approx(row.shear).epsilon(0.055));
    }
}

TEST_CASE("Manning's formula holds at the normal depth, for any channel") {
    for (const Invert& section :
         {arc, rectangle, Invert{.length = 1, .width = 3, .arc_radius = 1.5, .slope = 0.001}})
        for (const Real discharge : {1e-4, 0.05, 0.5, 20.0})
            for (const Real n : {0.009, 0.03}) {
                const Real depth = normal_depth(section, discharge, n), area = section.flow_area(depth);
                const Real carried = area * std::pow(area / section.wetted_perimeter(depth), 2.0 / 3) *
                                     std::sqrt(section.slope) / n;
                CHECK(carried == doctest::Approx(discharge).epsilon(1e-9));  // a bisection to round-off
            }
}

TEST_CASE("the sampled velocity carries the discharge") {
    for (const Invert& section : {arc, rectangle})
        for (const Real n : {0.012, 0.02}) {
            const UniformFlow water = flow(section, n);
            // Midpoints, finer near the bed where the logarithm is steep.
            Real sum = 0;
            constexpr int strips = 400, levels = 1000;
            for (int i = 0; i < strips; ++i) {
                const Real y = (i + 0.5) / strips - 0.5, bed = section.bed_height(y),
                           height = water.depth() - bed;
                if (height <= 0) continue;
                for (int k = 0; k < levels; ++k) {
                    const Real low = height * cube(static_cast<Real>(k) / levels),
                               high = height * cube(static_cast<Real>(k + 1) / levels);
                    sum += water.sample({3, y, bed + 0.5 * (low + high)}, 0).velocity.x() * (high - low) /
                           strips;
                }
            }
            CHECK(sum ==
                  doctest::Approx(0.5).epsilon(1e-3));  // strips cut the waterline to 1/400 of a thin edge
        }
}

TEST_CASE("the profile is logarithmic with Schlichting's z0 = k_s/30, k_s = (26 n)^6") {
    const UniformFlow water = flow(arc, 0.015);
    const Real z0 = std::pow(26 * 0.015, 6) / 30;
    const auto u = [&](Real height) { return water.sample({0, 0, height}, 0).velocity.x(); };
    CHECK(u(0) == 0);
    // Ratios do not know the constant: u(a)/u(b) = ln(1 + a/z0)/ln(1 + b/z0).
    CHECK(u(0.1) / u(0.01) == doctest::Approx(std::log1p(0.1 / z0) / std::log1p(0.01 / z0)).epsilon(1e-13));
    CHECK(u(0.15) > u(0.1));
    // It also answers to the wall: u = u*/kappa ln(z/z0) with u* = sqrt(g R S), kappa = 0.4, holds for a wide
    // rough channel; here Manning's n sets both, so they may differ by the constant of Strickler's formula
    // (10 %).
    const Real u_star = std::sqrt(water.bed_shear() / 1000);
    CHECK(u(0.1) == doctest::Approx(u_star / 0.4 * std::log(0.1 / z0)).epsilon(0.15));
}

TEST_CASE("depth below the surface, over the bed, along the channel and in time") {
    const UniformFlow water = flow(arc, 0.015);
    CHECK(water.sample({0, 0, water.depth()}, 0).depth == doctest::Approx(0));
    CHECK(water.sample({0, 0.2, 0.1}, 0).depth == doctest::Approx(water.depth() - 0.1));
    CHECK(water.sample({0, 0, 1}, 0).depth < 0);
    const FluidSample here = water.sample({1, 0.1, 0.1}, 0), there = water.sample({40, 0.1, 0.1}, 100),
                      mirrored = water.sample({1, -0.1, 0.1}, 0);
    CHECK(here.velocity == there.velocity);
    CHECK(here.velocity == mirrored.velocity);
    CHECK(here.velocity.tail<2>().norm() == 0);
    CHECK(water.sample({0, 0, -0.01}, 0).velocity.x() == 0);  // within the bed
    CHECK(here.density == 1000);
    CHECK(here.viscosity == 1.31e-3);
}

TEST_CASE("flow that cannot be is refused, with the rule") {
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    for (const Real bad : {0.0, -1.0, nan}) {
        CHECK_THROWS_AS(UniformFlow({.section = arc, .discharge = bad}), InputError);
        CHECK_THROWS_AS(UniformFlow({.section = arc, .discharge = 0.5, .manning = bad}), InputError);
        CHECK_THROWS_AS(UniformFlow({.section = arc, .discharge = 0.5, .density = bad}), InputError);
        CHECK_THROWS_AS(UniformFlow({.section = arc, .discharge = 0.5, .viscosity = bad}), InputError);
        CHECK_THROWS_AS(normal_depth(arc, bad, 0.015), InputError);
        CHECK_THROWS_AS(normal_depth(arc, 0.5, bad), InputError);
    }
    Invert level = arc;
    level.slope = 0;
    CHECK_THROWS_WITH_AS(normal_depth(level, 0.5, 0.015),
                         "Invert.slope must be finite and > 0, got 0 m/m; uniform flow needs a slope",
                         InputError);
    CHECK_THROWS_AS(UniformFlow({.section = level, .discharge = 0.5}), InputError);
    CHECK_THROWS_AS(UniformFlow({.section = {.width = -1}, .discharge = 0.5}), InputError);
}
