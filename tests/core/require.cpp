// Error messages: field, rule, value with its unit, remedy.
#include <abrade/core/require.hpp>

#include "../message_of.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace abrade;

namespace {

constexpr Real not_a_number = std::numeric_limits<Real>::quiet_NaN();
constexpr Real infinite = std::numeric_limits<Real>::infinity();

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
          "HertzMindlin.youngs must be finite and > 0, got -1 Pa");
    CHECK(message_of([] { require_positive(not_a_number, "Law.size", "m", "measure it"); }) ==
          "Law.size must be finite and > 0, got nan m; measure it");
    CHECK(message_of([] { require_not_negative(infinite, "Law.size", "m"); }) ==
          "Law.size must be finite and >= 0, got inf m");
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
