// Whether wear depends on the stone or on how the concrete is cut and reckoned; draws the pictures of
// docs/convergence.md on that, prints its tables and writes summary.json: chart_wear_mesh [FOLDER].
//
// Its runs take a quarter of an hour. What they gave is kept in FOLDER as wear_mesh.csv, and taken from there
// the next time.

#include "../../examples/common/charts.hpp"
#include "patch_runs.hpp"

#include <nlohmann/json.hpp>

#include <iomanip>
#include <iostream>

using namespace abrade;
using namespace abrade::charts;
using namespace abrade::examples;

namespace {

// --- drops of a sphere, one at a time ---------------------------------------------------------------

/// How the slab answers.
struct Slab {
    std::string title;
    ConcreteLevel level = ConcreteLevel::quasi_static;
    Real bond_over_contact = 1;  ///< stiffness [-]
    bool dashpot = false;
};

constexpr Real contact_stiffness = 2e7;  ///< [N/m]
constexpr int poses = 50;

/// Share of its energy that a sphere loses in the contact, mean over poses; negative where something
/// loosened.
Real share_lost(const Slab& slab, Real sphere_diameter, Real stone, Real speed) {
    Real sum = 0;
    for (int n = 0; n < poses; ++n) {
        Scene scene;
        scene.gravity.setZero();
        const Real side = std::max(6 * sphere_diameter, 0.12);
        scene.concrete = ConcreteBlock{
            .lattice = flat_lattice(side, side, {.sphere_diameter = sphere_diameter, .layers = 3}),
            .level = slab.level};
        // Points that fill one cell evenly (the golden ratio of two dimensions).
        const Real a = 0.7548776662466927 * n, b = 0.5698402909980532 * n;
        const Vec3 at((a - std::floor(a) - 0.5) * sphere_diameter,
                      (b - std::floor(b) - 0.5) * sphere_diameter, 0.5 * stone + 1e-4);
        scene.add_sphere(0.5 * stone, {.position = at, .velocity = {0, 0, -speed}});
        const Real energy = 0.5 * 2650 * pi / 6 * cube(stone) * square(speed);
        const auto lost = [&](auto sim) {
            // As long as ten contacts; a stone may sit in a hollow and touch several spheres one after the
            // other.
            const Real contact_time = pi * std::sqrt(2650 * pi / 6 * cube(stone) / contact_stiffness);
            sim.run({.end_time = 1e-3 / speed + 10 * contact_time + 0.3 * sphere_diameter / speed,
                     .safety = 0.2});
            return sim.ledger().concrete_lost_normal / energy;
        };
        const MohrCoulomb bond{{.tensile = 1e12, .stiffness = slab.bond_over_contact * contact_stiffness}};
        if (slab.dashpot)
            sum += lost(simulate(scene)
                            .contact(LinearSpring{{.stiffness = contact_stiffness, .restitution = 0.6}})
                            .bond(bond));
        else
            sum += lost(simulate(scene)
                            .contact(LinearHysteretic{{.stiffness = contact_stiffness, .restitution = 0.6}})
                            .bond(bond));
    }
    return sum / poses;
}

struct DropTable {
    Real stiff_against_static = 0;  ///< largest relative difference
    Real size_against_size = 0;     ///< of 0.02 and 0.01 m, static
};

DropTable drops(const std::filesystem::path& folder) {
    DropTable found;
    const std::vector<Slab> slabs{{"static"},
                                  {"rigid", ConcreteLevel::rigid},
                                  {"dynamic, bonds x64", ConcreteLevel::dynamic, 64},
                                  {"dynamic, bonds x1", ConcreteLevel::dynamic, 1},
                                  {"dynamic, bonds x1, dashpot", ConcreteLevel::dynamic, 1, true}};
    std::cout << "## Share of its energy that a sphere loses, e = 0.6; on a plane " << 1 - square(0.6)
              << "\n\n| stone, speed | concrete's spheres |";
    for (const Slab& slab : slabs) std::cout << " " << slab.title << " |";
    std::cout << "\n|---|---|";
    for (std::size_t n = 0; n < slabs.size(); ++n) std::cout << "---|";
    std::cout << "\n";
    std::vector<Curve> curves;
    for (const Slab& slab : slabs)
        for (const Real d : {0.01, 0.02})
            curves.push_back({.title = slab.title + ", " + to_text(1e3 * d) + " mm", .x = {}, .y = {}});
    for (const Real stone : {0.02, 0.05, 0.1})
        for (const Real speed : {0.5, 2.0}) {
            std::array<Real, 2> standing{};
            for (const std::size_t size : {0, 1}) {
                const Real d = size == 0 ? 0.01 : 0.02;
                std::cout << "| " << stone << " m, " << speed << " m/s | " << d << " m |";
                for (std::size_t n = 0; n < slabs.size(); ++n) {
                    const Real share = share_lost(slabs[n], d, stone, speed);
                    std::cout << " " << std::setprecision(4) << share << " |" << std::flush;
                    if (n == 0) standing[size] = share;
                    if (n == 2)
                        found.stiff_against_static =
                            std::max(found.stiff_against_static, std::abs(share / standing[size] - 1));
                    if (speed == 2.0) {
                        curves[2 * n + size].x.push_back(stone);
                        curves[2 * n + size].y.push_back(share);
                    }
                }
                std::cout << "\n";
            }
            found.size_against_size =
                std::max(found.size_against_size, std::abs(standing[0] / standing[1] - 1));
        }
    curves.push_back({.title = "plane", .x = {0.02, 0.1}, .y = {0.64, 0.64}, .style = CurveStyle::dashed});
    draw(LineChart{.title = "Share of its energy that a sphere loses at 2 m/s, e = 0.6",
                   .x = {.label = "diameter of the stone", .unit = "m"},
                   .y = {.label = "share lost in impacts", .unit = "-", .min = 0.0},
                   .curves = curves},
         folder / "wear_mesh_drops.png");
    return found;
}

// --- the struck patch ---------------------------------------------------------------------------------

Patch struck(Real sphere_diameter, ConcreteLevel level, Real bond_over_contact = 1) {
    Patch patch{.stones = 160, .dashpot = false, .level = level};
    patch.lattice = {.sphere_diameter = sphere_diameter,
                     .layers = static_cast<Index>(std::lround(0.06 / sphere_diameter))};
    patch.bond.stiffness = bond_over_contact * patch.contact.stiffness;
    patch.wear.acceleration = 1;  // nothing wears out: the same bed for all
    return patch;
}

Real patches(PatchRuns& runs) {
    struct Row {
        std::string label;
        Patch patch;
        int seeds;
    };
    const std::vector<Row> rows{
        {"static, 0.02 m", struck(0.02, ConcreteLevel::quasi_static), 8},
        {"static, 0.01 m", struck(0.01, ConcreteLevel::quasi_static), 8},
        {"rigid, 0.02 m", struck(0.02, ConcreteLevel::rigid), 8},
        {"rigid, 0.01 m", struck(0.01, ConcreteLevel::rigid), 8},
        {"dynamic, bonds x64, 0.02 m", struck(0.02, ConcreteLevel::dynamic, 64), 2},
    };
    std::cout << "\n## A patch that stones strike and slide over\n\n| concrete | worn, mm3 a stone | lost in "
                 "impacts, mJ "
                 "| in sliding, mJ | seeds |\n|---|---|---|---|---|\n";
    Real least = 1e300, most = 0;
    for (const Row& row : rows) {
        runs.make(row.label, row.patch, row.seeds);
        const Statistics s = runs.of(row.label);
        std::cout << "| " << row.label << std::setprecision(4) << " | " << 1e9 * s.mean.worn << " +- "
                  << 1e9 * s.standard_error(&PatchAnswers::worn) << " | " << 1e3 * s.mean.lost_normal
                  << " +- " << 1e3 * s.standard_error(&PatchAnswers::lost_normal) << " | "
                  << 1e3 * s.mean.lost_sliding << " +- "
                  << 1e3 * s.standard_error(&PatchAnswers::lost_sliding) << " | " << s.seeds << " |\n";
        least = std::min(least, s.mean.worn), most = std::max(most, s.mean.worn);
    }
    return most / least - 1;
}

// --- few collisions that wear much, or many that wear little -------------------------------------------

Real against_truth(PatchRuns& runs, const std::filesystem::path& folder) {
    constexpr Real product = 40'000;  // beta times stones: about two cells of 0.01 m
    const auto setting = [&](Real beta, const Overflow& overflow) {
        Patch patch = struck(0.01, ConcreteLevel::quasi_static);
        patch.lattice.layers = 12;
        patch.stones = static_cast<int>(product / beta);
        patch.worn_out = WornOut::fines, patch.overflow = overflow;
        patch.wear.acceleration = beta;
        return patch;
    };
    struct Way {
        std::string title;
        Overflow overflow;
    };
    const std::vector<Way> ways{{"crater", FillCrater{}},
                                {"patch", SpreadOverPatch{.length = 0.05, .width = 0.05}},
                                {"epoch", SpreadByEpoch{.length = 0.08, .every = 0.3}},
                                {"dropped", DropOverflow{}}};
    runs.make("truth, beta 1", setting(1, FillCrater{}), 1);
    const PatchAnswers truth = runs.of("truth, beta 1").mean;
    const auto impact = [](const PatchAnswers& a) { return a.lost_normal / a.lost(); };
    const auto worn = [](const PatchAnswers& a, Real beta) { return (a.worn + a.detached) / beta; };
    std::cout << "\n## Against many collisions that wear little: beta 1, " << truth.fed
              << " stones, largest share " << truth.share
              << "\n\n| way | beta | taken off | impact share | deepest square | largest share | seeds "
                 "|\n|---|---|---|---|---|---|---|\n";
    std::vector<Curve> curves;
    Real error = 0;
    for (const Way& way : ways) {
        Curve& curve = curves.emplace_back(Curve{.title = way.title, .x = {1}, .y = {1}});
        for (const Real beta : {10.0, 100.0, 1000.0, 5000.0}) {
            const std::string label = way.title + ", beta " + to_text(beta);
            runs.make(label, setting(beta, way.overflow), beta < 50 ? 3 : beta < 500 ? 8 : 16);
            const Statistics s = runs.of(label);
            const Real off = worn(s.mean, beta) / worn(truth, 1), share = impact(s.mean) / impact(truth);
            std::cout << "| " << way.title << " | " << beta << " | " << off << " +- "
                      << (s.standard_error(&PatchAnswers::worn) + s.standard_error(&PatchAnswers::detached)) /
                             beta / worn(truth, 1)
                      << " | " << share << " | "
                      << s.mean.max_depth * s.mean.fed / (truth.max_depth * truth.fed) << " | "
                      << s.mean.share << " | " << s.seeds << " |\n";
            curve.x.push_back(beta), curve.y.push_back(off);
            if (way.title == "crater" && beta == 10) error = std::max(std::abs(off - 1), std::abs(share - 1));
        }
    }
    draw(LineChart{.title = "Volume taken off, over that at beta = 1",
                   .x = {.label = "time acceleration beta", .unit = "-", .logarithmic = true},
                   .y = {.label = "over beta = 1", .unit = "-", .min = 0.0},
                   .curves = curves},
         folder / "wear_mesh_beta.png");
    return error;
}

}  // namespace

int main(int argc, char** argv) {
    const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/wear_mesh";
    std::filesystem::create_directories(folder);
    PatchRuns runs(folder / "wear_mesh.csv");
    const DropTable drop = drops(folder);
    const Real patch = patches(runs), truth = against_truth(runs, folder);
    const nlohmann::ordered_json summary{{"impact_loss_spread_relative", drop.stiff_against_static},
                                         {"impact_loss_size_spread_relative", drop.size_against_size},
                                         {"patch_worn_spread_relative", patch},
                                         {"beta_truth_error_relative", truth}};
    std::ofstream(folder / "summary.json") << summary.dump(2) << "\n";
    std::cout << "\n" << summary.dump(2) << "\n";
}
