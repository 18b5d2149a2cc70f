// Dashpots set by the mass of what is free: concrete that bonds hold loses as a rigid bed does, and the time
// step sees the stronger dashpot.
#include "../message_of.hpp"

#include <abrade/bond/mohr_coulomb.hpp>
#include <abrade/dem/laws/hertz_mindlin.hpp>
#include <abrade/dem/laws/linear_hysteretic.hpp>
#include <abrade/dem/laws/material_pairs.hpp>
#include <abrade/dem/laws/rolling_resistance.hpp>
#include <abrade/sim/simulation.hpp>
#include <abrade/wear/sub_particle.hpp>

#include <doctest/doctest.h>

#include <memory>

using namespace abrade;

namespace {

constexpr Real d = 0.02, contact_stiffness = 2e6, e = 0.6;

LinearSpring spring(DampingMass mass, Real friction = 0.5) {
    return LinearSpring{
        {.stiffness = contact_stiffness, .restitution = e, .friction = friction, .damping_mass = mass}};
}
HertzMindlin hertz(DampingMass mass) {
    return HertzMindlin{{.youngs = 2e8, .restitution = e, .friction = 0.5, .damping_mass = mass}};
}

/// A sphere that falls straight onto the middle of one sphere of the concrete at 1 m/s.
Scene drop(Real stone, ConcreteLevel level) {
    Scene scene;
    scene.gravity.setZero();
    scene.concrete = ConcreteBlock{.lattice = flat_lattice(7 * d, 7 * d, {.sphere_diameter = d, .layers = 3}),
                                   .level = level};
    // Between the blows of the corners: a stone of 0.15 m meets the middle one alone.
    scene.add_sphere(0.5 * stone, {.position = {0, 0, 0.5 * stone + 1e-5}, .velocity = {0, 0, -1}});
    return scene;
}

template <class Law>
auto simulation(const Scene& scene, const Law& law, Real bond_stiffness) {
    return simulate(scene).contact(law).bond(MohrCoulomb{{.tensile = 1e12, .stiffness = bond_stiffness}});
}

struct Blow {
    Real share_lost = 0, step = 0;
};
template <class Law>
Blow blow(const Law& law, Real stone, ConcreteLevel level, Real bonds_over_contact) {
    auto sim = simulation(drop(stone, level), law, bonds_over_contact * contact_stiffness);
    Real most = 0;
    // As many steps a contact on every bed: 0.5 of the step that stones alone allow is 50 of them.
    sim.run({.end_time = 6e-3, .safety = level == ConcreteLevel::dynamic ? 0.5 : 0.02, .observe_every = 1e-4},
            [&](const auto& s) { most = std::max(most, s.ledger().kinetic); });
    const Ledger& ledger = sim.ledger();
    CHECK(ledger.residual_relative() < 1e-12);
    CHECK(most < 1.0001 * ledger.kinetic_start);
    for (std::size_t b = 0; b < sim.particles().kind.size(); ++b)
        if (sim.particles().kind[b] == Kind::stone) CHECK(sim.particles().velocity[b].z() > 0.5);  // has left
    return {ledger.concrete_lost_normal / ledger.kinetic_start, 6e-3 / static_cast<Real>(sim.steps())};
}

}  // namespace

TEST_CASE("bonds that hold: an impact on dynamic concrete loses 1 - e^2, as on a rigid bed") {
    const Real closed_form = 1 - square(e);
    const auto check = [&](const auto& free, const auto& both, Real stone, Real as_if_free) {
        const Blow rigid = blow(free, stone, ConcreteLevel::rigid, 1),
                   held = blow(free, stone, ConcreteLevel::dynamic, 256),
                   light = blow(both, stone, ConcreteLevel::dynamic, 256);
        MESSAGE(free.name << ", stone of " << stone << " m: rigid " << rigid.share_lost << ", held "
                          << held.share_lost << ", as if free " << light.share_lost << ", 1 - e^2 "
                          << closed_form);
        CHECK(rigid.share_lost == doctest::Approx(closed_form).epsilon(0.01).scale(0));
        // The sphere gives way by k_c/(k_n + 4 k_s) = 0.2 % of the overlap, the block below by some more.
        CHECK(held.share_lost == doctest::Approx(closed_form).epsilon(0.01).scale(0));
        CHECK(light.share_lost < as_if_free * held.share_lost);
    };
    // 17 times the mass of the sphere that is hit, and 1.1 times.
    check(spring(DampingMass::free), spring(DampingMass::both), 0.05, 0.5);
    check(hertz(DampingMass::free), hertz(DampingMass::both), 0.05, 0.5);
    check(spring(DampingMass::free), spring(DampingMass::both), 0.02, 0.9);
}

