// A fluid that changes in time goes along with the solids: never behind them, in steps of its own, and what
// goes wrong in it stops the run.
#include <abrade/fluid/water_energy.hpp>
#include <abrade/sim/print.hpp>
#include <abrade/sim/simulation.hpp>

#include <doctest/doctest.h>

#include <sstream>
#include <vector>

using namespace abrade;

namespace {

/// Still water that counts how it is brought on. Its speed along x is its time.
struct Rising {
    static constexpr std::string_view name = "Rising";
    struct Params {
        Real step = 1e-3;   ///< [s]; 0: nothing flows
        Real start = 0;     ///< [s]
        Real fails_at = 1;  ///< [s]
        void validate() const {}
        void visit(auto&&) const {}
    };
    explicit Rising(Params params) : params_(params), time_(params.start) {}
    const Params& params() const noexcept { return params_; }

    FluidSample sample(const Vec3&, Real) const noexcept { return {{time_, 0, 0}, 10, 1000, 1e-3}; }
    Real time() const noexcept { return time_; }
    FluidStep stable_step() const noexcept {
        FluidStep step;
        if (params_.step > 0) step.lower(params_.step, "CFL", 7);
        return step;
    }
    void advance(Real to) {
        if (to > params_.fails_at) throw FluidError("cell 7 at x = 2 m: speed 1e+09 m/s");
        if (to <= time_) return;
        time_ = to;
        reached.push_back(to);
    }

    std::vector<Real> reached;  ///< [s]

private:
    Params params_;
    Real time_ = 0;
};
static_assert(AdvancingFluid<Rising> && !AccountsForEnergy<Rising>);

/// The same with an energy account.
struct Counting : Rising {
    using Rising::Rising;
    bool has_energy_account() const noexcept { return time() > 0; }
    WaterEnergy energy() const { return {.kinetic = 7.25, .inflow = 7.25}; }
};
static_assert(AdvancingFluid<Counting> && AccountsForEnergy<Counting>);

/// A fluid with a clock that does not go on.
struct Still : NoFluid {
    using NoFluid::NoFluid;
    Real time() const noexcept { return 0; }
};
static_assert(FluidModel<Still> && !AdvancingFluid<Still>);

auto stone_in(Rising::Params params) {
    Scene scene;
    scene.gravity.setZero();
    scene.add_sphere(0.01, {.position = {0, 0, 0}});
    return simulate(scene).contact(LinearSpring{{.stiffness = 1e5}}).fluid(Rising{params});
}

}  // namespace

TEST_CASE("a fluid of long steps takes whole ones, and is never behind the solids") {
    auto sim = stone_in({.step = 1e-3});
    Index seen = 0;
    sim.run({.end_time = 5.5e-3, .time_step = 1e-4, .observe_every = 1e-4}, [&](const auto& now) {
        ++seen;
        CHECK(now.fluid_model().time() >= now.time() * (1 - 1e-12));
        CHECK(now.fluid_model().time() <= now.time() + 1e-3);
    });
    CHECK(seen == 56);
    const auto& reached = sim.fluid_model().reached;
    REQUIRE(reached.size() == 6);
    for (std::size_t n = 0; n < 6; ++n)
        CHECK(reached[n] == doctest::Approx(1e-3 * static_cast<Real>(n + 1)).scale(0));
}

TEST_CASE("a fluid of short steps is brought to each step of the solids") {
    for (const Real step : {1e-6, 0.0}) {  // 0: nothing flows, so there is no step to round up to
        auto sim = stone_in({.step = step});
        sim.run({.end_time = 1e-3, .time_step = 1e-4});
        CHECK(sim.fluid_model().reached.size() == 10);
        CHECK(sim.fluid_model().time() == doctest::Approx(1e-3).scale(0));
    }
}

TEST_CASE("a fluid that begins earlier has settled before the solids begin, one that is ahead waits") {
    auto early = stone_in({.step = 1e-3, .start = -30});
    early.run({.end_time = 0}, [](const auto& now) {
        REQUIRE(!now.fluid_model().reached.empty());
        CHECK(now.fluid_model().reached.back() == 0);
    });
    auto late = stone_in({.step = 1e-3, .start = 0.5});
    late.run({.end_time = 0.01, .time_step = 1e-4});
    CHECK(late.fluid_model().reached.empty());
}

TEST_CASE("a user can stop a fluid that settles, and go on") {
    auto sim = stone_in({.step = 1e-3, .start = -30});
    sim.run({.end_time = 0.01, .time_step = 1e-4, .stop = [&] { return sim.fluid_model().time() > -20; }});
    CHECK(sim.stopped());
    CHECK(sim.steps() == 0);
    CHECK(sim.fluid_model().time() == doctest::Approx(-20).epsilon(0.01));
    sim.run({.end_time = 0.01, .time_step = 1e-4});
    CHECK_FALSE(sim.stopped());
    CHECK(sim.steps() == 100);
    auto whole = stone_in({.step = 1e-3, .start = -30});
    whole.run({.end_time = 0.01, .time_step = 1e-4});
    CHECK(sim.particles().velocity[0] == whole.particles().velocity[0]);
}

TEST_CASE("looking on changes nothing, and the ledger closes while the fluid changes") {
    auto watched = stone_in({.step = 7e-4}), alone = stone_in({.step = 7e-4});
    watched.run({.end_time = 0.05, .time_step = 1e-4, .observe_every = 3e-4}, [](const auto&) {});
    alone.run({.end_time = 0.05, .time_step = 1e-4});
    CHECK(watched.particles().velocity[0] == alone.particles().velocity[0]);
    CHECK(watched.fluid_model().reached == alone.fluid_model().reached);
    CHECK(watched.particles().velocity[0].x() > 0);
    CHECK(watched.ledger().residual_relative() < 1e-12);
    std::ostringstream out;
    out << watched;
    CHECK(out.str().find(", fluid ") != std::string::npos);
}

TEST_CASE("a fluid that accounts for its energy is told of beside the ledger, once it does") {
    Scene scene;
    scene.add_sphere(0.01, {.position = {0, 0, 0}});
    auto sim = simulate(scene).contact(LinearSpring{{.stiffness = 1e5}}).fluid(Counting{Rising::Params{}});
    const auto printed = [&] {
        std::ostringstream out;
        out << sim;
        return out.str();
    };
    sim.run({.end_time = 0});
    CHECK(printed().find("water    [J]") == std::string::npos);
    sim.run({.end_time = 0.002, .time_step = 1e-4});
    CHECK(printed().find("water    [J]\n         kinetic               7.25\n") != std::string::npos);
}

TEST_CASE("a fluid that goes wrong stops the run, and the state before it is kept") {
    auto sim = stone_in({.step = 1e-3, .fails_at = 0.0125});
    std::string said;
    Index id = 0;
    try {
        sim.run({.end_time = 1, .time_step = 1e-4});
    } catch (const RunError& error) {
        said = error.what(), id = error.id;
        CHECK(error.time == doctest::Approx(0.012));
        CHECK(error.step == 120);
    }
    CHECK(id == -1);
    CHECK(said ==
          "step 120 (t = 0.012 s, dt = 0.0001 s): Rising: cell 7 at x = 2 m: speed 1e+09 m/s; the last "
          "good state is that of t = 0 s");
    CHECK(sim.fluid_model().time() == doctest::Approx(0.012));
    CHECK(sim.last_good().position.size() == 1);

    auto at_once = stone_in({.start = -1, .fails_at = -0.5});
    CHECK_THROWS_WITH_AS(at_once.run({.end_time = 1}), doctest::Contains("step 0 (t = 0 s, dt = "), RunError);
}
