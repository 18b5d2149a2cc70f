// Draws the pictures of docs/verification/multi_rate.md and prints its tables: chart_multi_rate [FOLDER [RUNS]]. The
// folder is made where it is not; of RUNS runs, three if not said, the fastest counts.

#include "../../examples/common/charts.hpp"

#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <random>

using namespace abrade;
using namespace abrade::examples;

namespace {

constexpr Real radius = 0.01;

/// Each component within half a period.
Vec3 nearest(Vec3 apart, const Vec3& period) {
    for (int a = 0; a < 3; ++a)
        if (period[a] > 0) apart[a] -= period[a] * std::round(apart[a] / period[a]);
    return apart;
}

struct Difference {
    Real largest = 0, mean = 0;  ///< [m]
};
Difference difference(const Particles& a, const Particles& b, const Vec3& period) {
    Difference d;
    for (std::size_t i = 0; i < a.position.size(); ++i) {
        const Real apart = nearest(a.position[i] - b.position[i], period).norm();
        d.largest = std::max(d.largest, apart), d.mean += apart / static_cast<Real>(a.position.size());
    }
    return d;
}

// --- free flight ------------------------------------------------------------------------------------

const LinearSpring gas_law{{.stiffness = 1e5, .restitution = 0.9, .friction = 0.3}};

/// 4096 spheres that fill this share of periodic space, thrown about at 1 m/s.
Scene gas(Real share) {
    constexpr int side = 16;
    const Real apart = std::cbrt(4 * pi / 3 * cube(radius) / share), half = 0.5 * side * apart;
    std::mt19937 random(7);
    const auto uniform = [&] { return std::uniform_real_distribution<Real>(-1, 1)(random); };
    Scene scene;
    scene.gravity.setZero();
    scene.periodic_along = {true, true, true};
    scene.bounds = {Vec3::Constant(-half), Vec3::Constant(half)};
    for (int n = 0; n < side * side * side; ++n) {
        const Vec3 cell(n % side + 0.5, n / side % side + 0.5, n / side / side + 0.5);
        scene.add_sphere(radius, {.position = apart * cell - Vec3::Constant(half),
                                  .velocity = {uniform(), uniform(), uniform()}});
    }
    return scene;
}

struct Flight {
    Real share, on, off;  ///< [-], [s] per body and step
    Difference change;
    Real energy, residual;  ///< change of the kinetic energy [-], the larger ledger residual [-]
};

Flight fly(Real share, int runs) {
    constexpr Index steps = 4000;
    constexpr Real dt = 2e-5;
    Flight f{share, 1e300, 1e300, {}, 0, 0};
    for (int run = 0; run < runs; ++run) {
        auto on = simulate(gas(share)).contact(gas_law), off = simulate(gas(share)).contact(gas_law);
        on.run({.end_time = steps * dt, .time_step = dt});
        off.run({.end_time = steps * dt, .time_step = dt, .free_flight = false});
        const Real per = 1.0 / steps / on.particles().bodies();
        f.on = std::min(f.on, on.wall_seconds() * per), f.off = std::min(f.off, off.wall_seconds() * per);
        const Box& space = on.world().scene().bounds;
        f.change = difference(on.particles(), off.particles(), space.high - space.low);
        f.energy = std::abs(on.ledger().kinetic / off.ledger().kinetic - 1);
        f.residual = std::max(on.ledger().residual_relative(), off.ledger().residual_relative());
    }
    return f;
}

// --- sleep ------------------------------------------------------------------------------------------

const LinearSpring bed_law{{.stiffness = 5e4, .restitution = 0.3, .friction = 0.5}};
constexpr Real width = 0.48, settled = 1, end = 3, between = 1, step = 2e-5;

/// Three layers of spheres on a rigid concrete floor; from `settled` on, one more falls on them every
/// `between` seconds.
Scene bed() {
    Scene scene;
    scene.periodic_along = {true, true, false};
    scene.bounds = {{-0.5 * width, -0.5 * width, -1}, {0.5 * width, 0.5 * width, 2}};
    scene.concrete = ConcreteBlock{flat_lattice(width, width, {.layers = 1})};
    std::mt19937 random(5);
    const auto uniform = [&] { return std::uniform_real_distribution<Real>(-1, 1)(random); };
    for (int n = 0; n < 3 * 22 * 22; ++n)
        scene.add_sphere(radius, {.position = {0.0217 * (n % 22 - 10.5) + 5e-4 * uniform(),
                                               0.0217 * (n / 22 % 22 - 10.5) + 5e-4 * uniform(),
                                               0.0105 + 0.0205 * (n / 484)}});
    scene.feed = FeedParams{.volume_rate = 4 * pi / 3 * cube(radius) / between,
                            .classes = {{2 * radius, 1, StoneShape::sphere}},
                            .region = {{-0.5 * width, -0.5 * width, 0.12}, {0.5 * width, 0.5 * width, 0.15}},
                            .velocity = {0.5, 0, -1},
                            .start = settled - 0.9 * between};
    return scene;
}

struct Rest {
    Real speed, wall = 1e300, awake = 0;  ///< [m/s], [s], share of bodies [-]
    Difference change{};
    Real lost = 0, concrete = 0, asleep = 0, residual = 0;  ///< [J], the last one [-]
    Particles particles{};
};

/// Goes on from a bed that has settled.
template <class Sim>
Rest rest(const Sim& from, Real speed, int runs, Real time_step = step) {
    Rest out{.speed = speed};
    for (int run = 0; run < runs; ++run) {
        Sim sim = from;
        const Real before = sim.wall_seconds();
        const Ledger start = sim.ledger();
        Real awake = 0;
        int seen = 0;
        sim.run({.end_time = end, .time_step = time_step, .observe_every = 0.01, .sleep_speed = speed},
                [&](const auto& now) {
                    const auto& p = now.particles();
                    const auto free = p.bodies() - now.concrete().sites();
                    awake += 1 - static_cast<Real>(now.world().state().sleep.count) / static_cast<Real>(free);
                    ++seen;
                    out.residual = std::max(out.residual, now.ledger().residual_relative());
                });
        const Ledger& e = sim.ledger();
        out.wall = std::min(out.wall, sim.wall_seconds() - before), out.awake = awake / seen;
        out.lost = e.lost() - start.lost(), out.asleep = e.lost_asleep;
        out.concrete = e.concrete_lost_normal + e.concrete_lost_sliding - start.concrete_lost_normal -
                       start.concrete_lost_sliding;
        out.particles = sim.particles();
    }
    return out;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/multi_rate";
        const int runs = argc > 2 ? std::stoi(argv[2]) : 3;
        std::filesystem::create_directories(folder);

        Curve on{.title = "free flight", .x = {}, .y = {}}, off{.title = "every step", .x = {}, .y = {}};
        std::ofstream flights(folder / "free_flight.csv");
        flights << "solid_share,on_ns,off_ns,largest_difference_m,energy_difference,residual\n";
        std::cout
            << "| solid share | every step, ns | free flight, ns | saved | largest difference, m | energy | "
               "residual |\n|---|---|---|---|---|---|---|\n";
        for (const Real share : {1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.3}) {
            const Flight f = fly(share, runs);
            flights << to_text(f.share) << ',' << 1e9 * f.on << ',' << 1e9 * f.off << ',' << f.change.largest
                    << ',' << f.energy << ',' << f.residual << '\n';
            std::cout << std::setprecision(3) << "| " << f.share << " | " << 1e9 * f.off << " | "
                      << 1e9 * f.on << " | " << std::round(100 * (1 - f.on / f.off)) << " % | "
                      << f.change.largest << " | " << f.energy << " | " << f.residual << " |" << std::endl;
            on.x.push_back(share), on.y.push_back(1e9 * f.on);
            off.x.push_back(share), off.y.push_back(1e9 * f.off);
        }
        draw(LineChart{.title = "Free flight: wall time for each body and step",
                       .x = {.label = "share of space that is solid", .unit = "", .logarithmic = true},
                       .y = {.label = "wall time", .unit = "ns", .min = 0},
                       .curves = {off, on}},
             folder / "multi_rate_flight.png");

        auto from = simulate(bed()).contact(bed_law).wear(SubParticleAbrasion{{.coefficient = 1e-7}});
        from.run({.end_time = settled, .time_step = step});
        const Vec3 period(width, width, 0);
        const Rest awake = rest(from, 0, runs);
        Curve wall{.title = "wall time", .x = {}, .y = {}}, share{.title = "awake, mean", .x = {}, .y = {}},
            moved{.title = "mean difference in place at the end", .x = {}, .y = {}},
            other{.title = "the same of a time step 5 % smaller, nobody asleep",
                  .x = {},
                  .y = {},
                  .style = CurveStyle::dashed};
        std::ofstream sleeps(folder / "sleep.csv");
        sleeps << "speed_m_s,wall_s,awake,mean_difference_m,largest_difference_m,lost_J,concrete_lost_J,"
                  "lost_asleep_J,residual\n";
        std::cout << "\n| sleep_speed, m/s | wall time, s | awake | mean difference, mm | largest, mm | "
                     "lost, J | on concrete, J | lost_asleep, J | residual |\n"
                     "|---|---|---|---|---|---|---|---|---|\n";
        const auto show = [&](const Rest& r, const std::string& name, const Difference& d) {
            sleeps << name << ',' << r.wall << ',' << r.awake << ',' << d.mean << ',' << d.largest << ','
                   << r.lost << ',' << r.concrete << ',' << r.asleep << ',' << r.residual << '\n';
            std::cout << std::setprecision(4) << "| " << name << " | " << r.wall << " | "
                      << std::round(100 * r.awake) << " % | " << 1e3 * d.mean << " | " << 1e3 * d.largest
                      << " | " << r.lost << " | " << r.concrete << " | " << r.asleep << " | " << r.residual
                      << " |" << std::endl;
        };
        show(awake, "0", {});
        const Rest finer = rest(from, 0, 1, 0.95 * step);
        const Difference yardstick = difference(finer.particles, awake.particles, period);
        show(finer, "0, step 5 % smaller", yardstick);
        for (const Real speed : {1e-4, 1e-3, 3e-3, 1e-2}) {
            const Rest r = rest(from, speed, runs);
            const Difference d = difference(r.particles, awake.particles, period);
            show(r, to_text(speed), d);
            wall.x.push_back(speed), wall.y.push_back(100 * r.wall / awake.wall);
            share.x.push_back(speed), share.y.push_back(100 * r.awake);
            moved.x.push_back(speed), moved.y.push_back(1e6 * d.mean);
            other.x.push_back(speed), other.y.push_back(1e6 * yardstick.mean);
        }
        draw(
            LineChart{
                .title = "A bed on which a stone falls every second: what sleep saves",
                .x = {.label = "sleep_speed", .unit = "m/s", .max = 1e-2, .logarithmic = true},
                .y = {.label = "share of the run with everybody awake", .unit = "%", .min = 0, .max = 110},
                .curves = {wall, share}},
            folder / "multi_rate_saved.png");
        draw(LineChart{.title = "The same bed: what sleep changes",
                       .x = {.label = "sleep_speed", .unit = "m/s", .max = 1e-2, .logarithmic = true},
                       .y = {.label = "mean difference in place", .unit = "um", .min = 0},
                       .curves = {moved, other}},
             folder / "multi_rate_changed.png");
        std::cout << "\npictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
