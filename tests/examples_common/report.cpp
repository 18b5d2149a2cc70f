// The report is one file that loads nothing; pictures come out of gnuplot; both say what failed.
#include "../../examples/common/report.hpp"
#include "../../examples/common/charts.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace abrade;
using namespace abrade::examples;

namespace {

std::string text_of(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream{path, std::ios::binary}.rdbuf();
    return text.str();
}

bool is_picture(const std::filesystem::path& path) { return text_of(path).starts_with("\x89PNG\r\n"); }

bool has(const std::string& whole, std::string_view part) { return whole.find(part) != whole.npos; }

bool without_gnuplot() { return run_gnuplot("--version").status != 0; }

}  // namespace

TEST_CASE("base64 and HTML text") {
    CHECK(base64("") == "");
    CHECK(base64("M") == "TQ==");
    CHECK(base64("Ma") == "TWE=");
    CHECK(base64("Man") == "TWFu");
    CHECK(base64("\xff\xfe\xfd\xfc") == "//79/A==");
    CHECK(html_text("<a href='x'>&\"") == "&lt;a href=&#39;x&#39;&gt;&amp;&quot;");
}

TEST_CASE("a report holds everything, escaped, and loads nothing") {
    std::ofstream{"tiny.png", std::ios::binary} << "\x89PNG bytes";
    const Report report{.title = "A <b> & c",
                        .explanation = "What \"it\" shows.",
                        .summary = {{"worn_volume", "1.5e-06", "m³"}},
                        .figures = {{"tiny.png", "A 'picture' <1>"}},
                        .parameters = {{"water.depth", "0.16", "m", "depth", "paper is <silent>", "default"}},
                        .notes = {"stopped early"},
                        .versions = build_versions()};
    write_report(report, "report.html");
    const std::string html = text_of("report.html");
    CHECK(has(html, "<h1>A &lt;b&gt; &amp; c</h1>"));
    CHECK(has(html, "src=\"data:image/png;base64," + base64("\x89PNG bytes") + "\""));
    CHECK(has(html, "A &#39;picture&#39; &lt;1&gt;"));
    CHECK(has(html, "assumption</span>paper is &lt;silent&gt;"));
    CHECK(has(html, "stopped early"));
    for (const char* loaded : {"<script", "http:", "https:", "<link", "url(", "@import"})
        CHECK(!has(html, loaded));
    CHECK_THROWS_AS(write_report(report, "missing/report.html"), FileError);
    CHECK_THROWS_AS(to_html({.figures = {{"missing.png", ""}}}), FileError);
}

TEST_CASE("each kind of picture comes out, also of nothing and of what is not finite") {
    if (without_gnuplot()) return;
    const Real nan = std::nan("");
    LineChart lines{.title = "it's a `date` \"$x\" a_b", .x = {"x", "m"}, .y = {"y", "mm"}, .curves = {}};
    draw(lines, "nothing.png");
    CHECK(is_picture("nothing.png"));
    lines.curves = {
        {"a", {1, 2, 3}, {1, nan, 3}}, {"none", {nan}, {nan}}, {"points", {2}, {2}, CurveStyle::points}};
    lines.bands = {{"band", {1, 3}, {0.5, 0.5}, {4, 4}}};
    lines.y.logarithmic = true;
    draw(lines, "lines.png");
    CHECK(is_picture("lines.png"));
    CHECK(std::filesystem::exists("lines.gp"));
    CHECK(std::filesystem::exists("lines.dat"));

    std::filesystem::create_directories("folder with spaces");
    ColourMap map{.title = "map",
                  .x = {"x", "m", 0.0, 2.0},
                  .y = {"y", "m", 0.0, 1.0},
                  .colour = {"z", "mm"},
                  .columns = 2,
                  .values = {0, 0, 0, nan}};
    draw(map, "folder with spaces/map.png");
    CHECK(is_picture("folder with spaces/map.png"));
    map.equal_aspect = true;
    map.values = {nan, nan, nan, nan};
    draw(map, "map.png");
    CHECK(is_picture("map.png"));
    map.columns = 3;
    CHECK_THROWS_AS(draw(map, "map.png"), InputError);

    CirclePicture view{.title = "view", .x = {"x", "m"}, .y = {"z", "m"}, .colour = {"rate"}, .sets = {}};
    draw(view, "empty_view.png");
    CHECK(is_picture("empty_view.png"));
    view.sets = {{"concrete", {{0, 0, 0.5, 0.1}, {40, 0, 0.5, 0.1}}},
                 {"stones", {{1, 1, 0.2, 0}}, "#6b8ba4", true}};
    view.lines = {{"water", {0, 40}, {0.5, 0.5}}};
    draw(view, "view.png");
    CHECK(is_picture("view.png"));
    view.sets = {{"tower", {{0, 0, 0.5, 0}, {0, 40, 0.5, 1}}}};
    draw(view, "tower.png");
    CHECK(is_picture("tower.png"));
}

TEST_CASE("a picture that does not come out says why") {
    if (without_gnuplot()) return;
    std::string message;
    try {
        make_picture("broken.png", "plot nonsense(\n", "", 400, 300);
    } catch (const FileError& error) {
        message = error.what();
    }
    CHECK(has(message, "gnuplot made no picture from 'broken.gp'"));
    CHECK(has(message, "line 6"));
    CHECK_THROWS_AS(make_picture("missing/x.png", "", "", 400, 300), FileError);
}
