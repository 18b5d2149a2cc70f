// How much concrete does a stone wear off when it is dropped, again and again?
//
//   examples/run drop_on_concrete [--out FOLDER]
//
// Problem. A sphere falls from a height h on a slab of bonded spheres, is caught on its way up, and the next
// one falls on the same spot. Which way does the energy m g h go, and what does it wear?
//
// Theory. Of what the contact loses, half goes into the concrete and wears it at C_w beta:
//   worn = C_w beta 1/2 (energy lost in concrete contacts)                      exact, to round-off
// On rigid concrete the contact loses 1 - e^2 of the energy that the sphere brings:
//   worn = C_w beta 1/2 m g h (1 - e^2)                                         linear in h, n, m and beta
// On bonded concrete a part of it goes off as waves, and ends in the dashpots of the bonds:
//   m g h = lost in the contact + lost in bonds + carried away by the rebound
// A contact that loses by a dent (LinearHysteretic) loses 1 - e^2 of what it takes up, whatever the masses
// are. One with a dashpot (LinearSpring) is that of two free bodies: it counts with m_eff of the sphere and
// the one concrete sphere that it hits, as if no bonds held that. On a stiff slab this makes the damping
// ratio
//   zeta' = zeta sqrt(m_eff / m),   and e' = e(zeta') > e.

#include "../common/textbook.hpp"

#include <abrade/abrade.hpp>

using namespace abrade;
using namespace abrade::examples;

namespace {

constexpr Real coefficient = 1.1e-7, radius = 0.025, concrete_diameter = 0.02, concrete_density = 2400;
constexpr Real restitution = 0.6, stiffness = 2e6;  // of the contact [-], [N/m]
constexpr Real interval = 0.008;                    // from drop to drop; a contact lasts 1 ms [s]

struct Case {
    Real height = 0.05;   ///< [m]
    Real density = 2650;  ///< of the sphere [kg/m3]
    Real beta = 100;      ///< time acceleration [-]
    int drops = 1;
    Real bond_stiffness = 64 * stiffness;  ///< [N/m]; 0: rigid concrete
    bool dashpot = false;                  ///< else contacts lose by a dent
    Real mass() const { return density * 4.0 / 3 * pi * cube(radius); }
    Real brought() const { return mass() * standard_gravity * height; }  ///< by each drop [J]
};

struct Outcome {
    Ledger ledger;
    std::vector<Real> worn;  ///< after each drop [m3]
    Real rebound = 0, fracture_rate = 0, worn_from_energy = 0, wear_error = 0;
    Index bonds_broken = 0;
};

/// x points up, so that the outlet, which takes out what passes its x, catches the sphere on its way up.
Scene scene_of(const Case& c) {
    Lattice slab = flat_lattice(0.14, 0.14, {.sphere_diameter = concrete_diameter, .layers = 3});
    for (LatticeSite& site : slab.sites) std::swap(site.centre.x(), site.centre.z());
    constexpr Real gap = 1e-4;  // the fall down to here is free flight, and known
    constexpr Real half = radius * (1 + 1e-9);
    Scene scene;
    scene.gravity = {-standard_gravity, 0, 0};
    scene.concrete = ConcreteBlock{.lattice = slab, .density = concrete_density};
    scene.outlet = radius + 2 * gap;
    const Real volume = 4.0 / 3 * pi * cube(radius);
    scene.feed = FeedParams{.volume_rate = volume / interval,
                            .classes = {{.size = 2 * radius, .fraction = 1}},
                            .density = c.density,
                            .region = {{gap, -half, -half}, {gap + 2 * half, half, half}},
                            .velocity = {-std::sqrt(2 * standard_gravity * (c.height - gap)), 0, 0},
                            .start = -0.9 * interval};
    return scene;
}

template <class Sim>
Outcome run(Sim sim, const Case& c) {
    Outcome out;
    sim.run({.end_time = c.drops * interval, .time_step = 2e-6, .observe_every = interval},
            [&](const Sim& now) {
                if (now.steps() > 0) out.worn.push_back(now.concrete().worn_volume());
            });
    const Ledger& e = out.ledger = sim.ledger();
    const Concrete& concrete = sim.concrete();
    // What was fed less what left is lost; what was brought, counted from the surface, less that came back.
    out.rebound =
        c.drops * c.brought() - (e.fed_kinetic + e.fed_potential) + e.left_kinetic + e.left_potential;
    for (Index s = 0; s < concrete.sites(); ++s)
        out.fracture_rate = std::max(out.fracture_rate, concrete.fracture(s));
    out.worn_from_energy = coefficient * c.beta * 0.5 * (e.concrete_lost_normal + e.concrete_lost_sliding);
    out.wear_error = relative_error(out.worn.back(), out.worn_from_energy);
    out.bonds_broken = sim.bonds_broken();
    return out;
}

Outcome drop(const Case& c) {
    const auto with = [&](auto sim) {
        if (c.bond_stiffness == 0) return run(std::move(sim), c);  // no bond law: concrete is a rigid bed
        return run(std::move(sim).bond(MohrCoulomb{{.tensile = 2.7e6, .stiffness = c.bond_stiffness}}), c);
    };
    const SubParticleAbrasion wear{{.coefficient = coefficient, .acceleration = c.beta}};
    if (c.dashpot)
        return with(
            simulate(scene_of(c))
                .contact(LinearSpring{{.stiffness = stiffness, .restitution = restitution, .friction = 0.5}})
                .wear(wear));
    return with(
        simulate(scene_of(c))
            .contact(LinearHysteretic{{.stiffness = stiffness, .restitution = restitution, .friction = 0.5}})
            .wear(wear));
}

/// Restitution of a damping ratio below 1, the inverse of damping_ratio_without_tension.
Real restitution_of(Real zeta) { return std::exp(-2 * zeta * std::acos(zeta) / std::sqrt(1 - square(zeta))); }

/// What one drop wears off [m3] when the contact loses the share 1 - e^2 of what it brings.
Real theory(const Case& c, Real e) { return coefficient * c.beta * 0.5 * c.brought() * (1 - square(e)); }

/// On a stiff slab, with the dashpot of a contact between two free bodies.
Real restitution_of_dashpot(const Case& c) {
    const Real sphere = concrete_density * pi / 6 * cube(concrete_diameter);
    return restitution_of(damping_ratio_without_tension(restitution) *
                          std::sqrt(sphere / (sphere + c.mass())));
}

constexpr Real mm3 = 1e9;

/// Worn volume over a quantity that `set` writes into a case.
struct Sweep {
    std::vector<Real> x, rigid, bonded, dashpot, theory_dent, theory_dashpot;

