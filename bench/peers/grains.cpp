// One scene of bench/peers, timed: peers_grains --case NAME --scene FILE, or --make-gas FILE. Prints JSON.

#include <abrade/abrade.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <chrono>
#include <fstream>
#include <iostream>
#include <limits>
#include <random>

using namespace abrade;

namespace {

constexpr Real radius = 0.01, density = 2500;              // of every sphere [m], [kg/m3]
constexpr Real bed_side = 0.54, clump_bed_side = 0.42;     // of the periodic floors [m]
constexpr int gas_spheres = 20000, gas_cells_a_side = 28;  // of a grid that holds one sphere a cell
constexpr Real gas_solid_fraction = 0.1;

Real gas_side() { return std::cbrt(gas_spheres * 4.0 / 3 * pi * cube(radius) / gas_solid_fraction); }

/// Rows of `columns` numbers; lines that begin with # are skipped.
std::vector<std::vector<Real>> read_rows(const std::string& file, std::size_t columns) {
    std::ifstream in(file);
    if (!in) throw std::runtime_error("cannot read " + file);
    std::vector<std::vector<Real>> rows;
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream words(line);
        std::vector<Real> row(columns);
        for (Real& x : row) words >> x;
        if (!words)
            throw std::runtime_error(file + ": a line of fewer than " + std::to_string(columns) + " numbers");
        rows.push_back(std::move(row));
    }
    if (rows.empty()) throw std::runtime_error(file + " is empty");
    return rows;
}

/// The same on every machine: the standard's generator, but not its distributions, which are free to differ.
class Dice {
public:
    Real uniform() { return (static_cast<Real>(generator_() >> 11) + 0.5) * 0x1p-53; }
    Real normal() { return std::sqrt(-2 * std::log(uniform())) * std::cos(2 * pi * uniform()); }
    std::size_t below(std::size_t n) { return generator_() % n; }

private:
    std::mt19937_64 generator_{7};
};

/// Spheres in cells drawn from a grid, normal velocities of 1 m/s a direction: x y z u v w.
void make_gas(const std::string& file) {
    Dice dice;
    const int m = gas_cells_a_side;
    std::vector<int> cells(static_cast<std::size_t>(m) * m * m);
    for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = static_cast<int>(c);
    for (std::size_t c = 0; c < gas_spheres; ++c)
        std::swap(cells[c], cells[c + dice.below(cells.size() - c)]);
    std::vector<Vec3> velocities(gas_spheres);
    Vec3 mean = Vec3::Zero();
    for (Vec3& v : velocities) {
        for (Real& component : v) component = dice.normal();
        mean += v / gas_spheres;
    }
    std::ofstream out(file);
    out.precision(12);
    const Real cell = gas_side() / m;
    for (std::size_t n = 0; n < velocities.size(); ++n) {
        const int c = cells[n];
        const Vec3 x = cell * Vec3(c % m + 0.5, c / m % m + 0.5, c / m / m + 0.5), v = velocities[n] - mean;
        out << x.transpose() << " " << v.transpose() << "\n";
    }
    if (!out) throw std::runtime_error("cannot write " + file);
}

Scene floor_of_side(Real side) {
    Scene scene;
    scene.gravity = {0, 0, -9.81};
    scene.periodic_along = {true, true, false};
    scene.bounds.low = {0, 0, -std::numeric_limits<Real>::infinity()};
    scene.bounds.high = {side, side, std::numeric_limits<Real>::infinity()};
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    return scene;
}

/// `x` brought back to [0, side) along x and y.
Vec3 wrapped(Vec3 x, Real side) {
    for (int a = 0; a < 2; ++a) {
        x[a] -= side * std::floor(x[a] / side);
        if (x[a] >= side) x[a] = 0;
    }
    return x;
}

Scene bed(const std::string& file) {
    Scene scene = floor_of_side(bed_side);
    for (const auto& row : read_rows(file, 3))
        scene.add_sphere(radius, {.position = wrapped({row[0], row[1], row[2]}, bed_side)}, density);
    return scene;
}

Scene gas(const std::string& file) {
    Scene scene;
    scene.gravity.setZero();
    scene.periodic_along = {true, true, true};
    scene.bounds = {Vec3::Zero(), Vec3::Constant(gas_side())};
    for (const auto& row : read_rows(file, 6))
        scene.add_sphere(radius, {.position = {row[0], row[1], row[2]}, .velocity = {row[3], row[4], row[5]}},
                         density);
    return scene;
}

