// Draws the pictures of docs/verification/ledger.md: chart_ledger [FOLDER], which is made where it is not.

#include "../../examples/common/charts.hpp"
#include "../../tests/verification/ledger_scenes.hpp"

#include <iostream>

using namespace ledger_scenes;
using namespace abrade::examples;

namespace {

constexpr LinearSpring::Params gas_linear{.stiffness = 5e5, .restitution = 0.8, .friction = 0.3},
    bed_linear{.stiffness = 5e5, .restitution = 0.5, .friction = 0.5};
constexpr HertzMindlin::Params gas_hertz{.youngs = 5e8, .restitution = 0.8, .friction = 0.3},
    bed_hertz{.youngs = 5e8, .restitution = 0.5, .friction = 0.5};

struct History {
    std::vector<Real> time, steps, residual, residue;  ///< [s], [-], [-], of what was lost in the end [-]
    long begun = 0;
};
template <ContactLaw Law>
History follow(const Scene& scene, const typename Law::Params& params, Real end_time, Real safety) {
    const Counted<Law> law(params);
    auto sim = simulate(scene).contact(law);
    History h;
    sim.run({.end_time = end_time, .safety = safety, .observe_every = end_time / 100}, [&](const auto& now) {
        if (now.steps() == 0) return;
        const Ledger& e = now.ledger();
        h.time.push_back(now.time()), h.steps.push_back(now.steps());
        h.residual.push_back(std::max(e.residual_relative(), 1e-18));
        h.residue.push_back(std::abs(e.integration_residue()));
    });
    for (Real& r : h.residue) r /= sim.ledger().lost();
    h.begun = law.begun();
    std::cout << Law::name << ", safety " << safety << ": " << sim.steps() << " steps, " << h.begun
              << " contacts began, kinetic energy left " << sim.ledger().kinetic / sim.ledger().throughput()
              << ", residual at most " << *std::max_element(h.residual.begin(), h.residual.end())
              << ", integration residue " << h.residue.back() << " of the energy lost\n";
    return h;
}

void scenes(const std::filesystem::path& folder) {
    struct Case {
        std::string title;
        std::function<History(Real)> run;
    };
    const Case cases[] = {
        {"gas, LinearSpring", [](Real s) { return follow<LinearSpring>(gas(11), gas_linear, 0.6, s); }},
        {"gas, HertzMindlin", [](Real s) { return follow<HertzMindlin>(gas(11), gas_hertz, 0.6, s); }},
        {"bed, LinearSpring", [](Real s) { return follow<LinearSpring>(bed(3, 4), bed_linear, 1.0, s); }},
        {"bed, HertzMindlin", [](Real s) { return follow<HertzMindlin>(bed(3, 4), bed_hertz, 1.0, s); }}};
    const std::vector<Real> safeties{0.1, 0.2, 0.5, 0.8};
    std::vector<Curve> residual, residue;
    for (const Case& c : cases) {
        std::cout << c.title << "\n";
        Curve over_step{.title = c.title};
        for (const Real safety : safeties) {
            const History h = c.run(safety);
            over_step.x.push_back(safety), over_step.y.push_back(100 * h.residue.back());
            if (safety == 0.5) residual.push_back({.title = c.title, .x = h.steps, .y = h.residual});
        }
        residue.push_back(over_step);
    }
    residual.push_back({.title = "gate", .x = {0, 6e4}, .y = {1e-12, 1e-12}, .style = CurveStyle::dashed});
    residue.push_back(
        {.title = "second order", .x = {0.1, 0.8}, .y = {1e-2, 64e-2}, .style = CurveStyle::dashed});
    draw(LineChart{.title = "Residual of the ledger: round-off",
                   .x = {.label = "steps", .min = 0, .max = 6e4},
                   .y = {.label = "residual / energy that passed through",
                         .min = 1e-18,
                         .max = 1e-11,
                         .logarithmic = true},
                   .curves = residual},
         folder / "verification_ledger_residual.png");
    draw(LineChart{.title = "Integration residue: the square of the step",
                   .x = {.label = "time step / stable step", .min = 0.08, .max = 1, .logarithmic = true},
                   .y = {.label = "integration residue / energy lost", .unit = "%", .logarithmic = true},
                   .curves = residue},
         folder / "verification_ledger_residue.png");
}

/// A million steps without damping.
struct Walk {
    std::vector<Real> step, energy, deviation;  ///< [1e6 steps], [-], [-]
};
template <ContactLaw Law>
Walk walk(const Scene& scene, const typename Law::Params& params, Real safety) {
    const Counted<Law> law(params);
    auto sim = simulate(scene).contact(law);
    sim.run({.end_time = 0});
    const Real dt = safety * sim.stable_time_step().seconds;
    constexpr int steps = 1'000'000;
    Walk w;
    sim.run({.end_time = steps * dt, .time_step = dt, .observe_every = steps / 1000 * dt},
            [&](const auto& now) {
                const Ledger& e = now.ledger();
                w.step.push_back(1e-6 * now.steps());
                w.energy.push_back(100 *
                                   ((e.kinetic + e.stored_contacts - e.stored_start) / e.kinetic_start - 1));
                if constexpr (std::same_as<Law, LinearSpring>)
                    w.deviation.push_back(100 * params.stiffness * dt * dt * std::sqrt(law.speed4() / 360) /
                                          e.kinetic_start);
            });
    Real farthest = 0;
    for (const Real e : w.energy) farthest = std::max(farthest, std::abs(e));
    std::cout << Law::name << ", safety " << safety << ": " << law.begun() << " contacts began, energy "
              << farthest << " % away at most, one standard deviation "
              << (w.deviation.empty() ? 0 : w.deviation.back()) << " %, residual "
              << sim.ledger().residual_relative() << "\n";
    return w;
}

void undamped(const std::filesystem::path& folder) {
    const Axis steps{.label = "steps", .unit = "millions", .min = 0, .max = 1};
    std::vector<Curve> inside;
    for (const Real safety : {0.5, 0.25, 0.125}) {
        const Walk w = walk<LinearSpring>(squeezed(), {.stiffness = 5e5}, safety);
        inside.push_back(
            {.title = "step " + to_text(safety) + " of the stable one", .x = w.step, .y = w.energy});
    }
    draw(LineChart{.title = "Eight elastic spheres that never part: no drift",
                   .x = steps,
                   .y = {.label = "energy less that of the start", .unit = "% of the kinetic energy"},
                   .curves = inside},
         folder / "verification_ledger_squeezed.png");
    const Walk linear = walk<LinearSpring>(handful(), {.stiffness = 5e5}, 0.2),
               finer = walk<LinearSpring>(handful(), {.stiffness = 5e5}, 0.1),
               hertz = walk<HertzMindlin>(handful(), {.youngs = 5e8}, 0.2);
    Band band{
        .title = "one standard deviation, theory, step 0.2", .x = linear.step, .high = linear.deviation};
    for (const Real d : linear.deviation) band.low.push_back(-d);
    draw(LineChart{.title = "Five elastic spheres that meet and part: a random walk",
                   .x = steps,
                   .y = {.label = "energy less that of the start", .unit = "%"},
                   .curves = {{.title = "LinearSpring, step 0.2 of the stable one",
                               .x = linear.step,
                               .y = linear.energy},
                              {.title = "LinearSpring, 0.1", .x = finer.step, .y = finer.energy},
                              {.title = "HertzMindlin, 0.2", .x = hertz.step, .y = hertz.energy}},
                   .bands = {band}},
         folder / "verification_ledger_walk.png");
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/ledger";
        std::filesystem::create_directories(folder);
        scenes(folder), undamped(folder);
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