    Sweep(const std::vector<Real>& values, auto&& set) : x(values) {
        for (const Real value : values) {
            Case c;
            set(c, value);
            bonded.push_back(mm3 * drop(c).worn.back());
            theory_dent.push_back(mm3 * theory(c, restitution));
            theory_dashpot.push_back(mm3 * theory(c, restitution_of_dashpot(c)));
            c.dashpot = true;
            dashpot.push_back(mm3 * drop(c).worn.back());
            c.dashpot = false, c.bond_stiffness = 0;
            rigid.push_back(mm3 * drop(c).worn.back());
        }
    }
    void plot(const std::string& title, const Axis& axis, const std::filesystem::path& picture) const {
        const Axis worn{.label = "worn volume", .unit = "mm3", .logarithmic = axis.logarithmic};
        draw(LineChart{.title = title,
                       .x = axis,
                       .y = worn,
                       .curves = {{"theory, 1 - e^2", x, theory_dent},
                                  {"rigid concrete", x, rigid, CurveStyle::points},
                                  {"bonded concrete", x, bonded, CurveStyle::points},
                                  {"theory, dashpot on a stiff slab", x, theory_dashpot, CurveStyle::dashed},
                                  {"bonded concrete, dashpot", x, dashpot, CurveStyle::points}}},
             picture);
    }
};

Summary drop_on_concrete(const OutputFolder& folder) {
    // 1. One drop, from many heights, of many masses, at many beta. An exponent of 1 is a straight line
    // through 0.
    const Sweep heights(evenly(0.02, 0.2, 10), [](Case& c, Real h) { c.height = h; });
    heights.plot("One drop", {.label = "height", .unit = "m", .min = 0.0},
                 folder.path("worn_against_height.png"));
    const Sweep masses({0.0625, 0.125, 0.25, 0.5, 1, 2},
                       [](Case& c, Real m) { c.density = m / (4.0 / 3 * pi * cube(radius)); });
    masses.plot("One drop of a sphere of 5 cm", {.label = "mass", .unit = "kg", .logarithmic = true},
                folder.path("worn_against_mass.png"));
    const Sweep betas({25, 50, 100, 200}, [](Case& c, Real beta) { c.beta = beta; });

    // 2. Again and again on the same spot, which loses its strength but not its stiffness.
    const Case again{.drops = 20};
    const Outcome twenty = drop(again);
    std::vector<Real> number = evenly(1, again.drops, again.drops), worn, expected;
    for (int n = 0; n < again.drops; ++n) {
        worn.push_back(mm3 * twenty.worn[static_cast<std::size_t>(n)]);
        expected.push_back(mm3 * (n + 1) * theory(again, restitution));
    }
    const StraightLine fit = straight_line(number, worn);
    std::vector<Real> fitted;
    for (const Real n : number) fitted.push_back(fit.intercept + fit.slope * n);
    draw(LineChart{.title = "Drops of 5 cm on the same spot",
                   .x = {.label = "number of drops", .min = 0.0},
                   .y = {.label = "worn volume", .unit = "mm3", .min = 0.0},
                   .curves = {{"fitted line", number, fitted},
                              {"theory, 1 - e^2", number, expected, CurveStyle::dashed},
                              {"bonded concrete", number, worn, CurveStyle::points}}},
         folder.path("worn_against_drops.png"));

    // 3. Where the energy of a drop goes, by the stiffness of the bonds.
    std::vector<Real> ratio, contact, bonds, rebound, dashpot;
    for (const Real bond : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0}) {
        Case c{.bond_stiffness = bond * stiffness};
        const Outcome out = drop(c);
        ratio.push_back(bond), contact.push_back(100 * out.ledger.lost_normal / c.brought());
        bonds.push_back(100 * out.ledger.lost_bond / c.brought());
        rebound.push_back(100 * out.rebound / c.brought());
        c.dashpot = true;
        dashpot.push_back(100 * drop(c).ledger.lost_normal / c.brought());
    }
    const Real e_dashpot = restitution_of_dashpot({});
    draw(LineChart{.title = "Where the energy of one drop goes",
                   .x = {.label = "bond stiffness / contact stiffness", .logarithmic = true},
                   .y = {.label = "of the energy brought", .unit = "%", .min = 0.0, .max = 100.0},
                   .curves = {{"lost in the contact", ratio, contact},
                              {"lost in bonds", ratio, bonds},
                              {"rebound", ratio, rebound},
                              {"lost in the contact, dashpot", ratio, dashpot},
                              {"theory, dashpot on a stiff slab", ratio,
                               std::vector<Real>(ratio.size(), 100 * (1 - square(e_dashpot))),
                               CurveStyle::dashed},
                              {"theory, 1 - e^2", ratio,
                               std::vector<Real>(ratio.size(), 100 * (1 - square(restitution))),
                               CurveStyle::dashed}}},
         folder.path("energy_shares.png"));

