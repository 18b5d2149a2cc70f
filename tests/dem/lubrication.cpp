// The film between surfaces that nearly touch: what it takes from a sphere that crosses it, by the law alone
// and through the engine.
#include "../message_of.hpp"

#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/dem/laws/lubrication.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace abrade;

namespace {

using Film = Lubricated<LinearSpring>;

constexpr Real radius = 5e-3, density = 2500, range = 2e-3, roughness = 5e-6;
const Real mass = density * 4.0 / 3 * pi * cube(radius);

Film law(Real viscosity, Real stiffness = 1e5) {
    return Film({.contact = {.stiffness = stiffness},
                 .viscosity = viscosity,
                 .range = range,
                 .roughness = roughness});
}

/// Speed that a sphere loses from where a film begins to where it touches: the impulse of
/// 6 pi mu R^2 (1/max(h, h_r) - 1/h_c) over its mass.
Real lost_speed(Real viscosity, Real effective_radius, Real effective_mass) {
    return 6 * pi * viscosity * square(effective_radius) * std::log(range / roughness) / effective_mass;
}

/// Onto a wall, or (`two`) onto a sphere like it that comes towards it.
struct Fall {
    Real speed = 0.5, viscosity = 0.01;
    Real step = 1e-6;
    bool two = false;
};
struct Found {
    Real slowest = 0;  ///< of the speeds as it touches and as the film has let it go [m/s]
    Real touches_at = 0;
    Ledger ledger;
};
Found fall(const Fall& f) {
    Scene scene;
    scene.gravity = Vec3::Zero();
    const Real side = f.two ? 1.0 : 0.0;
    scene.add_sphere(radius, {.position = {0, 0, radius + 2 * range}, .velocity = {0, 0, -f.speed}}, density);
    if (f.two)
        scene.add_sphere(
            radius, {.position = {0, 0, -radius - 2 * range}, .velocity = {0, 0, side * f.speed}}, density);
    else
        scene.add_wall({0, 0, 0}, {0, 0, 1});
    auto sim = simulate(scene).contact(law(f.viscosity));
    Found found;
    bool touched = false;
    const RunOptions options{.end_time = 10 * range / f.speed, .time_step = f.step, .observe_every = f.step};
    sim.run(options, [&](const auto& now) {
        const Real z = now.particles().position[0].z(), v = now.particles().velocity[0].z();
        if (!touched && z > radius) found.touches_at = -v;
        touched |= z < radius;
        found.slowest = v;
    });
    found.ledger = sim.ledger();
    return found;
}

}  // namespace

TEST_CASE("a film takes its impulse from a sphere, in steps of any length that the film bears") {
    const Real whole = lost_speed(0.01, radius, mass);
    for (const Real step : {1e-7, 1e-6, 5e-6, 2e-5}) {
        const Found found = fall({.step = step});
        CAPTURE(step);
        // As it comes the last step may not be seen to its end.
        CHECK(found.touches_at - (0.5 - whole) >= -0.01 * whole);
        CHECK(std::abs(0.5 - found.slowest - 2 * whole) < 0.02 * whole);
        CHECK(found.ledger.residual_relative() < 1e-12);
        CHECK(std::abs(found.ledger.integration_residue()) < 0.02 * found.ledger.lost_film);
        CHECK(std::abs(found.ledger.lost_film / (0.5 * mass * (square(0.5) - square(found.slowest))) - 1) <
              0.02);
        CHECK(found.ledger.lost_normal == 0);
    }
}

TEST_CASE("two spheres have half the effective radius and half the mass") {
    const Real whole = lost_speed(0.01, 0.5 * radius, 0.5 * mass);  // of 2 v
    const Found found = fall({.two = true});
    CHECK(std::abs(2 * (0.5 - found.slowest) - 2 * whole) < 0.02 * whole);
    CHECK(found.ledger.residual_relative() < 1e-12);
}

TEST_CASE("a film that is too viscous for the step stops a sphere and throws none back") {
    for (const Real viscosity : {1.0, 100.0, 1e4}) {
        const Found found = fall({.viscosity = viscosity, .step = 2e-5});
        CAPTURE(viscosity);
        CHECK(found.ledger.lost_film > 0.8 * found.ledger.kinetic_start);  // what is booked is as coarse
        CHECK(found.ledger.kinetic < 0.01 * found.ledger.kinetic_start);
    }
}

TEST_CASE("what does not move has no film, nor what is farther than the range or pressed") {
    constexpr Real viscosity = 1e-3;
    const Film film = law(viscosity);
    ContactKinematics<Real> contact{};
    contact.normal = Vec3::UnitZ(), contact.inverse_mass = 1 / mass, contact.curvature = 1 / radius;
    contact.time_step = 1e-6;
    const auto force = [&](Real gap, Real approach) {
        contact.overlap = -gap, contact.velocity = {0, 0, -approach};
        return film.respond(contact, {}).load.force.z();
    };
    CHECK(force(0.1 * range, 0) == 0);
    CHECK(force(1.01 * range, 1) == 0);
    CHECK(std::abs(force(-0.01 * range, 0.1) - 1e5 * 0.01 * range) < 1e-12);
    for (const Real gap : {0.5 * range, 0.01 * range, 2 * roughness}) {
        const Real known = 6 * pi * viscosity * square(radius) * (1 / gap - 1 / range);
        CHECK(std::abs(force(gap, 1e-6) / (known * 1e-6) - 1) < 1e-3);
        CHECK(std::abs(force(gap, -1e-6) / (known * -1e-6) - 1) < 1e-3);
    }
    CHECK(force(0, 1e-9) > 0);
}

TEST_CASE("parameters of a film are refused with their remedy") {
    const auto refused = [](Film::Params params) {
        params.contact.stiffness = 1e5;
        return message_of([&] { Film{params}; });
    };
    CHECK(refused({.viscosity = 0, .range = 1, .roughness = 0.1}).find("Lubricated.viscosity") == 0);
    CHECK(refused({.viscosity = 1, .range = -1, .roughness = 0.1}).find("Lubricated.range") == 0);
    CHECK(refused({.viscosity = 1, .range = 1, .roughness = 2}).find("Lubricated.roughness") == 0);
    CHECK(refused({.viscosity = 1, .range = 1, .roughness = 0}).find("Lubricated.roughness") == 0);
}
