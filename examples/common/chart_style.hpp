#pragma once
// What the kinds of pictures share: axes, palettes, layout, legend. Palettes are safe for the colour-blind.

#include <abrade/core/require.hpp>
#include <abrade/core/types.hpp>

#include "gnuplot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abrade::examples {

/// An axis, or the colour bar.
struct Axis {
    std::string label{};        ///< "distance along the channel"
    std::string unit{};         ///< "m"; empty when dimensionless
    std::optional<Real> min{};  ///< from the data where it is not given
    std::optional<Real> max{};
    bool logarithmic = false;
};

enum class CurveStyle { line, dashed, points };

/// A line or a set of points. Values that are not finite make a gap.
struct Curve {
    std::string title{};
    std::vector<Real> x{};
    std::vector<Real> y{};
    CurveStyle style = CurveStyle::line;
};

enum class Palette {
    wear,   ///< pale to dark brown: nothing to much
    water,  ///< pale to dark blue
};

namespace charts {

inline constexpr std::array<std::string_view, 7> colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                         "#e69f00", "#56b4e9", "#000000"};

/// The range of what was added so far.
struct Range {
    Real low = std::numeric_limits<Real>::infinity();
    Real high = -std::numeric_limits<Real>::infinity();
    void add(Real value) {
        if (!std::isfinite(value)) return;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    bool empty() const { return !(low <= high); }
};

inline std::string axis_title(const Axis& axis) {
    return gnuplot_text(axis.unit.empty() ? axis.label : axis.label + " [" + axis.unit + "]");
}

inline std::string limits(const Axis& axis) {
    return "[" + (axis.min ? gnuplot_number(*axis.min) : "*") + ":" +
           (axis.max ? gnuplot_number(*axis.max) : "*") + "]";
}

/// Where the axes lie on the canvas [pixel]. Set by hand, so that a metre is as long in x as in y to the
/// pixel and the legend never lies on a label.
struct Layout {
    int width = 1200;
    int height = 700;
    int left = 135;
    int right = 30;
    int top = 60;
    int bottom = 92;

