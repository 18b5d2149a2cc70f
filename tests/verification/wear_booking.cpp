// When the energy of a contact is booked as wear: as it flows, when the contact opens, or what is dissipated.
#include "wear_scenes.hpp"

#include <doctest/doctest.h>

using namespace abrade;
using namespace abrade::verification;

namespace {

/// The largest of |booked| over the energy brought, over phases of the first touch.
Real worst_of(Throw impact, const auto& booked) {
    Real worst = 0;
    for (const Real phase : {0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95}) {
        impact.phase = phase;
        worst = std::max(worst, std::abs(booked(bookings_of(impact))));
    }
    return worst / (0.5 * impact.mass * (square(impact.along) + square(impact.across)));
}

}  // namespace

TEST_CASE("an elastic impact: dissipated is nothing, at the end is the integrator's residue, of its order") {
    const Throw elastic{.restitution = 1, .friction = 0};
    CHECK(worst_of(elastic, [](const Bookings& b) { return b.dissipated; }) == 0);
    Real last = 0;
    for (const Real steps : {50.0, 100.0, 200.0, 400.0, 800.0}) {
        Throw impact = elastic;
        impact.steps = steps;
        const Real residue = worst_of(impact, [](const Bookings& b) { return b.running; });
        MESSAGE(steps << " steps: at the end " << residue << ", order "
                      << (last > 0 ? std::log2(last / residue) : NAN));
        if (last > 0) CHECK(residue < 0.2 * last);  // third order: an eighth
        last = residue;
    }
    // As it flows without what is negative: all that was brought, whatever the step.
    CHECK(worst_of(elastic, [](const Bookings& b) { return b.never_back; }) ==
          doctest::Approx(1).epsilon(0.01));
}

TEST_CASE("an elastic impact that sticks: what is dissipated falls with the step too") {
    const Throw sticking{.along = 1, .across = 0.2, .restitution = 1, .friction = 10};
    Real last = 0;
    for (const Real steps : {50.0, 200.0, 800.0}) {
        Throw impact = sticking;
        impact.steps = steps;
        const Real lost = worst_of(impact, [](const Bookings& b) { return b.dissipated; });
        const Real end = worst_of(impact, [](const Bookings& b) { return b.running - b.dissipated; });
        MESSAGE(steps << " steps: dissipated " << lost << ", residue " << end);
        if (last > 0) CHECK(lost < 0.1 * last);  // 4 times the steps: a sixteenth
        last = lost;
    }
}

TEST_CASE("over one impact, what is dissipated and the sum at the end are the same to second order") {
    for (const Real e : {0.9, 0.6, 0.3})
        for (const Real across : {0.0, 0.5, 4.0}) {
            Real last = 0;
            CAPTURE(e);
            CAPTURE(across);
            for (const Real steps : {50.0, 200.0, 800.0}) {
                const Throw impact{.across = across, .restitution = e, .steps = steps};
                const Real apart =
                    worst_of(impact, [](const Bookings& b) { return b.at_end - b.dissipated; });
                CHECK(worst_of(impact, [](const Bookings& b) { return b.still_owed; }) == 0);
                if (steps == 50) CHECK(apart < 0.02);
                if (last > 0) CHECK(apart < 0.2 * last);
                last = apart;
            }
            MESSAGE("e " << e << ", across " << across << ", 800 steps: " << last);
        }
}

TEST_CASE("a sphere that slides and rolls without leaving the ground: at the end nothing is ever booked") {
    BookingRecord record;
    Scene scene;
    scene.concrete = flat_concrete(1e4);
    const Real mass = 0.1;
    scene.add_sphere(0.02, {.position = {0, 0, 0.02 - mass * standard_gravity / 1e6}, .velocity = {2, 0, 0}},
                     mass / (4.0 / 3 * pi * cube(0.02)));
    auto sim = simulate(std::move(scene))
                   .contact(LinearSpring{{.stiffness = 1e6, .restitution = 0.3, .friction = 0.3}})
                   .wear(RecordingWear{record});
    sim.run({.end_time = 0.3, .time_step = 2e-5});
    const Bookings b = record.sums();
    CHECK(b.dissipated == doctest::Approx(mass * 4 / 7).epsilon(0.01).scale(0));  // m v^2 / 7, wear02
    CHECK(b.still_owed == doctest::Approx(b.dissipated).epsilon(1e-3).scale(0));
    CHECK(b.at_end == 0);
}

TEST_CASE(
    "a stone that comes to rest: dissipated is all that it brought, the last contact is owed for ever") {
    BookingRecord record;
    Scene scene;
    scene.concrete = flat_concrete(100);
    const Real mass = 0.1, height = 0.01;
    scene.add_sphere(0.02, {.position = {0, 0, 0.02 + height}}, mass / (4.0 / 3 * pi * cube(0.02)));
    auto sim = simulate(std::move(scene))
                   .contact(LinearSpring{{.stiffness = 1e6, .restitution = 0.5, .friction = 0.3}})
                   .wear(RecordingWear{record});
    sim.run({.end_time = 1, .time_step = 2e-5});
    const Bookings b = record.sums();
    const Real brought = mass * standard_gravity * height;
    CHECK(b.dissipated == doctest::Approx(brought).epsilon(0.01));
    CHECK(b.at_end + b.still_owed == doctest::Approx(b.dissipated).epsilon(0.01));
    CHECK(b.still_owed > 0);
    CHECK(b.never_back > b.dissipated * 1.2);
    CHECK(record.contacts() > 3);
    const Bookings then = b;
    sim.run({.end_time = 2});
    CHECK(record.sums().dissipated - then.dissipated < 1e-12 * brought);  // at rest nothing wears
    MESSAGE("at rest, over what was brought: dissipated "
            << b.dissipated / brought << ", at the end " << b.at_end / brought << " and owed "
            << b.still_owed / brought << ", never back " << b.never_back / brought << ", contacts "
            << record.contacts());
}