TEST_CASE("who counts: bonded spheres are held, grains are not; two that are held are as two that are free") {
    // 1/m of each contact as the law sees it, a stone of 0.05 m at rest on the middle sphere.
    const auto seen = [](DampingMass mass, bool loose) {
        Scene scene = drop(0.05, ConcreteLevel::dynamic);
        scene.stones.front().state = {.position = {0, 0, 0.025 - 1e-6}};
        // A sphere that no bond ties is a grain from the start.
        Lattice& lattice = scene.concrete->lattice;
        const Index middle = lattice.site(3, 3, 0);
        if (loose)
            std::erase_if(lattice.bonds,
                          [&](const auto& bond) { return bond.first == middle || bond.second == middle; });
        auto sim = simulation(scene, spring(mass, 0), 1e8);
        sim.run({.end_time = 1e-4});
        const Particles& p = sim.particles();
        std::vector<std::pair<Kind, Real>> all;
        sim.world().each_contact([&](Index first, Index second, const auto& contact, const auto&) {
            const Index other = p.kind[static_cast<std::size_t>(first)] == Kind::stone ? second : first;
            if (p.kind[static_cast<std::size_t>(first)] == Kind::stone ||
                p.kind[static_cast<std::size_t>(second)] == Kind::stone)
                all.emplace_back(p.kind[static_cast<std::size_t>(other)], contact.inverse_mass);
        });
        return all;
    };
    const Real stone = 1 / (2650 * pi / 6 * cube(0.05)), sphere = 1 / (2400 * pi / 6 * cube(d));
    const auto expect = [&](DampingMass mass, bool loose, Kind kind, Real inverse_mass) {
        const auto all = seen(mass, loose);
        REQUIRE(all.size() == 1);
        CHECK(all[0].first == kind);
        CHECK(all[0].second == doctest::Approx(inverse_mass).epsilon(1e-12).scale(0));
    };
    expect(DampingMass::both, false, Kind::concrete, stone + sphere);
    expect(DampingMass::free, false, Kind::concrete, stone);
    expect(DampingMass::both, true, Kind::grain, stone + sphere);
    expect(DampingMass::free, true, Kind::grain, stone + sphere);

    // The kernel's own rule, lane by lane; offsets in units of a place.
    HotArrays lines;
    lines.resize(2);
    lines.motion[0].inverse_mass = 3, lines.motion[1].inverse_mass = 5;
    struct {
        std::array<LineOffset, pack_lanes> first{}, second{};
    } pack;
    pack.second.fill(line_offset(1));
    const LineReader at(lines);
    for (const auto& [held, expected] :
         {std::pair{HeldSides::none, 8.0}, std::pair{HeldSides::first, 5.0},
          std::pair{HeldSides::second, 3.0}, std::pair{HeldSides::both, 8.0}}) {
        std::array<HeldSides, pack_lanes> sides{};
        sides.fill(held);
        const Pack found = detail::free_inverse_mass(pack, sides.data(), at, Pack(8));
        for (int k = 0; k < pack_lanes; ++k) CHECK(found[k] == expected);
    }
    lines.motion[1].inverse_mass = 0;  // held against what is fixed: its own mass, as ever
    std::array<HeldSides, pack_lanes> first{};
    first.fill(HeldSides::first);
    CHECK(detail::free_inverse_mass(pack, first.data(), at, Pack(3))[0] == 3);
}

TEST_CASE("where no bond holds a sphere that could move, both choices give the same bits") {
    for (const ConcreteLevel level : {ConcreteLevel::quasi_static, ConcreteLevel::rigid}) {
        const auto run = [&](DampingMass mass) {
            Scene scene = drop(0.05, level);
            scene.add_sphere(0.01, {.position = {0.02, 0, 0.08}, .velocity = {0, 0, -3}});  // meets the other
            auto sim = simulation(scene, spring(mass), 1e8);
            sim.run({.end_time = 0.02});
            std::vector<Real> all;
            sim.ledger().visit([&](std::string_view, Real value) { all.push_back(value); });
            for (const Vec3& x : sim.particles().position) all.insert(all.end(), x.data(), x.data() + 3);
            return all;
        };
        CHECK(run(DampingMass::free) == run(DampingMass::both));
    }
}

TEST_CASE("the time step sees the dashpot of the heaviest stone on a light sphere") {
    for (const Real stone : {0.05, 0.15}) {
        CAPTURE(stone);
        const auto step_of = [&](DampingMass mass) {
            auto sim = simulation(drop(stone, ConcreteLevel::dynamic), spring(mass), contact_stiffness);
            sim.run({.end_time = 0});
            return sim.stable_time_step().seconds;
        };
        const Real both = step_of(DampingMass::both), free = step_of(DampingMass::free);
        MESSAGE("stone of " << stone << " m: as if free " << both * 1e6 << " us, held " << free * 1e6
                            << " us");
        CHECK(free < 0.5 * both);
        // The engine's own step, all of it: no energy from nowhere.
        auto sim =
            simulation(drop(stone, ConcreteLevel::dynamic), spring(DampingMass::free), contact_stiffness);
        Real most = 0;
        sim.run({.end_time = 3e-3, .safety = 1, .observe_every = 5e-5},
                [&](const auto& s) { most = std::max(most, s.ledger().kinetic); });
        CHECK(most < 1.0001 * sim.ledger().kinetic_start);
        CHECK(sim.ledger().residual_relative() < 1e-12);
        // The step that was enough before is refused, and says why.
        auto hasty =
            simulation(drop(stone, ConcreteLevel::dynamic), spring(DampingMass::free), contact_stiffness);
        const std::string refused = message_of([&] { hasty.run({.end_time = 3e-3, .time_step = both}); });
        CHECK(refused.find("time_step") != std::string::npos);
        CHECK(refused.find("bonds and contacts as they stand") != std::string::npos);
    }
    // A stone that is still to come counts as well.
    const auto fed = [](DampingMass mass) {
        Scene scene = drop(0.02, ConcreteLevel::dynamic);
        scene.feed = FeedParams{.volume_rate = 1e-9,
                                .classes = {{.size = 0.15, .fraction = 1, .shape = StoneShape::sphere}},
                                .region = {{-0.1, -0.1, 0.3}, {0.1, 0.1, 0.6}}};
        auto sim = simulation(scene, spring(mass), contact_stiffness);
        sim.run({.end_time = 0});
        return sim.stable_time_step().seconds;
    };
    CHECK(fed(DampingMass::free) < 0.2 * fed(DampingMass::both));
}

