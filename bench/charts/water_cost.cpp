// Draws how exact water is against the time that it takes, ours and OpenFOAM's on the same flows, and writes
// what was measured as CSV: chart_water_cost [FOLDER [OPENFOAM_CSV]]. Folders are made where they are not.
// One thread; some minutes. OPENFOAM_CSV: what bench/peers/openfoam/accuracy.py wrote, best on the same
// machine in the same hour; bench/peers/openfoam_measured.csv unless told otherwise.

#include "../../tests/verification/reference_table.hpp"
#include "panels.hpp"

#include <abrade/fluid/grid_fluid.hpp>

#include <ctime>
#include <fstream>
#include <functional>
#include <iostream>

using namespace abrade;

namespace {

namespace fs = std::filesystem;

/// One run; errors by the names that they have in OpenFOAM's table.
struct Run {
    std::string name{};
    Index cells = 0, steps = 0;
    Real seconds = 0;  ///< of the processor, with what it takes to begin, as OpenFOAM's ExecutionTime
    std::map<std::string, Real> errors{};
};

struct Variant {
    std::string name;
    std::function<Run(int)> run;  ///< of cells
};

/// The median of three where a run is short.
Run timed(const std::function<Run()>& once) {
    std::vector<Run> runs;
    do {
        const std::clock_t start = std::clock();
        runs.push_back(once());
        runs.back().seconds = static_cast<Real>(std::clock() - start) / CLOCKS_PER_SEC;
    } while (runs.size() < 3 && runs.back().seconds < 2);
    std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.seconds < b.seconds; });
    return runs[runs.size() / 2];
}

/// Through the four points nearest to x; xs rise. As accuracy.py has it.
Real cubic(const std::vector<Real>& xs, const std::vector<Real>& ys, Real x) {
    const auto above = std::lower_bound(xs.begin() + 1, xs.end() - 1, x) - xs.begin();
    const auto size = static_cast<std::ptrdiff_t>(xs.size());
    const auto first = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above - 2, 0, size - 4));
    Real total = 0;
    for (std::size_t i = first; i < first + 4; ++i) {
        Real weight = 1;
        for (std::size_t j = first; j < first + 4; ++j)
            if (j != i) weight *= (x - xs[j]) / (xs[i] - xs[j]);
        total += weight * ys[i];
    }
    return total;
}

/// The lid-driven cavity at Re 1000 after 40 s, against U. Ghia et al. 1982
/// (doi 10.1016/0021-9991(82)90058-4) and the smallest u on the centre line of O. Botella and R. Peyret 1998
/// (doi 10.1016/S0045-7930(98)00002-4).
template <AdvectionScheme Scheme, class State = Real>
Run cavity(int n, Real tolerance) {
    GridFluid<2, FullBox, Scheme, State> flow(
        {.grid = {.cells = {n, n}, .spacing = Point<2>::Constant(1.0 / n)},
         .side_velocity = [](const Point<2>& x, Real) { return Point<2>(x[1] > 1 - 1e-9 ? 1 : 0, 0); },
         .density = 1,
         .viscosity = 1e-3,
         .tolerance = tolerance});
    flow.advance(40);
    std::vector<Real> z{0}, u{0};
    for (int k = 0; k < n; ++k) {
        z.push_back((k + 0.5) / n);
        u.push_back(static_cast<Real>(flow.velocity()[0][flow.grid().layout().at({n / 2, k})]));
    }
    z.push_back(1), u.push_back(1);
    Run run{.cells = n * n, .steps = flow.steps()};
    Real& off_ghia = run.errors["largest_u_off_ghia"];
    for (const ReferenceRow& row : reference_table("flu01_ghia1982_u_vertical_centreline.csv"))
        off_ghia = std::max(off_ghia, std::abs(cubic(z, u, row.at("y")) - row.at("u_Re1000")));
    Real least = 0;
    for (int k = 0; k <= 5000; ++k) least = std::min(least, cubic(z, u, k / 5000.0));
    run.errors["u_min_off_spectral"] = least + 0.3885698;
    return run;
}

/// G. Taylor and A. Green's vortices in a periodic square of 2 pi, viscosity 0.01, after 10 s. Velocities
/// count where they are kept: ours on faces, OpenFOAM's in cells.
template <AdvectionScheme Scheme, class State = Real>
Run taylor_green(int n, Real tolerance) {
    constexpr Real nu = 0.01, end = 10;
    const auto exact = [](const Point<2>& x, Real t) {
        return Point<2>(std::exp(-2 * nu * t) *
                        Point<2>(std::sin(x[0]) * std::cos(x[1]), -std::cos(x[0]) * std::sin(x[1])));
    };
    GridFluid<2, FullBox, Scheme, State> flow(
        {.grid = {.cells = {n, n}, .spacing = Point<2>::Constant(2 * pi / n)},
         .sides = Sides<2>::all(Side::periodic),
         .velocity = [&](const Point<2>& x) { return exact(x, 0); },
         .density = 1,
         .viscosity = nu,
         .tolerance = tolerance});
    flow.advance(end);
    Real off = 0, all = 0;
    flow.grid().for_each([&](const CellNumber<2>& cell, Offset c) {
        for (int a = 0; a < 2; ++a) {
            const Real wanted = exact(flow.grid().face_centre(a, cell), end)[a];
            off += square(static_cast<Real>(flow.velocity()[a][c]) - wanted), all += square(wanted);
        }
    });
    return {
        .cells = n * n, .steps = flow.steps(), .errors = {{"velocity_rms_relative", std::sqrt(off / all)}}};
}

