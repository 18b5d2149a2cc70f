// Dormant concrete: who is a body, what the ledger says, what comes loose while it sleeps.
#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/bond/parallel_bond.hpp>
#include <abrade/core/parallel.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <doctest/doctest.h>

#include "../message_of.hpp"

using namespace abrade;

namespace {

constexpr Real d = 0.02;
const LinearSpring law{{.stiffness = 1e6, .restitution = 0.6, .friction = 0.4}};
const MohrCoulomb bond{{.tensile = 2.7e6, .stiffness = 4e6, .damping = 0.3}};
const SubParticleAbrasion wear{{.acceleration = 100}};

/// A slab, and a stone that falls on it from `height` [m] at x.
Scene slab(Real side, Real height, Real x = 0) {
    Scene scene;
    scene.concrete = ConcreteBlock{flat_lattice(side, side, {.sphere_diameter = d, .layers = 3})};
    scene.add_sphere(0.025, {.position = {x, 0, 0.025 + height}});
    return scene;
}

template <class Sim>
Index count(const Sim& sim, Kind kind) {
    const auto& kinds = sim.particles().kind;
    return static_cast<Index>(std::count(kinds.begin(), kinds.end(), kind));
}

}  // namespace

TEST_CASE("untouched concrete is no body; what is hit wakes, and sleeps again") {
    auto sim = simulate(slab(0.5, 0.05)).contact(law).bond(bond).wear(wear);
    const auto run = [&](Real until) { sim.run({.end_time = until, .wake_force = 1}); };
    run(0.02);
    CHECK(sim.particles().bodies() == 1);  // the stone, on its way
    CHECK(sim.awake_fraction_mean() == 0);
    CHECK(sim.concrete().sites() == 25 * 25 * 3);
    for (Index s = 0; s < sim.concrete().sites(); ++s)
        CHECK(sim.concrete_place(s) == sim.concrete().lattice().sites[static_cast<std::size_t>(s)].centre);
    run(0.103);
    CHECK(count(sim, Kind::concrete) > 20);
    CHECK(sim.concrete().worn_volume() > 0);
    const Real worn = sim.concrete().worn_volume();
    run(0.155);  // the stone is up again
    CHECK(count(sim, Kind::concrete) == 0);
    CHECK(sim.concrete().worn_volume() == worn);
    run(0.6);
    const Ledger& e = sim.ledger();
    CHECK(e.residual_relative() < 1e-12);
    CHECK(e.lost_asleep > 0);
    CHECK(e.lost_asleep < 1e-3 * e.lost());
    CHECK(std::abs(e.integration_residue()) < 1e-3 * e.lost());
    CHECK(sim.awake_fraction_mean() < 0.5);
}

TEST_CASE("ids and sites of what wakes again are those it had") {
    auto sim = simulate(slab(0.3, 0.001)).contact(law).bond(bond);
    sim.run({.end_time = 0.02, .wake_force = 1});
    const Particles& p = sim.particles();
    Index seen = 0;
    for (std::size_t b = 0; b < p.site.size(); ++b) {
        if (p.site[b] < 0) continue;
        CHECK(p.id[b] == p.site[b]);
        const LatticeSite& site = sim.concrete().lattice().sites[static_cast<std::size_t>(p.site[b])];
        CHECK((p.position[b] - site.centre).norm() < 0.01 * d);
        CHECK(sim.concrete_place(p.site[b]) == p.position[b]);
        CHECK((p.kind[b] == Kind::fixed) == site.held);
        ++seen;
    }
    CHECK(seen > 0);
    CHECK(p.id.front() == 15 * 15 * 3);  // the stone came after the concrete
}

TEST_CASE("a run may begin asleep, go on awake, and sleep again") {
    auto sim = simulate(slab(0.3, 0.002)).contact(law).bond(bond).wear(wear);
    sim.run({.end_time = 0.03, .wake_force = 1});
    sim.run({.end_time = 0.031});
    CHECK(count(sim, Kind::concrete) == 15 * 15 * 2);
    CHECK(count(sim, Kind::fixed) == 15 * 15);
    CHECK(sim.ledger().residual_relative() < 1e-12);
    sim.run({.end_time = 0.2, .wake_force = 5});
    CHECK(count(sim, Kind::concrete) < 15 * 15);
    CHECK(sim.ledger().residual_relative() < 1e-12);
    CHECK(std::abs(sim.ledger().integration_residue()) < 1e-2 * sim.ledger().lost());
}

