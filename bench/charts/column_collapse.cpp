// Draws the pictures of docs/verification/column_collapse.md: chart_column_collapse [FOLDER], which is made
// where it is not. Takes some ten minutes.
//
// chart_column_collapse FOLDER series SHAPE RADIUS STIFFNESS ROLLING ASPECT... draws nothing: it adds one
// more series to FOLDER/column_collapse_series.csv. SHAPE is round or flat, ROLLING the grains' friction of
// rolling after the container is taken away.

#include "../../tests/verification/column_collapse.hpp"
#include <abrade/dem/laws/rolling_resistance.hpp>
#include "../../examples/common/charts.hpp"

#include <fstream>
#include <iostream>

using namespace column_collapse;
using namespace abrade::examples;

namespace {

void add_row(std::ostream& table, const Deposit& d) {
    table << (d.column.shape == Shape::round ? "round," : "flat,") << d.column.radius << ','
          << d.column.aspect << ',' << d.after.size() << ',' << d.runout << ',' << d.contiguous << ','
          << runout_law(d.column.shape, d.column.aspect) << ',' << d.height << ',' << d.time << ','
          << d.ledger.residual_relative() << ',' << d.ledger.integration_residue() / d.ledger.throughput()
          << std::endl;
}

void add_exponents(std::ostream& table, const std::vector<Deposit>& deposits) {
    table << "# exponent of the runout: " << runout_exponent(deposits) << ", of the contiguous "
          << runout_exponent(deposits, &Deposit::contiguous) << std::endl;
}

std::vector<Deposit> run(const Series& series, std::ostream& table) {
    auto deposits = collapse_all(series, [&](const Deposit& deposit) { add_row(table, deposit); });
    add_exponents(table, deposits);
    return deposits;
}

/// One more series, from SHAPE on: the arguments.
void run_series(const std::vector<std::string>& options, std::ostream& table) {
    if (options.size() < 5 || (options[0] != "round" && options[0] != "flat"))
        throw std::invalid_argument("series needs SHAPE RADIUS STIFFNESS ROLLING ASPECT...");
    Column column = column_of(options[0] == "round" ? Shape::round : Shape::flat, std::stod(options[1]),
                              std::stod(options[2]));
    const Real rolling = std::stod(options[3]);
    column.aspect = std::stod(options.back());
    const Grains grains = settled(column);
    const LinearSpring law = grain_law(column);
    const RollingResistance<LinearSpring> resisting{{.contact = law.params(), .friction = rolling}};
    std::vector<Deposit> deposits;
    for (std::size_t n = 4; n < options.size(); ++n) {
        column.aspect = std::stod(options[n]);
        const Grains standing = cut(grains, column.height());
        deposits.push_back(rolling > 0 ? collapse(column, standing, resisting)
                                       : collapse(column, standing, law));
        add_row(table, deposits.back());
    }
    add_exponents(table, deposits);
}

std::vector<Real> spread(Real from, Real to) {
    std::vector<Real> x;
    for (int i = 0; i <= 200; ++i) x.push_back(from * std::pow(to / from, i / 200.0));
    return x;
}

template <class Value>
Curve line(const std::string& title, Real from, Real to, Value&& value) {
    Curve c{.title = title, .x = spread(from, to), .style = CurveStyle::dashed};
    for (const Real x : c.x) c.y.push_back(value(x));
    return c;
}

template <class Value>
Curve points(const std::string& title, const std::vector<Deposit>& deposits, Value&& value) {
    Curve c{.title = title, .style = CurveStyle::points};
    for (const Deposit& d : deposits) c.x.push_back(d.column.aspect), c.y.push_back(value(d));
    return c;
}

void laws(const std::vector<Deposit>& round, const std::vector<Deposit>& flat,
          const std::filesystem::path& folder) {
    const Axis aspect{
        .label = "height / radius (length) of the column", .min = 0.4, .max = 10, .logarithmic = true};
    const auto runout = [](const Deposit& d) { return d.runout; };
    draw(
        LineChart{
            .title = "How far a column spreads when its container is taken away",
            .x = aspect,
            .y = {.label = "(front - radius) / radius", .min = 0.3, .max = 12, .logarithmic = true},
            .curves = {points("round", round, runout), points("flat", flat, runout),
                       line("published, round", 0.4, 10, [](Real a) { return runout_law(Shape::round, a); }),
                       line("published, flat", 0.4, 10, [](Real a) { return runout_law(Shape::flat, a); })}},
        folder / "verification_column_collapse_runout.png");
    const auto height = [](const Deposit& d) { return d.height; };
    draw(
        LineChart{.title = "How high the deposit stands",
                  .x = aspect,
                  .y = {.label = "height of the deposit / radius", .min = 0.3, .max = 3, .logarithmic = true},
                  .curves = {points("round", round, height), points("flat", flat, height),
                             line("height of the column", 0.4, 1, [](Real a) { return a; }),
                             line("0.88 a^(1/6), round", 1.7, 10,
                                  [](Real a) { return 0.88 * std::pow(a, 1. / 6); })}},
        folder / "verification_column_collapse_height.png");
}

/// Grains of a slice through the middle, before and after.
void picture(const Deposit& d, const std::filesystem::path& file) {
    const auto slice = [&](const std::string& title, const std::string& colour, const Grains& grains) {
        CircleSet set{.title = title, .circles = {}, .colour = colour, .outline = true};
        for (const Grain& grain : grains)
            if (d.column.shape == Shape::flat || std::abs(grain.centre.y()) < 1)
                set.circles.push_back({grain.centre.x(), grain.centre.z(), grain.radius, 0});
        return set;
    };
    Grains fixed;
    const Scene scene = bed(d.column, d.profile.front() + 6);
    for (const Scene::Stone& stone : scene.stones) fixed.push_back({stone.state.position / diameter, 0.5});
    const Real front = d.profile.front() + 6;
    draw(CirclePicture{.title = "Column and deposit, round, height / radius = " + to_text(d.column.aspect) +
                                ": a slice of 2 d",
                       .x = {.label = "x / d", .min = -front, .max = front},
                       .y = {.label = "height / d", .min = -2, .max = d.column.height() + 1},
                       .sets = {slice("before", "#e6eef4", d.before), slice("after", "#0072b2", d.after),
                                slice("bed", "#888888", fixed)}},
         file);
}

void profiles(const std::vector<Deposit>& deposits, const std::filesystem::path& file) {
    LineChart chart{.title = "Deposits of round columns: height against distance from the axis",
                    .x = {.label = "r / radius", .min = 0},
                    .y = {.label = "height / radius", .min = 0}};
    for (const Deposit& d : deposits) {
        Curve curve{.title = "a = " + to_text(d.column.aspect)};
        for (std::size_t n = 0; n < d.profile.height.size(); ++n)
            curve.x.push_back((static_cast<Real>(n) + 0.5) / d.column.radius),
                curve.y.push_back(d.profile.height[n] / d.column.radius);
        chart.curves.push_back(std::move(curve));
    }
    draw(chart, file);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/column_collapse";
        std::filesystem::create_directories(folder);
        if (argc > 2) {
            if (std::string(argv[2]) != "series")
                throw std::invalid_argument("there is no '" + std::string(argv[2]) + "', but 'series'");
            std::ofstream table(folder / "column_collapse_series.csv", std::ios::app);
            run_series({argv + 3, argv + argc}, table);
            return 0;
        }
        std::ofstream table(folder / "column_collapse.csv");
        table << "shape,radius_d,aspect,grains,runout,contiguous_runout,law,height,time_sqrt_d_g,"
                 "ledger_residual,integration_residue\n";
        auto round = run(high_round, table);
        picture(round[1], folder / "verification_column_collapse_deposit.png");
        for (Deposit& d : run(low_round, table)) round.push_back(std::move(d));
        profiles(round, folder / "verification_column_collapse_profiles.png");
        auto flat = run(high_flat, table);
        for (Deposit& d : run(low_flat, table)) flat.push_back(std::move(d));
        laws(round, flat, folder);
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