/// Eight spheres on the corners of a cube. The file holds their centres, in the order of the corners here.
Scene clumps(const std::string& file) {
    constexpr Real half = 0.006;
    std::vector<Sphere> corners;
    for (const Real x : {-half, half})
        for (const Real y : {-half, half})
            for (const Real z : {-half, half}) corners.push_back({{x, y, z}, radius});
    Clump cube = make_clump("cube", corners);
    cube.members = corners;  // any axes of a cube are principal: take its own

    Scene scene = floor_of_side(clump_bed_side);
    const auto rows = read_rows(file, 3);
    if (rows.size() % corners.size() != 0) throw std::runtime_error(file + ": not eight spheres a clump");
    for (std::size_t first = 0; first < rows.size(); first += corners.size()) {
        Vec3 centre = Vec3::Zero();
        Mat3 turn = Mat3::Zero();
        for (std::size_t k = 0; k < corners.size(); ++k) {
            const Vec3 x(rows[first + k][0], rows[first + k][1], rows[first + k][2]);
            centre += x / 8;
            turn += x * corners[k].centre.transpose() / (8 * half * half);
        }
        if ((turn * turn.transpose() - Mat3::Identity()).norm() > 1e-4 || turn.determinant() < 0)
            throw std::runtime_error(file + ": spheres " + std::to_string(first) + " on are not a cube");
        const Quaternion orientation = Quaternion(turn).normalized();
        scene.add_stone(cube, {.position = wrapped(centre, clump_bed_side), .orientation = orientation},
                        density);
    }
    return scene;
}

struct Options {
    std::string name, file;
    int steps = 1000, warm = 500, threads = 1;
};

template <class Law>
void measure(const Options& options, Scene scene, const Law& law, Real dt, Real skin) {
    auto sim = simulate(std::move(scene)).contact(law);
    const auto run = [&](int steps) {
        sim.run({.end_time = sim.time() + steps * dt, .time_step = dt, .skin = skin});
    };
    run(options.warm);
    const auto start = std::chrono::steady_clock::now();
    run(options.steps);
    const Real seconds = std::chrono::duration<Real>(std::chrono::steady_clock::now() - start).count();
    Index touching = 0;
    sim.world().each_contact([&](Index, Index second, const auto&...) { touching += second >= 0; });
    const nlohmann::json result{
        {"case", options.name},
        {"particle_steps_per_s", static_cast<Real>(sim.particles().spheres()) * options.steps / seconds},
        {"ledger_residual_relative", sim.ledger().residual_relative()},
        {"contacts", touching},
        {"instruction_set", instruction_set},
        {"compiler", ABRADE_COMPILER}};
    std::cout << result.dump() << "\n";
}

void run_case(const Options& o) {
    const LinearSpring::Params linear{.stiffness = 1e5, .restitution = 0.5, .friction = 0.5};
    const HertzMindlin::Params hertz{.youngs = 1e8, .poisson = 0.25, .restitution = 0.5, .friction = 0.5};
    if (o.name == "bed_linear") measure(o, bed(o.file), LinearSpring{linear}, 1.4e-5, 0.002);
    if (o.name == "bed_hertz") measure(o, bed(o.file), HertzMindlin{hertz}, 1.4e-5, 0.002);
    if (o.name == "gas") measure(o, gas(o.file), LinearSpring{{.stiffness = 1e5}}, 1.4e-5, 0.005);
    if (o.name == "bed_clumps") measure(o, clumps(o.file), LinearSpring{linear}, 3.3e-5, 0.002);
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    std::string gas_file;
    CLI::App app{"Times one of the scenes that bench/peers/run compares."};
    auto* name = app.add_option("--case", options.name)
                     ->check(CLI::IsMember({"bed_linear", "bed_hertz", "gas", "bed_clumps"}));
    app.add_option("--scene", options.file, "initial state")->needs(name);
    app.add_option("--steps", options.steps, "timed")->check(CLI::PositiveNumber);
    app.add_option("--warm", options.warm, "steps before")->check(CLI::PositiveNumber);
    app.add_option("--threads", options.threads)->check(CLI::PositiveNumber);
    app.add_option("--make-gas", gas_file, "write the initial state of the gas there")->excludes(name);
    app.require_option(1, 0);
    CLI11_PARSE(app, argc, argv);
    try {
        set_thread_count(options.threads);
        gas_file.empty() ? run_case(options) : make_gas(gas_file);
    } catch (const std::exception& problem) {
        std::cerr << "error: " << problem.what() << "\n";
        return 1;
    }
}
