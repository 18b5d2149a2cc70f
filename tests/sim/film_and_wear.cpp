// Wear laws see impacts through the film of a law that acts before surfaces touch, and nothing of the film
// itself.

#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/dem/laws/lubrication.hpp>
#include <abrade/geometry/lattice.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/archard.hpp>
#include <abrade/wear/finnie.hpp>
#include <abrade/wear/ishibashi.hpp>
#include <abrade/wear/sklar_dietrich.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <array>
#include <tuple>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

const LinearSpring dry{{.stiffness = 1e6, .restitution = 0.5, .friction = 0.4}};
Lubricated<LinearSpring> wet(Real viscosity) {
    return Lubricated<LinearSpring>{
        {.contact = dry.params(), .viscosity = viscosity, .range = 0.002, .roughness = 1e-5}};
}

/// What each law says that a contact wears [m3], in a simulation that none of them changes.
struct EachLaw : NoWear {
    using NoWear::NoWear;
    static constexpr std::string_view name = "EachLaw";
    static inline std::array<Real, 5> worn{};

    static auto laws() {
        return std::tuple(SubParticleAbrasion{{}}, Archard{{.coefficient = 1e-4, .hardness = 1e9}},
                          Finnie{{.flow_stress = 1e7}}, SklarDietrich{{.tensile = 2.7e6, .youngs = 2.7e10}},
                          Ishibashi{{.impact = 1e-9, .friction = 1e-10}});
    }
    WearIncrement<Real> increment(const ContactKinematics<Real>& contact,
                                  const ContactLoad<Real>& load) const noexcept {
        std::size_t k = 0;
        const auto add = [&](const auto& law) {
            const auto increment = law.increment(contact, load);
            worn[k++] += increment.normal + increment.tangential;
        };
        std::apply([&](const auto&... law) { (add(law), ...); }, laws());
        return {0, 0};
    }
};

struct Struck {
    std::array<Real, 5> worn;  ///< [m3], as in `EachLaw::laws`
    Real height, speed;        ///< of the ball at the end [m], along the normal [m/s]
};

/// A ball that strikes rigid concrete at 45 degrees.
template <class Law>
Struck struck_by(const Law& law) {
    Scene scene;
    scene.gravity.setZero();
    scene.concrete = ConcreteBlock{.lattice = flat_lattice(0.3, 0.1, {.sphere_diameter = 0.02, .layers = 1}),
                                   .level = ConcreteLevel::rigid};
    scene.add_sphere(0.02, {.position = {-0.05, 0, 0.06}, .velocity = {1, 0, -1}});
    EachLaw::worn = {};
    auto sim = simulate(scene).contact(law).wear(EachLaw{});
    sim.run({.end_time = 0.1});
    return {EachLaw::worn, sim.particles().position[0].z(), sim.particles().velocity[0].z()};
}

}  // namespace

TEST_CASE("a film that hardly slows a ball changes little of what its impact wears") {
    const Struck without = struck_by(dry), with = struck_by(wet(1e-6));
    CHECK(with.speed > 0);  // it has been there
    for (std::size_t law = 0; law < with.worn.size(); ++law) {
        CAPTURE(law);
        CHECK(without.worn[law] > 0);
        CHECK(with.worn[law] == doctest::Approx(without.worn[law]).epsilon(0.02).scale(0));
    }
}

TEST_CASE("a film that stops a ball before it touches wears nothing, by no law") {
    const Struck by = struck_by(wet(100));
    CHECK(std::abs(by.speed) < 0.01);  // it has been stopped
    CHECK(by.height < 0.06);
    for (const Real worn : by.worn) CHECK(worn == 0);
}
