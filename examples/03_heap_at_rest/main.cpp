// Does a heap that lies still wear the concrete that carries it?
//
//   examples/run heap_at_rest [--out FOLDER]
//
// Problem. Sixty stones of three shapes fall gently on a slab of bonded spheres, come to rest, and lie there.
//
// Theory. Wear counts energy, not force. A contact at rest carries its load for ever and loses nothing:
//   dE = f . v dt -> 0 as v -> 0, however large f is.
// So once the heap has come to rest,
//   worn volume = constant, to the last bit;
//   vertical forces on slab and kerb = weight of the heap.
// Rest is an approach: friction holds, dashpots let what still swings die away, and kinetic energy falls by a
// constant factor per second until only round-off moves. The wear rate falls with it.

#include "../common/textbook.hpp"

#include <abrade/abrade.hpp>

#include <random>

using namespace abrade;
using namespace abrade::examples;

namespace {

constexpr Real coefficient = 1.1e-7, beta = 100;  // [m3/J], [-]
constexpr Real side = 0.48, diameter = 0.04;      // of the slab and of its spheres [m]
constexpr Real rest_from = 4, end_time = 6;       // [s]
constexpr std::uint32_t seed = 7;

Scene heap_above_concrete() {
    Scene scene;
    scene.concrete =
        ConcreteBlock{.lattice = flat_lattice(side, side, {.sphere_diameter = diameter, .layers = 2})};
    for (const Vec3& inward : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
        scene.add_wall(-0.5 * side * inward, inward);  // a kerb, for those that roll
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return std::generate_canonical<Real, 53>(random); };
    const auto turned = [&] {
        const Real w = uniform() - 0.5, x = uniform() - 0.5, y = uniform() - 0.5, z = uniform() - 0.5;
        return Quaternion(w, x, y, z).normalized();
    };
    for (int n = 0; n < 60; ++n) {
        const Vec3 place{0.07 * (n % 4 - 1.5), 0.07 * (n / 4 % 4 - 1.5), 0.045 + 0.07 * (n / 16)};
        const auto shape = static_cast<StoneShape>(n % 3);
        scene.add_stone(make_stone(shape, 0.035 + 0.02 * uniform()),
                        {.position = place, .orientation = turned()});
    }
    return scene;
}

/// What is looked at over time.
struct History {
    std::vector<Real> time, kinetic, worn, wear_rate, carried;  ///< [s], [J], [m3], [m3/s], [N]
    std::vector<Real> energy;                                   ///< kinetic, potential and elastic [J]
    std::vector<Vec3> at_rest;                                  ///< [sphere] positions at rest_from [m]
    Real weight = 0, all_forces = 0, moved = 0;                 ///< [N], [N], [m]