struct Front {
    Real time, place;  ///< T = t sqrt(2 g / a), Z = x / a [-]
};

/// Place at a time, or time at a place; NaN beyond the ends.
Real at(const std::vector<Front>& path, Real Front::*from, Real Front::*wanted, Real value) {
    for (std::size_t k = 1; k < path.size(); ++k) {
        const Front &low = path[k - 1], &high = path[k];
        if (low.*from <= value && value <= high.*from)
            return low.*wanted +
                   (high.*wanted - low.*wanted) * (value - low.*from) / (high.*from - low.*from);
    }
    return std::numeric_limits<Real>::quiet_NaN();
}

/// The front of J. Martin and W. Moyce 1952 (doi 10.1098/rsta.1952.0006), a column twice as high as wide, to
/// 0.24 s: where the lowest row is half full, every 0.01 s; aligned at Z = 1.44. `n`: cells across the
/// column.
template <AdvectionScheme Scheme>
Run dam_break(int n, Real tolerance, Side walls) {
    constexpr Real width = 0.05715;
    GridFluid<2, FreeSurface, Scheme> flow(
        {.grid = {.cells = {8 * n, 3 * n}, .spacing = Point<2>::Constant(width / n)},
         .sides = Sides<2>::all(walls),
         .water = [](const Point<2>& x) { return std::min(width - x[0], 2 * width - x[1]); },
         .gravity = {0, -9.81},
         .viscosity = 1e-3,
         .tolerance = tolerance});
    std::vector<Front> path;
    for (int k = 0; k <= 24; ++k) {
        flow.advance(0.01 * k);
        const auto share = [&](int i) { return flow.liquid().fraction()[flow.grid().layout().at({i, 0})]; };
        int wet = 0;
        for (int i = 0; i + 1 < 8 * n; ++i)
            if (share(i) > 0.5) wet = i;
        const Real beyond = (share(wet) - 0.5) / (share(wet) - share(wet + 1));
        path.push_back({0.01 * k * std::sqrt(2 * 9.81 / width), (wet + 0.5 + beyond) / n});
    }
    Run run{.cells = 24 * n * n, .steps = flow.steps()};
    for (const std::string series : {"1.125in", "2.25in"}) {
        std::vector<Front> measured;
        for (const ReferenceRow& row : reference_table("flu06_dambreak_front_martin_moyce.csv"))
            if (row.is("series", "MM_n2eq2_a" + series + "_pysph"))
                measured.push_back({row.at("T"), row.at("Z")});
        const Real shift =
            at(path, &Front::place, &Front::time, 1.44) - at(measured, &Front::place, &Front::time, 1.44);
        Real& most = run.errors["Z_largest_relative_" + series];
        for (const Front& m : measured) {
            const Real off = at(path, &Front::time, &Front::place, m.time + shift) / m.place - 1;
            if (m.place > 1.44 && std::abs(off) > std::abs(most)) most = off;
        }
    }
    return run;
}

struct Flow {
    std::string name;  ///< in OpenFOAM's table
    std::string solver, title;
    std::vector<int> cells;
    std::vector<Variant> variants;
    std::vector<std::pair<std::string, std::string>> errors;  ///< name, title of a panel
    examples::Axis time, error;
    Real unit = 1;  ///< of errors on that axis
};

std::vector<Run> of_openfoam(const std::string& table, const Flow& flow) {
    std::vector<Run> runs;
    for (const ReferenceRow& row : reference_table(table)) {
        if (!row.is("case", flow.name)) continue;
        const auto cells = static_cast<Index>(row.at("cells"));
        if (runs.empty() || runs.back().cells != cells)
            runs.push_back({flow.solver, cells, static_cast<Index>(row.at("steps")), row.at("cpu_s")});
        runs.back().errors[row.texts.at("error")] = row.at("value");
    }
    return runs;
}

/// Runs all variants, prints them beside OpenFOAM's, draws errors over seconds.
void compare(const Flow& flow, const std::string& table, const fs::path& folder, std::ostream& csv) {
    charts::PanelChart chart{.title = flow.title, .x = flow.time, .y = flow.error};
    chart.columns = flow.errors.size();
    if (chart.columns == 1) chart.panel_width = 900;
    for (const auto& [error, title] : flow.errors) chart.panels.push_back({title, {}});
    const auto add = [&](const std::string& name, const std::vector<Run>& runs) {
        chart.names.push_back(name);
        for (std::size_t p = 0; p < flow.errors.size(); ++p) {
            examples::Curve curve;
            for (const Run& run : runs) {
                const Real off = run.errors.at(flow.errors[p].first);
                curve.x.push_back(run.seconds), curve.y.push_back(std::abs(off) / flow.unit);
                std::ostringstream line;
                line << flow.name << ',' << name << ',' << run.cells << ',' << run.steps << ',' << run.seconds
                     << ',' << flow.errors[p].first << ',' << off << '\n';
                csv << line.str();
                std::cout << line.str() << std::flush;
            }
            chart.panels[p].curves.push_back(curve);
        }
    };
    add(flow.solver, of_openfoam(table, flow));
    for (const Variant& variant : flow.variants) {
        std::vector<Run> runs;
        for (const int n : flow.cells) runs.push_back(timed([&] { return variant.run(n); }));
        add(variant.name, runs);
    }
    draw(chart, folder / ("water_cost_" + flow.name.substr(0, flow.name.find("_2d")) + ".png"));
}

