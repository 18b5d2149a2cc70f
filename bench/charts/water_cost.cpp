// Draws how exact water is against the time that it takes, ours and OpenFOAM's on the same flows, and writes
// what was measured as CSV: chart_water_cost [FOLDER [OPENFOAM_CSV]]. Folders are made where they are not.
// One thread; some minutes. OPENFOAM_CSV: what bench/peers/openfoam/accuracy.py wrote, best on the same
// machine in the same hour; bench/peers/openfoam_measured.csv unless told otherwise.

#include "../../tests/verification/reference_table.hpp"
#include "../../tests/verification/water_flows.hpp"
#include "panels.hpp"

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

template <class Flow>
Run cost_of(const water_flows::Timed<Flow>& run) {
    return {.cells = run.flow.cost.cells, .steps = run.flow.cost.steps, .seconds = run.seconds};
}

/// The cavity against U. Ghia et al. 1982 (doi:10.1016/0021-9991(82)90058-4) and the smallest u on the centre
/// line of O. Botella and R. Peyret 1998 (doi:10.1016/S0045-7930(98)00002-4).
template <AdvectionScheme Scheme, class State = Real>
Run cavity(int n, Real tolerance) {
    const auto timed =
        water_flows::timed([&] { return water_flows::cavity<Scheme, State>(n, {.tolerance = tolerance}); });
    const std::vector<Real>&z = timed.flow.at, &u = timed.flow.u;
    Run run = cost_of(timed);
    Real& off_ghia = run.errors["largest_u_off_ghia"];
    for (const ReferenceRow& row : reference_table("flu01_ghia1982_u_vertical_centreline.csv"))
        off_ghia = std::max(off_ghia, std::abs(cubic(z, u, row.at("y")) - row.at("u_Re1000")));
    Real least = 0;
    for (int k = 0; k <= 5000; ++k) least = std::min(least, cubic(z, u, k / 5000.0));
    run.errors["u_min_off_spectral"] = least + 0.3885698;
    return run;
}

/// Velocities count where they are kept: ours on faces, OpenFOAM's in cells.
template <AdvectionScheme Scheme, class State = Real>
Run taylor_green(int n, Real tolerance) {
    const auto timed = water_flows::timed(
        [&] { return water_flows::taylor_green<Scheme, State>(n, {.tolerance = tolerance}); });
    const Real h = 2 * pi / n;
    Real off = 0, all = 0;
    for (int c = 0; c < n * n; ++c) {
        const Real x = c % n * h, y = c / n * h;
        const auto at = [&](Real right, Real up) {
            return water_flows::Vortices::exact({x + right, y + up}, water_flows::Vortices::end);
        };
        const Real u = at(0, 0.5 * h)[0], v = at(0.5 * h, 0)[1];
        const auto k = static_cast<std::size_t>(c);
        off += square(timed.flow.u[k] - u) + square(timed.flow.v[k] - v), all += square(u) + square(v);
    }
    Run run = cost_of(timed);
    run.errors["velocity_rms_relative"] = std::sqrt(off / all);
    return run;
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

/// The front of the column where the lowest row is half full, aligned with the measured ones at Z = 1.44.
/// `n`: cells across the column.
template <AdvectionScheme Scheme>
Run dam_break(int n, Real tolerance, Boundary walls) {
    const auto timed = water_flows::timed(
        [&] { return water_flows::dam_break<Scheme>(n, {.tolerance = tolerance, .walls = walls}); });
    std::vector<Front> path;
    for (std::size_t k = 0; k < timed.flow.time.size(); ++k)
        path.push_back(
            {timed.flow.time[k] * std::sqrt(2 * 9.81 / water_flows::Collapse::width), timed.flow.front(k)});
    Run run = cost_of(timed);
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
        for (const int n : flow.cells) runs.push_back(variant.run(n));
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
             .variants = {{"Koren", [](int n) { return cavity<Koren>(n, 1e-6); }},
                          {"Central", [](int n) { return cavity<Central>(n, 1e-6); }},
                          {"Upwind", [](int n) { return cavity<Upwind>(n, 1e-6); }},
                          {"Koren at 1e-4", [](int n) { return cavity<Koren>(n, 1e-4); }},
                          {"Koren at 1e-8", [](int n) { return cavity<Koren>(n, 1e-8); }},
                          {"Koren in float", [](int n) { return cavity<Koren, float>(n, 1e-6); }}},
             .errors = {{"largest_u_off_ghia", "u along the centre line, off Ghia et al."},
                        {"u_min_off_spectral", "smallest u there, off Botella and Peyret"}},
             .time = seconds(0.02, 200),
             .error = errors("error, in speeds of the lid", 1e-3, 0.5)},
            {.name = "taylor_green_2d",
             .solver = "icoFoam",
             .title = "Taylor-Green vortices, 10 s, 32 x 32 to 128 x 128 cells",
             .cells = {32, 64, 128},
             .variants = {{"Koren", [](int n) { return taylor_green<Koren>(n, 1e-6); }},
                          {"Central", [](int n) { return taylor_green<Central>(n, 1e-6); }},
                          {"Upwind", [](int n) { return taylor_green<Upwind>(n, 1e-6); }},
                          {"Koren at 1e-4", [](int n) { return taylor_green<Koren>(n, 1e-4); }},
                          {"Koren at 1e-8", [](int n) { return taylor_green<Koren>(n, 1e-8); }},
                          {"Koren in float", [](int n) { return taylor_green<Koren, float>(n, 1e-6); }}},
             .errors = {{"velocity_rms_relative", "root mean square error of the velocity"}},
             .time = seconds(0.001, 100),
             .error = errors("share of the velocity", 1e-5, 1)},
            {.name = "dam_break_2d_martin_moyce",
             .solver = "interFoam",
             .title = "Collapse of a column, 8 to 32 cells across: the front off Martin and Moyce's",
             .cells = {8, 16, 32},
             .variants = {{"Koren", [](int n) { return dam_break<Koren>(n, 1e-6, Boundary::wall); }},
                          {"Central", [](int n) { return dam_break<Central>(n, 1e-6, Boundary::wall); }},
                          {"Upwind", [](int n) { return dam_break<Upwind>(n, 1e-6, Boundary::wall); }},
                          {"Koren at 1e-4", [](int n) { return dam_break<Koren>(n, 1e-4, Boundary::wall); }},
                          {"Koren at 1e-8", [](int n) { return dam_break<Koren>(n, 1e-8, Boundary::wall); }},
                          {"Koren on slip walls",
                           [](int n) { return dam_break<Koren>(n, 1e-6, Boundary::free_slip); }}},
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
