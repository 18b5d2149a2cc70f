// Bodies and a fluid that resolves them, with one that is none: it pushes with a force and a torque that are
// given. What loads do to bodies between exchanges and at them, and the ledger.
#include <abrade/dem/laws/linear_spring.hpp>
#include <abrade/fluid/uniform_flow.hpp>
#include <abrade/geometry/stone_shapes.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

using namespace abrade;

namespace {

/// Force and torque that grow with time; a step of the fluid's is as long as given.
struct Pusher {
    static constexpr std::string_view name = "Pusher";
    using Params = NoParams;
    Pusher() = default;
    explicit Pusher(Params) {}
    const Params& params() const noexcept {
        static constexpr Params none{};
        return none;
    }
    FluidSample sample(const Vec3&, Real) const noexcept { return {}; }
    Real time() const noexcept { return now; }
    FluidStep stable_step() const { return {own_step, "given", -1}; }
    void advance(Real to) { now = to; }
    void advance(Real to, std::span<FlowBody> bodies) {
        const Real dt = to - now;
        longest = std::max(longest, dt);
        for (FlowBody& body : bodies) {
            FlowLoad load{force, torque};
            load.force *= 1 + growth * (now + 0.5 * dt), load.torque *= 1 + growth * (now + 0.5 * dt);
            const FlowLoad more = load - body.load;
            body.velocity += dt * body.inverse_mass * more.force;
            body.angular_velocity += dt * body.inverse_inertia * more.torque;
            body.load = load;
            ++exchanges;
        }
        now = to;
    }
    static void fields(auto&& field) {
        field("now", "s", &Pusher::now), field("exchanges", &Pusher::exchanges);
    }

    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    Real own_step = 1e-2, growth = 0, now = 0, longest = 0;
    Index exchanges = 0;
};
static_assert(ResolvedFluid<Pusher>);
static_assert(!ResolvedFluid<UniformFlow> && !ResolvedFluid<NoFluid>);

constexpr Real radius = 0.05, density = 2000;

Scene with_a(bool clump) {
    Scene scene;
    scene.gravity = {0, 0, -1};
    if (clump)
        scene.add_stone(make_stone(StoneShape::angular, 2 * radius), {.position = {0, 0, 1}}, density);
    else
        scene.add_sphere(radius, {.position = {0, 0, 1}}, density);
    return scene;
}
auto pushed(bool clump, Pusher fluid) {
    return simulate(with_a(clump)).contact(LinearSpring{{.stiffness = 1e4, .restitution = 0.7}}).fluid(fluid);
}

}  // namespace

TEST_CASE("a constant force and torque: the impulse is that of the whole time, the ledger closes") {
    for (const bool clump : {false, true}) {
        CAPTURE(clump);
        Pusher fluid;
        fluid.force = {0.3, 0, 2}, fluid.torque = {0, 2e-4, 0};
        auto sim = pushed(clump, fluid);
        sim.run({.end_time = 0.5});
        const Real mass = sim.particles().mass[0], t = sim.fluid_model().time();
        // Since the last exchange the load has acted on; before the first it acted afterwards, all at once.
        CHECK(sim.time() - t < 1.001e-2);
        CHECK(sim.particles().velocity[0].x() == doctest::Approx(0.3 * 0.5 / mass).epsilon(1e-12));
        CHECK(sim.particles().velocity[0].z() == doctest::Approx((2 / mass - 1) * 0.5).epsilon(1e-12));
        CHECK((sim.particles().angular_momentum[0] - Vec3(0, 1e-4, 0)).norm() < 1e-14);
        CHECK(sim.fluid_model().longest <= 1e-2);
        CHECK(sim.fluid_model().exchanges >= 49);
        CHECK(sim.ledger().flow_work > 0);
        CHECK(sim.ledger().residual_relative() < 1e-13);
        if (!clump) {
            const Real spin = 1e-4 / (0.4 * mass * square(radius));
            const Real moved = 0.5 * mass * sim.particles().velocity[0].squaredNorm() + 0.5e-4 * spin;
            CHECK(sim.ledger().kinetic == doctest::Approx(moved).epsilon(1e-12));
        }
    }
}

TEST_CASE("a growing force: its increments are applied where they are found") {
    Pusher fluid;
    fluid.force = {0.3, 0, 0}, fluid.growth = 10;
    auto sim = pushed(false, fluid);
    sim.run({.end_time = 0.5});
    const Real t = sim.fluid_model().time(), mass = sim.particles().mass[0];
    const Real exchanged = 0.3 * (t + 5 * square(t));
    const Real since = (sim.time() - t) * 0.3 * (1 + 10 * (t - 0.5 * sim.fluid_model().longest));
    CHECK(mass * sim.particles().velocity[0].x() == doctest::Approx(exchanged + since).epsilon(1e-3));
    CHECK(sim.ledger().residual_relative() < 1e-13);
}

TEST_CASE("a fluid of short steps is asked at each step of the solids, one step late") {
    Pusher fluid;
    fluid.force = {0.3, 0, 0}, fluid.own_step = 1e-9;
    auto sim = pushed(false, fluid);
    sim.run({.end_time = 0.02});
    CHECK(sim.fluid_model().exchanges == sim.steps() - 1);
    CHECK(sim.time() - sim.fluid_model().time() == doctest::Approx(sim.time_step()).epsilon(1e-9));
}

TEST_CASE("observing changes no bit") {
    Pusher fluid;
    fluid.force = {0.3, 0.1, 0.5}, fluid.torque = {1e-4, 0, 1e-4}, fluid.growth = 3;
    auto once = pushed(true, fluid), watched = pushed(true, fluid);
    once.run({.end_time = 0.3});
    watched.run({.end_time = 0.3, .observe_every = 0.013});
    CHECK(once.particles().position[0] == watched.particles().position[0]);
    CHECK(once.particles().angular_momentum[0] == watched.particles().angular_momentum[0]);
    CHECK(once.ledger().flow_work == watched.ledger().flow_work);
}

TEST_CASE("a fluid that begins earlier settles alone; between two runs it waits for the solids") {
    Pusher fluid;
    fluid.force = {0.3, 0, 0}, fluid.now = -0.2;
    auto sim = pushed(false, fluid);
    sim.run({.end_time = 0.05});
    const Index exchanges = sim.fluid_model().exchanges;
    CHECK(exchanges >= 4);
    CHECK(exchanges <= 6);  // none while it settled
    const Real mass = sim.particles().mass[0], between = sim.fluid_model().time();
    CHECK(between < sim.time());
    sim.run({.end_time = 0.1});
    CHECK(sim.fluid_model().longest <= 1e-2);  // nothing was passed over
    CHECK(sim.particles().velocity[0].x() == doctest::Approx(0.3 * 0.1 / mass).epsilon(1e-12));
    CHECK(sim.ledger().residual_relative() < 1e-13);
}