    std::string margins() const {
        const auto x = [&](int pixel) { return to_text(static_cast<Real>(pixel) / width); };
        const auto y = [&](int pixel) { return to_text(static_cast<Real>(pixel) / height); };
        return "set lmargin at screen " + x(left) + "\nset rmargin at screen " + x(width - right) +
               "\nset tmargin at screen " + y(height - top) + "\nset bmargin at screen " + y(bottom) + "\n";
    }
};

/// The distance between tics so that some `wanted` of them fit between low and high: 1, 2 or 5 times a power
/// of ten.
inline Real tic_step(Real low, Real high, int wanted) {
    if (!(high > low)) return 1;
    const Real rough = (high - low) / std::max(wanted, 1);
    const Real power = std::pow(10.0, std::floor(std::log10(rough)));
    for (const Real factor : {1.0, 2.0, 5.0})
        if (factor * power >= rough * 0.999) return factor * power;
    return 10 * power;
}

inline std::string tics(const std::string& axis, Real low, Real high, int pixels, int pixels_per_tic) {
    return "set " + axis + "tics " + to_text(tic_step(low, high, pixels / pixels_per_tic)) + "\n";
}

/// Labels at 1, 2 and 5 where an axis spans so little that powers of ten would leave one or two.
inline std::string logarithmic_scale(const std::string& name, const Axis& axis) {
    if (!axis.logarithmic) return "";
    std::string s = "set logscale " + name + "\nset format " + name + " '%g'\n";
    if (!(axis.min && axis.max && *axis.max < 60 * *axis.min)) return s;
    std::string tics;
    for (Real power = std::pow(10.0, std::floor(std::log10(*axis.min))); power <= *axis.max; power *= 10)
        for (const Real factor : {1.0, 2.0, 5.0})
            if (const Real at = factor * power; at >= *axis.min && at <= *axis.max) {
                const std::string number = to_text(at);
                tics += (tics.empty() ? "'" : ", '") + number + "' " + number;
            }
    return s + "set " + name + "tics (" + tics + ")\n";
}

/// The look that all pictures share.
inline std::string frame(const std::string& title, const Axis& x, const Axis& y) {
    std::string s = "set title " + gnuplot_text(title) + " font 'sans,17' textcolor '#222222'\n";
    s += "set clip two\nset border 3 linecolor '#666666'\nset tics out nomirror textcolor '#333333'\n";
    s += "set grid back linecolor '#e2e2e2' linetype 1 linewidth 0.7\n";
    s += "set xlabel " + axis_title(x) + " textcolor '#222222'\nset ylabel " + axis_title(y) +
         " textcolor '#222222'\n";
    s += logarithmic_scale("x", x) + logarithmic_scale("y", y);
    return s + "set xrange " + limits(x) + "\nset yrange " + limits(y) + "\n";
}

/// The legend, between title and axes; makes room for it at the top of the layout.
inline std::string legend(const std::vector<std::string>& titles, Layout& layout) {
    std::size_t named = 0, longest = 0;
    for (const std::string& title : titles) {
        named += title.empty() ? 0 : 1;
        longest = std::max(longest, title.size());
    }
    if (named == 0) return "unset key\n";
    const int each = 85 + 12 * static_cast<int>(longest);
    const int columns =
        std::clamp((layout.width - layout.left - layout.right) / each, 1, static_cast<int>(named));
    const int rows = (static_cast<int>(named) + columns - 1) / columns;
    layout.top = 55 + 26 * rows;
    return "set key at screen 0.5, screen " + to_text(1 - 44.0 / layout.height) +
           " center top horizontal Left reverse maxcols " + std::to_string(columns) +
           " samplen 2.5 width 1 textcolor '#222222'\nset title offset 0, " + to_text(1.1 * rows) + "\n";
}

/// The colour bar along the right side of the axes.
inline std::string colour_bar(const Axis& axis, Palette palette, const Range& found, const Layout& at) {
    const Real low = axis.min.value_or(found.empty() ? 0 : found.low);
    Real high = axis.max.value_or(found.empty() ? 1 : found.high);
    if (!(high > low)) high = low + (low == 0 ? 1 : std::abs(low));
    const int bar = std::max(at.height - at.top - at.bottom, 110);
    std::string s = "set cbrange [" + gnuplot_number(low) + ":" + gnuplot_number(high) + "]\n";
    s += "set cblabel " + axis_title(axis) +
         " textcolor '#222222'\nset colorbox noborder user origin screen " +
         to_text(1 - static_cast<Real>(at.right - 25) / at.width) + ", screen " +
         to_text(static_cast<Real>((at.height - at.top + at.bottom - bar) / 2) / at.height) +
         " size screen " + to_text(24.0 / at.width) + ", screen " +
         to_text(static_cast<Real>(bar) / at.height) + "\n";
    s += axis.logarithmic ? "set logscale cb\n" : tics("cb", low, high, bar, 45);
    return s + (palette == Palette::wear ? "set palette defined (0 '#eeeae0', 1 '#fee391', 2 '#fec44f', 3 "
                                           "'#fe9929', 4 '#d95f0e', 5 '#993404', 6 '#4a1803')\n"
                                         : "set palette defined (0 '#f4f7fa', 1 '#c6dbef', 2 '#6baed6', 3 "
                                           "'#2171b5', 4 '#08306b')\n");
}

/// Collects blocks of data and the plot command that reads them.
class Plot {
public:
    /// `first` is the number of the first block, where another plot's data stand before it in the file.
    explicit Plot(std::size_t first = 0) : first_(first) {}
    /// Starts a block that is drawn `with` the given style from the columns `usage`.
    void begin(const std::string& usage, const std::string& with, const std::string& title) {
        if (blocks_ > 0) data_ += "\n\n";
        command_ += (blocks_ == 0 ? "plot " : ", \\\n     ") + std::string{"data index "} +
                    std::to_string(first_ + blocks_) + " using " + usage + " with " + with +
                    (title.empty() ? " notitle" : " title " + gnuplot_text(title));
        titles_.push_back(title);
        ++blocks_;
    }
    void row(std::initializer_list<Real> values) {
        for (const Real value : values) data_ += gnuplot_number(value) + " ";
        data_ += '\n';
    }
    /// A curve of the palette's colour number `index`; false, and nothing is drawn, where no point of it is
    /// finite.
    bool curve(const Curve& curve, std::size_t index, Range x_limits = {}) {
        const std::size_t count = std::min(curve.x.size(), curve.y.size());
        bool any = false;
        for (std::size_t i = 0; i < count; ++i)
            any = any || (std::isfinite(curve.x[i]) && std::isfinite(curve.y[i]));
        if (!any) return false;
        const std::string colour = "linecolor '" + std::string{colours[index % colours.size()]} + "'";
        begin("1:2",
              curve.style == CurveStyle::points   ? "points pointtype 7 pointsize 1.4 " + colour
              : curve.style == CurveStyle::dashed ? "lines linewidth 2 dashtype 2 " + colour
                                                  : "lines linewidth 2 " + colour,
              curve.title);
        for (std::size_t i = 0; i < count; ++i)
            if (x_limits.empty() || (curve.x[i] >= x_limits.low && curve.x[i] <= x_limits.high))
                row({curve.x[i], curve.y[i]});
        return true;
    }
    const std::string& data() const { return data_; }
    std::size_t blocks() const { return blocks_; }
    /// The titles of what is drawn.
    const std::vector<std::string>& titles() const { return titles_; }
    /// The plot command; a note in an empty frame where there is nothing to draw.
    std::string command() const {
        if (blocks_ > 0) return command_ + "\n";
        return "set label 'nothing to draw' at graph 0.5, graph 0.5 center textcolor '#666666'\nunset "
               "logscale\n"
               "set xrange [0:1]\nset yrange [0:1]\nplot NaN notitle\n";
    }

private:
    std::string data_{};
    std::string command_{};
    std::vector<std::string> titles_{};
    std::size_t first_ = 0, blocks_ = 0;
};

}  // namespace charts

}  // namespace abrade::examples
