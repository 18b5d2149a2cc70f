// Depth-averaged water: slopes, flux and friction of one face and one cell, for numbers and for packs.
#include <abrade/fluid/shallow_water/kernel.hpp>

#include <doctest/doctest.h>

#include <random>

using namespace abrade;

namespace {

constexpr Real g = 9.81;

using Beside = WaterBeside<Real>;

/// Momentum through the face with the pressure of one side, which the kernel leaves out.
Real whole_momentum(const WaterFlux<Real>& flux, const Beside& low) {
    return flux.low + 0.5 * g * square(low.depth);
}

}  // namespace

TEST_CASE("slopes: exact for a line, none at a crest, never beyond the neighbours") {
    CHECK(limited_half_change(0.2, 0.2) == 0.1);
    CHECK(limited_half_change(0.2, -0.3) == 0);
    CHECK(limited_half_change(-0.1, 0.3) == 0);
    CHECK(limited_half_change(0.1, 0.4) ==
          doctest::Approx(0.1));  // to the nearer neighbour's value, no further
    CHECK(limited_half_change(-0.3, -0.2) == doctest::Approx(-0.125));  // half of the mean
}

TEST_CASE("equal states have their own flux, equal depths at rest have none at all") {
    for (const Real u : {-5.0, -1.0, 0.0, 0.3, 8.0}) {
        const Beside water{0.7, u, 2};
        const auto flux = water_flux(water, water, g);
        CHECK(flux.mass == doctest::Approx(0.7 * u).epsilon(1e-15));
        CHECK(flux.low == doctest::Approx(0.7 * u * u).epsilon(1e-15));
        CHECK(flux.high == flux.low);
        CHECK(flux.along == doctest::Approx(1.4 * u).epsilon(1e-15));
    }
    const Beside rest{0.123, 0, 0};
    const auto none = water_flux(rest, rest, g);
    CHECK(none.mass == 0);
    CHECK(none.low == 0);
    CHECK(none.high == 0);
}

TEST_CASE("shooting water brings the flux of the side that it comes from") {
    const Beside low{0.1, 5, 1}, high{0.4, 6, -1};
    const auto flux = water_flux(low, high, g);
    CHECK(flux.mass == doctest::Approx(0.5));
    CHECK(flux.low == doctest::Approx(2.5));
    CHECK(flux.high == doctest::Approx(2.5 + 0.5 * g * (0.01 - 0.16)));
    CHECK(flux.along == doctest::Approx(0.5));
}

TEST_CASE("mirrored states have the mirrored flux") {
    const Beside low{0.3, 1.2, 0.4}, high{0.1, -0.7, 0.9};
    const auto flux = water_flux(low, high, g);
    const auto back = water_flux(Beside{high.depth, -high.through, high.along},
                                 Beside{low.depth, -low.through, low.along}, g);
    CHECK(back.mass == doctest::Approx(-flux.mass).epsilon(1e-13));
    CHECK(back.along == doctest::Approx(-flux.along).epsilon(1e-13));
    CHECK(back.low == doctest::Approx(flux.high).epsilon(1e-13));
}

TEST_CASE("onto a dry bed water runs, out of it nothing comes") {
    const Beside wet{0.5, 0, 0}, dry{0, 0, 0};
    const auto forwards = water_flux(wet, dry, g), backwards = water_flux(dry, wet, g);
    // HLL between -c and the front at 2 c: 2/3 c h; Ritter has 8/27 c h at the dam.
    CHECK(forwards.mass == doctest::Approx(2.0 / 3 * std::sqrt(g * 0.5) * 0.5));
    CHECK(backwards.mass == doctest::Approx(-forwards.mass));
    CHECK(whole_momentum(forwards, wet) > 0);
    std::mt19937 random(1);
    std::uniform_real_distribution<Real> any(-20, 20), depth(0, 1e-3);
    for (int n = 0; n < 1000; ++n) {
        const Beside water{depth(random), any(random), any(random)};
        CHECK(water_flux(water, dry, g).mass >= 0);
        CHECK(water_flux(dry, water, g).mass <= 0);
    }
    const auto nothing = water_flux(dry, dry, g);
    CHECK(nothing.mass == 0);
    CHECK(nothing.low == 0);
    CHECK(nothing.along == 0);
}

