// What do five wear laws make of the same stone: thrown at concrete, and slid over it?
//
//   examples/run wear_laws [--out FOLDER]
//
// Problem. A sphere hits flat concrete at 5 m/s under angles from grazing to head-on; a block slides over it
// until it stops, and once more over a bed of spheres of 2 cm. Each law says what wears.
//
// Theory. m is the mass, v_n = v sin(alpha) and v_t = v cos(alpha) are the speeds into the surface and along
// it, F is the work of friction, N the weight of the block, s its way:
//   law                  one impact                                   block on the flat
//   SubParticleAbrasion  C_w 1/2 (1/2 m v_n^2 (1 - e^2) + F)          C_w 1/2 mu N s
//   Archard              k / H F / mu                                 k / H N s
//   Finnie               m v^2 / (p psi K) f(alpha)                   0: what slides has no impacts
//   SklarDietrich        1/2 m v_n^2 / eps_v                          0: friction is no impact
//   Ishibashi            C_1 1/2 m v_n^2 + C_2 F                      C_2 mu N s
// An impact slides throughout where tan(alpha) <= 2 / (7 mu (1 + e)):
//   F = mu m (1 + e) v_n (v_t - 7/4 mu (1 + e) v_n)
// The coefficients show how the laws differ in form. They are not calibrated: do not compare volumes.

#include "../common/chosen_wear.hpp"
#include "../common/textbook.hpp"

#include <abrade/abrade.hpp>

#include <functional>

using namespace abrade;
using namespace abrade::examples;

