// Draws the picture of docs/verification/03_heap_at_rest.md on five hundred stones that lie on concrete, and prints the
// table: chart_static_deposit [FOLDER], which is made where it is not. Some nine minutes.

#include "../../examples/common/charts.hpp"
#include "../../tests/verification/deposit.hpp"

#include <iostream>

using namespace deposit;
using namespace abrade::examples;

namespace {

constexpr Real rest_from = 3, end_time = 13;  // [s]

/// Wear since the observation before [cm3/s]; nothing where not a bit has changed.
std::vector<Real> wear_rate(const History& h) {
    std::vector<Real> rates{NAN};
    for (std::size_t i = 1; i < h.time.size(); ++i) {
        const Real rate = 1e6 * (h.worn[i] - h.worn[i - 1]) / (h.time[i] - h.time[i - 1]);
        rates.push_back(rate > 0 ? rate : NAN);
    }
    return rates;
}

Real worn_at(const History& h, Real time) {
    std::size_t i = 0;
    while (h.time[i] < time - 1e-9) ++i;
    return h.worn[i];
}

void draw_rates(const std::filesystem::path& folder) {
    LineChart chart{
        .title = "Five hundred stones come to rest on concrete",
        .x = {.label = "time", .unit = "s", .min = 0.0, .max = end_time},
        .y = {.label = "wear rate", .unit = "cm3/s", .min = 1e-14, .max = 1e3, .logarithmic = true},
        .curves = {}};
    std::cout << "worn [mm3], of it in the last " << end_time - rest_from
              << " s, unchanged since [s], kinetic energy [J], asleep\n";
    const auto add = [&](const std::string& name, const History& h) {
        chart.curves.push_back({name, h.time, wear_rate(h)});
        std::cout << name << ": " << 1e9 * h.worn.back() << ", "
                  << 1e9 * (h.worn.back() - worn_at(h, rest_from)) << ", " << h.unchanged_since() << ", "
                  << h.kinetic.back() << ", " << h.asleep << std::endl;
    };
    add("cubic lattice that stands",
        lie({.slab = Slab::cubic, .sleep_speed = 0, .level = ConcreteLevel::quasi_static}, springs,
            end_time));
    add("cubic lattice, springs that resist twisting",
        lie({.slab = Slab::cubic, .sleep_speed = 0}, twist_springs, end_time));
    add("cubic lattice, springs; stones may sleep", lie({.slab = Slab::cubic}, springs, end_time));
    add("hexagonal lattice, springs; nothing resists rolling",
        lie({.rolling_friction = 0, .sleep_speed = 0}, springs, end_time));
    add("hexagonal lattice, springs", lie({.sleep_speed = 0}, springs, end_time));
    add("hexagonal lattice, springs; stones may sleep", lie({}, springs, end_time));
    add("cubic lattice, beams; stones may sleep", lie({.slab = Slab::cubic}, beams, end_time));
    draw(chart, folder / "03_static_deposit.png");
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/static_deposit";
        std::filesystem::create_directories(folder);
        draw_rates(folder);
        std::cout << "picture in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
