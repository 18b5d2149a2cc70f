// The bonded block of bench/peers, timed: peers_bonds --law NAME --scene FILE. Prints JSON.

#include <abrade/abrade.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <chrono>
#include <fstream>
#include <iostream>

using namespace abrade;

namespace {

constexpr Real radius = 0.01, density = 2500;       // of every sphere [m], [kg/m3]
constexpr Real stiffness = 1e5, ratio = 0.2857143;  // of every bond [N/m], [-]
constexpr Real gap = 0.05;                          // pairs nearer than that share of a diameter are bonded
constexpr Real dt = 1.4e-5;                         // [s]

struct Options {
    std::string law = "parallel", file;
    int steps = 200, warm = 100, threads = 1;
};

/// x y z of each sphere, one a line.
std::vector<Vec3> read_centres(const std::string& file) {
    std::ifstream in(file);
    if (!in) throw std::runtime_error("cannot read " + file);
    std::vector<Vec3> centres;
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        Vec3 x;
        if (line.empty() || line[0] == '#') continue;
        if (!(words >> x.x() >> x.y() >> x.z()))
            throw std::runtime_error(file + ": a line of fewer than 3 numbers");
        centres.push_back(x);
    }
    return centres;
}

template <class Law>
void measure(const Options& options, const Law& law) {
    const std::vector<Vec3> centres = read_centres(options.file);
    Scene scene;
    scene.gravity.setZero();
    const Real volume = static_cast<Real>(centres.size()) * 4.0 / 3 * pi * cube(radius);
    scene.concrete = ConcreteBlock{lattice_of(centres, radius, volume, gap), density};
    auto sim =
        simulate(std::move(scene)).contact(LinearSpring{{.stiffness = stiffness, .friction = 0.5}}).bond(law);
    const auto run = [&](int steps) {
        sim.run({.end_time = sim.time() + steps * dt, .time_step = dt, .skin = 0.002});
    };
    run(options.warm);
    const auto start = std::chrono::steady_clock::now();
    run(options.steps);
    const Real seconds = std::chrono::duration<Real>(std::chrono::steady_clock::now() - start).count();
    const auto bonds = static_cast<Real>(sim.world().network().size());
    const nlohmann::json result{{"law", options.law},
                                {"bond_steps_per_s", bonds * options.steps / seconds},
                                {"bonds", bonds},
                                {"ledger_residual_relative", sim.ledger().residual_relative()},
                                {"instruction_set", instruction_set},
                                {"compiler", ABRADE_COMPILER}};
    std::cout << result.dump() << "\n";
}

void run_law(const Options& o) {
    constexpr Real strong = 1e9;
    if (o.law == "mohr_coulomb")
        measure(o, MohrCoulomb{{.tensile = strong, .stiffness = stiffness, .stiffness_ratio = ratio}});
    if (o.law == "parallel")
        measure(o, ParallelBond{{.youngs = stiffness * 2 * radius / (pi * square(radius)),
                                 .stiffness_ratio = ratio,
                                 .tensile = strong,
                                 .cohesion = strong}});
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app{"Times the bonded block that bench/peers/run compares."};
    app.add_option("--law", options.law)->check(CLI::IsMember({"mohr_coulomb", "parallel"}));
    app.add_option("--scene", options.file, "initial state")->required();
    app.add_option("--steps", options.steps, "timed")->check(CLI::PositiveNumber);
    app.add_option("--warm", options.warm, "steps before")->check(CLI::PositiveNumber);
    app.add_option("--threads", options.threads)->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);
    try {
        set_thread_count(options.threads);
        run_law(options);
    } catch (const std::exception& problem) {
        std::cerr << "error: " << problem.what() << "\n";
        return 1;
    }
}
