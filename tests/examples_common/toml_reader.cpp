// Parameters from TOML: what is wrong is said with file, line, key, and what was meant.
#include "../../examples/common/toml_reader.hpp"

#include "../message_of.hpp"

#include <doctest/doctest.h>

#include <array>
#include <fstream>

using namespace abrade;
using namespace abrade::examples;

namespace {

const std::string text = R"([water]
depth = 0.16
slope = 1
name = "uniform"
steady = true
levels = [1, 2.5]
file = "points.csv"

[[stones]]
diameter = 0.02

[[stones]]
diameter = -0.03
)";

TomlReader reader(const std::vector<std::string>& overrides = {}) {
    return TomlReader::from_text(text, "quick.toml", overrides);
}

bool has(const std::string& whole, std::string_view part) { return whole.find(part) != whole.npos; }

}  // namespace

TEST_CASE("values of each type are read, or taken from the fallback") {
    TomlReader in = reader();
    CHECK(in.number("water.depth", {.unit = "m"}) == 0.16);
    CHECK(in.number("water.slope") == 1.0);
    CHECK(in.integer("water.slope") == 1);
    CHECK(in.text("water.name") == "uniform");
    CHECK(in.flag("water.steady"));
    CHECK(in.numbers("water.levels", {.unit = "m"}) == std::vector<Real>{1, 2.5});
    CHECK(in.count("stones") == 2);
    CHECK(in.count("gravel") == 0);
    CHECK(in.number("stones[0].diameter") == 0.02);
    CHECK(in.number("water.missing", {.fallback = 3}) == 3.0);
    CHECK(in.numbers("water.none", {.fallback = std::vector<Real>{}}).empty());
    CHECK(in.has("water.depth"));
    CHECK(!in.has("air.depth"));
    CHECK(in.where("water.depth") == "quick.toml:2:9");
    static constexpr std::array<std::string_view, 2> kinds{"uniform", "grid"};
    CHECK(in.choice("water.name", kinds) == "uniform");
}

TEST_CASE("what was used is listed, with units and assumptions") {
    TomlReader in = reader({"water.slope=2"});
    in.number("water.depth", {.unit = "m", .help = "depth of the flow"});
    in.number("water.depth");
    in.number("water.manning", {.unit = "s/m^(1/3)", .fallback = 0.012, .assumption = "smooth concrete"});
    in.integer("water.slope");
    const std::vector<Parameter>& used = in.parameters();
    REQUIRE(used.size() == 3);
    CHECK(used[0].key == "water.depth");
    CHECK(used[0].value == "0.16");
    CHECK(used[0].unit == "m");
    CHECK(used[0].help == "depth of the flow");
    CHECK(used[0].origin == "file");
    CHECK(used[0].assumption.empty());
    CHECK(used[1].value == "0.012");
    CHECK(used[1].origin == "default");
    CHECK(used[1].assumption == "smooth concrete");
    CHECK(used[2].value == "2");
    CHECK(used[2].origin == "--set");
}

TEST_CASE("a wrong type names line, key, what is wanted and what was found") {
    TomlReader in = reader();
    CHECK(message_of([&] { in.number("water.name", {.unit = "m"}); }) ==
          "quick.toml:4:8: water.name must be a number in m, got the text 'uniform'");
    CHECK(message_of([&] { in.integer("water.depth"); }) ==
          "quick.toml:2:9: water.depth must be a whole number, got the number 0.16");
    CHECK(message_of([&] { in.text("water.depth"); }) ==
          "quick.toml:2:9: water.depth must be a text in quotes, got the number 0.16");
    CHECK(message_of([&] { in.flag("water.slope"); }) ==
          "quick.toml:3:9: water.slope must be true or false, got the whole number 1");
    CHECK(message_of([&] { in.number("water"); }) == "quick.toml:1:1: water must be a number, got a table");
    CHECK(message_of([&] { in.number("water.depth.x"); }) ==
          "quick.toml:2:9: water.depth.x must be inside a table, got the number 0.16");
    CHECK(has(message_of([&] { in.count("water"); }), "must be tables [[water]], got a table"));
    CHECK(message_of([&] { in.number("stones[1].diameter", {.unit = "m", .bound = Bound::positive}); }) ==
          "quick.toml:13:12: stones[1].diameter must be > 0, got -0.03 m");
    static constexpr std::array<std::string_view, 2> kinds{"uniform_flow", "grid"};
    CHECK(
        message_of([&] { in.choice("water.name", kinds); }) ==
        "quick.toml:4:8: water.name must be one of \"uniform_flow\" \"grid\", got \"uniform\"; did you mean "
        "\"uniform_flow\"?");
    TomlReader nan = TomlReader::from_text("a = nan", "nan.toml");
    CHECK(message_of([&] { nan.number("a", {.unit = "m"}); }) == "nan.toml:1:5: a must be finite, got nan m");
}

TEST_CASE("a number outside its bounds names them, the unit and the remedy") {
    TomlReader in = reader({"water.slope=2"});
    const Key<Real> about{.unit = "m", .least = 0.2, .most = 5, .remedy = "give metres"};
    CHECK(message_of([&] { in.number("water.depth", about); }) ==
          "quick.toml:2:9: water.depth must be from 0.2 to 5, got 0.16 m; give metres");
    CHECK(in.number("water.slope", about) == 2);
    CHECK(message_of([&] { in.numbers("water.levels", {.unit = "m", .least = 0, .most = 2}); }) ==
          "quick.toml:6:14: water.levels[1] must be from 0 to 2, got 2.5 m");
    CHECK(in.overridden("water.slope"));
    CHECK(!in.overridden("water.depth"));
    CHECK(!in.overridden("air.depth"));
}

