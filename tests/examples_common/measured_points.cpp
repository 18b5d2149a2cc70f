// A user's CSV of measured points: errors name file, row and column.
#include "../../examples/common/measured_points.hpp"

#include <doctest/doctest.h>

#include <fstream>

using namespace abrade;
using namespace abrade::examples;

namespace {

std::string message_of(const std::string& csv) {
    std::ofstream{"points.csv"} << csv;
    try {
        read_measured_points("points.csv");
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing was thrown";
}

}  // namespace

TEST_CASE("points are read past comments, spaces and a spreadsheet's marks") {
    std::ofstream{"points.csv"}
        << "\xEF\xBB\xBFx_m,depth_mm_per_m3\r\n# by hand\n\n 10.5 , 1.2e-1\r\n11,-0.01\n+12,0.5";
    const std::vector<MeasuredPoint> points = read_measured_points("points.csv");
    REQUIRE(points.size() == 3);
    CHECK(points[0].x == 10.5);
    CHECK(points[0].depth == 0.12);
    CHECK(points[1].depth == -0.01);
    CHECK(points[2].x == 12.0);
}

TEST_CASE("what is wrong is said with file, row and column") {
    CHECK(message_of("x,depth\n1,2\n1;2\n") ==
          "points.csv, row 3 must be two columns, x [m] and depth [mm/m3], separated by a comma, got '1;2'");
    CHECK(
        message_of("x,depth\n1,2,3\n") ==
        "points.csv, row 2 must be two columns, x [m] and depth [mm/m3], separated by a comma, got '1,2,3'");
    CHECK(message_of("x,depth\n\n# c\none,2\n") ==
          "points.csv, row 4, column 1 (x) must be a number in m, got 'one'");
    CHECK(message_of("x,depth\n1,\n") ==
          "points.csv, row 2, column 2 (depth) must be a number in mm/m3, got ''");
    CHECK(message_of("x,depth\n1,2 mm\n") ==
          "points.csv, row 2, column 2 (depth) must be a number in mm/m3, got '2 mm'");
    CHECK(message_of("x,depth\n1,nan\n") ==
          "points.csv, row 2, column 2 (depth) must be a number in mm/m3, got 'nan'");
    CHECK(message_of("1,2\n") ==
          "points.csv, row 1 must be a header line, got '1,2'; put \"x_m,depth_mm_per_m3\" first");
    CHECK(message_of("x,depth\n") ==
          "points.csv must be given with at least one point below its header line, got none");
    CHECK_THROWS_WITH_AS(
        read_measured_points("missing.csv"),
        "measured points must be a CSV file that can be read, got 'missing.csv'; check its path", InputError);
    CHECK_THROWS_AS(read_measured_points("."), InputError);
}