    void operator()(const auto& sim) {
        const Particles& p = sim.particles();
        Real vertical = 0;
        all_forces = 0;
        const auto is_stone = [&](Index body) {
            return body >= 0 && p.kind[static_cast<std::size_t>(body)] == Kind::stone;
        };
        sim.world().each_contact([&](Index first, Index second, const auto&, const auto& load) {
            all_forces += load.force.norm();
            if (is_stone(first) != is_stone(second)) vertical += (is_stone(first) ? 1 : -1) * load.force.z();
        });
        const Real worn_now = sim.concrete().worn_volume();
        const Real rate = time.empty() || sim.time() == time.back()
                              ? 0
                              : (worn_now - worn.back()) / (sim.time() - time.back());
        weight = 0;
        for (std::size_t b = 0; b < p.mass.size(); ++b)
            if (p.kind[b] == Kind::stone) weight += p.mass[b] * standard_gravity;
        const Ledger& e = sim.ledger();
        time.push_back(sim.time()), kinetic.push_back(e.kinetic);
        energy.push_back(e.kinetic + e.potential + e.stored_contacts + e.stored_bonds);
        worn.push_back(worn_now), wear_rate.push_back(rate);
        carried.push_back(vertical);
        if (sim.time() < rest_from)
            at_rest = p.centre;
        else
            for (std::size_t s = 0; s < at_rest.size(); ++s)
                moved = std::max(moved, (p.centre[s] - at_rest[s]).norm());
    }
};

void draw_history(const History& h, const OutputFolder& folder) {
    std::vector<Real> worn, carried, rate;
    for (std::size_t i = 0; i < h.time.size(); ++i) {
        worn.push_back(h.worn[i] / h.worn.back()), carried.push_back(h.carried[i] / h.weight);
        rate.push_back(h.wear_rate[i] > 0 ? 1e6 * h.wear_rate[i] : NAN);
    }
    const Axis time{.label = "time", .unit = "s", .min = 0.0, .max = end_time};
    draw(LineChart{.title = "A heap comes to rest",
                   .x = time,
                   .y = {.label = "of the final value", .min = 0.0, .max = 3.0},
                   .curves = {{"vertical force on slab and kerb / weight", h.time, carried},
                              {"worn volume / final", h.time, worn}}},
         folder.path("force_and_wear.png"));
    draw(
        LineChart{.title = "Motion dies away, and wear with it",
                  .x = time,
                  .y = {.label = "on a logarithmic scale", .min = 1e-27, .max = 1e3, .logarithmic = true},
                  .curves = {{"kinetic energy [J]", h.time, h.kinetic}, {"wear rate [cm3/s]", h.time, rate}}},
        folder.path("decay.png"));
}

void draw_heap(const Particles& p, const Concrete& concrete, const OutputFolder& folder) {
    CircleSet slab, stones{.title = "stones", .circles = {}, .colour = "#7a8b99", .outline = true};
    for (std::size_t s = 0; s < p.body.size(); ++s) {
        const auto b = static_cast<std::size_t>(p.body[s]);
        const Vec3& x = p.centre[s];
        if (p.kind[b] == Kind::stone)
            stones.circles.push_back({x.x(), x.z(), p.radius[s], 0});
        else if (std::abs(x.y()) < diameter)
            slab.circles.push_back({x.x(), x.z(), p.radius[s], 100 * concrete.fracture(p.site[b])});
    }
    draw(CirclePicture{.title = "The heap at rest, and the rows of concrete in the middle",
                       .x = {.label = "x", .unit = "m", .min = -0.5 * side, .max = 0.5 * side},
                       .y = {.label = "height", .unit = "m", .min = -2 * diameter, .max = 0.12},
                       .colour = {.label = "fracture rate", .unit = "%", .min = 0.0},
                       .sets = {slab, stones}},
         folder.path("heap.png"));
}

Summary heap_at_rest(const OutputFolder& folder) {
    auto sim = simulate(heap_above_concrete())
                   .contact(LinearSpring{{.stiffness = 3e5, .restitution = 0.5, .friction = 0.6}})
                   .bond(MohrCoulomb{{.tensile = 2.7e6, .stiffness = 3e5}})
                   .wear(SubParticleAbrasion{{.coefficient = coefficient, .acceleration = beta}});
    History h;
    sim.run({.end_time = end_time, .observe_every = 0.02}, [&](const auto& now) { h(now); });
    draw_history(h, folder);
    draw_heap(sim.particles(), sim.concrete(), folder);

    // Since when has the worn volume been what it is now, to the last bit?
    std::size_t last_change = h.worn.size() - 1;
    while (last_change > 0 && h.worn[last_change - 1] == h.worn.back()) --last_change;
    Real worn_at_rest = 0, fastest_at_rest = 0, energy_at_rest = 0;
    for (std::size_t i = 0; i < h.time.size(); ++i)
        if (h.time[i] < rest_from)
            worn_at_rest = h.worn[i], energy_at_rest = h.energy[i];
        else
            fastest_at_rest = std::max(fastest_at_rest, h.wear_rate[i]);
    const Ledger& e = sim.ledger();
    const Real from_energy = coefficient * beta * 0.5 * (e.concrete_lost_normal + e.concrete_lost_sliding);
    return {{"seed", seed},
            {"stones", 60},
            {"simulated_s", sim.time()},
            {"time_step_s", sim.time_step()},
            {"worn_volume_mm3", 1e9 * h.worn.back()},
            {"worn_volume_from_energy_mm3", 1e9 * from_energy},
            {"worn_volume_error_relative", relative_error(h.worn.back(), from_energy)},
            {"bonds_broken", sim.bonds_broken()},
            {"rest_from_s", rest_from},
            {"worn_since_rest_mm3", 1e9 * (h.worn.back() - worn_at_rest)},
            // Half of what energy has been lost since goes into the concrete, at most.
            {"wearable_at_rest_mm3", 1e9 * coefficient * beta * 0.5 * (energy_at_rest - h.energy.back())},
            {"worn_unchanged_for_s", end_time - h.time[last_change]},
            {"max_wear_rate_at_rest_mm3_per_s", 1e9 * fastest_at_rest},
            {"end_wear_rate_mm3_per_s", 1e9 * h.wear_rate.back()},
            {"max_displacement_since_rest_m", h.moved},
            {"kinetic_J", e.kinetic},
            {"weight_N", h.weight},
            {"carried_N", h.carried.back()},
            {"carried_error_relative", relative_error(h.carried.back(), h.weight)},
            {"sum_of_contact_forces_N", h.all_forces},
            {"energy_lost_normal_J", e.lost_normal},
            {"energy_lost_sliding_J", e.lost_sliding},
            {"energy_lost_in_bonds_J", e.lost_bond},
            {"integration_residue_J", e.integration_residue()},
            {"integration_residue_relative", std::abs(e.integration_residue()) / e.throughput()},
            {"ledger_residual_relative", e.residual_relative()}};
}

}  // namespace

int main(int argc, char** argv) {
    return textbook_main(argc, argv, "03_heap_at_rest", "A heap at rest on concrete", heap_at_rest);
}