TEST_CASE("bits do not depend on threads") {
    const auto positions = [](int threads) {
        const int before = thread_count();
        set_thread_count(threads);
        auto sim = simulate(slab(0.6, 0.001, 0.1)).contact(law).bond(bond).wear(wear);
        sim.run({.end_time = 0.02, .wake_force = 0.5});
        set_thread_count(before);
        return std::pair(sim.particles().position, sim.concrete().worn_volume());
    };
    CHECK(positions(1) == positions(2));
}

TEST_CASE("what hangs on a broken bridge falls, though it slept") {
    // A beam that stands out over nothing: its tip is far from where the stone cuts it off.
    std::vector<Vec3> centres;
    for (int n = 0; n < 30; ++n) centres.push_back({n * d, 0, -0.5 * d});
    Lattice beam = lattice_of(centres, 0.5 * d, 30 * cube(d));
    beam.sites.front().held = true;
    Scene scene;
    scene.concrete = ConcreteBlock{beam};
    scene.add_sphere(0.025, {.position = {5 * d, 0, 0.026}, .velocity = {0, 0, -8}});
    auto sim = simulate(scene).contact(law).bond(MohrCoulomb{{.tensile = 1e5, .stiffness = 4e6}});
    Index awake_before = 0;
    sim.run({.end_time = 1,
             .observe_every = 1e-5,

             .wake_force = 30,
             .stop = [&] { return sim.bonds_broken() > 0; }},
            [&](const auto& now) {
                if (now.bonds_broken() == 0) awake_before = count(now, Kind::concrete);
            });
    MESSAGE(awake_before << " awake when the bridge broke");
    CHECK(awake_before < 25);
    sim.run({.end_time = sim.time() + 0.05, .wake_force = 30});
    Index gone = 0;
    for (Index s = 0; s < 30; ++s) gone += sim.concrete().gone(s);
    CHECK(gone > 20);
    CHECK(sim.concrete().gone(29));
    CHECK(count(sim, Kind::grain) == gone);
    CHECK(sim.ledger().residual_relative() < 1e-12);
}

TEST_CASE("other variants: rigid concrete, bonds with moments, a periodic channel") {
    SUBCASE("rigid concrete") {
        const auto worn = [](Real wake_force, Index* bodies) {
            auto sim = simulate(slab(0.5, 0.01)).contact(law).wear(wear);
            sim.run({.end_time = 0.06, .wake_force = wake_force});
            *bodies = sim.particles().bodies();
            return sim.concrete().worn_volume();
        };
        Index all = 0, near = 0;
        const Real expected = worn(0, &all);
        CHECK(expected > 0);
        CHECK(worn(1, &near) == doctest::Approx(expected).scale(0).epsilon(1e-12));
        CHECK(all == 25 * 25 * 3 + 1);
        CHECK(near < 60);
    }
    SUBCASE("bonds with moments") {
        const auto worn = [](Real wake_force) {
            auto sim = simulate(slab(0.4, 0.01))
                           .contact(law)
                           .bond(ParallelBond{{.youngs = 2e8, .tensile = 2.7e6, .cohesion = 5e6}})
                           .wear(wear);
            sim.run({.end_time = 0.06, .wake_force = wake_force, .wake_radius = 4});
            CHECK(sim.ledger().residual_relative() < 1e-12);
            return sim.concrete().worn_volume();
        };
        const Real expected = worn(0);
        CHECK(expected > 0);
        CHECK(std::abs(worn(1) / expected - 1) < 0.01);
    }
    SUBCASE("a periodic channel") {
        const auto after = [](Real wake_force) {
            Scene scene = slab(0.4, 0.002, 0.195);
            scene.periodic_along = {true, false, false};
            scene.bounds = {{-0.2, -1, -1}, {0.2, 1, 1}};
            auto sim = simulate(scene).contact(law).bond(bond).wear(wear);
            sim.run({.end_time = 0.03, .wake_force = wake_force, .wake_radius = 6});
            return sim.concrete().worn_volume();
        };
        const Real expected = after(0);
        CHECK(expected > 0);
        CHECK(std::abs(after(0.5) / expected - 1) < 1e-3);
    }
}

