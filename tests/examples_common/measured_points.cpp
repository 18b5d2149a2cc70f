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
    const std::string leave_out = "; a # in front leaves the row out";
    // Another number of columns; a comma in a decimal is one.
    for (const std::string row : {"1;2", "1,2,3", "1", "1,5,0,2", "1,2,", "1 2"})
        CHECK(message_of("x,depth\n1,2\n" + row + "\n") ==
              "points.csv, row 3 must be two columns, x [m] and depth [mm/m3], separated by a comma, got '" +
                  row + "'; decimals take a point; a # in front leaves a row out");
    // What is no number: text, nothing, a unit, NaN, infinity, beyond what a number holds.
    for (const std::string bad :
         {"one", "", "2 mm", "nan", "NaN", "inf", "-inf", "1e999", "0x1p3", "1.2.3", "--1", "+-1"}) {
        CHECK(message_of("x,depth\n\n# c\n" + bad + ",2\n") ==
              "points.csv, row 4, column 1 (x) must be a number in m, got '" + bad + "'" + leave_out);
        CHECK(message_of("x,depth\n1," + bad + "\n") ==
              "points.csv, row 2, column 2 (depth) must be a number in mm/m3, got '" + bad + "'" + leave_out);
    }
    CHECK(message_of("1,2\n") ==
          "points.csv, row 1 must be a header line, got '1,2'; put \"x_m,depth_mm_per_m3\" first");
    for (const std::string empty : {"", "\n\n", "# nothing\n", "x,depth\n", "x,depth\n# 1,2\n"})
        CHECK(message_of(empty) ==
              "points.csv must be given with at least one point below its header line, got none; write rows "
              "of x [m], depth [mm/m3] under \"x_m,depth_mm_per_m3\"");
    CHECK_THROWS_WITH_AS(
        read_measured_points("missing.csv"),
        "measured points must be a CSV file that can be read, got 'missing.csv'; check its path", InputError);
    CHECK_THROWS_AS(read_measured_points("."), InputError);
}
