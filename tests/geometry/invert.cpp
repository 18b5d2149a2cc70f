// The cross-section of the channel.
#include <abrade/geometry/invert.hpp>

#include <doctest/doctest.h>

#include <limits>

using namespace abrade;

namespace {

/// Area under water by strips across, from the bed's shape alone.
Real area_by_strips(const Invert& s, Real depth) {
    constexpr int strips = 200'000;
    const Real dy = s.width / strips;
    Real sum = 0;
    for (int i = 0; i < strips; ++i)
        sum += std::max(0.0, depth - s.bed_height((i + 0.5) * dy - 0.5 * s.width)) * dy;
    return sum;
}

/// Length of the wetted bed by chords, plus the walls.
Real perimeter_by_chords(const Invert& s, Real depth) {
    constexpr int chords = 200'000;
    const Real edge = s.bed_height(0.5 * s.width);
    const Real half =
        depth > edge ? 0.5 * s.width : std::sqrt(square(s.arc_radius) - square(s.arc_radius - depth));
    Real sum = 2 * std::max(0.0, depth - edge);
    for (int i = 0; i < chords; ++i) {
        const Real y0 = half * (2.0 * i / chords - 1), y1 = half * (2.0 * (i + 1) / chords - 1);
        sum += std::hypot(y1 - y0, s.bed_height(y1) - s.bed_height(y0));
    }
    return sum;
}

const Invert channel{.length = 45, .width = 1, .arc_radius = 1, .slope = 0.05};
const Invert half_pipe{.length = 5, .width = 0.6, .arc_radius = 0.3, .slope = 0.01};

}  // namespace

TEST_CASE("the bed is an arc, lowest at the centre line, level beyond the walls") {
    CHECK(channel.bed_height(0) == 0);
    CHECK(channel.bed_height(0.5) == doctest::Approx(1 - std::sqrt(0.75)).epsilon(1e-14));
    CHECK(channel.bed_height(-0.3) == channel.bed_height(0.3));
    CHECK(channel.bed_height(0.7) == channel.bed_height(0.5));
    for (Real y = -0.5; y <= 0.5; y += 0.05)  // on the circle about (0, R)
        CHECK(std::hypot(y, channel.bed_height(y) - 1) == doctest::Approx(1).epsilon(1e-14));
    CHECK(channel.half_angle() == doctest::Approx(pi / 6).epsilon(1e-14));
}

TEST_CASE("flow area and wetted perimeter against sums over strips, below and above the arc's edge") {
    for (const Invert& s : {channel, half_pipe})
        for (const Real depth : {0.001, 0.02, 0.1, 0.133, 0.135, 0.3, 0.8}) {
            CAPTURE(depth);
            // Strips: second order, except at the waterline where the bed is steep.
            CHECK(s.flow_area(depth) == doctest::Approx(area_by_strips(s, depth)).epsilon(1e-5));
            CHECK(s.wetted_perimeter(depth) == doctest::Approx(perimeter_by_chords(s, depth)).epsilon(1e-5));
        }
    CHECK(channel.flow_area(0) == 0);
    CHECK(channel.wetted_perimeter(0) == 0);
}

TEST_CASE("area and perimeter do not jump where the walls begin") {
    const Real edge = channel.bed_height(0.5), step = 1e-9;
    CHECK(channel.flow_area(edge + step) - channel.flow_area(edge - step) ==
          doctest::Approx(2 * step).epsilon(1e-3).scale(0));
    // The arc meets the wall at 60 degrees from upright: the perimeter's slope jumps, its value does not.
    CHECK(std::abs(channel.wetted_perimeter(edge + step) - channel.wetted_perimeter(edge - step)) <
          10 * step);
}

TEST_CASE("a huge radius is a rectangle") {
    const Invert flat{.length = 1, .width = 1, .arc_radius = 1e4, .slope = 0.05};
    // The arc rises by w^2/(8R) = 1.25e-5 m at its edges.
    CHECK(flat.flow_area(0.125) == doctest::Approx(0.125).epsilon(1e-4));
    CHECK(flat.wetted_perimeter(0.125) == doctest::Approx(1.25).epsilon(1e-4));
}

TEST_CASE("gravity turns with the slope and keeps its size") {
    CHECK(channel.gravity().norm() == doctest::Approx(standard_gravity).epsilon(1e-15));
    CHECK(channel.gravity().x() == doctest::Approx(0.05 * standard_gravity).epsilon(1e-15));
    CHECK(channel.gravity().y() == 0);
    CHECK(channel.gravity().z() < 0);
}

TEST_CASE("a section that cannot be is refused, with the rule") {
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    CHECK_NOTHROW(channel.validate());
    CHECK_NOTHROW(half_pipe.validate());  // R = w/2 exactly: a half pipe
    for (const Real bad : {0.0, -1.0, nan}) {
        CHECK_THROWS_AS((Invert{.length = bad}.validate()), InputError);
        CHECK_THROWS_AS((Invert{.width = bad}.validate()), InputError);
        CHECK_THROWS_AS((Invert{.arc_radius = bad}.validate()), InputError);
    }
    CHECK_THROWS_WITH_AS((Invert{.width = 1, .arc_radius = 0.4}.validate()),
                         "Invert.arc_radius must be at least half the width (0.5 m), got 0.4 m; widen the "
                         "arc or narrow the channel",
                         InputError);
    for (const Real bad : {-0.01, 1.0, nan}) CHECK_THROWS_AS((Invert{.slope = bad}.validate()), InputError);
}