TEST_CASE("a crater that has come to rest wears no more, and every account is a number") {
    // Spheres that have lost bonds and stand still must not be taken for contacts of each other.
    const auto run = [](Real wake_force, Index radius) {
        Scene scene = slab(0.2, 1);
        scene.stones.front().state = {.position = {0, 0, 0.026}, .velocity = {3, 0, -6}};
        auto sim =
            simulate(scene).contact(law).bond(MohrCoulomb{{.tensile = 3e5, .stiffness = 4e6}}).wear(wear);
        sim.run({.end_time = 0.1, .sleep_speed = 0.02, .wake_force = wake_force, .wake_radius = radius});
        sim.ledger().visit([](std::string_view name, Real value) {
            CAPTURE(name);
            CHECK(std::isfinite(value));
        });
        sim.world().each_contact([&](Index body, Index other, const auto&, const auto&) {
            const auto still = [&](Index b) {
                return b < 0 || sim.particles().inverse_mass[static_cast<std::size_t>(b)] == 0;
            };
            CHECK(!(still(body) && still(other)));
        });
        CHECK(sim.bonds_broken() > 10);
        return sim.concrete().worn_volume();
    };
    const Real awake = run(0, 2);
    CHECK(run(1, 2) == doctest::Approx(awake).scale(0).epsilon(0.05));
    CHECK(run(10, 0) == doctest::Approx(awake).scale(0).epsilon(0.05));
}

TEST_CASE("feed keeps clear of concrete that sleeps") {
    Scene scene = slab(0.5, 1);
    scene.feed = FeedParams{.volume_rate = 1e-3,
                            .classes = {{.size = 0.03, .fraction = 1, .shape = StoneShape::sphere}},
                            .region = {{-0.2, -0.2, -0.05}, {0.2, 0.2, 0.02}},
                            .velocity = {0, 0, 0}};
    const auto lowest = [&](Real wake_force) {
        auto sim = simulate(scene).contact(law).bond(bond);
        Real z = 1;
        sim.run({.end_time = 0.1, .observe_every = 1e-3, .wake_force = wake_force}, [&](const auto& now) {
            for (std::size_t b = 0; b < now.particles().kind.size(); ++b)
                if (now.particles().kind[b] == Kind::stone) z = std::min(z, now.particles().position[b].z());
        });
        CHECK(sim.feed()->supplied_stones() > 3);
        return z;
    };
    CHECK(lowest(1) > 0.005);
    CHECK(lowest(1) == doctest::Approx(lowest(0)).scale(0).epsilon(0.2));
}

TEST_CASE("the stable step is that of all concrete, asleep or not") {
    auto stiff =
        simulate(slab(0.2, 0.05)).contact(law).bond(MohrCoulomb{{.tensile = 2.7e6, .stiffness = 4e8}});
    CHECK(message_of([&] {
              stiff.run({.end_time = 1e-3, .time_step = 1e-5, .wake_force = 1});
          }).find("at most the stable step") != std::string::npos);
    auto sim = simulate(slab(0.2, 0.05)).contact(law).bond(MohrCoulomb{{.tensile = 2.7e6, .stiffness = 4e8}});
    sim.run({.end_time = 1e-4, .wake_force = 1});
    const Real asleep = sim.stable_step_now().seconds;
    sim.run({.end_time = 2e-4});
    CHECK(sim.stable_step_now().seconds == doctest::Approx(asleep).scale(0).epsilon(1e-3));
    CHECK(asleep < 3e-6);
}

TEST_CASE("what rests on sleeping concrete is stored once") {
    Scene scene = slab(0.3, 0);
    auto sim = simulate(scene).contact(law).bond(bond);
    sim.run({.end_time = 1, .observe_every = 0.02, .sleep_speed = 0.01, .wake_force = 0.5},
            [&](const auto& now) {
                Real stored = 0;
                now.world().each_contact(
                    [&](Index, Index, const auto&, const auto& load) { stored += load.stored; });
                CHECK(std::abs(now.ledger().stored_contacts - stored) <= 1e-6 * stored);
            });
}

TEST_CASE("rigid concrete that a stone has passed by is no body any more") {
    Scene scene = slab(2, 1);
    scene.gravity.setZero();
    scene.stones.front().state = {.position = {-0.9, 0, 0.0252}, .velocity = {5, 0, 0}};
    auto sim = simulate(scene).contact(law).wear(wear);
    Index most = 0;
    sim.run({.end_time = 0.3, .observe_every = 1e-3, .wake_force = 1},
            [&](const auto& now) { most = std::max(most, now.particles().bodies()); });
    CHECK(most > 3);
    CHECK(most < 60);
}