TEST_CASE(
    "what contacts as they stand allow a held sphere is never above the true limit, nor below half of it") {
    using P = Policies<LinearSpring, MohrCoulomb, NoWear, NoFluid, NoDrag>;
    // A heavy stone pressed between the middle sphere and a fixed one; springs are as good as linear.
    const auto pressed = [](DampingMass mass) {
        constexpr Real overlap = 1e-6;
        Scene scene;
        scene.gravity.setZero();
        scene.concrete = ConcreteBlock{flat_lattice(3 * d, 3 * d, {.sphere_diameter = d, .layers = 2})};
        State<P> state(scene,
                       P{spring(mass, 0), MohrCoulomb{{.tensile = 1e12, .stiffness = 2e6}}, {}, {}, {}});
        const Clump stone = make_clump("stone", {{Vec3::Zero(), 0.05}});
        state.particles.add(stone, 2650, {.position = {0, 0, 0.05 - overlap}}, Kind::stone);
        state.particles.add(stone, 2650, {.position = {0, 0, 0.15 - 2 * overlap}}, Kind::fixed);
        auto world = std::make_unique<World<P>>(std::move(state));
        world->set_skin(0.1 * d);
        world->open(0);
        return world;
    };
    const auto allowed = [&](DampingMass mass) {
        return StableStepNow(pressed(mass)->state()).of_touching(1).seconds;
    };
    const Real free = allowed(DampingMass::free), both = allowed(DampingMass::both);
    const auto grows = [&](DampingMass mass, Real dt) {
        const auto world = pressed(mass);
        Real t = 0;
        // Brought to rest first, so that a dashpot that may not pull hides nothing.
        for (int n = 0; n < 20000; ++n, t += 0.5 * free) world->step(t, 0.5 * free, false);
        // Far above round-off, far below the 2e-6 J that the contacts store.
        const Real bound = std::max(100 * world->publish().kinetic, 1e-14);
        for (int n = 0; n < 3000; ++n, t += dt) {
            world->step(t, dt, false);
            if (!(world->publish().kinetic < bound)) return true;
        }
        return false;
    };
    MESSAGE("allowed: as if free " << both * 1e6 << " us, held " << free * 1e6 << " us");
    CHECK(free < 0.3 * both);
    CHECK(!grows(DampingMass::free, 0.98 * free));
    CHECK(grows(DampingMass::free, 2.02 * free));
    CHECK(!grows(DampingMass::both, 0.98 * both));
    CHECK(grows(DampingMass::free, 0.98 * both));
}

TEST_CASE("wrappers pass it on; other laws have nothing to say; what is neither is refused") {
    const LinearSpring::Params free{.stiffness = 1e6, .restitution = 0.6, .damping_mass = DampingMass::free};
    CHECK(damps_free_mass(LinearSpring{free}));
    CHECK(!damps_free_mass(LinearSpring{{.stiffness = 1e6}}));
    CHECK(damps_free_mass(RollingResistance<LinearSpring>{{.contact = free}}));
    CHECK(!damps_free_mass(LinearHysteretic{{.stiffness = 1e6}}));
    CHECK(damps_free_mass(MaterialPairs<LinearSpring>{
        {.materials = {"a", "b"}, .pairs = {{"a", "a", {.stiffness = 1e6}}, {"a", "b", free}}}}));
    static_assert(!MayDampFreeMass<RollingResistance<LinearHysteretic>>);
    CHECK(describe(LinearSpring{free}).find("damping_mass_free = 1") != std::string::npos);
    const auto wrong = static_cast<DampingMass>(7);
    const std::string rule =
        ".damping_mass must be DampingMass::both or DampingMass::free, got 7; free counts a bonded concrete "
        "sphere as held, both as if no bond held it";
    CHECK(message_of([&] { LinearSpring({.stiffness = 1e6, .damping_mass = wrong}); }) ==
          "LinearSpring" + rule);
    CHECK(message_of([&] { HertzMindlin({.youngs = 1e9, .damping_mass = wrong}); }) == "HertzMindlin" + rule);
}
