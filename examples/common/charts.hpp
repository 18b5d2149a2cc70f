#pragma once
// The kinds of pictures that programs make: lines with bands, colour maps, circles to scale.

#include <abrade/core/require.hpp>
#include <abrade/core/types.hpp>

#include "chart_style.hpp"
#include "gnuplot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace abrade::examples {

/// The area between two curves.
struct Band {
    std::string title{};
    std::vector<Real> x{};
    std::vector<Real> low{};
    std::vector<Real> high{};
};

/// Lines and points over bands.
struct LineChart {
    std::string title{};
    Axis x{};
    Axis y{};
    std::vector<Curve> curves{};
    std::vector<Band> bands{};
    int width = 1200;  ///< [pixel]
    int height = 700;  ///< [pixel]
};

/// A map of values on a regular grid. Cells that are not finite stay white.
struct ColourMap {
    std::string title{};
    Axis x{};  ///< min and max must be given: the outer edges of the grid
    Axis y{};
    Axis colour{};
    std::size_t columns = 0;     ///< cells along x
    std::vector<Real> values{};  ///< [row x column], rows from y.min up
    bool equal_aspect = false;   ///< a metre across as long as a metre along; else the map fills the picture
    Palette palette = Palette::wear;
    std::vector<Curve> lines{};
    int width = 1200;
    int height = 500;  ///< of a stretched map
};

/// A filled circle.
struct Circle {
    Real x = 0;
    Real y = 0;
    Real radius = 0;
    Real value = 0;  ///< on the colour axis, where its set is coloured by value
};

/// Circles drawn in the order given: the last lies on top.
struct CircleSet {
    std::string title{};
    std::vector<Circle> circles{};
    std::string colour{};  ///< "#7a8b99"; empty: by value
    bool outline = false;
};

/// A side or plan view: circles to scale, and lines. Circles outside of the axes' limits are not written.
struct CirclePicture {
    std::string title{};
    Axis x{};
    Axis y{};
    Axis colour{};
    std::vector<CircleSet> sets{};
    std::vector<Curve> lines{};
    Palette palette = Palette::wear;
    int width = 1200;
    int rows =
        0;  ///< strips that a long channel is cut into, one below the other; 0: as many as are readable
};

/// Draws lines, points and bands to `picture` (a .png); script and data stay beside it.
inline void draw(const LineChart& chart, const std::filesystem::path& picture) {
    charts::Plot plot;
    for (std::size_t b = 0; b < chart.bands.size(); ++b) {
        const Band& band = chart.bands[b];
        const std::size_t count = std::min({band.x.size(), band.low.size(), band.high.size()});
        if (count == 0) continue;
        static constexpr std::array<std::string_view, 3> fills{"#cfe3f1", "#e4e4e4", "#fbe3c8"};
        plot.begin(
            "1:2:3",
            "filledcurves fillcolor '" + std::string{fills[b % fills.size()]} + "' fillstyle solid noborder",
            band.title);
        for (std::size_t i = 0; i < count; ++i) plot.row({band.x[i], band.low[i], band.high[i]});
    }
    std::size_t index = 0;
    for (const Curve& curve : chart.curves) plot.curve(curve, index++);
    charts::Layout layout{.width = chart.width, .height = chart.height};
    std::string script = charts::frame(chart.title, chart.x, chart.y) + charts::legend(plot.titles(), layout);
    make_picture(picture, script + layout.margins() + plot.command(), plot.data(), layout.width,
                 layout.height);
}

/// Draws a colour map.
inline void draw(const ColourMap& map, const std::filesystem::path& picture) {
    const std::size_t rows = map.columns == 0 ? 0 : map.values.size() / map.columns;
    require(rows > 0 && rows * map.columns == map.values.size(),
            {"ColourMap.values", "whole rows of " + std::to_string(map.columns) + " columns", "values"},
            static_cast<Real>(map.values.size()));
    const Real x0 = map.x.min.value_or(0), y0 = map.y.min.value_or(0);
    const Real width = map.x.max.value_or(x0 + 1) - x0, height = map.y.max.value_or(y0 + 1) - y0;
    const Real dx = width / static_cast<Real>(map.columns), dy = height / static_cast<Real>(rows);
    charts::Range found;
    charts::Plot plot;
    plot.begin("1:2:3", "image", "");
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < map.columns; ++c) {
            const Real value = map.values[r * map.columns + c];
            found.add(value);
            plot.row({x0 + (static_cast<Real>(c) + 0.5) * dx, y0 + (static_cast<Real>(r) + 0.5) * dy, value});
        }
    std::size_t index = 0;
    for (const Curve& line : map.lines) plot.curve(line, index++);
    charts::Layout layout{.width = map.width, .height = map.height, .right = 180};
    const auto plot_width = layout.width - layout.left - layout.right;
    std::string key = charts::legend(plot.titles(), layout);
    if (map.equal_aspect) {
        layout.height =
            layout.top + layout.bottom + std::clamp(static_cast<int>(plot_width * height / width), 20, 4000);
        key = charts::legend(plot.titles(), layout);
    }
    std::string script = charts::frame(map.title, map.x, map.y) + key + layout.margins() + "unset grid\n";
    script += charts::tics("y", y0, y0 + height, layout.height - layout.top - layout.bottom, 45);
    script += charts::colour_bar(map.colour, map.palette, found, layout);
    if (found.empty())
        script += "set label 'nothing to draw' at graph 0.5, graph 0.5 center textcolor '#666666'\n";
    make_picture(picture, script + plot.command(), plot.data(), layout.width, layout.height);
}