namespace {

constexpr Real restitution = 0.6, mu = 0.3, speed = 5, radius = 0.025, density = 2650, slide_speed = 2;
constexpr Real mass = density * 4.0 / 3 * pi * cube(radius);

/// Energies of one impact [J]; that of friction has a closed form only where it slides throughout.
struct ImpactEnergy {
    Real along, friction;
    explicit ImpactEnergy(Real degrees) {
        const Real vn = speed * std::sin(radians(degrees)), vt = speed * std::cos(radians(degrees));
        const Real push = mu * (1 + restitution) * vn;
        along = 0.5 * mass * square(vn);
        friction = 3.5 * push <= vt ? mass * push * (vt - 1.75 * push) : NAN;
    }
};

/// A law, and its closed forms [m3]: of an impact under an angle [degree], of the work of friction [J] of a
/// block.
struct Case {
    std::string key, title;
    ChosenWear law;
    std::function<Real(Real)> impact, block;
};

std::vector<Case> cases() {
    const SubParticleAbrasion sub_particle{{.coefficient = 1.1e-7}};
    const Archard archard{{.coefficient = 1e-4, .hardness = 1e9}};
    const Finnie finnie{{.flow_stress = 1e8}};
    const SklarDietrich sklar{{.tensile = 2.7e6, .youngs = 2.68e10}};
    const Ishibashi ishibashi{{.impact = 1e-9, .friction = 2e-10}};
    const auto nothing = [](Real) { return Real{0}; };
    return {{"sub_particle", "SubParticleAbrasion", ChosenWear{sub_particle},
             [](Real degrees) {
                 const ImpactEnergy e(degrees);
                 return 1.1e-7 / 2 * (e.along * (1 - square(restitution)) + e.friction);
             },
             [](Real work) { return 1.1e-7 / 2 * work; }},
            {"archard", "Archard", ChosenWear{archard},
             [](Real degrees) { return 1e-4 / 1e9 * ImpactEnergy(degrees).friction / mu; },
             [](Real work) { return 1e-4 / 1e9 * work / mu; }},
            {"finnie", "Finnie", ChosenWear{finnie},
             [=](Real degrees) {
                 return finnie.volume(mass, speed * std::sin(radians(degrees)),
                                      speed * std::cos(radians(degrees)));
             },
             nothing},
            {"sklar_dietrich", "SklarDietrich", ChosenWear{sklar},
             [=](Real degrees) { return sklar.volume(ImpactEnergy(degrees).along); }, nothing},
            {"ishibashi", "Ishibashi", ChosenWear{ishibashi},
             [](Real degrees) {
                 const ImpactEnergy e(degrees);
                 return 1e-9 * e.along + 2e-10 * e.friction;
             },
             [](Real work) { return 2e-10 * work; }}};
}

/// Rigid concrete that is one great sphere [m], as flat as a plane where it is hit; its top is the origin.
ConcreteBlock flat_concrete(Real great) {
    const LatticeSite site{.centre = {0, 0, -great}, .cell_volume = 1};
    return {.lattice = Lattice{great, 1, 1, 1, {site}, {1}}};
}

/// Worn by one impact [m3].
Real worn_by_impact(const ChosenWear& law, Real degrees) {
    const Real along = speed * std::sin(radians(degrees)), across = speed * std::cos(radians(degrees));
    constexpr Real stiffness = 1e7;
    const Real contact = pi * std::sqrt(mass / stiffness), dt = contact / 200;
    Scene scene;
    scene.gravity.setZero();
    scene.concrete = flat_concrete(100);
    scene.add_sphere(radius, {.position = {0, 0, radius + along * dt}, .velocity = {across, 0, -along}},
                     density);
    auto sim =
        simulate(std::move(scene))
            .contact(LinearSpring{{.stiffness = stiffness, .restitution = restitution, .friction = mu}})
            .wear(law);
    sim.run({.end_time = 2 * contact, .time_step = dt});
    return sim.concrete().worn_volume();
}

/// Worn by a block of four feet that slides to its end [m3]: over flat concrete, or over a bed of spheres.
struct Slide {
    Real worn = 0, work = 0;  ///< [m3], of friction [J]
    Slide(const ChosenWear& law, bool on_spheres) {
        constexpr Real stiffness = 1e6, great = 1e4, off = 0.05, foot = 0.02;
        const Clump block = make_clump(
            "block",
            {{{off, off, 0}, foot}, {{off, -off, 0}, foot}, {{-off, off, 0}, foot}, {{-off, -off, 0}, foot}},
            ClumpParts::apart);
        const Real pressed = density * block.volume * standard_gravity / (4 * stiffness);
        Scene scene;
        scene.concrete =
            on_spheres ? ConcreteBlock{flat_lattice(1.6, 0.4, {.layers = 1})} : flat_concrete(great);
        // On its springs, in balance; feet off the middle of the great sphere stand a little lower.
        const Vec3 start(on_spheres ? -0.7 : 0, 0, foot - (on_spheres ? 0 : pressed + square(off) / great));
        scene.add_stone(block, {.position = start, .velocity = {slide_speed, 0, 0}}, density);
        auto sim =
            simulate(std::move(scene))
                .contact(LinearSpring{{.stiffness = stiffness, .restitution = restitution, .friction = mu}})
                .wear(law);
        sim.run({.end_time = 1.2, .time_step = 2e-5});
        worn = sim.concrete().worn_volume(), work = sim.ledger().lost_sliding;
    }
};

constexpr Real mm3 = 1e9;

Summary wear_laws(const OutputFolder& folder) {
    Summary summary{
        {"speed_m_per_s", speed}, {"mass_kg", mass}, {"restitution", restitution}, {"friction", mu}};
    LineChart chart{.title = "One impact at 5 m/s under each law",
                    .x = {.label = "angle between path and surface", .unit = "degree", .min = 0, .max = 90},
                    .y = {.label = "worn volume / that law's largest", .min = 0, .max = 1.1}};
    const auto law_cases = cases();
    Curve closed_forms{.title = "closed forms, where there are", .style = CurveStyle::points};
    for (const Case& c : law_cases) {
        Curve curve{.title = c.title};
        std::vector<Real> exact;
        for (const Real angle : evenly(3, 90, 30)) {
            curve.x.push_back(angle), curve.y.push_back(worn_by_impact(c.law, angle));
            exact.push_back(c.impact(angle));
        }
        const Real largest = *std::max_element(curve.y.begin(), curve.y.end());
        Real worst = 0;
        for (std::size_t n = 0; n < exact.size(); ++n) {
            if (std::isfinite(exact[n])) worst = std::max(worst, std::abs(curve.y[n] - exact[n]) / largest);
            curve.y[n] /= largest;
            closed_forms.x.push_back(curve.x[n]), closed_forms.y.push_back(exact[n] / largest);
        }
        summary[c.key + "_impact_largest_mm3"] = mm3 * largest;
        summary[c.key + "_impact_error_of_largest"] = worst;
        chart.curves.push_back(std::move(curve));
    }
    chart.curves.push_back(std::move(closed_forms));
    draw(chart, folder.path("worn_against_angle.png"));

    for (const Case& c : law_cases) {
        const Slide flat(c.law, false), rough(c.law, true);
        const Real expected = c.block(0.5 * density * 4 * 4.0 / 3 * pi * cube(0.02) * square(slide_speed));
        summary[c.key + "_block_mm3"] = mm3 * flat.worn;
        if (expected > 0) summary[c.key + "_block_error_relative"] = relative_error(flat.worn, expected);
        summary[c.key + "_block_on_spheres_mm3"] = mm3 * rough.worn;
    }
    return summary;
}

}  // namespace

int main(int argc, char** argv) {
    return textbook_main(argc, argv, "05_wear_laws", "Five wear laws on one stone", wear_laws);
}
