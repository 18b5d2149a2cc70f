#pragma once
// Small multiples: panels side by side with the same axes, one legend for all.

#include "../../examples/common/chart_style.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace abrade::charts {

/// One panel: as many curves as there are names in the chart, in that order; a curve may be empty.
struct Panel {
    std::string title{};
    std::vector<examples::Curve> curves{};
};

/// A straight line in logarithmic axes through (x, y), to read an order from.
struct Slope {
    Real x = 0, y = 0, slope = 0;
    Real reach = 10;  ///< from x to reach x
    std::string label{};
};

struct PanelChart {
    std::string title{};
    examples::Axis x{}, y{};
    std::vector<std::string> names{};
    std::vector<Panel> panels{};  ///< row by row
    std::vector<Slope> slopes{};  ///< in every panel
    std::size_t columns = 2;
    int panel_width = 560, panel_height = 400;  ///< [pixel]
};

inline void draw(const PanelChart& chart, const std::filesystem::path& picture) {
    using examples::gnuplot_number, examples::gnuplot_text;
    namespace style = examples::charts;
    static constexpr std::array<int, 7> marks{7, 5, 9, 11, 13, 6, 4};
    const int legend_rows = (static_cast<int>(chart.names.size()) + 1) / 2;  // two columns fit at least
    const int left = 110, right = 45, top = 90 + 24 * legend_rows, bottom = 90, gap_x = 55, gap_y = 95;
    const auto columns = static_cast<int>(chart.columns);
    const int rows = (static_cast<int>(chart.panels.size()) + columns - 1) / columns;
    const int width = left + columns * chart.panel_width + (columns - 1) * gap_x + right;
    const int height = top + rows * chart.panel_height + (rows - 1) * gap_y + bottom;

    const auto look = [](std::size_t c) {
        return " with linespoints linecolor '" + std::string{style::colours[c % style::colours.size()]} +
               "' linewidth 1.8 pointtype " + std::to_string(marks[c % marks.size()]) + " pointsize 0.9";
    };
    std::string data, script = style::frame("", chart.x, chart.y);
    script += "unset title\nset label 1 " + gnuplot_text(chart.title) + " at screen 0.5, screen " +
              to_text(1 - 24.0 / height) + " center font 'sans,17' textcolor '#222222'\n";
    if (chart.y.logarithmic) script += "set format y '10^{%T}'\nset termoption enhanced\n";
    if (chart.x.logarithmic) script += "set format x '10^{%T}'\nset termoption enhanced\n";
    script += "unset key\nset multiplot\n";
    int block = 0;
    for (std::size_t p = 0; p < chart.panels.size(); ++p) {
        const Panel& panel = chart.panels[p];
        const int row = static_cast<int>(p) / columns, column = static_cast<int>(p) % columns;
        style::Layout at{.width = width, .height = height};
        at.left = left + column * (chart.panel_width + gap_x);
        at.right = width - at.left - chart.panel_width;
        at.top = top + row * (chart.panel_height + gap_y);
        at.bottom = height - at.top - chart.panel_height;
        script += at.margins();
        script +=
            "set title " + gnuplot_text(panel.title) + " font 'sans,15' textcolor '#222222' offset 0,-0.6\n";
        script += row + 1 == rows ? "set xlabel " + style::axis_title(chart.x) + "\n" : "unset xlabel\n";
        script += column == 0 ? "set ylabel " + style::axis_title(chart.y) + "\nset format y" +
                                    (chart.y.logarithmic ? " '10^{%T}'" : "") + "\n"
                              : "unset ylabel\nset format y ''\n";
        if (p == 1) script += "unset label 1\n";
        int label = 10;
        std::string plots;
        for (const Slope& slope : chart.slopes) {
            const Real end_x = slope.x * slope.reach, end_y = slope.y * std::pow(slope.reach, slope.slope);
            script += "set label " + std::to_string(label++) + " " + gnuplot_text(slope.label) + " at " +
                      to_text(end_x) + "," + to_text(end_y) +
                      " left offset 0.4,0 font 'sans,12' textcolor '#777777'\n";
            data += to_text(slope.x) + " " + to_text(slope.y) + "\n" + to_text(end_x) + " " + to_text(end_y) +
                    "\n\n\n";
            plots += (plots.empty() ? "plot " : ", \\\n     ") + std::string("data index ") +
                     std::to_string(block++) +
                     " using 1:2 with lines linecolor '#999999' linewidth 1.2 dashtype 3 notitle";
        }
        for (std::size_t c = 0; c < chart.names.size(); ++c) {
            const examples::Curve& curve = panel.curves.at(c);
            for (std::size_t i = 0; i < curve.x.size(); ++i)
                data += gnuplot_number(curve.x[i]) + " " + gnuplot_number(curve.y[i]) + "\n";
            if (curve.x.empty()) data += "NaN NaN\n";
            data += "\n\n";
            plots += (plots.empty() ? "plot " : ", \\\n     ") + std::string("data index ") +
                     std::to_string(block++) + " using 1:2" + look(c) + " notitle";
        }
        script += plots + "\n";
    }
    // The legend is a plot of its own, as wide as the picture: gnuplot fits a legend to its plot.
    style::Layout all{.width = width, .height = height, .left = 10, .right = 10, .top = 40, .bottom = 10};
    script += all.margins() +
              "unset title\nunset border\nunset tics\nunset grid\nunset xlabel\n"
              "unset ylabel\nunset label\nunset logscale\nset xrange [0:1]\nset yrange [0:1]\n"
              "set key at screen 0.5, screen " +
              to_text(1 - 44.0 / height) +
              " center top horizontal Left reverse maxcols 3 samplen 2.5 width 2 textcolor '#222222'\n";
    std::string legend;
    for (std::size_t c = 0; c < chart.names.size(); ++c)
        legend += (legend.empty() ? "plot " : ", \\\n     ") + std::string("NaN") + look(c) + " title " +
                  gnuplot_text(chart.names[c]);
    script += legend + "\nunset multiplot\n";
    examples::make_picture(picture, script, data, width, height);
}

}  // namespace abrade::charts