TEST_CASE("a key that nobody asked for is an error, with the nearest known key") {
    const std::string typos =
        "[water]\ndepht = 0.16\nslope = 1\n[wear]\n[extra]\nz = 1\n[[stones]]\nsize = 1\ndiametre = 2\n";
    TomlReader in = TomlReader::from_text(typos, "quick.toml");
    in.number("water.depth", {.fallback = 0.1});
    in.number("water.slope");
    in.count("stones");
    in.number("stones[0].size");
    in.number("stones[0].diameter", {.fallback = 0.02});
    const std::string message = message_of([&] { in.reject_unknown(); });
    CHECK(message ==
          "quick.toml:2:1: unknown key water.depht; did you mean water.depth?\n"
          "quick.toml:4:2: unknown key wear; known there: stones, water\n"
          "quick.toml:6:1: unknown key extra.z\n"
          "quick.toml:9:1: unknown key stones[0].diametre; did you mean stones[0].diameter?");
    in.allow("extra");
    CHECK(!has(message_of([&] { in.reject_unknown(); }), "unknown key extra"));
    TomlReader near = reader({"water.lvels=1"});  // a key that is allowed is known, too
    for (const char* key : {"water.levels", "stones"}) near.allow(key);
    CHECK(has(message_of([&] { near.reject_unknown(); }),
              "unknown key water.lvels; did you mean water.levels?"));

    TomlReader good = reader();
    for (const char* key : {"water", "stones", "stones[0]", "stones[1]"}) good.allow(key);
    CHECK_NOTHROW(good.reject_unknown());
}

TEST_CASE("a missing key names its unit, and the key that was perhaps meant") {
    TomlReader in = reader();
    CHECK(message_of([&] { in.number("water.dept", {.unit = "m"}); }) ==
          "quick.toml: water.dept [m] is required but not given; quick.toml:2:1 has water.depth: is that "
          "meant?");
    CHECK(message_of([&] { in.number("air.pressure", {.unit = "Pa"}); }) ==
          "quick.toml: air.pressure [Pa] is required but not given");
}

TEST_CASE("overrides go through the same checks") {
    TomlReader in = reader(
        {"water.depth=0.2", "stones[1].diameter = 0.04", "new.section.name=\"x=y\"", "water.levels=[3]"});
    CHECK(in.number("water.depth") == 0.2);
    CHECK(in.number("stones[1].diameter", {.bound = Bound::positive}) == 0.04);
    CHECK(in.text("new.section.name") == "x=y");
    CHECK(in.numbers("water.levels") == std::vector<Real>{3});

    CHECK(message_of([] { reader({"water.depth=\"deep\""}).number("water.depth", {.unit = "m"}); }) ==
          "--set water.depth=\"deep\": water.depth must be a number in m, got the text 'deep'");
    CHECK(message_of([] { reader({"water.depth=deep"}); }) ==
          "--set water.depth must be given a TOML value, got 'deep'; text needs quotes: --set "
          "'water.depth=\"deep\"'");
    CHECK(message_of([] { reader({"water.depth"}); }) ==
          "--set must be given as section.key=value, got 'water.depth'");
    CHECK(message_of([] { reader({"=1"}); }) == "--set must be given as section.key=value, got '=1'");
    CHECK(has(message_of([] { reader({"stones[7].diameter=1"}); }), "got stones[7], which is not there"));
    CHECK(has(message_of([] { reader({"water.depth.x=1"}); }),
              "must be inside a table, got inside the number"));
    CHECK(has(message_of([] { reader({"water.levels[x]=1"}); }), "of the form section.name[0]"));
    TomlReader unknown = reader({"water.dpth=1"});
    for (const char* key :
         {"stones", "water.slope", "water.name", "water.steady", "water.levels", "water.file"})
        unknown.allow(key);
    unknown.number("water.depth");
    CHECK(message_of([&] { unknown.reject_unknown(); }) ==
          "--set water.dpth=1: unknown key water.dpth; did you mean water.depth?");
}

TEST_CASE("files that cannot be read or are not TOML") {
    CHECK(message_of([] { TomlReader::from_file("missing.toml"); }) ==
          "parameter file must be one that can be read, got 'missing.toml' (No such file or directory); "
          "check its path");
    CHECK(has(message_of([] { TomlReader::from_file("."); }), "a folder"));
    std::ofstream{"broken.toml"} << "a = 1\nb = = 2\n";
    CHECK(has(message_of([] { TomlReader::from_file("broken.toml"); }), "broken.toml:2:5: not valid TOML:"));
    std::filesystem::create_directories("setup");
    std::ofstream{"setup/good.toml"} << "points = \"p.csv\"\nnone = \"\"\n";
    TomlReader in = TomlReader::from_file("setup/good.toml");
    CHECK(in.file("points") == std::filesystem::path{"setup/p.csv"});
    CHECK(in.file("none").empty());
    const std::vector<std::string> overrides{"points=\"q.csv\""};
    CHECK(TomlReader::from_file("setup/good.toml", overrides).file("points") ==
          std::filesystem::path{"q.csv"});
}
