#pragma once
// Where a run goes wrong, and by how much: tunnelling, lost tangential memory, energy drift.

#include "stable_limit.hpp"

#include <abrade/dem/time/odeint_steppers.hpp>

namespace abrade::charts {

// --- tunnelling --------------------------------------------------------------------------------------

/// The speed [m/s] at which two equal frictionless spheres have the energy to pass through each other:
/// 1/2 (m/2) v^2 = 1/2 k (2 r)^2.
inline Real tunnelling_speed(Real radius, Real stiffness, Real mass) {
    return radius * std::sqrt(8 * stiffness / mass);
}

struct Encounter {
    Real approach = 0;  ///< [m/s]
    Scene scene{};
    LinearSpring law;

    /// Two balls head on, at a share of their tunnelling speed.
    explicit Encounter(Real share) : law(linear_law(1, 0)) {
        const Real r = 0.5 * ball_diameter, mass = 4.0 / 3 * pi * cube(r) * stone_density;
        approach = share * tunnelling_speed(r, law.stiffness(), mass);
        scene.gravity.setZero();
        for (const Real side : {-1.0, 1.0})
            scene.add_sphere(
                r, {.position = {1.05 * side * r, 0, 0}, .velocity = {-0.5 * side * approach, 0, 0}},
                stone_density);
    }
};

/// Speed at which they part over that of their approach, by the engine without its guards: 1 where they
/// bounce off, -1 where they have passed through each other.
inline Real parting_speed(Real share) {
    const Encounter meeting(share);
    using P = Policies<LinearSpring, NoBond, NoWear, NoFluid, NoDrag>;
    World<P> world(State<P>(meeting.scene, P{meeting.law, {}, {}, {}, {}}));
    world.set_skin(0.05 * ball_diameter);
    world.open(0);
    const Real mass = world.particles().mass[0];
    const Real dt = 0.01 * std::sqrt(mass / meeting.law.stiffness());
    for (int n = 0; n < 1500; ++n) world.step(n * dt, dt, false);
    world.publish();
    return (world.particles().velocity[1].x() - world.particles().velocity[0].x()) / meeting.approach;
}

// --- lost tangential memory -----------------------------------------------------------------------------

enum class Keeping { once_a_step, never, at_each_of_two_stages };

/// A linear spring whose memory is kept as the engine keeps it, or as it must not be: dropped, or committed
/// at each of two stages of one step.
class Misremembering {
public:
    static constexpr std::string_view name = "Misremembering";
    struct Params {
        LinearSpring::Params spring{};
        Keeping keeping = Keeping::once_a_step;
        void validate() const { spring.validate(); }
        void visit(auto&& f) const { spring.visit(f); }
    };
    template <class Number>
    using Memory = LinearSpring::Memory<Number>;

