// Runs the scenes in which solvers of free surfaces fail, prints a table of what each showed and writes
// summary.json for docs/verification/water_stress.md: chart_water_stress [FOLDER [WORD]]. Only scenes whose name holds
// WORD, if one is given. One thread; half a minute.

#include "../../tests/fluid/stress_scenes.hpp"

#include <nlohmann/json.hpp>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>

using namespace abrade;

namespace {

/// The worst of all scenes.
struct Worst {
    Real speed = 0, gained = 0, overfull = 0;
    int scenes = 0, failed = 0;
};

template <int Dim>
void run(const std::vector<stress::Scene<Dim>>& scenes, std::string_view word, Worst& worst) {
    for (const stress::Scene<Dim>& scene : scenes) {
        if (scene.name.find(word) == std::string::npos) continue;
        const auto begun = std::chrono::steady_clock::now();
        const stress::Outcome seen = stress::run<GridFluid<Dim>>(scene);
        const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begun;
        std::printf("| %s | %.2f | %.1e | %.1e | %.0e | %.0e | %d | %.1f |%s%s\n", scene.name.c_str(),
                    seen.speed, seen.beyond, seen.gained, seen.overfull, seen.lost,
                    static_cast<int>(seen.steps), wall.count(), seen.error.empty() ? "" : " ",
                    seen.error.c_str());
        std::fflush(stdout);
        // Where fronts meet twice as much is allowed.
        worst.speed = std::max(worst.speed, seen.speed / (scene.fronts ? 2 : 1));
        worst.gained = std::max(worst.gained, seen.gained);
        worst.overfull = std::max(worst.overfull, seen.overfull);
        ++worst.scenes, worst.failed += !seen.error.empty();
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        namespace fs = std::filesystem;
        const fs::path folder = argc > 1 ? argv[1] : "out/charts/water_stress";
        const std::string_view word = argc > 2 ? argv[2] : "";
        fs::create_directories(folder);
        std::cout
            << "| scene | fastest face over the fall's speed | momentum above 1.5 of it | energy gained | "
               "overfull | volume | steps | s |\n|---|---|---|---|---|---|---|---|\n";
        Worst worst;
        run(stress::plane_scenes(), word, worst);
        run(stress::space_scenes(), word, worst);
        require(worst.scenes > 0,
                {"WORD: scenes whose name holds it", "at least 1", "", "leave it out for all"}, 0);
        const nlohmann::ordered_json summary{{"worst_speed_ratio", worst.speed},
                                             {"worst_energy_gain_relative", worst.gained},
                                             {"worst_overfill", worst.overfull},
                                             {"scenes", worst.scenes},
                                             {"failed", worst.failed}};
        std::ofstream(folder / "summary.json") << summary.dump(2) << "\n";
        std::cout << summary.dump(2) << "\nin " << (folder / "summary.json").string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
