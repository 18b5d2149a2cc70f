// Depth-averaged water against closed solutions.
#include "shallow_water.hpp"
#include "reference_table.hpp"

#include <abrade/fluid/uniform_flow.hpp>

#include <doctest/doctest.h>

using namespace shallow;

TEST_CASE("a dam breaks on a dry bed: Ritter") {
    const DamBreak dam{.left = 1, .right = 0};
    ShallowWater<1> water = dam.water(800, 10);
    water.advance(1);
    Real missed = 0, volume = 0;
    for (const Column& p : points_of(water))
        missed += std::abs(p.depth - dam.at(p.x, 1).depth), volume += p.depth;
    CHECK(missed / volume < 1.5e-3);  // 1.0e-3 is measured; most of it is at the fan's head and the tip
    Index compared = 0;
    for (const ReferenceRow& row : reference_table("flu10_dambreak_ritter_stoker_analytic.csv")) {
        if (!row.is("case", "ritter_h0=1_t=1")) continue;
        // The table's closed form is ours; water is compared where it is deeper than 1 cm: the tip is not
        // gated.
        CHECK(dam.at(row.at("x"), 1).depth == doctest::Approx(row.at("h")).epsilon(1e-5).scale(0));
        CHECK(dam.at(row.at("x"), 1).speed == doctest::Approx(row.at("u")).epsilon(1e-5).scale(0));
        if (row.at("h") < 0.05) continue;
        const FluidSample here = water.sample({row.at("x"), 0, 0}, 1);
        CHECK(std::abs(here.depth - row.at("h")) < 0.01);
        CHECK(std::abs(here.velocity.x() - row.at("u")) < 0.03 * std::sqrt(9.81));
        ++compared;
    }
    CHECK(compared == 10);
}

TEST_CASE("a dam breaks on shallower water: Stoker's state behind the shock, and its speed") {
    struct Case {
        const char* name;
        Real left, right, half_length, time;
    };
    for (const Case& one :
         {Case{"stoker_hl=1_hr=0.1", 1, 0.1, 10, 2}, Case{"stoker_hl=1_hr=0.5", 1, 0.5, 10, 2},
          Case{"stoker_hl=0.3_hr=0.018", 0.3, 0.018, 5, 2}}) {
        CAPTURE(one.name);
        ShallowWater<1> water = DamBreak{.left = one.left, .right = one.right}.water(400, one.half_length);
        water.advance(one.time);
        Real depth = 0, speed = 0, shock = 0;
        for (const ReferenceRow& row : reference_table("flu10_dambreak_ritter_stoker_analytic.csv")) {
            if (row.is("case", std::string(one.name) + "_middle_state"))
                depth = row.at("h"), speed = row.at("u");
            if (row.is("case", std::string(one.name) + "_shock_speed")) shock = row.at("x");
        }
        const DamBreak::Middle exact = DamBreak{.left = one.left, .right = one.right}.middle();
        CHECK(exact.depth == doctest::Approx(depth).epsilon(1e-5).scale(0));
        CHECK(exact.shock == doctest::Approx(shock).epsilon(1e-5).scale(0));
        // Halfway between the fan's foot and the shock.
        const Real foot = speed - std::sqrt(9.81 * depth);
        const FluidSample middle = water.sample({0.5 * (foot + shock) * one.time, 0, 0}, one.time);
        CHECK(middle.depth == doctest::Approx(depth).epsilon(0.03).scale(0));
        CHECK(middle.velocity.x() == doctest::Approx(speed).epsilon(0.03).scale(0));
        Real front = 0;  // where depth falls through the mean of both
        for (const Column& p : points_of(water))
            if (p.depth > 0.5 * (depth + one.right)) front = p.x + 0.5 * water.grid().spacing(0);
        CHECK(front / one.time == doctest::Approx(shock).epsilon(0.03).scale(0));
    }
}

