#include "drawings.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

namespace abrade::examples {

namespace {

namespace fs = std::filesystem;

constexpr auto seed_colour = "#7b8187", mean_colour = "#0072b2", error_fill = "#b5d4ea",
               bracket_fill = "#fbe9d3", bar_colour = "#56b4e9";
constexpr Real gap = Statistics::unknown;  // gnuplot lifts its pen

/// A running mean over about 2 half + 1 places.
std::vector<Real> smoothed(const std::vector<Real>& values, std::size_t half) {
    std::vector<Real> out(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t from = i > half ? i - half : 0, to = std::min(values.size(), i + half + 1);
        for (std::size_t k = from; k < to; ++k) out[i] += values[k] / static_cast<Real>(to - from);
    }
    return out;
}

std::vector<std::vector<Real>> smoothed_depths(const EnsembleCase& one, const DepthChart& chart) {
    std::vector<std::vector<Real>> depths = one.depths(chart.line);
    for (auto& depth : depths) depth = smoothed(depth, chart.half);
    return depths;
}

void begin_fill(charts::Plot& plot, const std::string& colour, const std::string& title) {
    plot.begin("1:2:3", "filledcurves fillcolor '" + colour + "' fillstyle solid noborder", title);
}

void add_bracket(charts::Plot& plot, const DepthChart& chart) {
    begin_fill(plot, bracket_fill, chart.bracket_title);
    plot.row({chart.from, chart.bracket.low, chart.bracket.high});
    plot.row({chart.to, chart.bracket.low, chart.bracket.high});
}

/// As high as the compared part of `lines` asks for: far down the channel the first stones to pass divide by
/// nearly nothing.
Axis depth_axis(const DepthChart& chart, const std::vector<Curve>& lines) {
    Real highest = chart.bracket.high;
    for (const Curve& line : lines)
        for (std::size_t i = 0; i < line.x.size(); ++i)
            if (line.x[i] >= chart.from && line.x[i] <= chart.to) highest = std::max(highest, line.y[i]);
    return {.label = "depth per converted sediment", .unit = "mm/m3", .min = 0.0, .max = 1.25 * highest};
}

void finish(charts::Plot& plot, const std::string& title, const Axis& x, const Axis& y, charts::Layout layout,
            const std::string& more, const fs::path& picture) {
    const std::string script = charts::frame(title, x, y) + charts::legend(plot.titles(), layout);
    make_picture(picture, script + more + layout.margins() + plot.command(), plot.data(), layout.width,
                 layout.height);
}

std::optional<Real> to_number(const std::string& text) {
    Real value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return {};
    return value;
}

Axis axis_of(const Metric& metric) { return {.label = metric.title, .unit = metric.unit}; }

Statistics scaled(Statistics s, Real factor) {
    s.mean *= factor, s.standard_error *= factor, s.standard_deviation *= factor;
    return s;
}

std::string error_bars(const char* direction) {
    return std::string(direction) + "errorbars pointtype 7 pointsize 1.3 linewidth 2 linecolor '" +
           mean_colour + "'";
}
std::string seed_points() {
    return std::string("points pointtype 6 pointsize 1.3 linewidth 1.2 linecolor '") + seed_colour + "'";
}
/// An unknown standard error is drawn as none: the point alone.
Real drawn_error(const Statistics& s) { return std::isfinite(s.standard_error) ? s.standard_error : 0; }

/// Rows with names to the left of the axis, the first on top at y = 0.
std::string row_names(const std::vector<std::string>& names) {
    std::string tics;
    for (std::size_t i = 0; i < names.size(); ++i)
        tics += (i == 0 ? "" : ", ") + gnuplot_text(names[i]) + " " + to_text(-static_cast<Real>(i));
    return "set ytics (" + tics + ")\n";
}
/// The same, and room for them in the layout.
std::string row_names(const std::vector<std::string>& names, charts::Layout& layout) {
    std::size_t longest = 0;
    for (const std::string& name : names) longest = std::max(longest, name.size());
    layout.left = std::clamp(40 + 11 * static_cast<int>(longest), 120, 700);
    layout.width = std::max(layout.width, layout.left + 730);
    layout.height = layout.top + layout.bottom + 60 + 44 * static_cast<int>(names.size());
    return row_names(names);
}

const std::vector<std::string> titles_of_cases{"each seed", "mean and its standard error"};

/// A metric of all cases, one row below the other; nothing where no run has it.
charts::Plot plot_of_cases(const Ensemble& e, const Metric& metric, std::size_t first_block) {
    charts::Plot plot(first_block);
    const bool any = std::any_of(e.cases.begin(), e.cases.end(),
                                 [&](const EnsembleCase& one) { return one.of(metric.name).count > 0; });
    if (!any) return plot;
    plot.begin("1:2", seed_points(), titles_of_cases[0]);
    for (std::size_t i = 0; i < e.cases.size(); ++i)
        for (const Real x : e.cases[i].by_seed(metric.name))
            plot.row({metric.factor * x, -static_cast<Real>(i) - 0.18});
    plot.begin("1:2:3", error_bars("x"), titles_of_cases[1]);
    for (std::size_t i = 0; i < e.cases.size(); ++i) {
        const Statistics s = scaled(e.cases[i].of(metric.name), metric.factor);
        plot.row({s.mean, -static_cast<Real>(i), drawn_error(s)});
    }
    return plot;
}

}  // namespace

bool sweeps_one_number(const Ensemble& e) {
    return !e.one_at_a_time() && e.swept.size() == 1 &&
           std::all_of(e.cases.begin(), e.cases.end(), [](const EnsembleCase& one) {
               return to_number(one.overrides.front().second).has_value();
           });
}

void draw(const DepthChart& chart, const EnsembleCase& one, const fs::path& picture) {
    const std::vector<Real> place = one.places(chart.line);
    const auto depths = smoothed_depths(one, chart);
    const auto along = statistics_along(depths);
    charts::Plot plot;
    add_bracket(plot, chart);
    begin_fill(plot, error_fill, "standard error of the mean");
    for (std::size_t i = 0; i < along.size(); ++i)
        plot.row({place[i], along[i].mean - drawn_error(along[i]), along[i].mean + drawn_error(along[i])});
    plot.begin("1:2", std::string("lines linewidth 0.8 linecolor '") + seed_colour + "'", "each seed");
    std::vector<Curve> lines;
    for (const auto& depth : depths) {
        lines.push_back({.title = "", .x = place, .y = depth});
        for (std::size_t i = 0; i < depth.size(); ++i) plot.row({place[i], depth[i]});
        plot.row({gap, gap});
    }
    plot.begin("1:2", std::string("lines linewidth 3 linecolor '") + mean_colour + "'", "mean");
    for (std::size_t i = 0; i < along.size(); ++i) plot.row({place[i], along[i].mean});
    finish(plot, chart.title, chart.place, depth_axis(chart, lines), {}, "", picture);
}

void draw_means(const DepthChart& chart, const std::vector<const EnsembleCase*>& cases,
                const fs::path& picture) {
    charts::Plot plot;
    add_bracket(plot, chart);
    std::vector<Curve> means;
    for (const EnsembleCase* one : cases) {
        Curve mean{.title = one->label(), .x = one->places(chart.line), .y = {}};
        for (const Statistics& s : statistics_along(smoothed_depths(*one, chart))) mean.y.push_back(s.mean);
        plot.curve(mean, means.size());
        means.push_back(std::move(mean));
    }
    finish(plot, chart.title, chart.place, depth_axis(chart, means), {}, "", picture);
}

void draw_against_value(const Ensemble& e, const Metric& metric, const fs::path& picture) {
    std::map<Real, const EnsembleCase*> by_value;
    for (const EnsembleCase& one : e.cases) by_value[*to_number(one.overrides.front().second)] = &one;
    const Real first = by_value.begin()->first, last = by_value.rbegin()->first;
    const Real beside = first < last ? 0.05 * (last - first) : 1;
    charts::Plot plot;
    plot.begin("1:2", seed_points(), "each seed");
    for (const auto& [value, one] : by_value)
        for (const Real x : one->by_seed(metric.name)) plot.row({value, metric.factor * x});
    plot.begin("1:2", std::string("lines linewidth 1.5 linecolor '") + mean_colour + "'", "");
    for (const auto& [value, one] : by_value) plot.row({value, metric.factor * one->of(metric.name).mean});
    plot.begin("1:2:3", error_bars("y"), "mean and its standard error");
    for (const auto& [value, one] : by_value) {
        const Statistics s = scaled(one->of(metric.name), metric.factor);
        plot.row({value, s.mean, drawn_error(s)});
    }
    finish(plot, metric.title, {.label = e.swept.front(), .min = first - beside, .max = last + beside},
           axis_of(metric), {}, "", picture);
}

void draw_cases(const Ensemble& e, const std::vector<Metric>& metrics, const fs::path& picture) {
    std::vector<std::string> names;
    for (const EnsembleCase& one : e.cases) names.push_back(one.label());
    charts::Layout page;
    const std::string tics = row_names(names, page),
                      no_names = row_names(std::vector<std::string>(names.size()));
    const int count = static_cast<int>(metrics.size()), across = std::min(count, 3), gap = 45,
              wide = count > 1 ? 440 : page.width - page.left - page.right,
              high = page.height - page.top - page.bottom;
    page.width = page.left + across * (wide + gap) - gap + page.right;
    charts::legend(titles_of_cases, page);  // sets the room at the top
    if (count > 1) page.top += 26;          // a panel is too narrow for the two titles side by side
    page.height = page.top + (count + across - 1) / across * (high + page.bottom);
    charts::Layout same = page;
    const std::string key = charts::legend(titles_of_cases, same);

    std::string script = count > 1 ? "set multiplot\n" : "", data;
    std::size_t blocks = 0;
    for (int panel = 0; panel < count; ++panel) {
        const Metric& metric = metrics[static_cast<std::size_t>(panel)];
        const int column = panel % across;
        charts::Layout at = page;
        at.left = page.left + column * (wide + gap), at.right = page.width - at.left - wide;
        at.top = page.top + panel / across * (high + page.bottom), at.bottom = page.height - at.top - high;
        const charts::Plot plot = plot_of_cases(e, metric, blocks);
        if (plot.blocks() > 0) data += (blocks > 0 ? "\n\n" : "") + plot.data();
        blocks += plot.blocks();
        Axis x = axis_of(metric);
        x.logarithmic = count > 1 && metric.logarithmic;
        const bool negative = std::any_of(e.cases.begin(), e.cases.end(), [&](const EnsembleCase& one) {
            return one.of(metric.name).min < 0;
        });
        if (count > 1 && !x.logarithmic && !negative) x.min = 0;
        if (panel > 0) script += "unset label\nunset logscale\n";
        script += charts::frame(count > 1 ? "" : metric.title, x,
                                {.label = "", .min = 0.5 - static_cast<Real>(names.size()), .max = 0.5});
        script += panel == 0 ? key : "unset key\n";
        script += (column == 0 ? tics : no_names) + at.margins() + plot.command();
    }
    if (count > 1) script += "unset multiplot\n";
    make_picture(picture, script, data, page.width, page.height);
}

void draw_tornado(const Ensemble& e, const Metric& metric, const fs::path& picture) {
    const Statistics base = scaled(e.cases.front().of(metric.name), metric.factor);
    struct Bar {
        std::string value;
        Statistics s;
    };
    struct Row {
        std::string key;
        std::vector<Bar> bars;
        Real reach = 0;  ///< farthest mean from the base
    };
    std::vector<Row> rows;
    for (const std::string& key : e.swept) {
        Row row{key, {}};
        for (const EnsembleCase& one : e.cases) {
            if (one.overrides.empty() || one.overrides.front().first != key) continue;
            const Statistics s = scaled(one.of(metric.name), metric.factor);
            if (s.count == 0) continue;
            row.bars.push_back({one.overrides.front().second, s});
            row.reach = std::max(row.reach, std::abs(s.mean - base.mean));
        }
        rows.push_back(row);
    }
    std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.reach > b.reach; });

    // Each value has a bar of its own, so that none hides another.
    std::vector<std::string> names;
    std::string labels;
    charts::Range range;
    charts::Plot plot;
    const Real bottom = 0.5 - static_cast<Real>(rows.size()), base_error = drawn_error(base);
    begin_fill(plot, "#e4e4e4", "base and its standard error");
    for (const Real x : {base.mean - base_error, base.mean + base_error})
        plot.row({x, bottom, 0.5}), range.add(x);
    plot.begin("1:2:3:4:5:6",
               std::string("boxxyerror fillcolor '") + bar_colour + "' fillstyle solid noborder",
               "change from the base");
    const auto place = [](std::size_t row, std::size_t bar, std::size_t bars) {
        return 0.36 - static_cast<Real>(row) -
               0.72 * (static_cast<Real>(bar) + 0.5) / static_cast<Real>(bars);
    };
    for (std::size_t r = 0; r < rows.size(); ++r) {
        names.push_back(rows[r].key);
        for (std::size_t b = 0; b < rows[r].bars.size(); ++b) {
            const auto& [value, s] = rows[r].bars[b];
            const Real y = place(r, b, rows[r].bars.size()),
                       half = 0.3 / static_cast<Real>(rows[r].bars.size());
            plot.row(
                {s.mean, y, std::min(s.mean, base.mean), std::max(s.mean, base.mean), y - half, y + half});
            const Real error = drawn_error(s), side = s.mean < base.mean ? -1 : 1;
            range.add(s.mean - error), range.add(s.mean + error);
            labels += "set label " + gnuplot_text(unquoted(value)) + " at " +
                      to_text(side < 0 ? std::min(s.mean - error, base.mean - base_error)
                                       : std::max(s.mean + error, base.mean + base_error)) +
                      ", " + to_text(y) + (side < 0 ? " right offset -1, 0" : " left offset 1, 0") +
                      " front textcolor '#222222'\n";
        }
    }
    plot.begin("1:2:3", error_bars("x"), "mean and its standard error");
    for (std::size_t r = 0; r < rows.size(); ++r)
        for (std::size_t b = 0; b < rows[r].bars.size(); ++b) {
            const Statistics& s = rows[r].bars[b].s;
            plot.row({s.mean, place(r, b, rows[r].bars.size()), drawn_error(s)});
        }
    plot.begin("1:2", "lines linewidth 1.5 linecolor '#444444'", "");
    plot.row({base.mean, bottom}), plot.row({base.mean, 0.5});
    charts::Layout layout;
    const std::string tics = row_names(names, layout);
    layout.height += 26 * static_cast<int>(e.cases.size());
    Axis x = axis_of(metric);
    if (!range.empty() && range.high > range.low) {
        const Real room = 0.14 * (range.high - range.low);  // for the labels
        x.min = range.low - room, x.max = range.high + room;
    }
    finish(plot, metric.title + ", one parameter at a time", x, {.label = "", .min = bottom, .max = 0.5},
           layout, tics + labels, picture);
}

}  // namespace abrade::examples