    explicit Misremembering(Params params) : params_(params), law_(params.spring) {}
    const Params& params() const noexcept { return params_; }
    ContactResponse<Real, Memory<Real>> respond(const ContactKinematics<Real>& contact,
                                                const Memory<Real>& memory) const noexcept {
        if (params_.keeping == Keeping::never) return law_.respond(contact, {});
        const auto once = law_.respond(contact, memory);
        return params_.keeping == Keeping::once_a_step ? once : law_.respond(contact, once.memory);
    }
    ContactRigidity rigidity(Real radius) const noexcept { return law_.rigidity(radius); }
    Real stable_dt(Real mass, Real radius) const noexcept { return law_.stable_dt(mass, radius); }

private:
    Params params_;
    LinearSpring law_;
};
static_assert(ContactLaw<Misremembering>);

struct Rest {
    Real slid = 0;     ///< in the second half of the time [m]
    Real creep = 0;    ///< the speed that a spring made anew at each step allows, see `rest_on_incline` [m/s]
    Real residue = 0;  ///< integration residue over the work of gravity in that time [-]
    Real forgotten = 0;  ///< what the forgotten springs should have taken of that work [-]
    Real duration = 0;   ///< of that half [s]
};

/// A stone of four balls lies on an incline of 10 degrees, friction 0.5: it must stay. Without memory each
/// contact holds by k_t v dt + c_t v only, and the stone creeps at g sin(10 deg) m / (4 (k_t dt + c_t)).
inline Rest rest_on_incline(Keeping keeping) {
    const Misremembering law{
        {.spring = {.stiffness = 1e5, .restitution = 0.3, .friction = 0.5}, .keeping = keeping}};
    const Real r = 0.01, angle = 10 * pi / 180;
    std::vector<Sphere> balls;
    for (const Real x : {-1.0, 1.0})
        for (const Real y : {-1.0, 1.0}) balls.push_back({Vec3(x * r, y * r, 0), r});
    Scene scene;
    scene.gravity = standard_gravity * Vec3(std::sin(angle), 0, -std::cos(angle));
    scene.add_wall({0, 0, 0}, {0, 0, 1});
    const Clump stone = make_clump("four balls", balls);
    scene.add_stone(stone, {.position = {0, 0, r - stone_density * stone.volume * 2.3 / 1e5}}, stone_density);
    auto sim = simulate(scene).contact(law);
    const Real dt = 2e-5, half = 0.5;
    sim.run({.end_time = half, .time_step = dt});
    const Real start = sim.particles().position[0].x(), residue = sim.ledger().integration_residue();
    sim.run({.end_time = 2 * half, .time_step = dt});
    const Real mass = sim.particles().mass[0], pull = mass * standard_gravity * std::sin(angle);
    const LinearSpring spring(law.params().spring);
    const Real kt = spring.tangential_stiffness(), ct = 2 * spring.damping_ratio() * std::sqrt(kt * mass);
    Rest rest{.duration = half};
    rest.slid = sim.particles().position[0].x() - start;
    rest.creep = pull / (4 * (kt * sim.time_step() + ct));
    rest.forgotten = kt * sim.time_step() / (kt * sim.time_step() + ct);
    rest.residue = (sim.ledger().integration_residue() - residue) / std::max(pull * rest.slid, 1e-30);
    return rest;
}

// --- energy drift -----------------------------------------------------------------------------------------

/// x'' = -x.
struct Spring {
    using Vector = std::array<Real, 1>;
    Vector acceleration(const Vector& x, const Vector&) { return {-x[0]}; }
    Vector acceleration_after(Real, const Vector& x, const Vector&) { return {-x[0]}; }
    void commit() {}
};

/// Largest error of the energy, as a share of it, up to each of the given numbers of steps of dt = 0.1/omega.
template <class M>
std::vector<Real> energy_errors(const std::vector<int>& marks) {
    Spring system;
    PhasePoint<1> point{{1}, {0}};
    typename M::template Stepper<Spring, 1> stepper(system, point);
    std::vector<Real> errors;
    Real most = 0;
    int n = 0;
    for (const int mark : marks) {
        for (; n < mark; ++n) {
            stepper.step(0.1);
            most = std::max(most, std::abs(square(point.position[0]) + square(point.velocity[0]) - 1));
        }
        errors.push_back(most);
    }
    return errors;
}
/// Explicit Euler, in closed form: (1 + dt^2)^n.
inline std::vector<Real> euler_errors(const std::vector<int>& marks) {
    std::vector<Real> errors;
    for (const int mark : marks) errors.push_back(std::expm1(mark * std::log1p(0.01)));
    return errors;
}
/// The engine: a ball that swings between two fixed ones without friction or damping. Kinetic and stored
/// energy above that of rest, k delta^2.
inline std::vector<Real> engine_errors(const std::vector<int>& marks) {
    using P = Policies<LinearSpring, NoBond, NoWear, NoFluid, NoDrag>;
    const LinearSpring law = linear_law(1, 0);
    const Real pressed = 1e-5;
    Scene scene;
    scene.gravity.setZero();
    State<P> state(scene, P{law, {}, {}, {}, {}});
    for (int n = 0; n < 3; ++n) {
        Bed::Body ball = ball_at({n * (ball_diameter - pressed), 0, 0}, n == 1 ? Kind::stone : Kind::fixed);
        state.particles.add(ball.clump, stone_density, ball.state, ball.kind);
    }
    const Real omega = std::sqrt(2 * law.stiffness() / state.particles.mass[1]), dt = 0.1 / omega;
    state.particles.velocity[1].x() = 0.5 * omega * pressed;
    const Real given = 0.5 * state.particles.mass[1] * state.particles.velocity[1].squaredNorm();
    World<P> world(std::move(state));
    world.set_skin(0.05 * ball_diameter);
    world.open(0);
    std::vector<Real> errors;
    Real most = 0;
    int n = 0;
    for (const int mark : marks) {
        for (; n < mark; ++n) {
            world.step(n * dt, dt, false);
            // Not at every step: an observation costs more than one; 7 is no divisor of a period.
            if (n > 100 && n % 7 != 0) continue;
            const Ledger& now = world.publish();
            const Real energy = now.kinetic + now.stored_contacts - law.stiffness() * square(pressed);
            most = std::max(most, std::abs(energy / given - 1));
        }
        errors.push_back(most);
    }
    return errors;
}

}  // namespace abrade::charts