/// Draws circles to scale, coloured by value or by set.
inline void draw(const CirclePicture& view, const std::filesystem::path& picture) {
    charts::Range x, y, value;
    for (const CircleSet& set : view.sets)
        for (const Circle& c : set.circles) {
            for (const Real side : {-c.radius, c.radius}) {
                x.add(c.x + side);
                y.add(c.y + side);
            }
            if (set.colour.empty()) value.add(c.value);
        }
    if (x.empty()) x = y = {0, 1};
    x = {view.x.min.value_or(x.low), view.x.max.value_or(x.high)};
    y = {view.y.min.value_or(y.low), view.y.max.value_or(y.high)};

    charts::Plot plot;
    for (const CircleSet& set : view.sets) {
        const bool by_value = set.colour.empty();
        std::vector<Circle> seen;
        for (const Circle& c : set.circles)
            if (c.x + c.radius >= x.low && c.x - c.radius <= x.high && c.y + c.radius >= y.low &&
                c.y - c.radius <= y.high)
                seen.push_back(c);
        if (seen.empty()) continue;
        plot.begin(by_value ? "1:2:3:4" : "1:2:3",
                   "circles fillcolor " + (by_value ? "palette" : "'" + set.colour + "'") +
                       " fillstyle solid " +
                       (set.outline ? "border linecolor '#333333' linewidth 0.7" : "noborder"),
                   set.title);
        for (const Circle& c : seen)
            by_value ? plot.row({c.x, c.y, c.radius, c.value}) : plot.row({c.x, c.y, c.radius});
    }
    std::size_t index = 0;
    for (const Curve& line : view.lines) plot.curve(line, index++);

    charts::Layout all{.width = view.width, .right = value.empty() ? 30 : 180};
    int plot_width = all.width - all.left - all.right;
    const Real length = x.high - x.low, ratio = length > 0 ? (y.high - y.low) / length : 1;
    int rows = view.rows;
    if (rows <= 0)
        for (rows = 1; rows < 6 && plot_width * ratio * rows < 120;) ++rows;
    const Real tallest = 2.0 * view.width;  // a high and narrow view is drawn narrower
    if (plot_width * ratio * rows > tallest) {
        plot_width = std::max(static_cast<int>(tallest / (ratio * rows)), 20);
        all.right = all.width - all.left - plot_width;
    }
    const int strip = std::max(static_cast<int>(plot_width * ratio * rows), 20);
    const int gap = 45;
    charts::legend(plot.titles(), all);  // sets the room at the top
    all.height = all.top + all.bottom + rows * strip + (rows - 1) * gap;
    std::string script = charts::frame(view.title, view.x, view.y) + charts::legend(plot.titles(), all);
    script += "unset grid\n" + charts::tics("y", y.low, y.high, strip, 45) +
              charts::tics("x", x.low, x.low + length / rows, plot_width, 110);
    if (!value.empty()) script += charts::colour_bar(view.colour, view.palette, value, all);
    if (rows > 1) script += "set multiplot\n";
    for (int row = 0; row < rows; ++row) {
        charts::Layout one = all;
        one.top = all.top + row * (strip + gap);
        one.bottom = all.height - one.top - strip;
        const charts::Range part{x.low + length * row / rows, x.low + length * (row + 1) / rows};
        if (row == 1) script += "unset title\nunset key\nunset colorbox\n";
        script += (row + 1 < rows ? "unset xlabel\n" : "set xlabel " + charts::axis_title(view.x) + "\n");
        script += "set xrange [" + to_text(part.low) + ":" + to_text(part.high) + "]\nset yrange [" +
                  to_text(y.low) + ":" + to_text(y.high) + "]\n" + one.margins() + plot.command();
    }
    if (rows > 1) script += "unset multiplot\n";
    make_picture(picture, script, plot.data(), all.width, all.height);
}

}  // namespace abrade::examples
