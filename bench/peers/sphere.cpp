// The fixed sphere of bench/peers, timed: bench_peers_sphere --cells N --reynolds RE. Prints JSON.

#include "../../tests/coupling/resolved_bodies.hpp"

#include <abrade/core/simd.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <ctime>
#include <iostream>

using namespace abrade;

int main(int argc, char** argv) {
    resolved::Stream stream;
    Real end = 12;
    CLI::App app{"Times the fixed sphere that bench/peers/run sphere compares."};
    app.add_option("--cells", stream.cells, "to a diameter")->check(CLI::PositiveNumber);
    app.add_option("--reynolds", stream.reynolds)->check(CLI::PositiveNumber);
    app.add_option("--off", stream.off, "the sphere's centre off a corner of cells [cell]");
    app.add_option("--step", stream.step, "largest step of time; 0: what is stable");
    app.add_option("--courant", stream.courant)->check(CLI::PositiveNumber);
    app.add_option("--tolerance", stream.tolerance)->check(CLI::PositiveNumber);
    app.add_option("--end", end, "[diameters over the stream's speed]")->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);
    try {
        set_thread_count(1);
        const std::clock_t start = std::clock();
        const resolved::Drag drag = resolved::drag_in(stream, end);
        const Real seconds = static_cast<Real>(std::clock() - start) / CLOCKS_PER_SEC;
        const nlohmann::json result{{"drag", drag.mean},
                                    {"cells", drag.cells},
                                    {"steps", drag.steps},
                                    {"seconds", seconds},
                                    {"instruction_set", instruction_set},
                                    {"compiler", ABRADE_COMPILER}};
        std::cout << result.dump() << "\n";
    } catch (const std::exception& problem) {
        std::cerr << "error: " << problem.what() << "\n";
        return 1;
    }
}
