// Whether wear depends on the stone or on how the concrete is cut and computed; draws the pictures of
// docs/verification/convergence.md on that, prints its tables and writes summary.json:
// chart_wear_mesh [FOLDER [drops|patch|beta|slow_patch]...]; all but the last, which takes hours, where none
// is named.
//
// Results of runs are kept in FOLDER as wear_mesh*.csv, and taken from there the next time. A part leaves
// what summary.json says of the others.

#include "wear_mesh_beta.hpp"
#include "wear_mesh_drops.hpp"
#include "wear_mesh_patch.hpp"

#include <ctime>

using namespace abrade;
using namespace abrade::charts;

namespace {

nlohmann::ordered_json make(const std::string& part, const std::filesystem::path& folder, PatchRuns& runs) {
    if (part == "drops") return DropChart(folder, 50).make();
    if (part == "patch") return PatchChart(folder, runs, 0).make();
    if (part == "slow_patch") return PatchChart(folder, runs, 2).make();
    if (part == "beta") return BetaChart(folder, runs).make();
    throw InputError("chart_wear_mesh: there is no part '" + part +
                     "'; parts are drops, patch, beta and slow_patch");
}

}  // namespace

int main(int argc, char** argv) {
    try {
        set_thread_count(1);
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/wear_mesh";
        std::vector<std::string> parts(argv + std::min(argc, 2), argv + argc);
        if (parts.empty()) parts = {"drops", "patch", "beta"};
        std::filesystem::create_directories(folder);
        PatchRuns runs(folder / "wear_mesh.csv");
        nlohmann::ordered_json summary;
        if (std::ifstream file(folder / "summary.json"); file) summary = nlohmann::ordered_json::parse(file);
        for (const std::string& part : parts) {
            const std::clock_t start = std::clock();
            summary.update(make(part, folder, runs));
            std::cerr << part << ": " << static_cast<Real>(std::clock() - start) / CLOCKS_PER_SEC
                      << " s of one core\n";
            std::ofstream(folder / "summary.json") << summary.dump(2) << "\n";
        }
        std::cout << "\n" << summary.dump(2) << "\n";
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
