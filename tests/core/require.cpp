// Error messages: field, rule, value with its unit, remedy.
#include <abrade/core/require.hpp>

#include "../message_of.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace abrade;

namespace {

constexpr Real not_a_number = std::numeric_limits<Real>::quiet_NaN();
constexpr Real infinite = std::numeric_limits<Real>::infinity();
const std::string look = "; look for a division by 0 or an uninitialised number where it is set";

}  // namespace

TEST_CASE("a broken rule names field, rule, value with unit, and remedy") {
    CHECK(message_of([] {
              require(false, {"Law.size", "below 3", "m", "cut it"}, 4.5);
          }) == "Law.size must be below 3, got 4.5 m; cut it");
    CHECK(message_of([] {
              require(false, {"Law.size", "below 3", "m"}, 4.5);
          }) == "Law.size must be below 3, got 4.5 m");
    CHECK(message_of([] {
              require(false, {"Law.ratio", "below 3"}, 4.5);
          }) == "Law.ratio must be below 3, got 4.5");
    CHECK(message_of([] {
              require(false, {"Law.ratio", "below 3", "", "cut it"}, 4.5);
          }) == "Law.ratio must be below 3, got 4.5; cut it");
    CHECK(message_of([] {
              fail({"Law.shape", "round", "", "file it"}, "'edgy'");
          }) == "Law.shape must be round, got 'edgy'; file it");
}

TEST_CASE("a rule that holds is silent") {
    CHECK_NOTHROW(require(true, {"Law.size", "below 3", "m", "cut it"}, 1));
    CHECK_NOTHROW(require_positive(1e-300, "Law.size"));
    CHECK_NOTHROW(require_not_negative(0, "Law.size"));
    CHECK_NOTHROW(require_not_negative(-0.0, "Law.size"));
    CHECK_NOTHROW(require_finite(-1e300, "Law.size"));
}

TEST_CASE("the common rules refuse zero, signs, infinities and NaN") {
    for (const Real bad : {0.0, -1.0, -1e-300, infinite, -infinite, not_a_number}) {
        CAPTURE(bad);
        CHECK_THROWS_AS(require_positive(bad, "Law.size", "m"), InputError);
    }
    for (const Real bad : {-1.0, -1e-300, infinite, -infinite, not_a_number}) {
        CAPTURE(bad);
        CHECK_THROWS_AS(require_not_negative(bad, "Law.size", "m"), InputError);
    }
    CHECK(message_of([] { require_positive(-1, "HertzMindlin.youngs", "Pa"); }) ==
          "HertzMindlin.youngs must be finite and > 0, got -1 Pa; check its sign");
    CHECK(message_of([] { require_positive(not_a_number, "Law.size", "m", "measure it"); }) ==
          "Law.size must be finite and > 0, got nan m; measure it");
    CHECK(message_of([] { require_not_negative(infinite, "Law.size", "m"); }) ==
          "Law.size must be finite and >= 0, got inf m" + look);
}

TEST_CASE("the common rules know a remedy that fits the value; one that is given counts more") {
    CHECK(message_of([] { require_positive(0, "Law.size"); }) ==
          "Law.size must be finite and > 0, got 0; was it left unset? give a number above 0");
    CHECK(message_of([] { require_not_negative(-1, "Law.size"); }) ==
          "Law.size must be finite and >= 0, got -1; check its sign");
    CHECK(message_of([] { require_not_negative(-1, "Law.size", "m", "measure it"); }) ==
          "Law.size must be finite and >= 0, got -1 m; measure it");
    CHECK(message_of([] { require_positive(infinite, "Law.size"); }) ==
          "Law.size must be finite and > 0, got inf" + look);
    CHECK(message_of([] { require_finite(infinite, "Law.start", "s"); }) ==
          "Law.start must be finite, got inf s" + look);
    CHECK(message_of([] { require_finite(infinite, "Law.start", "s", "0 starts at once"); }) ==
          "Law.start must be finite, got inf s; 0 starts at once");
}

TEST_CASE("a vector that is not finite: the component is named") {
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 place(1, 2, 3);
        place[axis] = infinite;
        const std::string refused = std::string("Body.place.") + "xyz"[axis] + " must be finite, got inf m";
        CHECK(message_of([&] { require_finite(place, "Body.place", "m"); }) == refused + look);
        CHECK(message_of([&] { require_finite(place, "Body.place", "m", "move it"); }) ==
              refused + "; move it");
    }
    CHECK_NOTHROW(require_finite(Vec3(1, -2, 1e300), "Body.place", "m"));
}

TEST_CASE("InputError is a std::invalid_argument, for callers that know nothing of us") {
    CHECK_THROWS_AS(require_positive(0, "Law.size"), std::invalid_argument);
}

TEST_CASE("to_text is short and reads back as the same number") {
    CHECK(to_text(0.3) == "0.3");
    CHECK(to_text(5e6) == "5e+06");
    CHECK(to_text(0) == "0");
    CHECK(to_text(-2) == "-2");
    CHECK(to_text(infinite) == "inf");
    CHECK(to_text(not_a_number).find("nan") !=
          std::string::npos);  // the sign of a NaN is the library's to print
    for (const Real value : {0.1 + 0.2, 1.0 / 3, pi, 6.02214076e23, std::numeric_limits<Real>::denorm_min(),
                             std::numeric_limits<Real>::max(), 1 - 1e-16, -123456.789}) {
        CAPTURE(value);
        CHECK(std::strtod(to_text(value).c_str(), nullptr) == value);
    }
}