examples::Axis seconds(Real low, Real high) {
    return {.label = "time on one processor", .unit = "s", .min = low, .max = high, .logarithmic = true};
}
examples::Axis errors(const std::string& label, Real low, Real high) {
    return {.label = label, .min = low, .max = high, .logarithmic = true};
}

std::vector<Flow> flows() {
    return {{.name = "cavity_2d_Re1000",
             .solver = "icoFoam",
             .title = "Lid-driven cavity, Re 1000, 40 s, 32 x 32 to 128 x 128 cells",
             .cells = {32, 64, 128},
             .variants = {{"Limited", [](int n) { return cavity<Limited>(n, 1e-6); }},
                          {"Central", [](int n) { return cavity<Central>(n, 1e-6); }},
                          {"Upwind", [](int n) { return cavity<Upwind>(n, 1e-6); }},
                          {"Limited at 1e-4", [](int n) { return cavity<Limited>(n, 1e-4); }},
                          {"Limited at 1e-8", [](int n) { return cavity<Limited>(n, 1e-8); }},
                          {"Limited in float", [](int n) { return cavity<Limited, float>(n, 1e-6); }}},
             .errors = {{"largest_u_off_ghia", "u along the centre line, off Ghia et al."},
                        {"u_min_off_spectral", "smallest u there, off Botella and Peyret"}},
             .time = seconds(0.02, 200),
             .error = errors("error, in speeds of the lid", 1e-3, 0.5)},
            {.name = "taylor_green_2d",
             .solver = "icoFoam",
             .title = "Taylor-Green vortices, 10 s, 32 x 32 to 128 x 128 cells",
             .cells = {32, 64, 128},
             .variants = {{"Limited", [](int n) { return taylor_green<Limited>(n, 1e-6); }},
                          {"Central", [](int n) { return taylor_green<Central>(n, 1e-6); }},
                          {"Upwind", [](int n) { return taylor_green<Upwind>(n, 1e-6); }},
                          {"Limited at 1e-4", [](int n) { return taylor_green<Limited>(n, 1e-4); }},
                          {"Limited at 1e-8", [](int n) { return taylor_green<Limited>(n, 1e-8); }},
                          {"Limited in float", [](int n) { return taylor_green<Limited, float>(n, 1e-6); }}},
             .errors = {{"velocity_rms_relative", "root mean square error of the velocity"}},
             .time = seconds(0.001, 100),
             .error = errors("share of the velocity", 1e-5, 1)},
            {.name = "dam_break_2d_martin_moyce",
             .solver = "interFoam",
             .title = "Collapse of a column, 8 to 32 cells across: the front off Martin and Moyce's",
             .cells = {8, 16, 32},
             .variants = {{"Limited", [](int n) { return dam_break<Limited>(n, 1e-6, Side::wall); }},
                          {"Central", [](int n) { return dam_break<Central>(n, 1e-6, Side::wall); }},
                          {"Upwind", [](int n) { return dam_break<Upwind>(n, 1e-6, Side::wall); }},
                          {"Limited at 1e-4", [](int n) { return dam_break<Limited>(n, 1e-4, Side::wall); }},
                          {"Limited at 1e-8", [](int n) { return dam_break<Limited>(n, 1e-8, Side::wall); }},
                          {"Limited on slip walls",
                           [](int n) { return dam_break<Limited>(n, 1e-6, Side::slip); }}},
             .errors = {{"Z_largest_relative_1.125in", "column 1.125 inches wide"},
                        {"Z_largest_relative_2.25in", "column 2.25 inches wide"}},
             .time = seconds(0.01, 50),
             .error = {.label = "largest error to 0.24 s", .unit = "%", .min = 0.0, .max = 10.0},
             .unit = 0.01}};
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const fs::path folder = argc > 1 ? argv[1] : "out/charts/water_cost";
        fs::create_directories(folder);
        const fs::path measured = argc > 2 ? argv[2] : "bench/peers/openfoam_measured.csv";
        const std::string table = fs::relative(measured, ABRADE_TEST_DATA).string();
        set_thread_count(1);
        std::ofstream csv(folder / "water_cost.csv");
        for (std::ostream* out : {static_cast<std::ostream*>(&csv), &std::cout})
            *out << "case,variant,cells,steps,cpu_s,error,value\n";
        for (const Flow& flow : flows()) compare(flow, table, folder, csv);
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