TEST_CASE("a jump is as high as Belanger has it and loses as much") {
    Index compared = 0;
    for (const ReferenceRow& row : reference_table("flu11_hydraulic_jump_belanger.csv")) {
        const Jump jump{row.at("F1")};
        CAPTURE(jump.froude);
        CHECK(jump.sequent() == doctest::Approx(row.at("h2_over_h1")).epsilon(1e-5).scale(0));
        if (jump.froude < 2 || jump.froude > 6) continue;
        ShallowWater<1> water = jump.bore(200);
        const Real time =
            30 / jump.froude * jump.sequent() / 2;  // it has run 15 m back from the wall at 40 m
        water.advance(time);
        const Real behind = water.depth(199), speed = jump.froude * (1 - 1 / jump.sequent());
        CHECK(behind == doctest::Approx(jump.sequent()).epsilon(0.05).scale(0));
        // Heads in the frame of the jump, at its own speed: what it holds more than the stream would.
        const Real pace = (water.volume() - 40) / (behind - 1) / time;
        const Real head_before = 1 + 0.5 * square(speed + pace), head_behind = behind + 0.5 * square(pace);
        CHECK(head_before - head_behind == doctest::Approx(row.at("dE_over_h1")).epsilon(0.1).scale(0));
        ++compared;
    }
    CHECK(compared == 5);
}

TEST_CASE("a jump stands where friction has slowed the stream down") {
    const Jump jump{3};
    ShallowWater<1> water = jump.standing(300, 0.9);
    water.advance(1500);
    const Real dx = water.grid().spacing(0);
    Index front = 0;
    for (Index i = 1; i < 150; ++i)
        if (water.depth(i) - water.depth(i - 1) > water.depth(front + 1) - water.depth(front)) front = i - 1;
    const Index before = front - 4, behind = front + 10;  // the jump itself is two or three cells wide
    REQUIRE(before > 5);
    REQUIRE(behind * dx < Jump::weir_at - Jump::weir_width);
    const Real h = water.depth(before), froude = water.speed(0, before) / std::sqrt(h);
    MESSAGE("jump at " << front * dx << " m, Froude " << froude << ", depths " << h << " and "
                       << water.depth(behind));
    CHECK(froude > 2);
    CHECK(water.depth(behind) / h == doctest::Approx(Jump{froude}.sequent()).epsilon(0.05).scale(0));
    CHECK(water.discharge(behind) == doctest::Approx(3).epsilon(0.01).scale(0));
}

TEST_CASE("a smooth wave: second order in space and time") {
    const SimpleWave wave;
    const Real time = 0.5 * wave.breaks();
    std::vector<Real> errors;
    for (const Index cells : {64, 128, 256, 512}) {
        ShallowWater<1> water = wave.line(cells);
        water.advance(time);
        errors.push_back(wave.error(water));
    }
    MESSAGE("errors " << errors[0] << " " << errors[1] << " " << errors[2] << " " << errors[3]);
    CHECK(order(errors[1], errors[2]) > 1.9);
    CHECK(order(errors[2], errors[3]) > 1.9);
}

