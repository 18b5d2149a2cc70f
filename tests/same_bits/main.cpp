// Runs scenes and prints a hash of the numbers of each, or compares the numbers with those of another
// program.

#include "scene_list.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <span>

namespace fs = std::filesystem;
using namespace same_bits;

namespace {

constexpr const char* usage =
    "same_bits [--scene NAME]... [--list] [--dump FOLDER] [--compare FOLDER] [--figures] [--seconds]\n"
    "Prints a line for each scene: its name, the count of its numbers, and a hash of their bytes.\n"
    "  --scene NAME      only this scene; may be given again\n"
    "  --list            prints the names instead\n"
    "  --dump FOLDER     also writes the numbers of each scene to FOLDER/NAME.bin, as doubles\n"
    "  --compare FOLDER  instead of hashes prints the largest difference from such files, over the largest\n"
    "                    number of its kind; fails where that is above 1e-10 or counts differ\n"
    "  --figures         also prints what happened in each scene\n"
    "  --seconds         also prints how long each scene took\n";

struct Options {
    std::vector<std::string> scenes;
    std::optional<fs::path> dump, compare;
    bool list = false, figures = false, seconds = false;
};

/// What the user got wrong.
struct UsageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

Options read(std::span<char*> arguments) {
    Options options;
    for (std::size_t n = 0; n < arguments.size(); ++n) {
        const std::string option = arguments[n];
        const auto value = [&]() -> std::string {
            if (n + 1 == arguments.size()) throw UsageError(option + " needs a value");
            return arguments[++n];
        };
        if (option == "--scene")
            options.scenes.push_back(value());
        else if (option == "--dump")
            options.dump = value();
        else if (option == "--compare")
            options.compare = value();
        else if (option == "--list")
            options.list = true;
        else if (option == "--figures")
            options.figures = true;
        else if (option == "--seconds")
            options.seconds = true;
        else
            throw UsageError("unknown option " + option + "\n" + usage);
    }
    return options;
}

/// In the order of their names.
std::vector<Scene> chosen(const Options& options) {
    std::vector<Scene> all = scenes();
    std::ranges::sort(all, {}, &Scene::name);
    for (std::size_t n = 1; n < all.size(); ++n)
        if (all[n].name == all[n - 1].name) throw std::logic_error("two scenes are called " + all[n].name);
    if (options.scenes.empty()) return all;
    std::vector<Scene> some;
    for (const std::string& name : options.scenes) {
        const auto found = std::ranges::find(all, name, &Scene::name);
        if (found == all.end()) {
            std::string known;
            for (const Scene& scene : all) known += "\n  " + scene.name;
            throw UsageError("no scene is called " + name + "; there are:" + known);
        }
        some.push_back(*found);
    }
    return some;
}

/// FNV-1a of 64 bits: http://www.isthe.com/chongo/tech/comp/fnv.
std::uint64_t hash_of(const Numbers& numbers) {
    std::uint64_t hash = 14695981039346656037u;
    for (const Numbers::Kind& kind : numbers.kinds())
        for (const Real value : kind.values) {
            std::array<unsigned char, sizeof(Real)> bytes;
            std::memcpy(bytes.data(), &value, sizeof(Real));
            for (const unsigned char byte : bytes) hash = (hash ^ byte) * 1099511628211u;
        }
    return hash;
}

fs::path file_of(const fs::path& folder, const Scene& scene) { return folder / (scene.name + ".bin"); }

void write(const fs::path& path, const Numbers& numbers) {
    fs::create_directories(path.parent_path());
    std::ofstream out(path, std::ios::binary);
    for (const Numbers::Kind& kind : numbers.kinds())
        out.write(reinterpret_cast<const char*>(kind.values.data()),
                  static_cast<std::streamsize>(kind.values.size() * sizeof(Real)));
    if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
}

std::vector<Real> numbers_in(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) throw std::runtime_error("cannot read " + path.string());
    std::vector<Real> values(fs::file_size(path) / sizeof(Real));
    in.read(reinterpret_cast<char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(Real)));
    return values;
}

/// Of the kind that differs most.
struct Difference {
    Real most = 0;  ///< over the largest of its kind [-]
    std::string kind;
};
Difference difference(const Numbers& numbers, std::span<const Real> before) {
    Difference worst;
    std::size_t first = 0;
    for (const auto& [name, values] : numbers.kinds()) {
        Real largest = 0, apart = 0;
        for (std::size_t n = 0; n < values.size(); ++n) {
            const Real a = values[n], b = before[first + n];
            if (std::memcmp(&a, &b, sizeof(Real)) == 0) continue;
            // No number, or an infinite one, on one side alone is as far apart as can be.
            const Real d = std::abs(a - b);
            apart = std::isfinite(d) ? std::max(apart, d) : std::numeric_limits<Real>::infinity();
        }
        for (std::size_t n = 0; n < values.size(); ++n)
            for (const Real value : {values[n], before[first + n]})
                if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
        first += values.size();
        const Real relative = apart > 0 ? apart / std::max(largest, std::numeric_limits<Real>::min()) : 0;
        if (relative > worst.most) worst = {relative, name};
    }
    return worst;
}

/// Prints a scene's line; returns whether it is as it was.
bool compare(const Scene& scene, const Numbers& numbers, const fs::path& folder) {
    const std::vector<Real> before = numbers_in(file_of(folder, scene));
    if (before.size() != numbers.count()) {
        std::printf("%-40s %9zu numbers, there were %zu  DIFFERS", scene.name.c_str(), numbers.count(),
                    before.size());
        return false;
    }
    const Difference found = difference(numbers, before);
    const bool same = found.most <= scene.tolerance;
    std::printf("%-40s %9zu %10.3g", scene.name.c_str(), numbers.count(), found.most);
    if (found.most > 0) std::printf("  %s", found.kind.c_str());
    if (!same) std::printf("  DIFFERS by more than %.3g", scene.tolerance);
    return same;
}

int run(const Options& options) {
    std::vector<std::string> failed;
    for (const Scene& scene : chosen(options)) {
        if (options.list) {
            std::printf("%s\n", scene.name.c_str());
            continue;
        }
        const auto start = std::chrono::steady_clock::now();
        bool fine = true;
        try {
            const Numbers numbers = scene.run();
            const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
            if (options.dump) write(file_of(*options.dump, scene), numbers);
            if (options.compare)
                fine = compare(scene, numbers, *options.compare);
            else
                std::printf("%-40s %9zu %016llx", scene.name.c_str(), numbers.count(),
                            static_cast<unsigned long long>(hash_of(numbers)));
            if (options.seconds) std::printf(" %7.2f s", took.count());
            std::printf("\n");
            if (options.figures)
                for (const auto& [name, value] : numbers.figures())
                    if (value != 0) std::printf("    %-32s %g\n", name.c_str(), value);
        } catch (const std::exception& error) {
            std::printf("%-40s failed: %s\n", scene.name.c_str(), error.what());
            fine = false;
        }
        std::fflush(stdout);
        if (!fine) failed.push_back(scene.name);
    }
    if (failed.empty()) return 0;
    std::fprintf(stderr, "error: %zu scenes differ or fail:", failed.size());
    for (const std::string& name : failed) std::fprintf(stderr, " %s", name.c_str());
    std::fprintf(stderr, "\n");
    return 1;
}

}  // namespace

int main(int count, char** arguments) {
    try {
        return run(read(std::span(arguments, static_cast<std::size_t>(count)).subspan(1)));
    } catch (const UsageError& error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return 2;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return 1;
    }
}
