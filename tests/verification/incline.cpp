// A sphere that slips or rolls, down a slope and on level ground, against closed forms (dem11). Gate: 0.5 %.
#include "incline.hpp"
#include "reference_table.hpp"

#include <doctest/doctest.h>

using namespace incline;

namespace {

constexpr Real gate = 0.005;
/// Round-off: each of some 2e4 steps adds up to 1e-16 of the energy, and equal steps round the same way.
constexpr Real round_off = 1e-12;

/// Largest relative errors, to be told.
struct Worst {
    Real value = 0;
    void add(Real measured, Real expected) {
        value = std::max(value, std::abs(measured / expected - 1));
        CHECK(measured == doctest::Approx(expected).epsilon(gate).scale(0));
    }
};

template <class Make>
void check_slopes(const std::string& name, Make&& law) {
    Worst acceleration, loss;
    Real residual = 0;
    for (const auto& row : reference_table("dem11_sphere_incline_analytic.csv")) {
        const Real angle = radians(row.at("theta_deg")), mu = row.at("mu");
        CAPTURE(row.at("theta_deg"));
        CAPTURE(mu);
        CHECK(row.is("regime", std::tan(angle) <= 3.5 * mu ? "roll" : "slip"));
        const Descent down = descend(law(mu), angle);
        acceleration.add(down.acceleration, row.at("a"));
        acceleration.add(down.rim_acceleration, row.at("R_alpha"));
        const Real weight = mass * g * std::cos(angle);
        if (row.is("regime", "slip"))
            loss.add(down.lost, mu * weight * down.slipped);
        else  // rolls without loss: what the contact loses is nothing beside what gravity brings
            CHECK(std::abs(down.lost) <= 1e-6 * down.ledger.gravity_work);
        residual = std::max(residual, down.ledger.residual_relative());
        CHECK(down.ledger.residual_relative() <= round_off);
    }
    MESSAGE(name << ": accelerations " << acceleration.value << ", loss " << loss.value
                 << ", ledger's residual " << residual);
}

template <class Law>
void check_slip_to_roll(const std::string& name, const Law& law) {
    const Real v0 = 1, mu = law.params().friction;
    for (const bool spinning : {false, true}) {
        CAPTURE(spinning);
        const SlipToRoll s = spinning ? slip_to_roll(law, 0, v0) : slip_to_roll(law, v0, 0);
        Worst time, speed, distance, slipped, lost;
        time.add(s.time, slip_time(v0, mu));
        const Real rolling = (spinning ? 2. / 7 : 5. / 7) * v0;
        speed.add(s.speed, rolling), speed.add(s.speeds.back(), rolling),
            speed.add(s.rim_speeds.back(), rolling);
        distance.add(s.distance, (spinning ? 2. : 12.) / 49 * square(v0) / (mu * g));
        slipped.add(s.slipped, square(v0) / (7 * mu * g));
        lost.add(s.lost, mass * square(v0) / 7);
        CHECK(s.lost_rolling >= 0);
        CHECK(s.lost_rolling <= 1e-6 * s.lost);
        CHECK(s.ledger.residual_relative() <= round_off);
        MESSAGE(name << std::string(spinning ? ", spinning" : ", sliding") << ": time " << time.value
                     << ", speeds " << speed.value << ", distance " << distance.value << ", slip "
                     << slipped.value << ", loss " << lost.value << ", lost while rolling / lost "
                     << s.lost_rolling / s.lost << ", ledger's residual " << s.ledger.residual_relative());
    }
}

}  // namespace

TEST_CASE("spheres on a slope roll or slip, and lose mu N times the slip (dem11)") {
    check_slopes("linear", linear);
    check_slopes("Hertz-Mindlin", hertz);
}

TEST_CASE("from sliding or spinning to rolling: time, speed, distance, slip, m v^2/7 lost (dem11)") {
    check_slip_to_roll("linear", linear(0.2));
    check_slip_to_roll("Hertz-Mindlin", hertz(0.2));
}

TEST_CASE("the slope at which rolling ends is that of tan theta = 7/2 mu") {
    const Real mu = 0.2, critical = std::atan(3.5 * mu);
    for (const auto& [angle, rolls] : {std::pair(0.99 * critical, true), std::pair(1.01 * critical, false)}) {
        const Descent down = descend(linear(mu), angle);
        const Real slip = down.acceleration - down.rim_acceleration;
        CHECK((std::abs(slip) < 1e-3 * down.acceleration) == rolls);
    }
}