TEST_CASE("friction and slope bring water to Manning's uniform flow, which then stays") {
    const Real slope = 0.01, manning = 0.02, depth = 0.3, g = standard_gravity;
    const Real speed = std::cbrt(square(depth)) * std::sqrt(slope) / manning;
    const auto water_at = [&](Real start) {
        return ShallowWater<1>{{.low = {0},
                                .high = {10},
                                .cells = {50},
                                .boundaries = {{{ShallowBoundary::periodic(), ShallowBoundary::periodic()}}},
                                .surface = [&](Real, Real) { return depth; },
                                .speed = {PlaneFunction([&](Real, Real) { return start * speed; })},
                                .gravity = {g * slope, 0, -g * std::sqrt(1 - square(slope))},
                                .manning = manning}};
    };
    ShallowWater<1> uniform = water_at(1);
    uniform.advance(10);
    ShallowWater<1> late = water_at(0);
    late.advance(12 * speed / (g * slope));  // a dozen of its time scales: tanh(12) is 1 - 8e-11
    Real missed = 0, missed_late = 0;
    for (Index i = 0; i < 50; ++i) {
        missed = std::max(missed, std::abs(uniform.speed(0, i) / speed - 1));
        missed = std::max(missed, std::abs(uniform.depth(i) / depth - 1));
        missed_late = std::max(missed_late, std::abs(late.speed(0, i) / speed - 1));
    }
    CHECK(missed < 1e-12);  // round-off of some 500 steps
    CHECK(missed_late < 1e-9);
    // On the way there: u = U tanh(g S t / U), to second order in the step.
    std::vector<Real> errors;
    for (const Real courant : {0.5, 0.25, 0.125}) {
        ShallowWater<1> water = water_at(0);
        auto params = water.params();
        params.courant = courant;
        water = ShallowWater<1>(params);
        const Real time = speed / (g * slope);
        water.advance(time);
        errors.push_back(std::abs(water.speed(0, 25) / (speed * std::tanh(1.0)) - 1));
    }
    MESSAGE("errors of the way there " << errors[0] << " " << errors[1] << " " << errors[2]);
    CHECK(order(errors[0], errors[1]) > 1.9);
    CHECK(order(errors[1], errors[2]) > 1.9);
}

TEST_CASE("down a channel water comes to the depth at which Manning's formula carries the discharge") {
    const Real slope = 0.01, manning = 0.02, discharge = 0.5, g = standard_gravity;
    const Real depth = std::pow(discharge * manning / std::sqrt(slope), 0.6);
    ShallowWater<1> water{
        {.low = {0},
         .high = {20},
         .cells = {100},
         .boundaries = {{{ShallowBoundary::inflow(discharge, 0.8 * depth), ShallowBoundary::outflow()}}},
         .gravity = {g * slope, 0, -g * std::sqrt(1 - square(slope))},
         .manning = manning}};
    water.advance(200);
    CHECK(water.depth(99) == doctest::Approx(depth).epsilon(0.02).scale(0));
    CHECK(water.discharge(50) == doctest::Approx(discharge).epsilon(1e-6).scale(0));
    CHECK(water.volume_residual() < 1e-12);
}

TEST_CASE("water swings in a parabolic bowl: depth, shore and period of Thacker's solution") {
    const Bowl bowl;
    ShallowWater<1> water = bowl.line(200);
    const Real dx = water.grid().spacing(0);
    for (const Real part : {0.25, 0.5, 1.0}) {
        water.advance(part * bowl.period());
        CAPTURE(part);
        CHECK(bowl.error(water) < 0.01);
        // The shore stands a radius to either side of the lake's middle; a film may be left behind it.
        const Real middle = bowl.swing * std::cos(2 * pi * part);
        Real left = 2, right = -2;
        for (Index i = 0; i < 200; ++i)
            if (water.depth(i) > 0.005 * bowl.depth)
                left = std::min(left, water.grid().centre(0, i)),
                right = std::max(right, water.grid().centre(0, i));
        CHECK(std::abs(left - (middle - bowl.radius)) < 2.5 * dx);
        CHECK(std::abs(right - (middle + bowl.radius)) < 2.5 * dx);
    }
    // The period: the middle of the water is back where it began, and stood still there last.
    const auto middle_of = [&] {
        Real moment = 0;
        for (const Column& p : points_of(water)) moment += p.x * p.depth * dx;
        return moment / water.volume();
    };
    Real last = 0, turned = 0;
    for (Real t = 1.9; t < 2.1; t += 0.002) {
        water.advance(t * bowl.period());
        if (const Real now = middle_of(); now > last) last = now, turned = t;
    }
    CHECK(turned == doctest::Approx(2).epsilon(0.005).scale(0));
    CHECK(last == doctest::Approx(bowl.swing).epsilon(0.02).scale(0));

    ShallowWater<2> round = bowl.plane(100);
    round.advance(bowl.period());
    CHECK(bowl.error(round) < 0.02);
    CHECK(round.volume_residual() < 1e-12);
}