TEST_CASE("both sides see one bed: the higher one, and none deeper than twice a cell's water") {
    CHECK(bed_at_face(0.1, 0.5, 2.0, 0.5, 2.0) == 0.1);
    CHECK(bed_at_face(0.1, 0.5, 0.2, 0.5, 2.0) == doctest::Approx(0.3));
    CHECK(bed_at_face(0.1, 0.5, 2.0, 0.9, 0.0) == 0.9);  // a dry cell above the water: its bed is a wall
}

TEST_CASE("a surface dips no lower than the bed, and a level one is not turned") {
    CHECK(change_above_bed(-0.4, 0.0, 0.1) == -0.1);
    CHECK(change_above_bed(0.4, 0.0, 0.1) == 0.1);
    CHECK(change_above_bed(-0.3, -0.3, 0.1) == -0.3);  // a film down a slope
    CHECK(change_above_bed(-0.5, -0.3, 0.1) == -0.4);
    CHECK(change_above_bed(-0.05, 0.0, 0.1) == -0.05);
    CHECK(change_above_bed(0.0, 0.5, 0.1) == 0.0);
    CHECK(change_above_bed(0.0, -0.5, 0.1) == 0.0);
}

TEST_CASE("friction: Manning's, from films to rivers") {
    for (Real h = 1e-6; h < 100; h *= 3)
        CHECK(friction_rate(h, 2.0, g * square(0.015)) ==
              doctest::Approx(g * square(0.015) * 2 / std::pow(h, 4.0 / 3)).epsilon(1e-13).scale(0));
}

TEST_CASE("a pack does what numbers do") {
    std::mt19937 random(2);
    std::uniform_real_distribution<Real> speed(-5, 5), depth(-0.2, 1), size(-20, 20);
    for (int n = 0; n < 200; ++n) {
        WaterBeside<Pack> low, high;
        Pack x;
        std::array<Beside, pack_lanes> lows, highs;
        for (int lane = 0; lane < pack_lanes; ++lane) {
            const auto k = static_cast<std::size_t>(lane);
            lows[k] = {std::max(0.0, depth(random)), speed(random), speed(random)};
            highs[k] = {std::max(0.0, depth(random)), speed(random), speed(random)};
            low.depth.set(lane, lows[k].depth), high.depth.set(lane, highs[k].depth);
            low.through.set(lane, lows[k].through), high.through.set(lane, highs[k].through);
            low.along.set(lane, lows[k].along), high.along.set(lane, highs[k].along);
            x.set(lane, std::exp(size(random)));
        }
        const auto flux = water_flux(low, high, g);
        const Pack root = detail::inverse_cube_root(x), rough = detail::rough_root(x);
        for (int lane = 0; lane < pack_lanes; ++lane) {
            const auto k = static_cast<std::size_t>(lane);
            const auto one = water_flux(lows[k], highs[k], g);
            // Wave speeds of packs have eight digits; depth and speed are about 1.
            CHECK(flux.mass[lane] == doctest::Approx(one.mass).epsilon(1e-7).scale(1));
            CHECK(flux.low[lane] == doctest::Approx(one.low).epsilon(1e-7).scale(10));
            CHECK(flux.along[lane] == doctest::Approx(one.along).epsilon(1e-7).scale(10));
            CHECK(root[lane] == doctest::Approx(1 / std::cbrt(x[lane])).epsilon(1e-15).scale(0));
            CHECK(rough[lane] == doctest::Approx(std::sqrt(x[lane])).epsilon(1e-8).scale(0));
        }
    }
}
