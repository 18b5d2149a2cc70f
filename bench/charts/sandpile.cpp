// Draws the pictures of docs/verification/sandpile.md: chart_sandpile [FOLDER [MODEL]]. The folder is made
// where it is not; MODEL is epsd or constant, both without it.
//
// A run takes minutes. What it gave is kept in FOLDER as sandpile_MODEL.csv and sandpile_MODEL_discs.csv, and
// taken from there the next time.
//
// chart_sandpile FOLDER causes [NUMBER...] draws nothing: it pours piles that differ in one thing each, all
// or those with a number, and adds their heights to FOLDER/sandpile_causes.csv.

#include "../../tests/verification/sandpile.hpp"
#include "../../examples/common/charts.hpp"
#include "../../tests/verification/reference_table.hpp"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

using namespace sandpile;
using namespace abrade::examples;

namespace {

struct Case {
    std::string name, title, published;
    Law::Model model;
    Real seconds;  ///< after the gate opened
};
const Case cases[] = {{"epsd", "elastic-plastic", "epsd_model", Law::Model::elastic_plastic, 16.5},
                      {"constant", "constant torque", "constant_model", Law::Model::constant_torque, 16.5}};

std::vector<std::vector<Real>> rows_of(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::vector<std::vector<Real>> rows;
    std::string line;
    std::getline(file, line);  // names of columns
    while (std::getline(file, line)) {
        auto& row = rows.emplace_back();
        std::istringstream text(line);
        for (std::string cell; std::getline(text, cell, ',');) row.push_back(std::stod(cell));
    }
    return rows;
}

struct Cause {
    std::string what;
    Pile pile;
};
const Cause causes[] = {
    {"30 % large by number", {}},
    {"30 % large by number, other order", {.seed = 2}},
    {"500 large of 3000", {.large = 1. / 6}},
    {"500 large of 3000, other order", {.large = 1. / 6, .seed = 2}},
    {"500 large of 3000, third order", {.large = 1. / 6, .seed = 3}},
    {"masses and inertias of discs", {.large = 1. / 6, .flat = true}},
    {"restitution 0.3", {.large = 1. / 6, .restitution = 0.3}},
    {"rolling friction 0.6", {.large = 1. / 6, .rolling_friction = 0.6}},
};

/// Heights 6.5 s after the gate opened, of the discs below the channel, and how many are still above its end.
void pour_causes(const std::filesystem::path& to, const std::vector<std::size_t>& numbers) {
    std::ofstream table(to, std::ios::app);
    for (const std::size_t n : numbers) {
        const Run run = pour(causes[n].pile, 6.5, 0.25, 0.8);
        Real highest = floor_height;
        Index above = 0;
        for (const Disc& disc : run.discs)
            if (disc.position.z() > channel_end)
                ++above;
            else
                highest = std::max(highest, disc.position.z());
        std::ostringstream line;
        line << n << ',' << causes[n].what << ',' << highest - floor_height << ',' << above << ','
             << run.integration_residue / run.lost << '\n';
        table << line.str() << std::flush, std::cout << line.str() << std::flush;
    }
}

void run(const Case& c, const std::filesystem::path& heights, const std::filesystem::path& discs) {
    const Run run = pour({.model = c.model}, c.seconds, 0.1);
    std::ofstream h(heights), d(discs);
    h << "t_s,height_m\n", d << "x_m,z_m,radius_m,wall\n";
    for (std::size_t n = 0; n < run.time.size(); ++n)
        h << to_text(run.time[n]) << ',' << to_text(run.height[n]) << '\n';
    for (const auto& [all, wall] : {std::pair(&run.discs, 0), std::pair(&run.walls, 1)})
        for (const Disc& disc : *all)
            d << to_text(disc.position.x()) << ',' << to_text(disc.position.z()) << ','
              << to_text(disc.radius) << ',' << wall << '\n';
    std::cout << c.name << ": " << run.steps << " steps, height " << run.height.back() << " m, lost "
              << run.lost << " J of which in rolling " << run.lost_rolling << " J, integration residue "
              << run.integration_residue << " J, residual " << run.residual << ", kinetic energy at the end "
              << run.kinetic << " J\n";
}

void picture(const Case& c, const std::filesystem::path& discs, const std::filesystem::path& to) {
    CircleSet small{.title = "6.9 mm", .circles = {}, .colour = "#e69f00", .outline = true},
        large{.title = "8.9 mm", .circles = {}, .colour = "#0072b2", .outline = true},
        walls{.title = "hopper", .circles = {}, .colour = "#7a8b99"};
    for (const auto& row : rows_of(discs)) {
        CircleSet& set = row[3] > 0 ? walls : row[2] > 0.004 ? large : small;
        set.circles.push_back({row[0], row[1] - floor_height, row[2]});
    }
    draw(CirclePicture{.title = "The pile: " + c.title,
                       .x = {.label = "x", .unit = "m", .min = -0.75, .max = 0.75},
                       .y = {.label = "height", .unit = "m", .min = 0, .max = 0.65},
                       .sets = {walls, small, large},
                       .rows = 1},
         to);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/sandpile";
        std::filesystem::create_directories(folder);
        if (argc > 2 && std::string(argv[2]) == "causes") {
            std::vector<std::size_t> numbers;
            for (int n = 3; n < argc; ++n) numbers.push_back(std::stoul(argv[n]));
            for (std::size_t n = 0; argc == 3 && n < std::size(causes); ++n) numbers.push_back(n);
            for (const std::size_t n : numbers)
                if (n >= std::size(causes)) throw std::invalid_argument("no cause " + std::to_string(n));
            pour_causes(folder / "sandpile_causes.csv", numbers);
            return 0;
        }
        std::vector<Curve> curves;
        for (const Case& c : cases) {
            if (argc > 2 && c.name != argv[2]) continue;
            const auto heights = folder / ("sandpile_" + c.name + ".csv"),
                       discs = folder / ("sandpile_" + c.name + "_discs.csv");
            if (!std::filesystem::exists(heights) || !std::filesystem::exists(discs)) run(c, heights, discs);
            Curve ours{.title = c.title};
            for (const auto& row : rows_of(heights)) ours.x.push_back(row[0]), ours.y.push_back(row[1]);
            Curve published{.title = "published, " + c.title, .style = CurveStyle::points};
            for (const auto& row : reference_table("dem13_sandpile_height_rolling_friction.csv"))
                if (row.is("model", c.published))
                    published.x.push_back(row.at("t_s")), published.y.push_back(row.at("height_m"));
            curves.push_back(ours), curves.push_back(published);
            picture(c, discs, folder / ("verification_sandpile_" + c.name + ".png"));
        }
        draw(LineChart{.title = "Height of a pile of 3000 discs under two models of rolling resistance",
                       .x = {.label = "time", .unit = "s", .min = 4, .max = 50},
                       .y = {.label = "highest centre over the floor", .unit = "m", .min = 0.2, .max = 0.3},
                       .curves = curves},
             folder / "verification_sandpile_height.png");
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
