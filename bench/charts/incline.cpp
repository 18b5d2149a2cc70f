// Draws the pictures of docs/verification/incline.md: chart_incline [FOLDER], which is made where it is not.

#include "../../tests/verification/incline.hpp"
#include "../../examples/common/charts.hpp"

#include <iostream>
#include <limits>

using namespace incline;
using namespace abrade::examples;

namespace {

void accelerations(const std::filesystem::path& folder) {
    const Real mu = 0.2;
    const auto centre = [&](Real angle) {
        return std::tan(angle) <= 3.5 * mu ? 5. / 7 * std::sin(angle)
                                           : std::sin(angle) - mu * std::cos(angle);
    };
    const auto rim = [&](Real angle) {
        return std::tan(angle) <= 3.5 * mu ? 5. / 7 * std::sin(angle) : 2.5 * mu * std::cos(angle);
    };
    Curve closed_centre{.title = "closed form, a / g"}, closed_rim{.title = "closed form, R alpha / g"};
    for (Real degrees = 0; degrees <= 80; degrees += 0.5) {
        closed_centre.x.push_back(degrees), closed_centre.y.push_back(centre(radians(degrees)));
        closed_rim.x.push_back(degrees), closed_rim.y.push_back(rim(radians(degrees)));
    }
    Curve measured_centre{.title = "measured, a / g", .style = CurveStyle::points},
        measured_rim{.title = "measured, R alpha / g", .style = CurveStyle::points};
    for (Real degrees = 5; degrees <= 80; degrees += 5) {
        const Descent down = descend(hertz(mu), radians(degrees));
        measured_centre.x.push_back(degrees), measured_centre.y.push_back(down.acceleration / g);
        measured_rim.x.push_back(degrees), measured_rim.y.push_back(down.rim_acceleration / g);
    }
    draw(LineChart{.title = "A sphere on a slope, mu = 0.2: it rolls up to 35 degrees, then slips",
                   .x = {.label = "slope", .unit = "degrees", .min = 0, .max = 80},
                   .y = {.label = "acceleration / g", .min = 0, .max = 1},
                   .curves = {closed_centre, closed_rim, measured_centre, measured_rim}},
         folder / "verification_incline_acceleration.png");
}

void transitions(const std::filesystem::path& folder) {
    const Real v0 = 1, mu = 0.2, slip = slip_time(v0, mu), lost = mass * square(v0) / 7;
    const LinearSpring law = linear(mu);
    const auto draw_one = [&](const char* title, const char* name, const SlipToRoll& s, Real rolling, Real v,
                              Real rim) {
        Curve speed{.title = "speed / v0"}, rim_speed{.title = "rim speed / v0"},
            loss{.title = "energy lost / (m v0^2 / 7)"},
            closed{.title = "closed forms", .style = CurveStyle::dashed};
        for (std::size_t n = 0; n < s.times.size(); ++n) {
            for (Curve* curve : {&speed, &rim_speed, &loss}) curve->x.push_back(s.times[n] / slip);
            speed.y.push_back(s.speeds[n] / v0), rim_speed.y.push_back(s.rim_speeds[n] / v0);
            loss.y.push_back(s.losses[n] / lost);
        }
        const auto line = [&](auto&& value) {
            for (Real t = 0; t <= 2.0001; t += 0.02) closed.x.push_back(t), closed.y.push_back(value(t));
            closed.x.push_back(2), closed.y.push_back(std::numeric_limits<Real>::quiet_NaN());
        };
        line([&](Real t) { return t < 1 ? v + (rolling - v) * t : rolling; });
        line([&](Real t) { return t < 1 ? rim + (rolling - rim) * t : rolling; });
        line([&](Real t) { return t < 1 ? 1 - square(1 - t) : 1; });
        draw(LineChart{.title = title,
                       .x = {.label = "time / (2 v0 / (7 mu g))", .min = 0, .max = 2},
                       .y = {.label = "share", .min = 0, .max = 1.1},
                       .curves = {speed, rim_speed, loss, closed},
                       .height = 560},
             folder / name);
    };
    draw_one("Thrown along a floor: slides, then rolls with 5/7 of its speed",
             "verification_incline_sliding.png", slip_to_roll(law, v0, 0), 5. / 7, 1, 0);
    draw_one("Set down spinning: slips, then rolls with 2/7 of its rim's speed",
             "verification_incline_spinning.png", slip_to_roll(law, 0, v0), 2. / 7, 0, 1);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::filesystem::path folder = argc > 1 ? argv[1] : "out/charts/incline";
        std::filesystem::create_directories(folder);
        accelerations(folder), transitions(folder);
        std::cout << "pictures in " << folder.string() << '\n';
    } catch (const std::exception& problem) {
        std::cerr << problem.what() << '\n';
        return 1;
    }
}
