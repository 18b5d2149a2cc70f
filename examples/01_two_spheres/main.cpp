// Where does the energy go when two spheres collide?
//
//   examples/run two_spheres [--out FOLDER]
//
// Problem. Two unequal spheres meet, once head-on and once obliquely, for a range of restitution e.
//
// Theory. Only the relative motion at the point of contact can be lost. Along the normal it has the mass
// m_eff,
//   1 / m_eff = 1 / m1 + 1 / m2,   E_n = 1/2 m_eff v_n^2 (1 - e^2).
// Along the tangent solid spheres also turn, which leaves 2/7 m_eff. While the contact slides, friction
// passes on mu times the normal momentum J = m_eff v_n (1 + e), and v_t falls by 7/2 mu (1 + e) v_n. So
//   E_t = mu J (v_t - 7/4 mu (1 + e) v_n),   if v_t > 7/2 mu (1 + e) v_n: it slides throughout.
// Here v_t / v_n = 2 and mu = 0.2, so every impact slides to its end (the bound is 1.4 at e = 1).
// The formulas are for an instant; a real contact lasts, and turns by some v_t t_c / (r1 + r2) while it does.

#include "../common/textbook.hpp"

#include <abrade/abrade.hpp>

using namespace abrade;
using namespace abrade::examples;

