// What an ensemble says of many runs, against closed forms.

#include "../../examples/ensemble_report/statistics.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace abrade;
using namespace abrade::examples;

TEST_CASE("mean, deviation and error of four values") {
    const std::vector<Real> values{1, 2, 3, 4};
    const Statistics s = statistics(values);
    CHECK(s.count == 4);
    CHECK(s.mean == 2.5);
    CHECK(s.standard_deviation == doctest::Approx(std::sqrt(5.0 / 3)).epsilon(1e-15));
    CHECK(s.standard_error == doctest::Approx(std::sqrt(5.0 / 12)).epsilon(1e-15));
    CHECK(s.min == 1);
    CHECK(s.max == 4);
}

TEST_CASE("a large offset costs no digits") {
    const std::vector<Real> values{1e8 + 1, 1e8 + 2, 1e8 + 3, 1e8 + 4};
    CHECK(statistics(values).standard_deviation == doctest::Approx(std::sqrt(5.0 / 3)).epsilon(1e-12));
}

TEST_CASE("what is not a number is left out, and one value has no error") {
    const std::vector<Real> values{Statistics::unknown, 3, Statistics::unknown};
    const Statistics s = statistics(values);
    CHECK(s.count == 1);
    CHECK(s.mean == 3);
    CHECK(std::isnan(s.standard_deviation));
    CHECK(std::isnan(s.standard_error));
    const Statistics none = statistics({});
    CHECK(none.count == 0);
    CHECK(std::isnan(none.mean));
}

TEST_CASE("along lines each place has its own mean") {
    const auto along = statistics_along({{1, 10, Statistics::unknown}, {3, 10, 5}});
    REQUIRE(along.size() == 3);
    CHECK(along[0].mean == 2);
    CHECK(along[0].standard_error == doctest::Approx(1).epsilon(1e-15));
    CHECK(along[1].standard_error == 0);
    CHECK(along[2].count == 1);
    CHECK(along[2].mean == 5);
    CHECK(statistics_along({}).empty());
}