    const Ledger& e = twenty.ledger;
    const Real brought = again.drops * again.brought();
    // The slab sags under its own weight, which is potential energy too.
    const Real left_in_slab = e.kinetic + e.stored_bonds - e.stored_start + e.potential - e.potential_start;
    Case rigid = again;
    rigid.bond_stiffness = 0;
    const Outcome hard = drop(rigid);
    Case damped = again;
    damped.dashpot = true;
    const Outcome with_dashpot = drop(damped);
    return {{"drops", again.drops},
            {"height_m", again.height},
            {"mass_kg", again.mass()},
            {"beta", again.beta},
            {"restitution", restitution},
            {"restitution_of_dashpot_on_slab", e_dashpot},
            {"worn_volume_mm3", mm3 * twenty.worn.back()},
            {"worn_volume_from_energy_mm3", mm3 * twenty.worn_from_energy},
            {"worn_volume_error_relative", twenty.wear_error},
            {"max_fracture_rate", twenty.fracture_rate},
            {"bonds_broken", twenty.bonds_broken},
            {"energy_brought_J", brought},
            {"energy_lost_in_contact_J", e.lost_normal + e.lost_sliding},
            {"energy_lost_in_bonds_J", e.lost_bond},
            {"energy_rebound_J", twenty.rebound},
            {"energy_left_in_slab_J", left_in_slab},
            {"integration_residue_J", e.integration_residue()},
            {"share_lost_in_contact", (e.lost_normal + e.lost_sliding) / brought},
            {"share_lost_in_contact_dashpot", with_dashpot.ledger.lost_normal / brought},
            {"share_lost_in_contact_dashpot_theory", 1 - square(e_dashpot)},
            {"share_lost_in_bonds", e.lost_bond / brought},
            {"rigid_worn_volume_mm3", mm3 * hard.worn.back()},
            {"rigid_worn_volume_closed_form_mm3", mm3 * again.drops * theory(again, restitution)},
            {"rigid_worn_volume_error_relative",
             relative_error(hard.worn.back(), again.drops * theory(again, restitution))},
            {"departure_from_line_drops_relative", fit.departure_relative},
            {"exponent_height_rigid", measured_order(heights.x, heights.rigid)},
            {"exponent_height_bonded", measured_order(heights.x, heights.bonded)},
            {"exponent_mass_rigid", measured_order(masses.x, masses.rigid)},
            {"exponent_mass_bonded", measured_order(masses.x, masses.bonded)},
            {"exponent_mass_dashpot", measured_order(masses.x, masses.dashpot)},
            {"exponent_beta_rigid", measured_order(betas.x, betas.rigid)},
            {"exponent_beta_bonded", measured_order(betas.x, betas.bonded)},
            {"ledger_residual_relative", std::max(e.residual_relative(), hard.ledger.residual_relative())}};
}

}  // namespace

int main(int argc, char** argv) {
    return textbook_main(argc, argv, "02_drop_on_concrete", "A sphere is dropped on concrete",
                         drop_on_concrete);
}
