#pragma once
// Runs of the struck patch over seeds, kept in a table so that a picture can be drawn anew without them.

#include "struck_patch.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace abrade::charts {

/// Over the seeds of one setting.
struct Statistics {
    PatchAnswers mean, deviation;  ///< standard deviation of one run
    int seeds = 0, failed = 0;     ///< runs that count, and those that went wrong
    Real standard_error(Real PatchAnswers::*of) const { return deviation.*of / std::sqrt(seeds); }
    std::string seeds_text() const {
        return std::to_string(seeds) + (failed > 0 ? " and " + std::to_string(failed) + " failed" : "");
    }
};

class PatchRuns {
public:
    /// Reads what is there already.
    explicit PatchRuns(std::filesystem::path table) : table_(std::move(table)) {
        std::ifstream file(table_);
        std::string line;
        std::getline(file, line);  // names of columns
        while (std::getline(file, line)) {
            std::istringstream text(line);
            std::string label, cell;
            std::getline(text, label, ';'), std::getline(text, cell, ';');
            PatchAnswers a;
            PatchAnswers::visit([&](const auto&, auto answer) {
                if (std::getline(text, cell, ';')) answer(a) = std::stod(cell);
            });
            runs_[label].push_back(a);
        }
    }

    /// Runs the patch under seeds 1 to `seeds` that are not there yet.
    void make(const std::string& label, Patch patch, int seeds) {
        std::vector<PatchAnswers>& done = runs_[label];
        while (static_cast<int>(done.size()) < seeds) {
            patch.seed = static_cast<std::uint32_t>(done.size()) + 1;
            try {
                done.push_back(run(patch));
            } catch (const RunError& error) {
                std::cerr << label << ", seed " << patch.seed << ": " << error.what() << '\n';
                done.emplace_back();  // fed nothing
            }
            std::ofstream file(table_, std::ios::app);
            if (file.tellp() == 0) {
                file << "setting;seed";
                PatchAnswers::visit([&](const auto& name, auto) { file << ';' << name; });
                file << '\n';
            }
            file << label << ';' << patch.seed;
            PatchAnswers::visit(
                [&](const auto&, auto answer) { file << ';' << to_text(answer(done.back())); });
            file << '\n';
            std::cerr << label << ", seed " << patch.seed << ": " << done.back().processor << " s\n";
        }
    }

    const std::vector<PatchAnswers>& all(const std::string& label) const { return runs_.at(label); }

    Real fastest(const std::string& label) const {  ///< time of one core [s]
        Real least = std::numeric_limits<Real>::infinity();
        for (const PatchAnswers& a : all(label))
            if (a.fed > 0) least = std::min(least, a.processor);
        return least;
    }

    Statistics of(const std::string& label) const {
        Statistics s;
        std::vector<PatchAnswers> done = runs_.at(label);
        s.failed = static_cast<int>(std::erase_if(done, [](const PatchAnswers& a) { return a.fed == 0; }));
        s.seeds = static_cast<int>(done.size());
        PatchAnswers::visit([&](const auto&, auto answer) {
            for (const PatchAnswers& a : done) answer(s.mean) += answer(a) / s.seeds;
            Real squares = 0;
            for (const PatchAnswers& a : done) squares += square(answer(a) - answer(s.mean));
            answer(s.deviation) = std::sqrt(squares / std::max(s.seeds - 1, 1));
        });
        return s;
    }

private:
    std::filesystem::path table_;
    std::map<std::string, std::vector<PatchAnswers>> runs_;
};

}  // namespace abrade::charts