namespace {

/// A beam clamped at both ends above a row of spheres that stand on held ones and that it does not touch. A
/// stone breaks it off at one end and presses it down on the row, which it is not bonded to.
struct BrokenBeam {
    static constexpr Index length = 9;
    static constexpr Real gap = 0.02 * d;

    static Scene scene() {
        std::vector<Vec3> centres;
        for (const Real z : {0.0, -d - gap, -2 * d - gap})
            for (Index n = 0; n < length; ++n) centres.push_back({0.999 * d * n, 0, z});
        Lattice lattice = lattice_of(centres, 0.5 * d, static_cast<Real>(centres.size()) * cube(d), 1e-6);
        for (std::size_t s = 0; s < lattice.sites.size(); ++s)
            lattice.sites[s].held = s >= 2 * length || s == 0 || s == length - 1;
        Scene scene;
        scene.concrete = ConcreteBlock{lattice};
        scene.add_sphere(0.02, {.position = {7 * 0.999 * d, 0, 0.031}, .velocity = {0, 0, -4}});
        return scene;
    }
    static bool in_row(Index site) { return site >= length && site < 2 * length; }

    Index broken = 0, gone = 0;
    bool stood = false;  ///< a sphere of the row, held by no bond that is looked at
    bool woke = false;   ///< some of the row
    Real deepest = 0;    ///< that any of the row was pressed down [m]
    Real pressed = 0;    ///< the hardest that the beam pressed on one of them [N]

    explicit BrokenBeam(Real wake_force) {
        auto sim = simulate(scene()).contact(law).bond(
            ParallelBond{{.youngs = 2e8, .tensile = 1e9, .cohesion = 1e6, .damping = 0.3}});
        sim.run({.end_time = 0.01, .observe_every = 1e-5, .wake_force = wake_force, .wake_radius = length},
                [&](const auto& now) { look(now); });
        CHECK(sim.ledger().residual_relative() < 1e-12);
        broken = sim.bonds_broken();
        for (Index s = 0; s < 2 * length; ++s) gone += sim.concrete().gone(s);
    }
    void look(const auto& sim) {
        const Particles& p = sim.particles();
        for (const Dormancy::Anchor& anchor : sim.world().state().dormancy.anchors)
            stood |= in_row(anchor.site) && anchor.bonds == 0;
        for (std::size_t b = 0; b < p.site.size(); ++b) {
            if (!in_row(p.site[b])) continue;
            woke |= p.inverse_mass[b] > 0;
            deepest = std::max(deepest, -d - gap - p.position[b].z());
        }
        sim.world().each_contact([&](Index body, Index other, const auto&, const auto& load) {
            if (other < 0) return;
            const Index a = p.site[static_cast<std::size_t>(body)],
                        b = p.site[static_cast<std::size_t>(other)];
            if (a >= 0 && b >= 0) pressed = std::max(pressed, load.force.norm());
        });
    }
};

}  // namespace

TEST_CASE("an anchor that contacts alone press on wakes once they press by more than the threshold") {
    const BrokenBeam awake(0);
    MESSAGE(awake.broken << " bonds broken, " << awake.gone << " spheres loose; the beam pressed by "
                         << awake.pressed << " N, the row gave way by " << awake.deepest << " m");
    CHECK(awake.broken > 0);
    CHECK(awake.gone == 0);
    CHECK(awake.pressed > 50);
    const BrokenBeam wakes(0.02 * awake.pressed);
    CHECK(wakes.stood);
    CHECK(wakes.woke);
    CHECK(wakes.broken == awake.broken);
    CHECK(wakes.deepest == doctest::Approx(awake.deepest).epsilon(0.02).scale(0));
    const BrokenBeam stands(3 * awake.pressed);
    CHECK(stands.stood);
    CHECK(!stands.woke);
    CHECK(stands.deepest == 0);
    CHECK(stands.pressed > 0.5 * awake.pressed);
}

TEST_CASE("bad options are named") {
    auto sim = simulate(slab(0.1, 0.1)).contact(law).bond(bond);
    CHECK(message_of([&] {
              sim.run({.end_time = 1, .wake_force = -1});
          }).find("RunOptions.wake_force must be finite and >= 0, got -1 N") != std::string::npos);
    CHECK(message_of([&] {
              sim.run({.end_time = 1, .wake_force = 1, .wake_radius = -1});
          }).find("RunOptions.wake_radius must be >= 0, got -1 bonds") != std::string::npos);
}
