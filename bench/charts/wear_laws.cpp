// Draws the pictures of docs/verification/wear_laws.md: chart_wear_laws [FOLDER], which is made where it is
// not.

#include "../../examples/common/charts.hpp"
#include "../../tests/verification/wear_scenes.hpp"
#include "panels.hpp"

#include <iostream>
#include <random>

using namespace abrade;
using namespace abrade::examples;
using namespace abrade::verification;

namespace {

constexpr Real phases[] = {0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95};

Real brought_by(const Throw& impact) {
    return 0.5 * impact.mass * (square(impact.along) + square(impact.across));
}

/// The three bookings of one impact over what it brought, against x.
struct ThreeBookings {
    Curve never_back{.title = "as it flows, what is negative left out", .style = CurveStyle::points};
    Curve at_end{.title = "sum at the end of the contact", .style = CurveStyle::dashed};
    Curve dissipated{.title = "dissipated part only", .style = CurveStyle::points};
    void add(Real x, const Throw& impact) {
        const Bookings b = bookings_of(impact);
        const Real brought = brought_by(impact);
        for (Curve* curve : {&never_back, &at_end, &dissipated}) curve->x.push_back(x);
        never_back.y.push_back(b.never_back / brought);
        at_end.y.push_back(b.at_end / brought);
        dissipated.y.push_back(b.dissipated / brought);
    }
};

/// The head-on impact of restitution 0.6, step by step.
void within(const std::filesystem::path& folder) {
    Curve running{.title = "as it flows"}, never_back{.title = "as it flows, what is negative left out"},
        at_end{.title = "sum at the end of the contact", .style = CurveStyle::dashed},
        dissipated{.title = "dissipated part only"};
    const Throw impact{.steps = 500};
    BookingRecord record;
    auto sim = simulate(impact.scene()).contact(impact.law()).wear(RecordingWear{record});
    sim.run({.end_time = 1.2 * impact.contact_time(),
             .time_step = impact.time_step(),
             .observe_every = impact.time_step()},
            [&](const auto& now) {
                const Bookings b = record.sums();
                for (Curve* curve : {&running, &never_back, &at_end, &dissipated})
                    curve->x.push_back(now.time() / impact.contact_time());
                running.y.push_back(b.running / brought_by(impact));
                never_back.y.push_back(b.never_back / brought_by(impact));
                at_end.y.push_back(b.at_end / brought_by(impact));
                dissipated.y.push_back(b.dissipated / brought_by(impact));
            });
    draw(LineChart{.title = "Within one impact head-on, restitution 0.6: what is booked until then",
                   .x = {.label = "time / duration without damping", .min = 0, .max = 1.2},
                   .y = {.label = "booked / energy brought", .min = 0, .max = 1.15},
                   .curves = {never_back, running, dissipated, at_end}},
         folder / "verification_wear_booking_within.png");
}

void over_restitution(const std::filesystem::path& folder) {
    Curve lost{.title = "lost, 1 - e^2"};
    ThreeBookings booked;
    for (int n = 1; n <= 20; ++n) {
        const Real e = 0.05 * n;
        lost.x.push_back(e), lost.y.push_back(1 - square(e));
        booked.add(e, {.restitution = e, .friction = 0});
    }
    draw(LineChart{.title = "One impact head-on, 50 steps a contact: what is booked",
                   .x = {.label = "restitution", .min = 0, .max = 1.02},
                   .y = {.label = "booked / energy brought", .min = 0, .max = 1.15},
                   .curves = {lost, booked.at_end, booked.never_back, booked.dissipated}},
         folder / "verification_wear_booking_restitution.png");
}

void over_angle(const std::filesystem::path& folder) {
    constexpr Real speed = 5, e = 0.6, mu = 0.3;
    Curve lost{.title = "lost, closed form while it slides"};
    ThreeBookings booked;
    for (Real degrees = 3; degrees <= 90; degrees += 3) {
        const Real along = speed * std::sin(radians(degrees)), across = speed * std::cos(radians(degrees));
        booked.add(degrees, {.along = along, .across = across, .restitution = e, .friction = mu});
        const Real after = across - 3.5 * mu * (1 + e) * along;
        const Real friction = mu * (1 + e) * along * (across + after) / 2;
        lost.x.push_back(degrees);
        lost.y.push_back(
            after >= 0 ? (0.5 * square(along) * (1 - square(e)) + friction) / (0.5 * square(speed)) : NAN);
    }
    draw(LineChart{.title = "One impact at 5 m/s, restitution 0.6, friction 0.3, 50 steps a contact",
                   .x = {.label = "angle between path and surface", .unit = "degree", .min = 0, .max = 90},
                   .y = {.label = "booked / energy brought", .min = 0, .max = 1.15},
                   .curves = {lost, booked.at_end, booked.never_back, booked.dissipated}},
         folder / "verification_wear_booking_angle.png");
}

/// A sphere of 5 cm that hops over a bed of spheres of 2 cm and comes to rest in a hollow.
void to_rest(const std::filesystem::path& folder) {
    Curve running{.title = "as it flows"}, never_back{.title = "as it flows, what is negative left out"},
        at_end{.title = "sum at the end of each contact"}, dissipated{.title = "dissipated part only"};
    BookingRecord record;
    Scene scene;
    scene.concrete = ConcreteBlock{flat_lattice(3, 0.3, {.layers = 1})};
    const Real radius = 0.025, mass = 2650 * 4.0 / 3 * pi * cube(radius);
    scene.add_sphere(radius, {.position = {-1.4, 0.003, 0.08}, .velocity = {1, 0.02, 0}});
    auto sim = simulate(std::move(scene))
                   .contact(LinearSpring{{.stiffness = 1e6, .restitution = 0.6, .friction = 0.5}})
                   .wear(RecordingWear{record});
    const Real kinetic = 0.5 * mass * 1.0004;
    sim.run({.end_time = 3, .time_step = 2e-5, .observe_every = 5e-4}, [&](const auto& now) {
        const Bookings b = record.sums();
        for (Curve* curve : {&running, &never_back, &at_end, &dissipated}) curve->x.push_back(now.time());
        running.y.push_back(b.running), never_back.y.push_back(b.never_back);
        at_end.y.push_back(b.at_end), dissipated.y.push_back(b.dissipated);
    });
    const Bookings b = record.sums();
    std::size_t sphere = 0;
    while (sim.particles().kind[sphere] != Kind::stone) ++sphere;
    const Real brought = kinetic + mass * standard_gravity * (0.08 - sim.particles().position[sphere].z());
    for (Curve* curve : {&running, &never_back, &at_end, &dissipated})
        for (Real& y : curve->y) y /= brought;
    std::cout << "to rest: speed " << sim.particles().velocity[sphere].norm() << " m/s, contacts "
              << record.contacts() << ", dissipated " << b.dissipated / brought << ", at the end "
              << b.at_end / brought << " and owed " << b.still_owed / brought << ", never back "
              << b.never_back / brought << " of what was brought\n";
    at_end.style = CurveStyle::dashed;
    draw(
        LineChart{.title = "A sphere hops over a bed of spheres and comes to rest: what is booked until then",
                  .x = {.label = "time", .unit = "s", .min = 0, .max = 3},
                  .y = {.label = "booked / energy brought", .min = 0},
                  .curves = {never_back, running, dissipated, at_end}},
        folder / "verification_wear_booking_rest.png");
}

void many(std::ostream& out) {
    std::mt19937 random(5);
    std::uniform_real_distribution<Real> u(0, 1);
    Bookings all;
    Real brought = 0;
    for (int n = 0; n < 500; ++n) {
        const Real angle = radians(90 * u(random)), speed = 0.5 + 4.5 * u(random);
        const Throw impact{
            .along = speed * std::sin(angle), .across = speed * std::cos(angle), .phase = u(random)};
        const Bookings b = bookings_of(impact);
        all.dissipated += b.dissipated, all.at_end += b.at_end, all.never_back += b.never_back;
        brought += brought_by(impact);
    }
    out << "500 impacts of any angle: dissipated " << all.dissipated / brought << ", at the end "
        << all.at_end / brought << ", never back " << all.never_back / brought << " of what was brought\n";
}

/// The worst over phases of first touch, against steps a contact.
void orders(const std::filesystem::path& folder) {
    const SklarDietrich sklar{{.tensile = 7e6, .youngs = 5e10}};
    Curve end, apart, approach;
    for (const Real steps : {12.5, 25.0, 50.0, 100.0, 200.0, 400.0, 800.0, 1600.0}) {
        Real worst_end = 0, worst_apart = 0, worst_approach = 0;
        for (const Real phase : phases) {
            const Throw elastic{.restitution = 1, .friction = 0, .steps = steps, .phase = phase};
            const Throw oblique{.across = 1, .steps = steps, .phase = phase};
            worst_end = std::max(worst_end, std::abs(bookings_of(elastic).running) / brought_by(elastic));
            const Bookings b = bookings_of(oblique);
            worst_apart = std::max(worst_apart, std::abs(b.running - b.dissipated) / brought_by(oblique));
            worst_approach = std::max(
                worst_approach,
                std::abs(worn_by(oblique, sklar) * sklar.energy_of_detachment() / (0.5 * oblique.mass) - 1));
        }
        for (Curve* curve : {&end, &apart, &approach}) curve->x.push_back(steps);
        end.y.push_back(worst_end), apart.y.push_back(worst_apart), approach.y.push_back(worst_approach);
    }
    for (std::size_t n = 0; n < end.x.size(); ++n)
        std::cout << end.x[n] << " steps: residue " << end.y[n] << ", end less dissipated " << apart.y[n]
                  << ", approach " << approach.y[n] << '\n';
    draw(
        abrade::charts::PanelChart{
            .title = "Energy booked for one impact: the worst of seven phases of first touch",
            .x = {.label = "steps a contact", .min = 10, .max = 2000, .logarithmic = true},
            .y = {.label = "error / energy brought", .min = 1e-9, .max = 1, .logarithmic = true},
            .names = {"restitution 1: sum at the end, all of it residue",
                      "restitution 0.6: sum at the end less dissipated", "work of approach less 1/2 m w^2"},
            .panels = {{.curves = {end, apart, approach}}},
            .slopes = {{50, 4e-3, -2, 10, "order 2"}, {50, 3e-6, -3, 8, "order 3"}},
            .columns = 1,
            .panel_width = 900,
            .panel_height = 520},
        folder / "verification_wear_orders.png");
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/wear_laws";
        std::filesystem::create_directories(folder);
        within(folder), over_restitution(folder), over_angle(folder), to_rest(folder), many(std::cout),
            orders(folder);
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