namespace {

constexpr Real radius1 = 0.02, radius2 = 0.03, density = 2650;         // [m], [kg/m3]
constexpr Real stiffness = 1e8, friction = 0.2, v_n = 0.1, v_t = 0.2;  // [N/m], [-], [m/s]

constexpr Real mass(Real radius) { return 4.0 / 3 * pi * cube(radius) * density; }
constexpr Real m_eff = mass(radius1) * mass(radius2) / (mass(radius1) + mass(radius2));

Vec3 momentum(const Particles& p) { return p.mass[0] * p.velocity[0] + p.mass[1] * p.velocity[1]; }

struct Impact {
    Ledger ledger;
    Real momentum_error;  // |p - p_start| / |p_start|
};

/// One impact, resolved by `steps` steps a contact. `phase` in (0, 1): where within a step the contact
/// begins.
Impact collide(Real restitution, Real tangential, Real steps, Real phase) {
    const Real contact_time = pi * std::sqrt(m_eff / stiffness), dt = contact_time / steps;
    const Vec3 velocity{v_n, tangential, 0};
    const Vec3 start = -(3 + phase) * dt * velocity;  // so that they touch with their centres along x

    Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(radius1, {.position = start, .velocity = velocity}, density);
    scene.add_sphere(radius2, {.position = {radius1 + radius2, 0, 0}}, density);
    auto sim = simulate(scene).contact(
        LinearSpring{{.stiffness = stiffness, .restitution = restitution, .friction = friction}});
    sim.run({.end_time = 3 * contact_time + 5 * dt, .time_step = dt});
    const Vec3 brought = mass(radius1) * velocity;
    return {sim.ledger(), (momentum(sim.particles()) - brought).norm() / brought.norm()};
}

Summary two_spheres(const OutputFolder& folder) {
    // 1. Energy lost against restitution.
    const auto normal = [](Real e) { return 0.5 * m_eff * square(v_n) * (1 - square(e)); };
    const auto sliding = [](Real e) {
        return friction * m_eff * v_n * (1 + e) * (v_t - 7.0 / 4 * friction * (1 + e) * v_n);
    };
    constexpr Real milli = 1e3, head_on = 0, fine = 400;
    std::vector<Real> e_oblique = evenly(0.1, 1.0, 10), e_head_on = evenly(0.05, 0.95, 10), lost_head_on,
                      lost_normal, lost_sliding;
    Real error_head_on = 0, error_normal = 0, error_sliding = 0, error_momentum = 0, residual = 0;
    const Real brought_normal = 0.5 * m_eff * square(v_n);
    for (std::size_t i = 0; i < e_oblique.size(); ++i) {
        const Real e = e_oblique[i];
        const Impact straight = collide(e_head_on[i], head_on, fine, 0.5),
                     oblique = collide(e, v_t, fine, 0.5);
        lost_head_on.push_back(milli * straight.ledger.lost_normal);
        lost_normal.push_back(milli * oblique.ledger.lost_normal);
        lost_sliding.push_back(milli * oblique.ledger.lost_sliding);
        const auto worse = [](Real& worst, Real error) { worst = std::max(worst, std::abs(error)); };
        worse(error_head_on, (straight.ledger.lost_normal - normal(e_head_on[i])) / brought_normal);
        worse(error_normal, (oblique.ledger.lost_normal - normal(e)) / brought_normal);
        worse(error_sliding, oblique.ledger.lost_sliding / sliding(e) - 1);
        for (const Impact& impact : {straight, oblique}) {
            worse(error_momentum, impact.momentum_error);
            worse(residual, impact.ledger.residual_relative());
        }
    }
    std::vector<Real> e_theory = evenly(0.0, 1.0, 101), theory_normal, theory_sliding;
    for (const Real e : e_theory)
        theory_normal.push_back(milli * normal(e)), theory_sliding.push_back(milli * sliding(e));
    draw(LineChart{.title = "Two spheres collide: energy lost",
                   .x = {.label = "restitution e", .min = 0.0, .max = 1.05},
                   .y = {.label = "energy lost", .unit = "mJ", .min = 0.0},
                   .curves = {{"normal, theory", e_theory, theory_normal},
                              {"sliding, theory", e_theory, theory_sliding},
                              {"normal, head-on", e_head_on, lost_head_on, CurveStyle::points},
                              {"normal, oblique", e_oblique, lost_normal, CurveStyle::points},
                              {"sliding, oblique", e_oblique, lost_sliding, CurveStyle::points}}},
         folder.path("energy_lost.png"));

    // 2. Error against time step. It depends on where in a step the contact begins: the mean over 32 phases.
    constexpr Real e = 0.6;
    constexpr int phases = 32;
    constexpr Real percent = 100;
    std::vector<Real> share_of_contact, error, residue, second_order;
    for (Real steps = 12.5; steps <= 800; steps *= 2) {
        Real mean_error = 0, mean_residue = 0;
        for (int n = 0; n < phases; ++n) {
            const Ledger ledger = collide(e, head_on, steps, (n + 0.5) / phases).ledger;
            mean_error += std::abs(ledger.lost_normal - normal(e)) / normal(e) / phases;
            mean_residue += std::abs(ledger.integration_residue()) / normal(e) / phases;
        }
        share_of_contact.push_back(1 / steps);
        error.push_back(percent * mean_error);
        residue.push_back(percent * mean_residue);
        second_order.push_back(error.front() * square(share_of_contact.back() / share_of_contact.front()));
    }
    draw(LineChart{.title = "Head-on, e = 0.6: error against time step",
                   .x = {.label = "time step / contact time", .logarithmic = true},
                   .y = {.label = "of the energy lost", .unit = "%", .min = 5e-4, .logarithmic = true},
                   .curves = {{"second order", share_of_contact, second_order, CurveStyle::dashed},
                              {"error of the energy lost", share_of_contact, error, CurveStyle::points},
                              {"integration residue of the ledger", share_of_contact, residue,
                               CurveStyle::points}}},
         folder.path("error_against_step.png"));

    const Impact typical = collide(e, v_t, fine, 0.5);
    return {{"restitution", e},
            {"friction", friction},
            {"time_step_s", pi * std::sqrt(m_eff / stiffness) / fine},
            {"energy_lost_normal_J", typical.ledger.lost_normal},
            {"energy_lost_normal_closed_form_J", normal(e)},
            {"energy_lost_sliding_J", typical.ledger.lost_sliding},
            {"energy_lost_sliding_closed_form_J", sliding(e)},
            {"worst_error_head_on_of_energy_brought", error_head_on},
            {"worst_error_normal_of_energy_brought", error_normal},
            {"worst_error_sliding_relative", error_sliding},
            {"turn_while_in_contact_rad", v_t * pi * std::sqrt(m_eff / stiffness) / (radius1 + radius2)},
            {"worst_momentum_error_relative", error_momentum},
            {"ledger_residual_relative", residual},
            {"error_at_50_steps_relative", error[2] / percent},
            {"residue_at_50_steps_relative", residue[2] / percent},
            {"order_of_error", measured_order(share_of_contact, error)},
            {"order_of_integration_residue", measured_order(share_of_contact, residue)}};
}

}  // namespace

int main(int argc, char** argv) {
    return textbook_main(argc, argv, "01_two_spheres", "Two spheres collide", two_spheres);
}
